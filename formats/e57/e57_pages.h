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

/* What is left when the checksums are taken out. */
typedef struct e57_pages {
	uint8_t *data; /* owned; length bytes, and 16 zeros behind them */
	size_t length;
	size_t xml, xml_length; /* where the description stands, within data */
} e57_pages;

/*
 * Checks the file's header and every page's CRC-32C, and puts the pages' content together.
 *   pages   on success to be given back with e57_pages_clear; zeroed on failure
 *   error   GW_ERROR_DATA with file and place; GW_ERROR_MEMORY
 */
gw_status e57_pages_read(e57_pages *pages, const input_file *in, gw_error *error);
void e57_pages_clear(e57_pages *pages);

/* From an offset in the file to one in data. False when it lies in a checksum or behind the end. */
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
