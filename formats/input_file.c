#include "input_file.h"
#include "memory.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#define FIRST_CAPACITY ((size_t)1 << 16)

static const uint8_t no_bytes[1];

static gw_status fail_reading(const input_file *in, gw_error *error)
{
	if (errno == EINTR)
		return gw_fail(error, GW_ERROR_CANCELLED, "reading %s was interrupted", in->name);
	return gw_fail(error, GW_ERROR_IO, "cannot read %s: %s", in->name, strerror(errno));
}

/* Doubles the buffer when it is full. The system would promise more than it has, and then end us.
 */
static gw_status grow(const input_file *in, uint8_t **bytes, size_t *capacity, size_t length,
					  gw_error *error)
{
	if (length < *capacity)
		return GW_OK;
	size_t wanted = *capacity ? *capacity * 2 : FIRST_CAPACITY;
	uint64_t available = gw_available_memory();
	bool fits = available == 0 || wanted - *capacity <= available;
	uint8_t *grown = fits ? realloc(*bytes, wanted) : NULL;
	if (!grown)
		return gw_fail(error, GW_ERROR_MEMORY,
					   "%s brings more than the %zu bytes read so far, and there is no memory "
					   "for it; save it to a file first, which is read without a copy",
					   in->name, length);
	*bytes = grown;
	*capacity = wanted;
	return GW_OK;
}

/* Reads to the end; for everything that cannot be mapped. */
static gw_status read_to_end(input_file *in, int descriptor, gw_error *error)
{
	uint8_t *bytes = NULL;
	size_t capacity = 0, length = 0;
	for (;;) {
		gw_status status = grow(in, &bytes, &capacity, length, error);
		if (status != GW_OK) {
			free(bytes);
			return status;
		}
		ssize_t got = read(descriptor, bytes + length, capacity - length);
		if (got < 0) {
			status = fail_reading(in, error);
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

static gw_status load(input_file *in, int descriptor, gw_error *error)
{
	struct stat info;
	if (fstat(descriptor, &info) != 0)
		return fail_reading(in, error);
	if (S_ISDIR(info.st_mode))
		return gw_fail(error, GW_ERROR_NO_INPUT, "%s is a directory, not a file", in->name);
	/* Files of /proc are regular, have no size, and still have content. A file on standard input
	 * may have been read in part by the program before us. */
	bool from_start = lseek(descriptor, 0, SEEK_CUR) == 0;
	if (S_ISREG(info.st_mode) && info.st_size > 0 && from_start &&
		(uintmax_t)info.st_size <= SIZE_MAX) {
		void *bytes = mmap(NULL, (size_t)info.st_size, PROT_READ, MAP_PRIVATE, descriptor, 0);
		if (bytes != MAP_FAILED) {
			in->data = bytes;
			in->length = (size_t)info.st_size;
			in->storage = INPUT_FILE_MAPPED;
			return GW_OK;
		}
	}
	return read_to_end(in, descriptor, error);
}

gw_status input_file_open(input_file *in, const char *path, gw_error *error)
{
	bool standard_input = strcmp(path, "-") == 0;
	*in = (input_file){ .name = "standard input", .data = no_bytes };
	if (!standard_input && !(in->name = in->owned_name = strdup(path)))
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to open %s", path);

	int descriptor = standard_input ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC);
	gw_status status;
	if (descriptor < 0)
		status = gw_fail(error, GW_ERROR_NO_INPUT, "cannot open %s: %s", path, strerror(errno));
	else
		status = load(in, descriptor, error);
	if (descriptor >= 0 && !standard_input)
		close(descriptor);
	if (status != GW_OK)
		input_file_close(in);
	return status;
}

void input_file_release(const input_file *in, const void *begin, const void *end)
{
	uintptr_t page = (uintptr_t)sysconf(_SC_PAGESIZE);
	uintptr_t first = ((uintptr_t)begin + page - 1) / page * page;
	uintptr_t last = (uintptr_t)end / page * page;
	if (in->storage == INPUT_FILE_MAPPED && first < last)
		madvise((void *)first, last - first, MADV_DONTNEED);
}

void input_file_close(input_file *in)
{
	if (in->storage == INPUT_FILE_HEAP)
		free((void *)(uintptr_t)in->data);
	else if (in->storage == INPUT_FILE_MAPPED)
		munmap((void *)(uintptr_t)in->data, in->length);
	free(in->owned_name);
	*in = (input_file){ 0 };
}
