#include "options/quality_preset.h"
#include "options/options.h"

#include <string.h>

/* With how many records there are, but for the spacing: one that is given by itself says it alone.
 */
#define NUMBERS 2

static const char *const set_by_quality[] = { "least-records",  "most-records", "record-spacing",
											  "gathered-error", "rays",         "light-samples",
											  "cones",          "leaf-spacing" };

static const option *find(const char *name)
{
	return option_find(VERB_BAKE, name, strlen(name));
}

/* Whether the option was given by itself, where the quality was given there. */
static bool wins(const settings *s, const char *name, uint8_t quality)
{
	uint8_t own = s->given[find(name) - options];
	return own != SETTINGS_BY_DEFAULT && own >= quality;
}

void quality_preset_apply(settings *s)
{
	settings preset = settings_default();
	uint8_t source = s->given[find("quality") - options];
	bool refines = s->bake.max_error > 0.0f || s->bake.time_limit > 0.0f;
	if (refines && source == SETTINGS_BY_DEFAULT)
		gw_bake_options_set_start(&preset.bake);
	else
		gw_bake_options_set_quality(&preset.bake, (gw_quality)s->quality);
	uint8_t spaced = s->given[find("record-spacing") - options];
	if (wins(s, "record-spacing", source))
		preset.bake.least_records = preset.bake.most_records = 0;
	for (size_t i = 0; i < sizeof set_by_quality / sizeof *set_by_quality; i++) {
		const option *o = find(set_by_quality[i]);
		if (wins(s, set_by_quality[i], i < NUMBERS && spaced > source ? spaced : source))
			continue;
		size_t size = o->type == OPTION_COUNT ? sizeof(uint32_t) : sizeof(float);
		memcpy((char *)s + o->offset, (const char *)&preset + o->offset, size);
	}
}
