/*
 * bake_journal.h - the journal of a bake by parts, from which another run goes on: it begins with
 * what bake it is of. Its other sections are the points that were kept, their light, and the parts
 * of the result that are written.
 */
#ifndef BAKE_JOURNAL_H
#define BAKE_JOURNAL_H

#include "files/journal_file.h"
#include "options/settings.h"
#include "table/format_parts.h"

/* What stands behind the name of the result in that of the journal. */
#define BAKE_JOURNAL_NAME ".resume"

/* And in that of the file of its tiles (tile_file.h), where it has some; OUTPUT_FILE_PART comes
 * after. */
#define BAKE_JOURNAL_TILES ".tiles"

/* Its sections after the first, in their order; the last where it has tiles. */
#define BAKE_JOURNAL_KEPT "kept"
#define BAKE_JOURNAL_LIGHT "light"
#define BAKE_JOURNAL_SORTED "tiles"

/* How a bake by parts keeps account. */
typedef struct bake_journal_use {
	const char *path; /* of the journal */
	bool owner, keep; /* as for journal_file_open */
} bake_journal_use;

typedef struct bake_journal {
	journal_file *file; /* to be closed with journal_file_close */
	size_t most;        /* points that may be kept */
	bool begun;         /* another run began it */
} bake_journal;

/*
 * Opens the journal of a bake, or begins one.
 *   journal   with the points that may be kept, which become what they were in the run that began
 *             it; its file is NULL on failure
 * GW_ERROR_USAGE where the journal is of another bake: other options or inputs, or another program;
 * the sentence says what differs. GW_ERROR_DATA where some of its sections is damaged. Else as for
 * journal_file_open and journal_file_begin.
 */
gw_status bake_journal_open(const bake_journal_use *use, const settings *settings,
							const format_parts *input, bake_journal *journal, gw_error *error);

/* Where a bake that is not gone on with left files beside the output: a note that names them, or
 * with --force they are removed. Fails where another process works on them.
 *   needed   their names are: in place of the note it fails with it, FILE_ERROR_CREATE */
gw_status bake_journal_left(const settings *settings, bool needed, gw_error *error);

#endif
