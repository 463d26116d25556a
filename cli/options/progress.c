#include "options/progress.h"
#include "program/text_quote.h"

#include <stdio.h>
#include <time.h>
#include <unistd.h>

static double now(void)
{
	struct timespec time;
	clock_gettime(CLOCK_MONOTONIC, &time);
	return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

progress progress_start(settings_progress kind, bool quiet)
{
	if (kind == SETTINGS_PROGRESS_AUTO && (quiet || !isatty(STDERR_FILENO)))
		kind = SETTINGS_PROGRESS_NONE;
	return (progress){ .kind = kind, .start = now() };
}

/* Seconds left by the rule of three; negative while too little is known. */
static double remaining(double elapsed, double done)
{
	return done > 0.02 && elapsed > 1.0 ? elapsed * (1.0 - done) / done : -1.0;
}

static void show_json(const char *stage, double done, double elapsed, double left)
{
	fprintf(stderr, "{\"stage\": ");
	text_quote_json(stderr, stage);
	fprintf(stderr, ", \"done\": %.4f, \"elapsed\": %.2f", done, elapsed);
	if (left >= 0.0)
		fprintf(stderr, ", \"remaining\": %.2f", left);
	fprintf(stderr, "}\n");
}

void progress_show(progress *p, const char *stage, double done)
{
	done = done < 0.0 ? 0.0 : done > 1.0 ? 1.0 : done;
	double elapsed = now() - p->start, left = remaining(elapsed, done);
	if (p->kind == SETTINGS_PROGRESS_JSON)
		show_json(stage, done, elapsed, left);
	if (p->kind != SETTINGS_PROGRESS_AUTO)
		return;
	char line[128], time[48] = "";
	if (left >= 3600.0)
		snprintf(time, sizeof time, ", %.1f h left", left / 3600.0);
	else if (left >= 0.0)
		snprintf(time, sizeof time, ", %d:%02d left", (int)left / 60, (int)left % 60);
	int length = snprintf(line, sizeof line, "%3.0f %%  %.40s%s", done * 100.0, stage, time);
	fprintf(stderr, "\r%s%*s", line, p->width > (size_t)length ? (int)p->width - length : 0, "");
	fflush(stderr);
	p->width = (size_t)length;
	p->shown = true;
}

void progress_clear(progress *p)
{
	if (p->shown)
		fprintf(stderr, "\r%*s\r", (int)p->width, "");
	p->shown = false;
	p->width = 0;
}

void progress_end(progress *p)
{
	progress_clear(p);
	p->kind = SETTINGS_PROGRESS_NONE;
}
