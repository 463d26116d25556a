#include "scene/mesh_notes.h"
#include "program/text_quote.h"

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
					 "glowworm: note: %s: %zu faces with fewer than 3 corners are left out\n", name,
					 m->faces_flat);
	if (m->degenerate > 0)
		text_message(stderr,
					 "glowworm: note: %s: %zu of %zu triangles have no area and are left out\n",
					 name, m->degenerate, m->triangle_count);
	if (m->faces_crossed > 0)
		text_message(
			stderr,
			"glowworm: note: %s: %zu concave faces cross themselves or have over 256 corners, "
			"and became fans, which may overlap\n",
			name, m->faces_crossed);
}
