#include "own_folder.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[64];

int enter_folder(void **state)
{
	(void)state;
	strcpy(folder, "/tmp/glowworm-test-XXXXXX");
	return mkdtemp(folder) ? chdir(folder) : -1;
}

int leave_folder(void **state)
{
	(void)state;
	return chdir("/") == 0 ? rmdir(folder) : -1;
}
