/*
 * output_file.h - a file that appears under its name only when it is whole.
 *
 * Bytes go through a buffer into a temporary file beside the target; output_file_commit flushes,
 * syncs and renames it. Until then the name holds what it held before, or nothing. Standard output,
 * devices and FIFOs cannot be renamed: bytes go straight to them, and they are never unlinked.
 *
 * The first failure is latched: every later call returns it again, so that a writer may check
 * only its last call. Messages name the file and the reason.
 *
 * The program must ignore SIGPIPE and SIGXFSZ; then a closed pipe and a file size limit are
 * failures like a full disk.
 *
 * Thread-safety: calls on different files may run at the same time.
 */
#ifndef OUTPUT_FILE_H
#define OUTPUT_FILE_H

#include "files/checksum.h"
#include "files/file_status.h"

typedef struct output_file output_file;

/* What stands behind a target's name in that of a file that is to become it. */
#define OUTPUT_FILE_PART ".part"

/*
 * Starts an output.
 *
 *   out     receives the output, to be ended by output_file_commit or output_file_abandon;
 *           NULL on failure
 *   path    where it shall appear; "-" is standard output. A symbolic link is followed: the file
 *           it leads to is replaced, the link stays
 *   force   false: an existing file is an error, now and again at the commit
 *   error   FILE_ERROR_CREATE when it exists already or the folder is missing or cannot be written
 *           to; GW_ERROR_MEMORY
 */
gw_status output_file_create(output_file **out, const char *path, bool force, gw_error *error);

/*
 * Starts an output, or goes on with one, whose temporary file has the target's name and
 * OUTPUT_FILE_PART behind it, and may outlast the process: who kept account of its bytes goes on
 * where they end. Several processes may write different bytes of it.
 *   keep   true: output_file_abandon leaves the file, and no signal removes it
 * Fails like output_file_create, and for targets that cannot be renamed.
 */
gw_status output_file_create_lasting(output_file **out, const char *path, bool force, bool keep,
									 gw_error *error);

/* The name of a file beside the one that would be written, with something behind its name: of where
 * a symbolic link leads. For free(); NULL: there was no memory. */
char *output_file_beside(const char *path, const char *behind);

/* Goes on at a place of a file of output_file_create_lasting, and begins a checksum of what is
 * written from there on. */
gw_status output_file_seek(output_file *out, uint64_t offset, gw_error *error);

/* All bytes that were written since then, which are with the system now. */
gw_status output_file_written(output_file *out, checksum *sum, gw_error *error);

/* Makes such a file as long as it will be, or empty. */
gw_status output_file_resize(output_file *out, uint64_t length, gw_error *error);

/* Whether such a file holds bytes of a length and a checksum at a place. */
bool output_file_holds(const output_file *out, uint64_t offset, uint64_t length, uint64_t value);

/* Hands all bytes that were written to the disk. */
gw_status output_file_sync(output_file *out, gw_error *error);

/* Ends an output of which others go on: its file stays. */
void output_file_leave(output_file **out);

/* Whether a file could be started under a name, as far as its name and what is there say it. */
gw_status output_file_check(const char *path, bool force, gw_error *error);

/* FILE_ERROR_IO when that many bytes do not fit on the disk, or are more than this process may
 * write; what cannot be known is no failure. */
gw_status output_file_check_room(const char *path, uint64_t bytes, gw_error *error);

/* Appends bytes. FILE_ERROR_IO when they could not be written, now or earlier. */
gw_status output_file_write(output_file *out, const void *bytes, size_t length, gw_error *error);

/* Writes over bytes that were written before, of an output that has a temporary file. Bytes go on
 * being appended. */
gw_status output_file_patch(output_file *out, uint64_t offset, const void *bytes, size_t length,
							gw_error *error);

/* Appends text, formatted as printf does; numbers with a decimal point follow the locale, so print
 * those with number_text.h. */
gw_status output_file_print(output_file *out, gw_error *error, const char *format, ...)
	__attribute__((format(printf, 3, 4)));

/* Hands all buffered bytes to the system, so that the file can be opened and read back. */
gw_status output_file_flush(output_file *out, gw_error *error);

/* Threads that writers may use for what they write; 0, as at first: one a processor. */
void output_file_use_threads(output_file *out, uint32_t threads);
uint32_t output_file_threads(const output_file *out);

/* The name for messages: the path, or "standard output". Valid as long as the output. */
const char *output_file_name(const output_file *out);

/* Path of the temporary file, or NULL when bytes go straight to a device, FIFO or standard output.
 * Valid as long as the output. */
const char *output_file_temporary(const output_file *out);

/*
 * Ends an output: flush, sync, rename, sync of the folder. Frees it and sets *out to NULL, whether
 * it succeeds or not; on failure the temporary file is removed and the target untouched, but for a
 * folder that cannot be synced: then the file is there, whole, and FILE_ERROR_IO says so.
 */
gw_status output_file_commit(output_file **out, gw_error *error);

/* Ends an output that is not wanted any more: removes the temporary file, frees it and sets *out to
 * NULL. An empty handle is accepted. */
void output_file_abandon(output_file **out);

/* Removes the temporary files of all outputs that are open. Async-signal-safe: for a handler that
 * ends the process. */
void output_file_remove_temporaries(void);

/* Has it remove another file, too; false when memory is short. The path is lent until
 * output_file_unregister, which is false where a signal took it: it may not be freed then. */
bool output_file_register(char *path);
bool output_file_unregister(char *path);

#endif
