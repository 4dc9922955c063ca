/* SPDX-License-Identifier: MIT */
/* A bar on stderr. */
#include <stdio.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/tool/owsctl/progress.h"

#define FIRST_NS NS_PER_S
#define EACH_NS (200 * NS_PER_MS)
#define WIDTH 30

struct progress progress_on(const char *what, int64_t now_ns, bool terminal)
{
	return (struct progress){.what = what, .next_ns = terminal ? now_ns + FIRST_NS : INT64_MAX};
}

struct progress progress_begin(const char *what, int64_t now_ns)
{
	return progress_on(what, now_ns, isatty(STDERR_FILENO));
}

void progress_show(struct progress *progress, int64_t now_ns, int64_t done, int64_t all)
{
	double part = all > 0 ? (double)done / (double)all : 0;
	char bar[WIDTH + 1];

	if (now_ns < progress->next_ns)
		return;
	progress->next_ns = now_ns + EACH_NS;
	progress->shown = true;
	part = part < 0 ? 0 : part > 1 ? 1 : part;
	for (int i = 0; i < WIDTH; i++)
		bar[i] = i < (int)(part * WIDTH) ? '#' : '.';
	bar[WIDTH] = '\0';
	fprintf(stderr, "\r%s [%s] %3d %%\33[K", progress->what, bar, (int)(part * 100));
	fflush(stderr);
}

void progress_end(struct progress *progress)
{
	if (progress->shown)
		fputs("\r\33[K", stderr);
	progress->shown = false;
	progress->next_ns = INT64_MAX;
}
