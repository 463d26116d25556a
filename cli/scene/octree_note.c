#include "scene/octree_note.h"

#include <stdio.h>

void octree_note_print(double leaf_size, double wanted, const char *why)
{
	if (wanted > 0.0)
		fprintf(stderr,
				"glowworm: note: the octree was made coarser, with leaves of %.3g m in place of "
				"%.3g m: %s\n",
				leaf_size, wanted, why);
}
