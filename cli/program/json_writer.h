/*
 * json_writer.h - JSON as text, value by value (jansson, which only reads here, has the names
 * json_*). Numbers are the shortest that read back the same; those that JSON cannot hold (NaN,
 * infinity) become null.
 */
#ifndef JSON_WRITER_H
#define JSON_WRITER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef struct json_writer {
	FILE *out;
	bool lines; /* members of objects and arrays of objects on lines of their own */
	int depth;
	bool comma; /* something stands before the next value */
	int flat;   /* depth from which all is on one line; 0: none */
} json_writer;

/* Every value takes the key that it has, or NULL within an array. */
void json_put_open(json_writer *json, const char *key, char bracket);      /* '{' or '[' */
void json_put_open_flat(json_writer *json, const char *key, char bracket); /* all on one line */
void json_put_close(json_writer *json, char bracket);                      /* '}' or ']' */
void json_put_text(json_writer *json, const char *key, const char *value);
void json_put_bool(json_writer *json, const char *key, bool value);
void json_put_count(json_writer *json, const char *key, uint64_t value);
void json_put_real(json_writer *json, const char *key, double value);
void json_put_single(json_writer *json, const char *key, float value);
void json_put_reals(json_writer *json, const char *key, const double *value, size_t count);
void json_put_singles(json_writer *json, const char *key, const float *value, size_t count);

#endif
