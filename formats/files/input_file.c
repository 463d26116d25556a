#include "files/input_file.h"
#include "glowworm_host.h"

#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#define FIRST_CAPACITY ((size_t)1 << 16)
#define CHUNK_BYTES ((size_t)1 << 23) /* what one thread reads at a time */

/* Shares of the free memory: a copy of a file is small beside the points that come of it. */
#define COPY_SHARE 4
#define STREAM_SHARE 2

static const uint8_t no_bytes[1];

static gw_status fail_reading(const input_file *in, int reason, gw_error *error)
{
	if (reason == EINTR)
		return gw_fail(error, GW_ERROR_CANCELLED, "reading %s was interrupted", in->name);
	return gw_fail(error, FILE_ERROR_IO, "cannot read %s: %s", in->name, strerror(reason));
}

static gw_status fail_changed(const input_file *in, gw_error *error)
{
	return gw_fail(error, FILE_ERROR_IO,
				   "%s was changed or cut short while it was read; try again when nothing writes "
				   "to it",
				   in->name);
}

/* ---------------------------------------------------------------------------- mapped files */

/*
 * Where mapped files lie, for a signal handler. A slot belongs to whoever set its `taken`; bytes
 * are only looked at while `begin` is set.
 */
#define MAPPED_MOST 64

typedef struct mapped_range {
	atomic_bool taken;
	atomic_uintptr_t begin, end; /* 0: nothing */
	atomic_bool failed;
} mapped_range;

static mapped_range mapped_ranges[MAPPED_MOST];

static mapped_range *register_range(const void *begin, size_t length)
{
	for (size_t i = 0; i < MAPPED_MOST; i++) {
		mapped_range *r = &mapped_ranges[i];
		if (atomic_exchange(&r->taken, true))
			continue;
		atomic_store(&r->failed, false);
		atomic_store(&r->end, (uintptr_t)begin + length);
		atomic_store(&r->begin, (uintptr_t)begin);
		return r;
	}
	return NULL;
}

static void unregister_range(mapped_range *r)
{
	atomic_store(&r->begin, 0);
	atomic_store(&r->taken, false);
}

/* From the page that failed to the end, zeros take the place of the file: readers expect anything,
 * and what they make of it is thrown away. */
bool input_file_lost_page(const void *address)
{
	uintptr_t at = (uintptr_t)address, page = (uintptr_t)sysconf(_SC_PAGESIZE);
	for (size_t i = 0; i < MAPPED_MOST; i++) {
		mapped_range *r = &mapped_ranges[i];
		uintptr_t begin = atomic_load(&r->begin), end = atomic_load(&r->end);
		if (begin == 0 || at < begin || at >= (end + page - 1) / page * page)
			continue;
		atomic_store(&r->failed, true);
		return mmap((void *)(at / page * page), end - at / page * page, PROT_READ,
					MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | MAP_FIXED, -1, 0) != MAP_FAILED;
	}
	return false;
}

static bool map_file(input_file *in, int descriptor, const struct stat *info)
{
	void *bytes = mmap(NULL, (size_t)info->st_size, PROT_READ, MAP_PRIVATE, descriptor, 0);
	if (bytes == MAP_FAILED)
		return false;
	in->range = register_range(bytes, (size_t)info->st_size);
	in->descriptor = in->range ? fcntl(descriptor, F_DUPFD_CLOEXEC, 3) : -1;
	if (in->descriptor < 0) {
		if (in->range)
			unregister_range(in->range);
		munmap(bytes, (size_t)info->st_size);
		return false;
	}
	in->data = bytes;
	in->length = (size_t)info->st_size;
	in->modified = info->st_mtim;
	in->storage = INPUT_FILE_MAPPED;
	return true;
}

/* --------------------------------------------------------------------------- copied files */

/* Whether the file is still the one that was opened. */
static bool unchanged(int descriptor, size_t length, struct timespec modified)
{
	struct stat now;
	return fstat(descriptor, &now) == 0 && (uintmax_t)now.st_size == length &&
		   now.st_mtim.tv_sec == modified.tv_sec && now.st_mtim.tv_nsec == modified.tv_nsec;
}

typedef struct copying {
	int descriptor;
	uint8_t *to;
	atomic_bool ended; /* before the length that it had */
	atomic_int reason; /* errno of the first failure */
} copying;

static void copy_range(void *user, size_t first, size_t last, uint32_t worker)
{
	copying *c = user;
	(void)worker;
	while (first < last && !atomic_load(&c->ended) && !atomic_load(&c->reason)) {
		ssize_t got = pread(c->descriptor, c->to + first, last - first, (off_t)first);
		if (got < 0)
			atomic_store(&c->reason, errno);
		else if (got == 0)
			atomic_store(&c->ended, true);
		else
			first += (size_t)got;
	}
}

/* Takes memory of its own, so that nothing that happens to the file matters any more. */
static gw_status copy_file(input_file *in, int descriptor, const struct stat *info, gw_error *error)
{
	size_t length = (size_t)info->st_size;
	void *bytes = mmap(NULL, length, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
	if (bytes == MAP_FAILED)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the %zu bytes of %s", length,
					   in->name);
	/* A page at a time, to get them takes longer than to fill them; no matter if it cannot be. */
	(void)madvise(bytes, length, MADV_HUGEPAGE);
	in->data = bytes;
	in->length = length;
	in->storage = INPUT_FILE_COPIED;
	copying job = { .descriptor = descriptor, .to = bytes };
	gw_parallel_for(0, length, CHUNK_BYTES, copy_range, &job);
	if (job.reason)
		return fail_reading(in, job.reason, error);
	if (job.ended || !unchanged(descriptor, length, info->st_mtim))
		return fail_changed(in, error);
	return GW_OK;
}

