/*
 * e57_text.h - the XML text of an E57 file that is written.
 */
#ifndef E57_TEXT_H
#define E57_TEXT_H

#include "e57/e57_layout.h"

/*
 * Describes scans that are laid out.
 *   sum     of their values, by which the file and its scans have names; how long the text is does
 *           not hang on it
 *   text    on success the caller's, for free(); *length bytes
 *   error   GW_ERROR_MEMORY
 */
gw_status e57_text_make(const e57_layout *layout, uint64_t sum, char **text, size_t *length,
						gw_error *error);

#endif
