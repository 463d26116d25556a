/*
 * nearest_name.h - the known name that was probably meant.
 */
#ifndef NEAREST_NAME_H
#define NEAREST_NAME_H

#include <stddef.h>

/* Room for what nearest_name_hint writes, with the final zero. */
#define NEAREST_NAME_HINT 128

/*
 * Writes a question for the end of a message.
 *   hint    receives "; did you mean 'NAME'?", or an empty text when nothing is near
 *   word    what was given
 *   prefix  put before the name in the question, such as "--"
 *   name    count known names; NULL entries are skipped
 * Returns hint. Near are names that at most a third of the letters set apart (edits as counted by
 * Damerau: insert, remove, replace, swap neighbours), and names that begin with the word.
 */
const char *nearest_name_hint(char hint[NEAREST_NAME_HINT], const char *word, const char *prefix,
							  const char *const *name, size_t count);

#endif
