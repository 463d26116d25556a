/*
 * json_place.h - where in a JSON text a value stands, for messages.
 */
#ifndef JSON_PLACE_H
#define JSON_PLACE_H

#include <stddef.h>

/* One step into a value: to a member by its key, or when key is NULL to an element by index. */
typedef struct json_step {
	const char *key;
	size_t index;
} json_step;

/*
 * Finds a value.
 *   text    length bytes that are known to be valid JSON
 *   step    count steps from the outermost value; where one leads nowhere, the place before it
 * holds Returns the line, from 1. Keys written with escapes are not found.
 */
size_t json_place_line(const char *text, size_t length, const json_step *step, size_t count);

#endif
