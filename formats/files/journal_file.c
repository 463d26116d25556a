#include "files/journal_file.h"

#include "files/checksum.h"
#include "files/output_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

/* Heads lie within one sector of a disk. */
#define ALIGNED 512u

typedef struct head {
	char tag[8];
	uint64_t length, value; /* of the section's bytes, and their checksum */
	uint64_t own;           /* checksum of what is above */
} head;

/* A slot as it is in the file. */
typedef struct stored {
	journal_slot slot;
	uint64_t own; /* checksum of the slot and of its number */
} stored;

struct journal_file {
	char *path;
	int descriptor;
	bool owner, keep;
	uint64_t at;    /* of the section's head */
	uint64_t place; /* that is read or written next */
	head section;
	bool there;
	checksum sum;   /* of its bytes so far */
	uint64_t slots; /* where the table begins; 0: it is not known yet */
};

/* --------------------------------------------------------------------------------- bytes there */

static gw_status fail_io(const journal_file *j, const char *what, gw_error *error)
{
	return gw_fail(error, errno == EINTR ? GW_ERROR_CANCELLED : FILE_ERROR_IO, "cannot %s %s: %s",
				   what, j->path, strerror(errno));
}

static gw_status fail_damaged(const journal_file *j, gw_error *error)
{
	return gw_fail(error, GW_ERROR_DATA,
				   "%s is damaged, so that nothing can go on from it; remove it to begin anew",
				   j->path);
}

static gw_status put_at(const journal_file *j, uint64_t place, const void *bytes, size_t length,
						gw_error *error)
{
	const uint8_t *from = bytes;
	while (length > 0) {
		ssize_t written = pwrite(j->descriptor, from, length, (off_t)place);
		if (written < 0)
			return fail_io(j, "write", error);
		from += written;
		place += (uint64_t)written;
		length -= (size_t)written;
	}
	return GW_OK;
}

/* How many bytes were there; what is missing is zeros. */
static gw_status get_at(const journal_file *j, uint64_t place, void *bytes, size_t length,
						size_t *got, gw_error *error)
{
	memset(bytes, 0, length);
	for (*got = 0; *got < length;) {
		ssize_t more =
			pread(j->descriptor, (uint8_t *)bytes + *got, length - *got, (off_t)(place + *got));
		if (more < 0)
			return fail_io(j, "read", error);
		if (more == 0)
			break;
		*got += (size_t)more;
	}
	return GW_OK;
}

static uint64_t value_of(const void *bytes, size_t length, uint64_t number)
{
	checksum sum = { 0 };
	checksum_add(&sum, bytes, length);
	checksum_add(&sum, &number, sizeof number);
	return checksum_value(&sum);
}

gw_status journal_file_sync(journal_file *j, gw_error *error)
{
	return fdatasync(j->descriptor) == 0 ? GW_OK : fail_io(j, "write", error);
}

/* ------------------------------------------------------------------------------------- the file */

