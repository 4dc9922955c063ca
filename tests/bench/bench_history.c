/* SPDX-License-Identifier: MIT */
/*
 * Years of history in hurried time, by the recorder's own writer: how large the file is, what its
 * retention leaves, and how long a trend takes.
 *     bench_history [YEARS [SIGNALS [SECONDS [DIRECTORY]]]]
 * Each signal changes in so many seconds. Without words: a year of 50 signals, 600 s. The file is
 * in memory, as what is measured is no disk, and times are those of the processor. In DIRECTORY it
 * stays, and is not made another time.
 */
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "src/ground/signal/value.h"
#include "src/history/file/writer.h"
#include "src/public/ows_history.h"
#include "tests/bench/aid.h"
#include "tests/bench/readings.h"

#define S INT64_C(1000000000)
#define DAY (86400 * S)
#define YEAR (365 * DAY)
#define FLUSH (600 * S)
#define DATE (18000 * DAY) /* wall clock minus boot time */
#define RUNS 15
#define POINTS 1000

static char directory[DIR_PATH + 16], path[DIR_PATH + 48];

static double cpu_ms(void)
{
	struct timespec t;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return (double)t.tv_sec * 1e3 + (double)t.tv_nsec / 1e6;
}

static void want(int err, const char *what)
{
	if (err >= 0)
		return;
	fprintf(stderr, "%s: %s\n", what, strerror(-err));
	exit(1);
}

static struct history_writer *begin(unsigned count)
{
	const struct history_options options = {
		.directory = directory,
		.boot = 1,
		.flush_ns = FLUSH,
		/* as without a Recorder block */
		.keep = {.days = 90, .minutes = 730, .bytes = 2000000000},
	};
	struct history_signal *signals = calloc(count, sizeof(*signals));
	struct history_writer *writer;
	static char names[65536][16];

	want(signals ? 0 : -12, "signals");
	for (unsigned i = 0; i < count; i++) {
		snprintf(names[i], sizeof(names[i]), "t%u", i);
		signals[i] = (struct history_signal){names[i], "°C", OWS_DOUBLE, 0, 4};
	}
	want(history_writer_open(&options, 0, DATE, true, &writer), directory);
	want(history_writer_signals(writer, signals, count, 0), "signals");
	history_writer_begin(writer, 0);
	free(signals);
	return writer;
}

/* Each second some of the signals change, as many as the mean says. */
static void record(struct history_writer *writer, unsigned count, double seconds, int64_t until)
{
	struct readings readings = readings_begin(count, 1);
	double due = count;
	unsigned at = 0;

	for (int64_t now = S; now <= until; now += S) {
		for (; due >= 1; due--, at = (at + 1) % count) {
			readings_next(&readings, at);
			history_writer_value(writer, at, now, OWS_Q_GOOD,
			                     value_of_double(readings.values[at]), NULL, 0);
		}
		due += count / seconds;
		if (now % (60 * S) == 0)
			want(history_writer_tick(writer, now), "commit");
	}
	readings_end(&readings);
}

static double ask(const char *text)
{
	sqlite3_stmt *statement;
	double value = 0;
	sqlite3 *db;

	if (sqlite3_open_v2(path, &db, SQLITE_OPEN_READONLY, NULL) ||
	    sqlite3_prepare_v2(db, text, -1, &statement, NULL) ||
	    sqlite3_step(statement) != SQLITE_ROW) {
		fprintf(stderr, "%s: %s\n", text, sqlite3_errmsg(db));
		exit(1);
	}
	value = sqlite3_column_double(statement, 0);
	sqlite3_finalize(statement);
	sqlite3_close(db);
	return value;
}

static void report_file(void)
{
	bench_line("history.file",
	           ask("select page_count * page_size / 1e6 from pragma_page_count,"
	               " pragma_page_size"),
	           "MB");
	bench_line("history.values", ask("select count(*) from raw"), "rows");
	bench_line("history.minutes", ask("select count(*) from minute"), "rows");
	bench_line("history.hours", ask("select count(*) from hour"), "rows");
	bench_line("history.values.days", ask("select (max(id) - min(id)) / 86400e6 from raw"),
	           "d");
	bench_line("history.minutes.days",
	           ask("select ((max(id) >> 16) - (min(id) >> 16)) / 1440.0 from minute"), "d");
	bench_line("history.hours.days",
	           ask("select ((max(id) >> 19) - (min(id) >> 19)) / 3.0 from hour"), "d");
}

/* The last part of the history. Each run opens the file anew, as owsctl does. */
static void report_trend(const char *name, int signals, int64_t end, int64_t span, int points)
{
	static struct ows_history_point found[POINTS];
	double taken[RUNS];

	for (int run = 0; run < RUNS; run++) {
		double begun = cpu_ms();
		struct ows_history *h;
		int known = 0;

		want(ows_history_open(NULL, directory, &h), directory);
		for (int i = 0; i < signals; i++)
			want(ows_history_points(h, i, DATE + end - span, DATE + end, found, points),
			     name);
		ows_history_close(h);
		taken[run] = cpu_ms() - begun;
		for (int i = 0; i < points; i++)
			known += found[i].known_ns > 0;
		if (known < points - 1) {
			fprintf(stderr, "%s: %d of %d points are known\n", name, known, points);
			exit(1);
		}
	}
	bench_distribution(name, taken, RUNS, "ms");
}

int main(int argc, char **argv)
{
	double years = argc > 1 ? atof(argv[1]) : 1, seconds = argc > 3 ? atof(argv[3]) : 600;
	unsigned count = argc > 2 ? (unsigned)atoi(argv[2]) : 50;
	int64_t end = (int64_t)(years * 365) * DAY;
	struct history_writer *writer;

	if (end < DAY || count < 10 || count > 60000 || seconds < 1) {
		fputs("usage: bench_history [YEARS [SIGNALS [SECONDS [DIRECTORY]]]]\n", stderr);
		return 2;
	}
	snprintf(directory, sizeof(directory), "%s%s", argc > 4 ? argv[4] : bench_dir()->path,
	         argc > 4 ? "" : "/history");
	snprintf(path, sizeof(path), "%s/history.sqlite", directory);
	if (access(path, F_OK) != 0) {
		writer = begin(count);
		record(writer, count, seconds, end);
		want(history_writer_close(writer, end), "close");
		bench_line("history.made", cpu_ms() / 1e3, "s");
	}
	report_file();
	if (end >= YEAR)
		report_trend("history.year_of_one", 1, end, YEAR, POINTS);
	if (end > YEAR)
		report_trend("history.all_of_one", 1, end, end, POINTS);
	report_trend("history.day_of_ten", 10, end, DAY, POINTS / 2);
	report_trend("history.day_of_ten_by_minutes", 10, end, DAY, POINTS);
	report_trend("history.quarter_of_ten_in_values", 10, end, DAY / 4, POINTS);
	return 0;
}
