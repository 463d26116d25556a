/*
 * octree_note.h - tells people of an octree that is not as fine as it was to be.
 */
#ifndef OCTREE_NOTE_H
#define OCTREE_NOTE_H

/*
 * Prints a note to standard error; nothing where wanted is 0.
 *   leaf_size   metres
 *   wanted      metres, what it was to be
 *   why         a sentence
 */
void octree_note_print(double leaf_size, double wanted, const char *why);

#endif
