#include "files/output_file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#define BUFFER_BYTES ((size_t)1 << 18)

struct output_file {
	char *name;      /* for messages */
	char *target;    /* NULL when bytes go straight to their place */
	char *temporary; /* as target */
	bool force;
	bool lasting, keep; /* see output_file_create_lasting */
	bool registered;    /* the temporary file is one that signals remove */
	checksum written;   /* of a lasting file, since output_file_seek */
	uint32_t threads;   /* see output_file_use_threads */
	int descriptor;
	uint8_t *buffer;
	size_t used;
	gw_error failure; /* the first one; status GW_OK while there is none */
};

/* ------------------------------------------------------------- temporary files and signals */

/*
 * All temporary paths, for a signal handler: chunks of slots that are never freed, each slot owned
 * by whoever exchanges its pointer. A handler on another thread may still read a path that it took;
 * therefore only the one who takes it out may free it.
 */
#define CHUNK_SLOTS 16

typedef struct chunk {
	_Atomic(char *) slot[CHUNK_SLOTS];
	_Atomic(struct chunk *) next;
} chunk;

static chunk first_chunk;

bool output_file_register(char *path)
{
	for (chunk *c = &first_chunk;;) {
		for (int i = 0; i < CHUNK_SLOTS; i++) {
			char *empty = NULL;
			if (atomic_compare_exchange_strong(&c->slot[i], &empty, path))
				return true;
		}
		chunk *next = atomic_load(&c->next);
		if (!next) {
			chunk *fresh = calloc(1, sizeof *fresh);
			if (!fresh)
				return false;
			if (atomic_compare_exchange_strong(&c->next, &next, fresh))
				next = fresh;
			else
				free(fresh);
		}
		c = next;
	}
}

/* True when the path is ours again; false when a handler took it. */
bool output_file_unregister(char *path)
{
	for (chunk *c = &first_chunk; c; c = atomic_load(&c->next)) {
		for (int i = 0; i < CHUNK_SLOTS; i++) {
			char *expected = path;
			if (atomic_compare_exchange_strong(&c->slot[i], &expected, NULL))
				return true;
		}
	}
	return false;
}

void output_file_remove_temporaries(void)
{
	int saved = errno;
	for (chunk *c = &first_chunk; c; c = atomic_load(&c->next)) {
		for (int i = 0; i < CHUNK_SLOTS; i++) {
			char *path = atomic_exchange(&c->slot[i], NULL);
			if (path)
				unlink(path);
		}
	}
	errno = saved;
}

/* ------------------------------------------------------------------------------ starting */

/* Length of the folder part of a path, with its slash; 0 when there is none. */
static size_t folder_length(const char *path)
{
	const char *slash = strrchr(path, '/');
	return slash ? (size_t)(slash - path) + 1 : 0;
}

/* ---------------------------------------------------------------------- those left by the dead */

/*
 * A process that is killed, or whose machine fails, leaves its temporary file. It is removed by the
 * next one that writes to the folder, if it is surely of a dead one: its name is one of ours, it
 * belongs to us, the process in its name does not live here, and nobody, on this machine or where
 * locks are shared between machines, holds the lock that its writer takes and the dead let go.
 */