static gw_status open_file(journal_file *j, gw_error *error)
{
	int create = j->owner ? O_CREAT : 0;
	j->descriptor = open(j->path, O_RDWR | create | O_CLOEXEC | O_NOFOLLOW, 0666);
	if (j->descriptor < 0)
		return gw_fail(error, FILE_ERROR_CREATE, "cannot create %s: %s", j->path, strerror(errno));
	if (j->owner && flock(j->descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
		return gw_fail(error, FILE_ERROR_CREATE,
					   "another glowworm works on this: it holds the lock of %s", j->path);
	if (!j->keep && !output_file_register(j->path))
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", j->path);
	return GW_OK;
}

gw_status journal_file_open(journal_file **journal, const char *path, bool owner, bool keep,
							gw_error *error)
{
	journal_file *j = *journal = calloc(1, sizeof *j);
	char *name = strdup(path);
	gw_status status = GW_OK;
	if (!j || !name) {
		free(name);
		free(j);
		*journal = NULL;
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", path);
	}
	*j = (journal_file){ .path = name, .owner = owner, .keep = keep };
	status = open_file(j, error);
	if (status == GW_OK)
		return GW_OK;
	/* It is not ours. */
	if (j->descriptor >= 0)
		close(j->descriptor);
	free(j->path);
	free(j);
	*journal = NULL;
	return status;
}

const char *journal_file_name(const journal_file *j)
{
	return j->path;
}

void journal_file_close(journal_file **journal, bool done)
{
	journal_file *j = *journal;
	*journal = NULL;
	if (!j)
		return;
	if (j->owner ? done || !j->keep : !done && !j->keep)
		unlink(j->path);
	close(j->descriptor);
	if (j->keep || output_file_unregister(j->path))
		free(j->path);
	free(j);
}

/* ------------------------------------------------------------------------------------- sections */

static uint64_t behind(uint64_t at, uint64_t length)
{
	uint64_t end = at + sizeof(head) + length;
	return (end + ALIGNED - 1) / ALIGNED * ALIGNED;
}

gw_status journal_file_begin(journal_file *j, const char *tag, bool *there, gw_error *error)
{
	static const head none;
	size_t got;
	if (j->there)
		j->at = behind(j->at, j->section.length);
	GW_TRY(get_at(j, j->at, &j->section, sizeof j->section, &got, error));
	j->there = *there = memcmp(&j->section, &none, sizeof none) != 0;
	j->place = j->at + sizeof(head);
	j->sum = (checksum){ 0 };
	if (!j->there) {
		memcpy(j->section.tag, tag, strlen(tag) + 1);
		return ftruncate(j->descriptor, (off_t)j->place) == 0 || !j->owner
				   ? GW_OK
				   : fail_io(j, "write", error);
	}
	bool good = j->section.own == value_of(&j->section, offsetof(head, own), j->at) &&
				strncmp(j->section.tag, tag, sizeof j->section.tag) == 0;
	return good ? GW_OK : fail_damaged(j, error);
}

uint64_t journal_file_length(const journal_file *j)
{
	return j->section.length;
}

gw_status journal_file_write(void *journal, const void *bytes, size_t length, gw_error *error)
{
	journal_file *j = journal;
	checksum_add(&j->sum, bytes, length);
	GW_TRY(put_at(j, j->place, bytes, length, error));
	j->place += length;
	return GW_OK;
}

gw_status journal_file_read(void *journal, void *bytes, size_t length, gw_error *error)
{
	journal_file *j = journal;
	size_t got;
	if (length > j->section.length - j->sum.length)
		return fail_damaged(j, error);
	GW_TRY(get_at(j, j->place, bytes, length, &got, error));
	if (got < length)
		return fail_damaged(j, error);
	checksum_add(&j->sum, bytes, length);
	j->place += length;
	return GW_OK;
}

gw_status journal_file_end(journal_file *j, gw_error *error)
{
	uint64_t value = checksum_value(&j->sum);
	if (j->there)
		return j->sum.length == j->section.length && value == j->section.value
				   ? GW_OK
				   : fail_damaged(j, error);
	GW_TRY(journal_file_sync(j, error));
	j->section.length = j->sum.length;
	j->section.value = value;
	j->section.own = value_of(&j->section, offsetof(head, own), j->at);
	GW_TRY(put_at(j, j->at, &j->section, sizeof j->section, error));
	j->there = true;
	return journal_file_sync(j, error);
}

static gw_status check_section(journal_file *j, const char *tag, bool *there, gw_error *error)
{
	uint8_t bytes[1 << 14];
	GW_TRY(journal_file_begin(j, tag, there, error));
	if (!*there)
		return GW_OK;
	for (uint64_t left = j->section.length; left > 0;) {
		size_t length = left < sizeof bytes ? (size_t)left : sizeof bytes;
		GW_TRY(journal_file_read(j, bytes, length, error));
		left -= length;
	}
	return journal_file_end(j, error);
}

gw_status journal_file_check(const journal_file *journal, const char *const *tag, size_t count,
							 gw_error *error)
{
	journal_file ahead = *journal;
	bool there = true;
	for (size_t i = 0; i < count && there; i++)
		GW_TRY(check_section(&ahead, tag[i], &there, error));
	return GW_OK;
}

/* ---------------------------------------------------------------------------------------- slots */

static uint64_t place_of(const journal_file *j, uint64_t part)
{
	return j->slots + part * sizeof(stored);
}

gw_status journal_file_slots(journal_file *j, uint64_t count, gw_error *error)
{
	struct stat info;
	j->slots = behind(j->at, j->section.length);
	if (fstat(j->descriptor, &info) != 0)
		return fail_io(j, "read", error);
	if (!j->owner || (uint64_t)info.st_size >= place_of(j, count))
		return GW_OK;
	return ftruncate(j->descriptor, (off_t)place_of(j, count)) == 0 ? GW_OK
																	: fail_io(j, "write", error);
}

bool journal_file_get(const journal_file *j, uint64_t part, journal_slot *slot)
{
	stored s;
	size_t got;
	bool good = get_at(j, place_of(j, part), &s, sizeof s, &got, NULL) == GW_OK;
	*slot = s.slot;
	return good && got == sizeof s && s.own == value_of(&s.slot, sizeof s.slot, part);
}

gw_status journal_file_put(journal_file *j, uint64_t part, const journal_slot *slot,
						   gw_error *error)
{
	const stored s = { *slot, value_of(slot, sizeof *slot, part) };
	return put_at(j, place_of(j, part), &s, sizeof s, error);
}
