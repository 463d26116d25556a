#include "program/exit_code.h"

#include <signal.h>

int exit_code_of(gw_status status, int signal)
{
	static const int code[] = {
		[GW_OK] = EXIT_CODE_GOOD,
		[GW_ERROR_USAGE] = EXIT_CODE_USAGE,
		[GW_ERROR_DATA] = EXIT_CODE_DATA,
		[GW_ERROR_NO_DEVICE] = EXIT_CODE_NO_DEVICE,
		[GW_ERROR_MEMORY] = EXIT_CODE_MEMORY,
		[GW_ERROR_INTERNAL] = EXIT_CODE_INTERNAL,
		[GW_ERROR_NO_INPUT] = EXIT_CODE_NO_INPUT,
		[GW_ERROR_CREATE] = EXIT_CODE_CREATE,
		[GW_ERROR_IO] = EXIT_CODE_IO,
		[GW_ERROR_MISSED] = EXIT_CODE_MISSED,
	};
	if (status == GW_ERROR_CANCELLED)
		return EXIT_CODE_SIGNAL + (signal ? signal : SIGINT);
	return code[status];
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
