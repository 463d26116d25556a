/*
 * e57_file.h - a small E57 file made by hand, for tests.
 *
 * Two scans. The first has 5 records of every type, of which number 2 is invalid, in two packets
 * with an index packet between them; its pose turns x to y and moves by 1000, 2000, 3000. The
 * second has 2 spherical records and no pose.
 */
#ifndef E57_FILE_H
#define E57_FILE_H

#include <stddef.h>
#include <stdint.h>

#define E57_FILE_ROOM 4096

/*
 * Makes the bytes of the file without checksums: header, records, description.
 *   content  E57_FILE_ROOM bytes
 *   xml      receives where the description begins
 * Returns their number.
 */
size_t e57_file_content(uint8_t *content, size_t *xml);

/*
 * Puts content into pages with their checksums, and the lengths into the header, unless they are
 * cut off.
 *   file   room for E57_FILE_PAGES(length) bytes
 * Returns the file's length.
 */
#define E57_FILE_PAGES(length) (((length) / 1020 + 1) * 1024)
size_t e57_file_pages(const uint8_t *content, size_t length, size_t xml, uint8_t *file);

#endif
