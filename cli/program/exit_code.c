#include "program/exit_code.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <string.h>

int exit_code_of(gw_status status, int signal)
{
	static const struct {
		gw_status status;
		int code;
	} table[] = {
		{ GW_OK, EXIT_CODE_GOOD },
		{ GW_ERROR_USAGE, EXIT_CODE_USAGE },
		{ GW_ERROR_DATA, EXIT_CODE_DATA },
		{ GW_ERROR_NO_DEVICE, EXIT_CODE_NO_DEVICE },
		{ GW_ERROR_MEMORY, EXIT_CODE_MEMORY },
		{ FILE_ERROR_NO_INPUT, EXIT_CODE_NO_INPUT },
		{ FILE_ERROR_CREATE, EXIT_CODE_CREATE },
		{ FILE_ERROR_IO, EXIT_CODE_IO },
		{ STATUS_MISSED, EXIT_CODE_MISSED },
	};
	if (status == GW_ERROR_CANCELLED)
		return EXIT_CODE_SIGNAL + (signal ? signal : SIGINT);
	for (size_t i = 0; i < sizeof table / sizeof *table; i++)
		if (table[i].status == status)
			return table[i].code;
	return EXIT_CODE_INTERNAL;
}

int exit_code_describe(int i, const char **meaning)
{
	static const struct {
		int code;
		const char *meaning;
	} table[] = {
		{ EXIT_CODE_GOOD, "done" },
		{ EXIT_CODE_MISSED, "done, but the result is not as good as asked" },
		{ EXIT_CODE_USAGE, "an option or argument that makes no sense" },
		{ EXIT_CODE_DATA, "an input or scene file whose content is bad" },
		{ EXIT_CODE_NO_INPUT, "an input that cannot be opened" },
		{ EXIT_CODE_NO_DEVICE, "no Vulkan device that can do the work" },
		{ EXIT_CODE_INTERNAL, "a fault of glowworm or of the driver" },
		{ EXIT_CODE_MEMORY, "not enough memory, or a limit of the device" },
		{ EXIT_CODE_CREATE, "an output that cannot be created" },
		{ EXIT_CODE_IO, "reading or writing failed half way: full disk, closed pipe" },
		{ EXIT_CODE_SIGNAL + SIGHUP, "stopped because the terminal was closed" },
		{ EXIT_CODE_SIGNAL + SIGINT, "stopped by an interrupt (Ctrl-C)" },
		{ EXIT_CODE_SIGNAL + SIGTERM, "stopped by a request to terminate" },
	};
	if (i < 0 || i >= (int)(sizeof table / sizeof *table))
		return -1;
	*meaning = table[i].meaning;
	return table[i].code;
}

/* Whether it is a pipe that nobody reads any more. */
static bool is_unread(FILE *printed)
{
	struct pollfd end = { .fd = fileno(printed), .events = POLLOUT };
	return poll(&end, 1, 0) == 1 && (end.revents & POLLERR);
}

gw_status exit_code_flush(FILE *printed, gw_error *error)
{
	errno = 0;
	if (fflush(printed) == 0 && !ferror(printed))
		return GW_OK;
	error->text[0] = '\0';
	if (is_unread(printed))
		return FILE_ERROR_IO;
	return gw_fail(error, FILE_ERROR_IO, "standard output cannot be written: %s",
				   strerror(errno ? errno : EIO));
}
