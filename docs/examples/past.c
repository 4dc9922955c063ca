/* SPDX-License-Identifier: MIT */
/*
 * Print what a signal had: its range in each of some stretches of time, and who commanded it. Needs
 * what owsd-recorder kept, and neither it nor owsd to run.
 *
 *     cc past.c $(pkg-config --cflags --libs libows libows-history) -o past
 *     ./past NAME [HOURS [DIRECTORY]]
 */
#include <ows.h>
#include <ows_history.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define SECOND INT64_C(1000000000)
#define STRETCHES 24

static const char *clock_of(int64_t time_ns, char text[32])
{
	time_t seconds = time_ns / SECOND;
	struct tm tm;

	strftime(text, 32, "%Y-%m-%d %H:%M:%S", localtime_r(&seconds, &tm));
	return text;
}

static int print_points(struct ows_history *h, int signal, int64_t from_ns, int64_t until_ns)
{
	struct ows_history_point points[STRETCHES];
	int got = ows_history_points(h, signal, from_ns, until_ns, points, STRETCHES);
	char text[32];

	for (int i = 0; i < got; i++) {
		printf("%s  ", clock_of(points[i].from_ns, text));
		if (points[i].good_ns > 0)
			printf("%g to %g", points[i].min, points[i].max);
		else
			printf("no good value");
		/* no line may be drawn through it */
		puts(points[i].gap ? ", not known throughout" : "");
	}
	return got;
}

static int print_commands(struct ows_history *h, int signal, int64_t from_ns, int64_t until_ns)
{
	struct ows_history_event e;
	char text[32];
	int got = ows_history_events(h, from_ns, until_ns, 1u << OWS_HISTORY_COMMAND);

	while (!got && (got = ows_history_next_event(h, &e)) == 1) {
		if (e.signal == signal)
			printf("%s  %g by %s\n", clock_of(e.time_ns, text), e.number,
			       e.who.serial ? e.who.name : "owsd");
		got = 0;
	}
	return got;
}

int main(int argc, char **argv)
{
	int64_t until_ns = (int64_t)time(NULL) * SECOND;
	int64_t from_ns = until_ns - (argc > 2 ? atoll(argv[2]) : 24) * 3600 * SECOND;
	struct ows_history *h;
	int err, signal;

	if (argc < 2)
		return 2;
	err = ows_history_open(NULL, argc > 3 ? argv[3] : NULL, &h);
	if (err) {
		fprintf(stderr, "cannot open the history: %s\n", strerror(-err));
		return 1;
	}
	signal = ows_history_find(h, argv[1]);
	err = signal < 0 ? signal : print_points(h, signal, from_ns, until_ns);
	if (err >= 0)
		err = print_commands(h, signal, from_ns, until_ns);
	if (err < 0)
		fprintf(stderr, "%s: %s\n", argv[1], strerror(-err));
	ows_history_close(h);
	return err < 0;
}
