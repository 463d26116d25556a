/* bake_journal.c - see bake_journal.h. */
#include "scene/bake_journal.h"

#include "files/checksum.h"
#include "files/output_file.h"
#include "program/text_quote.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Of a large input not all bytes are looked at: so many at its begin and at its end. */
#define LOOKED_AT ((size_t)1 << 18)

#define TEXT_MAX ((uint64_t)1 << 24)

/* The checksum of up to LOOKED_AT bytes at both ends of a file; 0 where it cannot be read. */
static uint64_t ends_of(const char *path)
{
	checksum sum = { 0 };
	struct stat info;
	uint8_t *bytes = malloc(LOOKED_AT);
	int file = open(path, O_RDONLY | O_CLOEXEC);
	bool good = bytes && file >= 0 && fstat(file, &info) == 0;
	off_t tail = good && (uint64_t)info.st_size > LOOKED_AT ? info.st_size - (off_t)LOOKED_AT : 0;
	for (int end = 0; end < 2 && good; end++) {
		ssize_t got = pread(file, bytes, LOOKED_AT, end ? tail : 0);
		good = got >= 0;
		checksum_add(&sum, bytes, good ? (size_t)got : 0);
	}
	if (file >= 0)
		close(file);
	free(bytes);
	return good ? checksum_value(&sum) : 0;
}

/* A file that the bake reads: what tells it from another. */
static void describe_file(FILE *out, const char *what, const char *path)
{
	struct stat info = { 0 };
	if (stat(path, &info) != 0)
		return;
	fprintf(out, "%s: %s of %lld bytes, changed at %lld.%09ld, sum %016llx\n", what, path,
			(long long)info.st_size, (long long)info.st_mtim.tv_sec, info.st_mtim.tv_nsec,
			(unsigned long long)ends_of(path));
}

/* Lines of a name and what it is, of which none may differ. */
static void describe(FILE *out, const settings *s, const format_parts *input)
{
	checksum scanners = { 0 };
	checksum_add(&scanners, s->scanner, 3 * s->scanner_count * sizeof *s->scanner);
	fprintf(out, "program: glowworm " GW_VERSION ", build %016llx\n",
			(unsigned long long)ends_of("/proc/self/exe"));
	fprintf(out, "command: %s\n", s->command);
	fprintf(out, "--memory: %llu\n", (unsigned long long)s->bake.memory);
	for (size_t i = 0; i < s->input_count; i++)
		describe_file(out, "input", s->input[i].path);
	fprintf(out, "points of the input: %llu\n", (unsigned long long)input->count);
	if (s->scene)
		describe_file(out, "scene file", s->scene);
	for (size_t i = 0; i < s->light_count; i++) {
		if (s->light[i].map[0])
			describe_file(out, "map of a light", s->light[i].map);
		if (s->light[i].ies[0])
			describe_file(out, "file of a luminaire", s->light[i].ies);
	}
	fprintf(out, "places of scanners: %016llx\n", (unsigned long long)checksum_value(&scanners));
}

/* text: for free() */
static gw_status make_text(const settings *s, const format_parts *input, char **text,
						   gw_error *error)
{
	size_t length;
	FILE *out = open_memstream(text, &length);
	if (out)
		describe(out, s, input);
	if (out && fclose(out) == 0)
		return GW_OK;
	if (out)
		free(*text);
	return gw_fail(error, GW_ERROR_MEMORY, "no memory to describe the bake");
}

/* Fails by the first line that differs. */
static gw_status compare(const journal_file *journal, const char *then, const char *now,
						 gw_error *error)
{
	const char *name = journal_file_name(journal);
	while (*then && *now) {
		size_t a = strcspn(then, "\n"), b = strcspn(now, "\n");
		if (a != b || memcmp(then, now, a) != 0)
			return gw_fail(error, GW_ERROR_USAGE,
						   "%s is of another bake and cannot be gone on with; then '%.*s', now "
						   "'%.*s'. Remove it to begin anew",
						   name, (int)(a < 300 ? a : 300), then, (int)(b < 300 ? b : 300), now);
		then += a + (then[a] == '\n');
		now += b + (now[b] == '\n');
	}
	if (!*then && !*now)
		return GW_OK;
	return gw_fail(error, GW_ERROR_USAGE,
				   "%s is of another bake and cannot be gone on with. Remove it to begin anew",
				   name);
}

