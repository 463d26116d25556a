/*
 * page_file.h - a page as a file: one HTML document that asks for nothing else.
 *
 * It is page.html, with page.css, the scripts of page_*.js and the scene as JSON put in, and after
 * them a script element for every block of points, deflated and in base64, so that a browser shows
 * the first points while it reads the last.
 */
#ifndef PAGE_FILE_H
#define PAGE_FILE_H

#include "files/output_file.h"
#include "page/page_scene.h"

/*
 * Writes a page.
 *   title    shown above it
 *   bytes    receives the file's length
 * Fails with FILE_ERROR_IO; GW_ERROR_MEMORY; GW_ERROR_CANCELLED.
 */
gw_status page_file_write(output_file *out, const settings *settings, const page_scene *page,
						  const char *title, uint64_t *bytes, gw_error *error);

#endif
