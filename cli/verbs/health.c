#include "verbs/health.h"
#include "program/build_facts.h"
#include "program/json_writer.h"

#include <stdarg.h>
#include <string.h>

static const char *const word[HEALTH_VERDICT_COUNT] = {
	[HEALTH_GOOD] = "good", [HEALTH_WARNING] = "note", [HEALTH_BAD] = "BAD"
};

void health_begin(health *h, const char *group)
{
	snprintf(h->group, sizeof h->group, "%s", group);
}

void health_add(health *h, health_verdict verdict, const char *name, const char *format, ...)
{
	if (h->count == HEALTH_ITEMS)
		h->count--;
	health_item *item = &h->item[h->count++];
	*item = (health_item){ .verdict = verdict };
	snprintf(item->group, sizeof item->group, "%s", h->group);
	snprintf(item->name, sizeof item->name, "%s", name);
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(item->text, sizeof item->text, format, arguments);
	va_end(arguments);
}

size_t health_tally(const health *h, health_verdict verdict)
{
	size_t count = 0;
	for (size_t i = 0; i < h->count; i++)
		count += h->item[i].verdict == verdict;
	return count;
}

void health_print(const health *h, FILE *out)
{
	const char *group = "";
	for (size_t i = 0; i < h->count; i++) {
		const health_item *item = &h->item[i];
		if (strcmp(group, item->group) != 0)
			fprintf(out, "%s%s\n", i ? "\n" : "", item->group);
		group = item->group;
		fprintf(out, "  %-4s  %-22s  %s\n", word[item->verdict], item->name, item->text);
	}
	size_t bad = health_tally(h, HEALTH_BAD), notes = health_tally(h, HEALTH_WARNING);
	if (bad == 0)
		fprintf(out, "\nAll is good; %zu to note.\n", notes);
	else
		fprintf(out, "\n%zu not good, %zu to note.\n", bad, notes);
	fprintf(
		out,
		"\nWith a report of a fault send all of this, the command and what it printed, and the\n"
		"smallest input that shows it. A fault that a hostile file could use is reported\n"
		"privately, as .github/SECURITY.md says.\n");
}

void health_print_json(const health *h, FILE *out)
{
	json_writer json = { .out = out, .lines = true };
	json_put_open(&json, NULL, '{');
	json_put_text(&json, "version", GW_VERSION);
	json_put_bool(&json, "good", health_tally(h, HEALTH_BAD) == 0);
	json_put_count(&json, "bad", health_tally(h, HEALTH_BAD));
	json_put_count(&json, "notes", health_tally(h, HEALTH_WARNING));
	json_put_count(&json, "devices_that_bake", h->bakes);
	json_put_open(&json, "items", '[');
	for (size_t i = 0; i < h->count; i++) {
		const health_item *item = &h->item[i];
		static const char *const verdict[] = { "good", "note", "bad" };
		json_put_open_flat(&json, NULL, '{');
		json_put_text(&json, "group", item->group);
		json_put_text(&json, "name", item->name);
		json_put_text(&json, "verdict", verdict[item->verdict]);
		json_put_text(&json, "text", item->text);
		json_put_close(&json, '}');
	}
	json_put_close(&json, ']');
	json_put_close(&json, '}');
	fputc('\n', out);
}
