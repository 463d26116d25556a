/* thinned_scene.c - see thinned_scene.h. */
#include "scene/thinned_scene.h"

#include "program/text_quote.h"

#include <stdio.h>

gw_status thinned_scene_read(const settings *s, const parted_cloud_look *look, const char *done,
							 thinned_scene *scene, gw_error *error)
{
	*scene = (thinned_scene){ .loaded = { .place = coordinates_metres() } };
	GW_TRY(parted_cloud_open_to_look(s, look, &scene->parted, error));
	parted_cloud *parted = scene->parted.most > 0 ? &scene->parted : NULL;
	GW_TRY(loaded_scene_read_parted(s, parted, &scene->loaded, error));
	if (!s->quiet && parted)
		text_message(stderr,
					 "glowworm: note: %zu points are %s of %llu, spread over their surface: memory "
					 "holds no more (--memory)\n",
					 scene->loaded.cloud.count, done, (unsigned long long)parted->file.count);
	return GW_OK;
}

void thinned_scene_clear(thinned_scene *scene)
{
	loaded_scene_clear(&scene->loaded);
	parted_cloud_close(&scene->parted);
}