/* ------------------------------------------------------------------------------- streams */

/* Doubles the buffer when it is full. The system would promise more than it has, and then end us;
 * and what never ends has to end here. */
static gw_status grow(const input_file *in, uint64_t most, uint8_t **bytes, size_t *capacity,
					  size_t length, gw_error *error)
{
	if (length < *capacity)
		return GW_OK;
	size_t wanted = *capacity ? *capacity * 2 : FIRST_CAPACITY;
	wanted = wanted > most && length < most ? (size_t)most : wanted;
	uint8_t *grown = wanted <= most ? realloc(*bytes, wanted) : NULL;
	if (!grown)
		return gw_fail(error, GW_ERROR_MEMORY,
					   "%s brings more than the %zu bytes read so far, and there is no memory "
					   "for it, or it has no end; save it to a file first",
					   in->name, length);
	*bytes = grown;
	*capacity = wanted;
	return GW_OK;
}

/* Reads to the end; for everything that has no size. */
static gw_status read_to_end(input_file *in, int descriptor, gw_error *error)
{
	uint8_t *bytes = NULL;
	size_t capacity = 0, length = 0;
	uint64_t available = gw_available_memory();
	uint64_t most = available ? available / STREAM_SHARE : SIZE_MAX / 2;
	most = in->most && in->most < most ? in->most : most;
	for (;;) {
		gw_status status = grow(in, most, &bytes, &capacity, length, error);
		size_t wanted = capacity - length < CHUNK_BYTES ? capacity - length : CHUNK_BYTES;
		ssize_t got = status == GW_OK ? read(descriptor, bytes + length, wanted) : -1;
		if (got < 0) {
			status = status == GW_OK ? fail_reading(in, errno, error) : status;
			free(bytes);
			return status;
		}
		if (got == 0)
			break;
		length += (size_t)got;
	}
	in->data = bytes;
	in->length = length;
	in->storage = INPUT_FILE_HEAP;
	return GW_OK;
}

/* ------------------------------------------------------------------------------- opening */

static gw_status load(input_file *in, int descriptor, uint64_t copied, gw_error *error)
{
	struct stat info;
	if (fstat(descriptor, &info) != 0)
		return fail_reading(in, errno, error);
	if (S_ISDIR(info.st_mode))
		return gw_fail(error, FILE_ERROR_NO_INPUT, "%s is a directory, not a file", in->name);
	/* Files of /proc are regular, have no size, and still have content. A file on standard input
	 * may have been read in part by the program before us. */
	bool from_start = lseek(descriptor, 0, SEEK_CUR) == 0;
	if (!S_ISREG(info.st_mode) || info.st_size <= 0 || !from_start ||
		(uintmax_t)info.st_size > SIZE_MAX / 2)
		return read_to_end(in, descriptor, error);
	if ((uint64_t)info.st_size > copied && map_file(in, descriptor, &info))
		return GW_OK;
	return copy_file(in, descriptor, &info, error);
}

gw_status input_file_open_as(input_file *in, const char *path, uint64_t copied, uint64_t most,
							 gw_error *error)
{
	bool standard_input = strcmp(path, "-") == 0;
	*in = (input_file){ .name = "standard input", .data = no_bytes, .most = most };
	if (!standard_input && !(in->name = in->owned_name = strdup(path)))
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to open %s", path);

	int descriptor = standard_input ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC);
	gw_status status;
	if (descriptor < 0 && errno == EINTR)
		status = fail_reading(in, errno, error);
	else if (descriptor < 0)
		status = gw_fail(error, FILE_ERROR_NO_INPUT, "cannot open %s: %s", path, strerror(errno));
	else
		status = load(in, descriptor, copied, error);
	if (descriptor >= 0 && !standard_input)
		close(descriptor);
	if (status != GW_OK)
		input_file_close(in);
	return status;
}

gw_status input_file_open(input_file *in, const char *path, gw_error *error)
{
	uint64_t available = gw_available_memory();
	return input_file_open_as(in, path, available ? available / COPY_SHARE : UINT64_MAX, 0, error);
}

/* Whole pages only. */
static void give_back(const void *begin, const void *end)
{
	uintptr_t page = (uintptr_t)sysconf(_SC_PAGESIZE);
	uintptr_t first = ((uintptr_t)begin + page - 1) / page * page;
	uintptr_t last = (uintptr_t)end / page * page;
	if (first < last)
		madvise((void *)first, last - first, MADV_DONTNEED);
}

void input_file_release(const input_file *in, const void *begin, const void *end)
{
	if (in->storage == INPUT_FILE_MAPPED)
		give_back(begin, end);
}

void input_file_discard(const input_file *in, const void *begin, const void *end)
{
	if (in->storage == INPUT_FILE_MAPPED || in->storage == INPUT_FILE_COPIED)
		give_back(begin, end);
}

gw_status input_file_check(const input_file *in, gw_status status, gw_error *error)
{
	if (in->storage != INPUT_FILE_MAPPED ||
		(!atomic_load(&in->range->failed) && unchanged(in->descriptor, in->length, in->modified)))
		return status;
	return fail_changed(in, error);
}

void input_file_close(input_file *in)
{
	bool kept = gw_lent_memory_is_kept();
	if (in->storage == INPUT_FILE_HEAP && !kept)
		free((void *)(uintptr_t)in->data);
	if (in->storage == INPUT_FILE_MAPPED) {
		unregister_range(in->range);
		close(in->descriptor);
	}
	if ((in->storage == INPUT_FILE_MAPPED || in->storage == INPUT_FILE_COPIED) && !kept)
		munmap((void *)(uintptr_t)in->data, in->length);
	free(in->owned_name);
	*in = (input_file){ 0 };
}
