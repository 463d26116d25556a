#include "output_file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define BUFFER_BYTES ((size_t)1 << 18)

struct output_file {
	char *name;      /* for messages */
	char *target;    /* NULL when bytes go straight to their place */
	char *temporary; /* as target */
	bool force;
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

static bool register_temporary(char *path)
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
static bool unregister_temporary(char *path)
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
	do {
		snprintf(out->temporary, size, "%.*s.glowworm-%ld-%u.part", (int)folder, out->target,
				 (long)getpid(), atomic_fetch_add(&serial, 1));
		out->descriptor = open(out->temporary, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
	} while (out->descriptor < 0 && errno == EEXIST);
	if (out->descriptor < 0) {
		int reason = errno;
		free(out->temporary);
		out->temporary = NULL;
		return gw_fail(error, GW_ERROR_CREATE, "cannot create %s: %s", out->name, strerror(reason));
	}
	if (replaced)
		(void)!fchmod(out->descriptor, replaced->st_mode & 0777);
	if (!register_temporary(out->temporary))
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", out->name);
	return GW_OK;
}

static gw_status open_directly(output_file *out, int descriptor, gw_error *error)
{
	out->descriptor = descriptor;
	if (descriptor < 0)
		return gw_fail(error, GW_ERROR_CREATE, "cannot open %s for writing: %s", out->name,
					   strerror(errno));
	return GW_OK;
}

static gw_status fail_existing(const output_file *out, gw_error *error)
{
	return gw_fail(error, GW_ERROR_CREATE,
				   "%s exists already; choose another name, or overwrite it with --force",
				   out->name);
}

/* Decides by what is there under the name: nothing, a file, or something that is no file. */
static gw_status open_target(output_file *out, const char *path, gw_error *error)
{
	if (strcmp(path, "-") == 0)
		return open_directly(out, fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3), error);

	struct stat info, *replaced = NULL;
	if (stat(path, &info) == 0) {
		if (S_ISDIR(info.st_mode))
			return gw_fail(error, GW_ERROR_CREATE, "cannot create %s: it is a directory",
						   out->name);
		if (!S_ISREG(info.st_mode))
			return open_directly(out, open(path, O_WRONLY | O_CLOEXEC), error);
		if (!out->force)
			return fail_existing(out, error);
		replaced = &info;
		out->target = realpath(path, NULL);
	} else if (lstat(path, &info) == 0) {
		return gw_fail(error, GW_ERROR_CREATE,
					   "cannot create %s: it is a symbolic link that leads nowhere", out->name);
	} else if (path[0] == '\0' || path[strlen(path) - 1] == '/') {
		return gw_fail(error, GW_ERROR_CREATE, "cannot create '%s': a file name is missing",
					   out->name);
	} else {
		out->target = strdup(path);
	}
	if (!out->target)
		return gw_fail(error, GW_ERROR_CREATE, "cannot create %s: %s", out->name, strerror(errno));
	return create_temporary(out, replaced, error);
}

gw_status output_file_create(output_file **out, const char *path, bool force, gw_error *error)
{
	*out = NULL;
	output_file *file = calloc(1, sizeof *file);
	if (!file)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", path);
	file->descriptor = -1;
	file->force = force;
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
		gw_fail(&out->failure, GW_ERROR_IO, "cannot write %s: %s", out->name, strerror(reason));
}

static void write_through(output_file *out, const uint8_t *bytes, size_t length)
{
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
	return gw_fail(error, GW_ERROR_IO,
				   "%s is written, but may not outlast a crash of this machine, because its folder "
				   "cannot be synced: %s",
				   out->name, strerror(reason));
}

static gw_status rename_temporary(output_file *out, gw_error *error)
{
	bool done = out->force ? rename(out->temporary, out->target) == 0
						   : rename_onto_nothing(out->temporary, out->target);
	if (!done && errno == EEXIST)
		return fail_existing(out, error);
	if (!done)
		return gw_fail(error, GW_ERROR_IO, "cannot rename %s to %s: %s", out->temporary,
					   out->target, strerror(errno));
	if (unregister_temporary(out->temporary))
		free(out->temporary);
	out->temporary = NULL;
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
		unlink(file->temporary);
		if (unregister_temporary(file->temporary))
			free(file->temporary);
	}
	free(file->target);
	free(file->name);
	free(file->buffer);
	free(file);
	*out = NULL;
}
