#include "scene/octree_note.h"
#include "glowworm_host.h"

#include <stdio.h>

void octree_note_print(double leaf_size, double wanted, const char *why)
{
	if (wanted > 0.0)
		fprintf(stderr,
				"glowworm: note: the octree was made coarser, with leaves of %s m in place of "
				"%s m: %s\n",
				GW_SAID(leaf_size, 3), GW_SAID(wanted, 3), why);
}
