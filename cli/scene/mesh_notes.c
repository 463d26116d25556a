#include "scene/mesh_notes.h"
#include "program/text_quote.h"
#include "glowworm_host.h"

#include <stdio.h>

void mesh_notes_print(const mesh *m, const char *name, bool albedo_given)
{
	for (size_t i = 0; i < m->note_count; i++)
		text_message(stderr, "glowworm: note: %s\n", m->note[i]);
	if (m->bare && !albedo_given)
		text_message(stderr,
					 "glowworm: note: %s has neither materials nor colours; its albedo is %g\n",
					 name, (double)GW_ALBEDO_DEFAULT);
	if (m->faces_flat > 0)
		text_message(stderr,
					 "glowworm: note: %s: %zu face%s with fewer than 3 corners %s left out\n", name,
					 m->faces_flat, gw_plural(m->faces_flat, "", "s"),
					 gw_plural(m->faces_flat, "is", "are"));
	if (m->degenerate > 0)
		text_message(
			stderr, "glowworm: note: %s: %zu of %zu triangle%s %s no area and %s left out\n", name,
			m->degenerate, m->triangle_count, gw_plural(m->triangle_count, "", "s"),
			gw_plural(m->degenerate, "has", "have"), gw_plural(m->degenerate, "is", "are"));
	if (m->faces_crossed > 0)
		text_message(
			stderr,
			"glowworm: note: %s: %zu concave face%s or %s over 256 corners, and became %s\n", name,
			m->faces_crossed, gw_plural(m->faces_crossed, " crosses itself", "s cross themselves"),
			gw_plural(m->faces_crossed, "has", "have"),
			gw_plural(m->faces_crossed, "a fan, which may overlap itself",
					  "fans, which may overlap"));
}
