/* input_notes.h - what people should know about inputs before they wait for their light. */
#ifndef INPUT_NOTES_H
#define INPUT_NOTES_H

#include "options/settings.h"
#include "scene/loaded_scene.h"

/* Says on standard error what was taken for the albedo where colours do not tell it, what looks
 * wrong with it, what coordinates and units were taken for, and what files say of themselves. */
void input_notes_print(const settings *settings, const loaded_scene *scene);

#endif