static gw_status read_head(journal_file *journal, const char *text, uint64_t *most, gw_error *error)
{
	uint64_t length = journal_file_length(journal);
	if (length < sizeof *most || length > TEXT_MAX)
		return gw_fail(error, GW_ERROR_DATA, "%s is damaged; remove it to begin anew",
					   journal_file_name(journal));
	length -= sizeof *most;
	char *then = calloc(1, (size_t)length + 1);
	if (!then)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to read %s", journal_file_name(journal));
	gw_status status = journal_file_read(journal, most, sizeof *most, error);
	if (status == GW_OK)
		status = journal_file_read(journal, then, (size_t)length, error);
	if (status == GW_OK)
		status = journal_file_end(journal, error);
	if (status == GW_OK)
		status = compare(journal, then, text, error);
	free(then);
	return status;
}

static gw_status write_head(journal_file *journal, const char *text, uint64_t most, gw_error *error)
{
	GW_TRY(journal_file_write(journal, &most, sizeof most, error));
	GW_TRY(journal_file_write(journal, text, strlen(text), error));
	return journal_file_end(journal, error);
}

static gw_status begin(bake_journal *journal, const char *text, gw_error *error)
{
	uint64_t kept = journal->most;
	GW_TRY(journal_file_begin(journal->file, "bake", &journal->begun, error));
	GW_TRY(journal->begun ? read_head(journal->file, text, &kept, error)
						  : write_head(journal->file, text, kept, error));
	journal->most = (size_t)kept;
	return GW_OK;
}

/* What another run has kept is whole, or the bake does not go on with it. */
static gw_status check_kept(const bake_journal *journal, bool tiles, gw_error *error)
{
	static const char *const tag[] = { BAKE_JOURNAL_KEPT, BAKE_JOURNAL_LIGHT, BAKE_JOURNAL_SORTED };
	size_t count = sizeof tag / sizeof *tag - !tiles;
	return journal->begun ? journal_file_check(journal->file, tag, count, error) : GW_OK;
}

gw_status bake_journal_open(const bake_journal_use *use, const settings *s,
							const format_parts *input, bake_journal *journal, gw_error *error)
{
	char *text;
	journal->file = NULL;
	GW_TRY(make_text(s, input, &text, error));
	gw_status status = journal_file_open(&journal->file, use->path, use->owner, use->keep, error);
	if (status == GW_OK)
		status = begin(journal, text, error);
	if (status == GW_OK && use->owner)
		status = check_kept(journal, s->tiles > 0, error);
	free(text);
	if (status != GW_OK)
		journal_file_close(&journal->file, false);
	return status;
}

/* ------------------------------------------------------------------------ what others left behind
 */

static gw_status remove_left(const char *journal, const char *part, const char *tiles,
							 gw_error *error)
{
	journal_file *left;
	GW_TRY(journal_file_open(&left, journal, true, true, error));
	unlink(part);
	if (tiles)
		unlink(tiles);
	journal_file_close(&left, true);
	return GW_OK;
}

static gw_status say_left(const settings *s, const char *journal, const char *part, bool needed,
						  gw_error *error)
{
	static const char text[] =
		"%s and %s are left of a bake that was stopped: --resume goes on with "
		"it, --force removes them";
	char *said;
	if (needed)
		return gw_fail(error, FILE_ERROR_CREATE, text, part, journal);
	if (!s->quiet && asprintf(&said, text, part, journal) >= 0) {
		text_message(stderr, "glowworm: note: %s\n", said);
		free(said);
	}
	return GW_OK;
}

gw_status bake_journal_left(const settings *s, bool needed, gw_error *error)
{
	char *journal = output_file_beside(s->output, BAKE_JOURNAL_NAME);
	char *part = output_file_beside(s->output, OUTPUT_FILE_PART);
	char *tiles = output_file_beside(s->output, BAKE_JOURNAL_TILES OUTPUT_FILE_PART);
	gw_status status = GW_OK;
	if (!journal || !part)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for the name of a file");
	else if (access(journal, F_OK) == 0)
		status = s->force ? remove_left(journal, part, tiles, error)
						  : say_left(s, journal, part, needed, error);
	free(journal);
	free(part);
	free(tiles);
	return status;
}
