#include "verbs/verbs.h"
#include "program/exit_code.h"
#include "verbs/health.h"

#include <stdlib.h>

static gw_status examine(health *h, gw_error *error)
{
	health_of_program(h);
	GW_TRY(health_of_devices(h, error));
	GW_TRY(health_of_machine(h, error));
	GW_TRY(health_of_libraries(h, error));
	if (h->asked->json)
		health_print_json(h, stdout);
	else
		health_print(h, stdout);
	size_t bad = health_tally(h, HEALTH_BAD);
	if (h->bakes == 0)
		return gw_fail(error, GW_ERROR_NO_DEVICE,
					   "no Vulkan device can bake here; the lines that begin with BAD say why");
	if (bad > 0)
		return gw_fail(error, STATUS_MISSED, "%zu thing%s not good; %s", bad,
					   bad == 1 ? " is" : "s are", "the lines that begin with BAD say which");
	return GW_OK;
}

gw_status verb_doctor(const settings *s, gw_error *error)
{
	if (s->input_count > 0)
		return gw_fail(error, GW_ERROR_USAGE, "doctor takes no files");
	health *h = calloc(1, sizeof *h);
	if (!h)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a list");
	h->asked = s;
	gw_status status = examine(h, error);
	free(h);
	return status;
}
