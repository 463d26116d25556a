#include "expected.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

void assert_ok(gw_status status, const gw_error *error)
{
	if (status == GW_ERROR_NO_DEVICE) {
		print_message("%s\n", error->text);
		skip();
	}
	if (status != GW_OK)
		fail_msg("%s", error->text);
}

void assert_ok_validated(gw_status status, const gw_error *error)
{
	assert_ok(status == GW_ERROR_USAGE ? GW_ERROR_NO_DEVICE : status, error);
}

gw_gpu *open_gpu(gw_gpu_options options)
{
	gw_gpu *gpu = NULL;
	gw_error error = { 0 };
	assert_ok_validated(gw_gpu_create(&options, &gpu, &error), &error);
	return gpu;
}
