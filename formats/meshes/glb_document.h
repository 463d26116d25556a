/*
 * glb_document.h - a binary glTF 2.0 file: its JSON, and the numbers in its binary chunk.
 *
 * Sources: Khronos, glTF 2.0 specification, 3.6 (accessors) and 4 (GLB).
 */
#ifndef GLB_DOCUMENT_H
#define GLB_DOCUMENT_H

#include "files/input_file.h"

#include <jansson.h>

typedef struct glb_document {
	const input_file *in;
	gw_error *error;
	json_t *root;         /* an object */
	const uint8_t *bytes; /* the binary chunk, length bytes; NULL when there is none */
	size_t length;
} glb_document;

/* Component types, as the file names them. */
enum {
	GLB_INT8 = 5120,
	GLB_UINT8 = 5121,
	GLB_INT16 = 5122,
	GLB_UINT16 = 5123,
	GLB_UINT32 = 5125,
	GLB_FLOAT = 5126,
};

/* Where the elements of an accessor stand: all of them are inside the file. */
typedef struct glb_values {
	const uint8_t *first;
	size_t stride;      /* bytes from one element to the next */
	size_t count;       /* elements, at least 1 */
	unsigned width;     /* numbers in an element, 1 to 4 */
	unsigned component; /* GLB_INT8 ... */
	bool normalized;    /* integers stand for -1 to 1 or 0 to 1 */
} glb_values;

/* True when the first bytes of a file are those of a GLB file. */
bool glb_probe(const uint8_t *head, size_t length);

/*
 * Finds the chunks and parses the JSON.
 *   document   to be closed with glb_close, on failure too; `in` has to live as long
 *   error      kept for all other calls; GW_ERROR_DATA for another version, chunks that are longer
 *              than the file, bad JSON, or an extension that is needed and unknown here
 */
gw_status glb_open(glb_document *document, const input_file *in, gw_error *error);
void glb_close(glb_document *document);

/* Fills *error: the file, the place (as printf's first argument) and the sentence. */
gw_status glb_fail(const glb_document *document, const char *form, ...)
	__attribute__((format(printf, 2, 3)));

/* Entry `index` of a list of the document, or NULL. */
json_t *glb_entry(const glb_document *document, const char *list, size_t index);

/*
 * A count or an index of an object.
 *   value   the number; `missing` when the object has no such member
 *   error   GW_ERROR_DATA when it is no integer from 0 to 2^53
 */
gw_status glb_size(const glb_document *document, json_t *object, const char *key, size_t missing,
				   size_t *value);

/* An array of `count` numbers of an object into `to`, which stays as it is without the member.
 * GW_ERROR_DATA when it is something else. */
gw_status glb_numbers(const glb_document *document, json_t *object, const char *key, double *to,
					  size_t count);

/* Finds the elements of an accessor. GW_ERROR_DATA when it or its view is damaged, sparse, or
 * reaches out of the file. */
gw_status glb_find_values(const glb_document *document, size_t accessor, glb_values *values);

/* Number `component` of element i. */
double glb_value(const glb_values *values, size_t i, size_t component);

#endif
