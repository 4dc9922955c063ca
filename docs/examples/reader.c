/* SPDX-License-Identifier: MIT */
/*
 * Print every signal whenever owsd publishes something. Shows how a reader lives through the end
 * and the return of owsd.
 *
 *     cc reader.c $(pkg-config --cflags --libs libows) -o reader
 *     ./reader [INSTANCE [SECONDS]]
 */
#include <ows.h>

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define SECOND INT64_C(1000000000)

static void print_signal(struct ows *h, int signal, int64_t now)
{
	struct ows_info info;
	struct ows_value v;
	char text[256] = "";
	int id;

	if (ows_info(h, signal, &info))
		return;
	id = ows_find(h, info.name);
	ows_get_text(h, id, now, &v, text, sizeof(text));
	printf("%-20s %-16s %s, %.1f s old\n", info.name, text, ows_quality_text(v.quality),
	       (double)v.age_ns / 1e9);
}

int main(int argc, char **argv)
{
	const char *instance = argc > 1 ? argv[1] : NULL;
	int64_t until = ows_now() + (argc > 2 ? atoll(argv[2]) : 1000000000) * SECOND;
	uint32_t news = 0;
	struct ows *h;
	int err = ows_open(instance, OWS_READ, &h);

	if (err) {
		fprintf(stderr, "cannot open owsd's image: %s\n", strerror(-err));
		return 1;
	}
	while (ows_now() < until) {
		/* Not at once at every news: a person reads this */
		struct timespec pause = {.tv_nsec = 200000000};
		int64_t now;

		err = ows_wait(h, &news, SECOND);
		if (err == -ESTALE)
			ows_reopen(h); /* -ENOENT: owsd is not back yet, the old values stay */
		now = ows_now();
		for (int i = 0; i < ows_count(h); i++)
			print_signal(h, i, now);
		printf("\n");
		nanosleep(&pause, NULL);
	}
	ows_close(h);
	return 0;
}