static bool is_left(int folder, const char *name)
{
	long process;
	unsigned serial;
	int end = 0;
	struct stat info;
	if (sscanf(name, ".glowworm-%ld-%u.part%n", &process, &serial, &end) < 2 || end == 0 ||
		name[end] != '\0' || process <= 0 || kill((pid_t)process, 0) == 0 || errno != ESRCH)
		return false;
	return fstatat(folder, name, &info, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(info.st_mode) &&
		   info.st_uid == geteuid();
}

static void remove_if_unlocked(int folder, const char *name)
{
	int descriptor = openat(folder, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
	if (descriptor < 0)
		return;
	if (flock(descriptor, LOCK_EX | LOCK_NB) == 0)
		unlinkat(folder, name, 0);
	close(descriptor);
}

/* Once for a folder, or again when another one came between: many frames go into one. */
static void remove_left_ones(const char *target)
{
	static atomic_ullong last;
	size_t length = folder_length(target);
	char *path = length ? strndup(target, length) : strdup(".");
	struct stat info;
	DIR *folder = path && stat(path, &info) == 0 ? opendir(path) : NULL;
	free(path);
	if (!folder)
		return;
	unsigned long long key = info.st_ino * 31u + info.st_dev;
	if (atomic_exchange(&last, key) != key)
		for (struct dirent *entry; (entry = readdir(folder));)
			if (is_left(dirfd(folder), entry->d_name))
				remove_if_unlocked(dirfd(folder), entry->d_name);
	closedir(folder);
}

/* The lock says that the writer lives. False when somebody who took us for dead was quicker. */
static bool lock_temporary(int descriptor)
{
	struct stat info;
	if (flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
		return false;
	return fstat(descriptor, &info) == 0 && info.st_nlink > 0;
}

/* -------------------------------------------------------------------------------- the file */

char *output_file_beside(const char *path, const char *behind)
{
	char *target = realpath(path, NULL), *name;
	if (asprintf(&name, "%s%s", target ? target : path, behind) < 0)
		name = NULL;
	free(target);
	return name;
}

/* Makes signals remove it, and its permissions those of the file that it will replace. */
static gw_status adopt_temporary(output_file *out, const struct stat *replaced, gw_error *error)
{
	if (replaced)
		(void)!fchmod(out->descriptor, replaced->st_mode & 0777);
	out->registered = !out->keep && output_file_register(out->temporary);
	if (!out->keep && !out->registered)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", out->name);
	return GW_OK;
}

static void forget_temporary(output_file *out)
{
	if (!out->registered || output_file_unregister(out->temporary))
		free(out->temporary);
	out->temporary = NULL;
}

static gw_status fail_temporary(output_file *out, gw_error *error)
{
	int reason = errno;
	free(out->temporary);
	out->temporary = NULL;
	return gw_fail(error, FILE_ERROR_CREATE, "cannot create %s: %s", out->name, strerror(reason));
}

/* Creates the file of the target's name and OUTPUT_FILE_PART, or takes the one that is there. */
static gw_status open_lasting(output_file *out, const struct stat *replaced, gw_error *error)
{
	out->temporary = output_file_beside(out->target, OUTPUT_FILE_PART);
	if (!out->temporary)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", out->name);
	out->descriptor = open(out->temporary, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
	return out->descriptor < 0 ? fail_temporary(out, error) : adopt_temporary(out, replaced, error);
}

/* Creates a file of a new name in the target's folder. Permissions are those of any new file (the
 * umask applies), or those of the file that will be replaced. */
static gw_status create_temporary(output_file *out, const struct stat *replaced, gw_error *error)
{
	static atomic_uint serial;
	size_t folder = folder_length(out->target);
	size_t size = folder + 64;
	out->temporary = malloc(size);
	if (!out->temporary)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", out->name);
	remove_left_ones(out->target);
	do {
		if (out->descriptor >= 0)
			close(out->descriptor);
		snprintf(out->temporary, size, "%.*s.glowworm-%ld-%u.part", (int)folder, out->target,
				 (long)getpid(), atomic_fetch_add(&serial, 1));
		out->descriptor = open(out->temporary, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
	} while (out->descriptor < 0 ? errno == EEXIST : !lock_temporary(out->descriptor));
	return out->descriptor < 0 ? fail_temporary(out, error) : adopt_temporary(out, replaced, error);
}

static gw_status open_directly(output_file *out, int descriptor, gw_error *error)
{
	out->descriptor = descriptor;
	if (descriptor < 0)
		return gw_fail(error, errno == EINTR ? GW_ERROR_CANCELLED : FILE_ERROR_CREATE,
					   "cannot open %s for writing: %s", out->name, strerror(errno));
	return GW_OK;
}

static gw_status fail_existing(const char *name, gw_error *error)
{
	return gw_fail(error, FILE_ERROR_CREATE,
				   "%s exists already; choose another name, or overwrite it with --force", name);
}

/* What is there under a name. */
typedef enum target_kind { TARGET_NOTHING, TARGET_FILE, TARGET_STREAM } target_kind;

/* Decides by what is there whether something can be written under the name. */
static gw_status look(const char *path, bool force, target_kind *kind, struct stat *info,
					  gw_error *error)
{
	bool there = stat(path, info) == 0;
	int reason = errno;
	*kind = !there ? TARGET_NOTHING : S_ISREG(info->st_mode) ? TARGET_FILE : TARGET_STREAM;
	if (there && S_ISDIR(info->st_mode))
		return gw_fail(error, FILE_ERROR_CREATE, "cannot create %s: it is a directory", path);
	if (*kind == TARGET_FILE && !force)
		return fail_existing(path, error);
	if (there)
		return GW_OK;
	/* Too long, or behind a folder that is none or closed. */
	if (reason != ENOENT && reason != ELOOP)
		return gw_fail(error, FILE_ERROR_CREATE, "cannot create %s: %s", path, strerror(reason));
	if (lstat(path, info) == 0)
		return gw_fail(error, FILE_ERROR_CREATE,
					   "cannot create %s: it is a symbolic link that leads nowhere", path);
	if (path[0] == '\0' || path[strlen(path) - 1] == '/')
		return gw_fail(error, FILE_ERROR_CREATE, "cannot create '%s': a file name is missing",
					   path);
	return GW_OK;
}

gw_status output_file_check(const char *path, bool force, gw_error *error)
{
	target_kind kind;
	struct stat info;
	return strcmp(path, "-") == 0 ? GW_OK : look(path, force, &kind, &info, error);
}

static gw_status fail_room(const char *path, uint64_t bytes, uint64_t most, gw_error *error)
{
	return gw_fail(error, FILE_ERROR_IO,
				   "%s will take at least %llu bytes, but there is room for %llu only", path,
				   (unsigned long long)bytes, (unsigned long long)most);
}

gw_status output_file_check_room(const char *path, uint64_t bytes, gw_error *error)
{
	struct stat info;
	struct statvfs disk;
	struct rlimit limit;
	if (strcmp(path, "-") == 0 || (stat(path, &info) == 0 && !S_ISREG(info.st_mode)))
		return GW_OK;
	if (getrlimit(RLIMIT_FSIZE, &limit) == 0 && bytes > limit.rlim_cur)
		return fail_room(path, bytes, limit.rlim_cur, error);
	size_t length = folder_length(path);
	char *folder = length ? strndup(path, length) : strdup(".");
	bool known = folder && statvfs(folder, &disk) == 0 && disk.f_blocks > 0;
	free(folder);
	if (!known)
		return GW_OK;
	uint64_t room = (uint64_t)(geteuid() == 0 ? disk.f_bfree : disk.f_bavail) * disk.f_frsize;
	return bytes > room ? fail_room(path, bytes, room, error) : GW_OK;
}

static gw_status open_target(output_file *out, const char *path, gw_error *error)
{
	struct stat info;
	target_kind kind;
	if (strcmp(path, "-") == 0 && !out->lasting)
		return open_directly(out, fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3), error);
	GW_TRY(look(path, out->force, &kind, &info, error));
	if (kind == TARGET_STREAM && out->lasting)
		return gw_fail(error, FILE_ERROR_CREATE,
					   "%s is no file, which alone can be written by parts", path);
	if (kind == TARGET_STREAM)
		return open_directly(out, open(path, O_WRONLY | O_CLOEXEC), error);
	out->target = kind == TARGET_FILE ? realpath(path, NULL) : strdup(path);
	if (!out->target)
		return gw_fail(error, FILE_ERROR_CREATE, "cannot create %s: %s", out->name,
					   strerror(errno));
	const struct stat *replaced = kind == TARGET_FILE ? &info : NULL;
	return out->lasting ? open_lasting(out, replaced, error)
						: create_temporary(out, replaced, error);
}

/* How a file is opened: as the head of output_file says. */
static gw_status create(output_file **out, const char *path, const output_file *how,
						gw_error *error)
{
	*out = NULL;
	output_file *file = calloc(1, sizeof *file);
	if (!file)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", path);
	*file = *how;
	file->descriptor = -1;
	file->name = strdup(strcmp(path, "-") == 0 ? "standard output" : path);
	file->buffer = malloc(BUFFER_BYTES);
	gw_status status;
	if (!file->name || !file->buffer)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", path);
	else
		status = open_target(file, path, error);
	if (status != GW_OK) {
		output_file_abandon(&file);
		return status;
	}
	*out = file;
	return GW_OK;
}

gw_status output_file_create(output_file **out, const char *path, bool force, gw_error *error)
{
	return create(out, path, &(output_file){ .force = force }, error);
}

gw_status output_file_create_lasting(output_file **out, const char *path, bool force, bool keep,
									 gw_error *error)
{
	return create(out, path, &(output_file){ .force = force, .lasting = true, .keep = keep },
				  error);
}

/* ------------------------------------------------------------------------------- writing */

static gw_status latched(const output_file *out, gw_error *error)
{
	if (error && out->failure.status != GW_OK)
		*error = out->failure;
	return out->failure.status;
}

static void latch(output_file *out, int reason)
{
	if (reason == EINTR)
		gw_fail(&out->failure, GW_ERROR_CANCELLED, "writing %s was interrupted", out->name);
	else
		gw_fail(&out->failure, FILE_ERROR_IO, "cannot write %s: %s", out->name, strerror(reason));
}

static void write_through(output_file *out, const uint8_t *bytes, size_t length)
{
	if (out->lasting)
		checksum_add(&out->written, bytes, length);
	while (length > 0 && out->failure.status == GW_OK) {
		ssize_t written = write(out->descriptor, bytes, length);
		if (written < 0) {
			latch(out, errno);
		} else {
			bytes += written;
			length -= (size_t)written;
		}
	}
}

gw_status output_file_flush(output_file *out, gw_error *error)
{
	write_through(out, out->buffer, out->used);
	out->used = 0;
	return latched(out, error);
}

gw_status output_file_write(output_file *out, const void *bytes, size_t length, gw_error *error)
{
	if (length > BUFFER_BYTES - out->used)
		output_file_flush(out, NULL);
	if (length > BUFFER_BYTES) {
		write_through(out, bytes, length);
	} else if (length > 0) {
		memcpy(out->buffer + out->used, bytes, length);
		out->used += length;
	}
	return latched(out, error);
}

gw_status output_file_patch(output_file *out, uint64_t offset, const void *bytes, size_t length,
							gw_error *error)
{
	const uint8_t *from = bytes;
	output_file_flush(out, NULL);
	for (size_t done = 0; done < length && out->failure.status == GW_OK;) {
		ssize_t written =
			pwrite(out->descriptor, from + done, length - done, (off_t)(offset + done));
		if (written < 0)
			latch(out, errno);
		else
			done += (size_t)written;
	}
	return latched(out, error);
}

gw_status output_file_print(output_file *out, gw_error *error, const char *format, ...)
{
	char line[1024], *text = line;
	va_list arguments;
	va_start(arguments, format);
	int length = vsnprintf(line, sizeof line, format, arguments);
	va_end(arguments);
	if (length >= (int)sizeof line) {
		va_start(arguments, format);
		length = vasprintf(&text, format, arguments);
		va_end(arguments);
	}
	if (length < 0) {
		latch(out, ENOMEM);
		return latched(out, error);
	}
	gw_status status = output_file_write(out, text, (size_t)length, error);
	if (text != line)
		free(text);
	return status;
}

/* ------------------------------------------------------------------------------ lasting files */

gw_status output_file_seek(output_file *out, uint64_t offset, gw_error *error)
{
	output_file_flush(out, NULL);
	out->written = (checksum){ 0 };
	if (out->failure.status == GW_OK && lseek(out->descriptor, (off_t)offset, SEEK_SET) < 0)
		latch(out, errno);
	return latched(out, error);
}

gw_status output_file_written(output_file *out, checksum *sum, gw_error *error)
{
	output_file_flush(out, NULL);
	*sum = out->written;
	return latched(out, error);
}

gw_status output_file_resize(output_file *out, uint64_t length, gw_error *error)
{
	output_file_flush(out, NULL);
	if (out->failure.status == GW_OK && ftruncate(out->descriptor, (off_t)length) != 0)
		latch(out, errno);
	return latched(out, error);
}

bool output_file_holds(const output_file *out, uint64_t offset, uint64_t length, uint64_t value)
{
	checksum sum = { 0 };
	uint8_t *bytes = malloc(BUFFER_BYTES);
	while (bytes && sum.length < length) {
		uint64_t left = length - sum.length;
		ssize_t got = pread(out->descriptor, bytes, left < BUFFER_BYTES ? left : BUFFER_BYTES,
							(off_t)(offset + sum.length));
		if (got <= 0)
			break;
		checksum_add(&sum, bytes, (size_t)got);
	}
	free(bytes);
	return sum.length == length && checksum_value(&sum) == value;
}

gw_status output_file_sync(output_file *out, gw_error *error)
{
	output_file_flush(out, NULL);
	if (out->failure.status == GW_OK && fdatasync(out->descriptor) != 0)
		latch(out, errno);
	return latched(out, error);
}

void output_file_leave(output_file **out)
{
	if (*out)
		(*out)->keep = true;
	output_file_abandon(out);
}

void output_file_use_threads(output_file *out, uint32_t threads)
{
	out->threads = threads;
}

uint32_t output_file_threads(const output_file *out)
{
	return out->threads;
}

const char *output_file_name(const output_file *out)
{
	return out->name;
}

const char *output_file_temporary(const output_file *out)
{
	return out->temporary;
}

/* -------------------------------------------------------------------------------- ending */

/* Renames without replacing; false with errno set. */
static bool rename_onto_nothing(const char *from, const char *to)
{
	if (renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_NOREPLACE) == 0)
		return true;
	if (errno != EINVAL && errno != ENOSYS)
		return false;
	/* The file system cannot do it in one step; a name taken within this moment is lost. */
	struct stat info;
	if (lstat(to, &info) == 0) {
		errno = EEXIST;
		return false;
	}
	return rename(from, to) == 0;
}

/* Without this a crash of the machine could undo the rename. Folders that may not be read and file
 * systems without such a thing are left alone. A failure does not unmake the file. */
static gw_status sync_folder(const output_file *out, gw_error *error)
{
	size_t length = folder_length(out->target);
	char *folder = length ? strndup(out->target, length) : strdup(".");
	int descriptor = folder ? open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1;
	bool good = descriptor >= 0 ? fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP
								: errno == EACCES;
	int reason = errno;
	if (descriptor >= 0)
		close(descriptor);
	free(folder);
	if (good)
		return GW_OK;
	return gw_fail(error, FILE_ERROR_IO,
				   "%s is written, but may not outlast a crash of this machine, because its folder "
				   "cannot be synced: %s",
				   out->name, strerror(reason));
}

static gw_status rename_temporary(output_file *out, gw_error *error)
{
	bool done = out->force ? rename(out->temporary, out->target) == 0
						   : rename_onto_nothing(out->temporary, out->target);
	if (!done && errno == EEXIST)
		return fail_existing(out->name, error);
	if (!done)
		return gw_fail(error, FILE_ERROR_IO, "cannot rename %s to %s: %s", out->temporary,
					   out->target, strerror(errno));
	forget_temporary(out);
	return sync_folder(out, error);
}

gw_status output_file_commit(output_file **out, gw_error *error)
{
	output_file *file = *out;
	output_file_flush(file, NULL);
	if (file->failure.status == GW_OK && file->target && fsync(file->descriptor) != 0)
		latch(file, errno);
	/* Network file systems report a full disk at the close. */
	if (close(file->descriptor) != 0 && file->failure.status == GW_OK)
		latch(file, errno);
	file->descriptor = -1;
	gw_status status = latched(file, error);
	if (status == GW_OK && file->target)
		status = rename_temporary(file, error);
	output_file_abandon(out);
	return status;
}

void output_file_abandon(output_file **out)
{
	output_file *file = *out;
	if (!file)
		return;
	if (file->descriptor >= 0)
		close(file->descriptor);
	if (file->temporary) {
		if (!file->keep)
			unlink(file->temporary);
		forget_temporary(file);
	}
	free(file->target);
	free(file->name);
	free(file->buffer);
	free(file);
	*out = NULL;
}
