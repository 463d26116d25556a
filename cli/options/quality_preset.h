/*
 * quality_preset.h - what --quality sets.
 */
#ifndef QUALITY_PRESET_H
#define QUALITY_PRESET_H

#include "options/settings.h"

/*
 * Gives the settings of settings->quality to every option that it sets and that nobody has set by
 * itself. An option stands by itself when it was set where the quality was, or closer to the
 * command line: --quality wins over the numbers of a scene file, --rays wins over --quality. A bake
 * that refines starts from few records unless a quality is given. To be called when all
 * scene files are read.
 */
void quality_preset_apply(settings *settings);

#endif
