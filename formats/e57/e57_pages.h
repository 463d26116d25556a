/*
 * e57_pages.h - the pages of an E57 file: 1020 bytes and their checksum each.
 */
#ifndef E57_PAGES_H
#define E57_PAGES_H

#include "files/input_file.h"

#define E57_PAGE ((size_t)1024)
#define E57_CONTENT ((size_t)1020) /* bytes of a page before its checksum */
#define E57_HEADER 48              /* bytes of the file's header */

/* CRC-32C of the content of a page. */
uint32_t e57_page_checksum(const uint8_t *content);

/* What is left of a file when the checksums are taken out: the pages' content. */
typedef struct e57_pages {
	const input_file *in;
	size_t length;          /* bytes of content */
	size_t xml, xml_length; /* where the description stands, within it */
} e57_pages;

/*
 * Looks at the file's header.
 *   pages   refers to the file; zeroed on failure
 *   error   GW_ERROR_DATA with file and place
 */
gw_status e57_pages_open(e57_pages *pages, const input_file *in, gw_error *error);

/* Checks every page's CRC-32C. GW_ERROR_DATA with file and place. */
gw_status e57_pages_check(const e57_pages *pages, gw_error *error);

/* Copies the content [at, at + length), which is there. */
void e57_pages_copy(const e57_pages *pages, size_t at, size_t length, void *to);

/* From an offset in the file to one in the content. False when it lies in a checksum or behind the
 * end. */
bool e57_pages_locate(const e57_pages *pages, uint64_t offset, size_t *at);

/* An unsigned number of `size` bytes, lowest first. */
static inline uint64_t e57_load(const uint8_t *bytes, size_t size)
{
	uint64_t value = 0;
	for (size_t b = 0; b < size; b++)
		value |= (uint64_t)bytes[b] << 8 * b;
	return value;
}

#endif
