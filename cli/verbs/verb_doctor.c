#include "verbs/verbs.h"
#include "verbs/health.h"

#include <stdlib.h>

gw_status verb_doctor(const settings *s, gw_error *error)
{
	if (s->input_count > 0)
		return gw_fail(error, GW_ERROR_USAGE, "doctor takes no files");
	health *h = calloc(1, sizeof *h);
	if (!h)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a list");
	h->asked = s;
	health_of_program(h);
	gw_status status = health_of_devices(h, error);
	if (status == GW_OK)
		status = health_of_machine(h, error);
	if (status == GW_OK)
		status = health_of_libraries(h, error);
	if (status == GW_OK && s->json)
		health_print_json(h, stdout);
	else if (status == GW_OK)
		health_print(h, stdout);
	size_t bad = health_tally(h, HEALTH_BAD);
	if (status == GW_OK && h->bakes == 0)
		status = gw_fail(error, GW_ERROR_NO_DEVICE,
						 "no Vulkan device can bake here; the lines that begin with BAD say why");
	else if (status == GW_OK && bad > 0)
		status = gw_fail(error, GW_ERROR_MISSED, "%zu thing%s not good; %s", bad,
						 bad == 1 ? " is" : "s are", "the lines that begin with BAD say which");
	free(h);
	return status;
}
