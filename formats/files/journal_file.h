/*
 * journal_file.h - what a long piece of work keeps of itself, so that it can go on after its
 * process was killed or its machine failed: sections of bytes one after the other, then a table of
 * slots for parts that are done.
 *
 * A section counts when its head says so, which is written when all of its bytes are on the disk: a
 * write that was torn leaves none. Heads, sections and slots have checksums; one that is there and
 * does not fit is damage, and GW_ERROR_DATA. A slot that does not fit is one of a part that is not
 * done.
 *
 * Its owner holds a lock of the file, so that nobody else goes on with the same work; others may
 * read sections and fill slots of their own.
 */
#ifndef JOURNAL_FILE_H
#define JOURNAL_FILE_H

#include "files/file_status.h"

typedef struct journal_file journal_file;

typedef struct journal_slot {
	uint64_t offset, length; /* of the part's bytes in the file of the results */
	uint64_t value;          /* their checksum */
} journal_slot;

/*
 * Opens a journal, or creates an empty one.
 *   owner   false: one of several that work together under an owner; the file has to be there
 *   keep    false: a signal that ends the process removes the file, as journal_file_close does
 * Fails with FILE_ERROR_CREATE, also where another process owns it; GW_ERROR_MEMORY.
 */
gw_status journal_file_open(journal_file **journal, const char *path, bool owner, bool keep,
							gw_error *error);

/*
 * Looks for the next section. Where it is there it can be read with journal_file_read, and
 * journal_file_end says whether all of it was what it was to be; where it is not, the owner writes
 * it with journal_file_write, and journal_file_end makes it count.
 *   tag     up to 7 letters, not that of another section
 *   there   receives whether it is
 */
gw_status journal_file_begin(journal_file *journal, const char *tag, bool *there, gw_error *error);
uint64_t journal_file_length(const journal_file *journal); /* of the section that is there */
gw_status journal_file_write(void *journal, const void *bytes, size_t length, gw_error *error);
gw_status journal_file_read(void *journal, void *bytes, size_t length, gw_error *error);
gw_status journal_file_end(journal_file *journal, gw_error *error);

/*
 * Reads what is there of the sections that come next, so that damage shows before anything is said
 * or done; the next journal_file_begin begins where it did before.
 *   tag   count of them, in their order
 * GW_ERROR_DATA
 */
gw_status journal_file_check(const journal_file *journal, const char *const *tag, size_t count,
							 gw_error *error);

/* After all sections: makes the table of slots, or finds it. */
gw_status journal_file_slots(journal_file *journal, uint64_t count, gw_error *error);
/* False where that part is not done. */
bool journal_file_get(const journal_file *journal, uint64_t part, journal_slot *slot);
gw_status journal_file_put(journal_file *journal, uint64_t part, const journal_slot *slot,
						   gw_error *error);

/* Hands slots to the disk. */
gw_status journal_file_sync(journal_file *journal, gw_error *error);

const char *journal_file_name(const journal_file *journal);

/* Closes it; the file stays where it was to be kept and is not done with. */
void journal_file_close(journal_file **journal, bool done);

#endif
