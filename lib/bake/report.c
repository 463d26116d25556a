/*
 * report.c - see report.h. A stage under way holds the account at its start; ending it turns that
 * into differences.
 */
#include "bake/report.h"

#include "device/passes.h"
#include "glowworm_host.h"

#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static gw_gpu_account account_of(gw_gpu *gpu)
{
	return gpu ? gw_gpu_read_account(gpu) : (gw_gpu_account){ 0 };
}

static void end_stage(gw_stage *stage, gw_gpu *gpu)
{
	gw_gpu_account now = account_of(gpu); /* which waits for what is under way */
	stage->seconds = gw_seconds() - stage->seconds;
	stage->device_seconds = now.device_seconds - stage->device_seconds;
	stage->compile_seconds = now.compile_seconds - stage->compile_seconds;
	stage->dispatches = now.dispatches - stage->dispatches;
	stage->submissions = now.submissions - stage->submissions;
	stage->uploaded_bytes = now.uploaded_bytes - stage->uploaded_bytes;
	stage->downloaded_bytes = now.downloaded_bytes - stage->downloaded_bytes;
	stage->bytes = now.bytes;
}

void gw_report_stage(gw_report *report, gw_gpu *gpu, const char *name)
{
	if (report->stage_count > 0)
		end_stage(&report->stage[report->stage_count - 1], gpu);
	if (name == NULL)
		return;
	assert(report->stage_count < GW_REPORT_STAGES);
	gw_stage *stage = &report->stage[report->stage_count++];
	gw_gpu_account now = account_of(gpu);
	*stage = (gw_stage){ .seconds = gw_seconds(),
						 .device_seconds = now.device_seconds,
						 .compile_seconds = now.compile_seconds,
						 .dispatches = now.dispatches,
						 .submissions = now.submissions,
						 .uploaded_bytes = now.uploaded_bytes,
						 .downloaded_bytes = now.downloaded_bytes };
	snprintf(stage->name, sizeof stage->name, "%s", name);
}

void gw_report_add_stage(gw_report *report, const gw_stage *stage)
{
	assert(report->stage_count < GW_REPORT_STAGES);
	report->stage[report->stage_count++] = *stage;
}

static_assert(GW_PASS_COUNT <= GW_REPORT_PASSES, "every pass has room in the report");

void gw_report_device(gw_report *report, gw_gpu *gpu)
{
	report->peak_bytes = account_of(gpu).peak_bytes;
	report->pass_count = 0;
	for (int id = 0; gpu && id < GW_PASS_COUNT; id++) {
		gw_pass_count *pass = &report->pass[report->pass_count];
		pass->runs = gw_passes_runs(gpu, (gw_pass_id)id, &pass->compiled);
		if (pass->runs == 0)
			continue;
		snprintf(pass->name, sizeof pass->name, "%s", gw_pass_row_of((gw_pass_id)id)->shader);
		report->pass_count++;
	}
}

double gw_report_seconds(const gw_report *report, const char *stage)
{
	double seconds = 0.0;
	for (uint32_t i = 0; i < report->stage_count; i++)
		seconds += strcmp(report->stage[i].name, stage) == 0 ? report->stage[i].seconds : 0.0;
	return seconds;
}

void gw_report_effect(gw_report *report, const char *name, const char *method, const char *reason,
					  ...)
{
	uint32_t i = 0;
	while (i < report->effect_count && strcmp(report->effect[i].name, name) != 0)
		i++;
	assert(i < GW_REPORT_EFFECTS);
	report->effect_count += i == report->effect_count;
	gw_effect *effect = &report->effect[i];
	effect->called_for = method != NULL;
	snprintf(effect->name, sizeof effect->name, "%s", name);
	snprintf(effect->method, sizeof effect->method, "%s", method ? method : "");
	va_list arguments;
	va_start(arguments, reason);
	vsnprintf(effect->reason, sizeof effect->reason, reason, arguments);
	va_end(arguments);
}

void gw_report_price(gw_report *report, const char *name, double seconds)
{
	for (uint32_t i = 0; i < report->effect_count; i++)
		if (strcmp(report->effect[i].name, name) == 0)
			report->effect[i].seconds = seconds;
}

/* Copies a sentence; {one|many} in it stands for what fits the number. */
static void put_counted(char *text, size_t room, uint64_t number, const char *sentence)
{
	size_t used = 0;
	bool one = false, many = false; /* within that part of the braces */
	for (; *sentence && used + 1 < room; sentence++) {
		if (*sentence == '{')
			one = true;
		else if (*sentence == '|' && one)
			one = false, many = true;
		else if (*sentence == '}' && many)
			many = false;
		else if (!(one && number != 1) && !(many && number == 1))
			text[used++] = *sentence;
	}
	text[used] = '\0';
}

void gw_report_count(gw_report *report, const char *name, uint64_t points, const char *meaning)
{
	uint32_t i = 0;
	while (i < report->count_count && strcmp(report->count[i].name, name) != 0)
		i++;
	if (points == 0) {
		if (i < report->count_count) /* of an earlier one */
			memmove(&report->count[i], &report->count[i + 1],
					(--report->count_count - i) * sizeof *report->count);
		return;
	}
	assert(i < GW_REPORT_COUNTS);
	report->count_count += i == report->count_count;
	gw_count *count = &report->count[i];
	count->points = points;
	snprintf(count->name, sizeof count->name, "%s", name);
	put_counted(count->meaning, sizeof count->meaning, points, meaning);
}
