/* SPDX-License-Identifier: MIT */
/*
 * Years of history in hurried time: of each age it has what its retention leaves, what a trend
 * shows is what was recorded, and the file has the size of its rows. HISTORY_YEARS=10 with 50
 * signals and the recorder's own retention; else four months with a tenth of that.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "unity.h"

#include "src/ground/signal/value.h"
#include "src/history/file/schema.h"
#include "tests/unit/aid/past.h"

#define HOUR (3600 * PAST_S)
#define STEP (1800 * PAST_S) /* each signal changes so often, within an hour */
#define PHASE (607 * PAST_S)
#define DATE (18000 * PAST_DAY)
#define RUN (61 * PAST_DAY) /* then the recorder is started again */
#define AWAY (3 * HOUR)
#define SIGNALS 50
#define POINTS 1000
#define LOOKS 200

static struct past past;
static int years, signals, days, minutes;
static int64_t end_ns;

void setUp(void)
{
	const char *wanted = getenv("HISTORY_YEARS");

	years = wanted ? atoi(wanted) : 0;
	signals = years ? SIGNALS : 3;
	days = years ? 90 : 9;
	minutes = years ? 730 : 73;
	end_ns = (years ? years * 365 : 130) * PAST_DAY;
}

void tearDown(void)
{
}

/* What a signal has from n * STEP + PHASE on. */
static double value_of(int signal, int64_t n)
{
	return (double)((n * 7919 + signal * 104729) % 4096) / 16;
}

static void put(int64_t n, int64_t at_ns)
{
	for (int i = 0; i < signals; i++)
		history_writer_value(past.writer, (uint32_t)i, at_ns, OWS_Q_GOOD,
		                     value_of_double(value_of(i, n)), NULL, 0);
}

static void begin(int64_t now_ns)
{
	static struct history_signal table[SIGNALS];
	static char names[SIGNALS][8];

	for (int i = 0; i < signals; i++) {
		snprintf(names[i], sizeof(names[i]), "t%d", i);
		table[i] = (struct history_signal){names[i], "°C", OWS_DOUBLE, 0, 4};
	}
	TEST_ASSERT_EQUAL_INT(0,
	                      history_writer_open(&past.options, now_ns, DATE, true, &past.writer));
	TEST_ASSERT_EQUAL_INT(
		0, history_writer_signals(past.writer, table, (uint32_t)signals, now_ns));
	history_writer_begin(past.writer, now_ns);
	put(now_ns / STEP - 1, now_ns);
}

static void record(void)
{
	int64_t begun_ns = 0;

	past_make(&past);
	past.options.flush_ns = PAST_DAY;
	past.options.keep = (struct history_keep){
		.days = (uint32_t)days, .minutes = (uint32_t)minutes, .bytes = 2000000000};
	begin(0);
	for (int64_t n = 0; n * STEP < end_ns; n++) {
		if (n * STEP - begun_ns == RUN) {
			past_end(&past, n * STEP);
			n += AWAY / STEP;
			begun_ns = n * STEP;
			begin(begun_ns);
		}
		put(n, n * STEP + PHASE);
		TEST_ASSERT_EQUAL_INT(0, history_writer_tick(past.writer, (n + 1) * STEP));
	}
	past_end(&past, end_ns);
}

/*
 * --- What there is -----------------------------------------------------------------------------
 */

static int64_t rows_of(const char *table)
{
	char text[64];

	snprintf(text, sizeof(text), "select count(*) from %s", table);
	return past_ask(&past, text);
}

static void check_retention_and_size(void)
{
	int64_t bytes = past_ask(&past, "select page_count * page_size from pragma_page_count(),"
	                                " pragma_page_size()");
	int64_t values = rows_of("raw"), sums = rows_of("minute"), hours = rows_of("hour");
	char text[160];

	TEST_ASSERT_INT64_WITHIN(
		1, days, past_ask(&past, "select (max(id) - min(id)) / 86400000000 from raw"));
	TEST_ASSERT_INT64_WITHIN(
		1, minutes,
		past_ask(&past, "select ((max(id) >> 16) - (min(id) >> 16)) / 1440 from minute"));
	/* for ever, but for the hours in which nobody recorded */
	TEST_ASSERT_INT64_WITHIN(2 * signals * (end_ns / RUN + 1),
	                         (end_ns - end_ns / RUN * AWAY) / HOUR * signals, hours);
	/* what was deleted was used again: nothing grows but the hours */
	TEST_ASSERT_TRUE(bytes < 40 * values + 90 * sums + 90 * hours + 1000000);
	snprintf(
		text, sizeof(text),
		"%.1f MB: %lld values of %d days, %lld minutes of %d days, %lld hours of %lld days",
		(double)bytes / 1e6, (long long)values, days, (long long)sums, minutes,
		(long long)hours, (long long)(end_ns / PAST_DAY));
	TEST_MESSAGE(text);
}

/*
 * --- What trends show --------------------------------------------------------------------------
 */

/* How far the time is from one in which nobody recorded; 0: within it. Before the first, too. */
static int64_t from_gap(int64_t ns)
{
	int64_t at = ns % (RUN + AWAY);

	return at > RUN ? 0 : at < RUN - at ? at : RUN - at;
}

static void check_point(const struct ows_history_point *p, int signal)
{
	int64_t from = p->from_ns - DATE, until = p->until_ns - DATE, at = from;
	double least = INFINITY, most = -INFINITY, sum = 0;
	char text[120];

	snprintf(text, sizeof(text), "signal %d, %.3f h to %.3f h", signal, (double)from / HOUR,
	         (double)until / HOUR);
	while (at < until) {
		int64_t n = (at - PHASE + STEP) / STEP - 1, next = (n + 1) * STEP + PHASE;
		double value = value_of(signal, n);

		next = next < until ? next : until;
		least = value < least ? value : least;
		most = value > most ? value : most;
		sum += value * (double)(next - at);
		at = next;
	}
	TEST_ASSERT_FALSE_MESSAGE(p->gap, text);
	TEST_ASSERT_INT64_WITHIN_MESSAGE(1000, until - from, p->good_ns, text);
	TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(least, p->min, text);
	TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(most, p->max, text);
	/* that of a minute is kept as a thousandth of its values' steps */
	TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.001 * (1 + most - least), sum / (double)(until - from),
	                                  p->mean, text);
}

static double cpu_ms(void)
{
	struct timespec t;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return (double)t.tv_sec * 1e3 + (double)t.tv_nsec / 1e6;
}

/* Stretches of that length at random times from an age on. */
static void check_looks(struct ows_history *h, int64_t oldest_ns, int64_t length)
{
	int looked = 0;

	for (int i = 0; i < LOOKS; i++) {
		struct ows_history_point points[4];
		int signal = (int)past_random((unsigned)signals);
		unsigned range = (unsigned)((oldest_ns - 4 * length) / length);
		int64_t from = (end_ns - oldest_ns) / length * length + past_random(range) * length;

		TEST_ASSERT_EQUAL_INT(4, ows_history_points(h, signal, DATE + from,
		                                            DATE + from + 4 * length, points, 4));
		if (from_gap(from) < 4 * HOUR || from_gap(from + 4 * length) < 4 * HOUR)
			continue;
		looked++;
		for (int k = 0; k < 4; k++)
			check_point(&points[k], signal);
	}
	TEST_ASSERT_TRUE(looked > LOOKS / 2);
}

static void check_trends(void)
{
	static struct ows_history_point points[POINTS];
	struct ows_history *h;
	char text[120];
	double begun, year, all;
	int gaps = 0;

	TEST_ASSERT_EQUAL_INT(0, ows_history_open(NULL, past.directory, &h));
	check_looks(h, end_ns - HOUR, 2 * HOUR);                /* hours */
	check_looks(h, (minutes - 2) * PAST_DAY, 300 * PAST_S); /* minutes */
	check_looks(h, (days - 2) * PAST_DAY, 60 * PAST_S);     /* values */
	begun = cpu_ms();
	TEST_ASSERT_EQUAL_INT(POINTS, ows_history_points(h, 1, DATE + end_ns - 365 * PAST_DAY,
	                                                 DATE + end_ns, points, POINTS));
	year = cpu_ms() - begun;
	begun = cpu_ms();
	TEST_ASSERT_EQUAL_INT(POINTS,
	                      ows_history_points(h, 1, DATE, DATE + end_ns, points, POINTS));
	all = cpu_ms() - begun;
	for (int i = 0; i < POINTS; i++)
		gaps += points[i].gap;
	/* each start in a point, or over a border of two; and the first seconds */
	TEST_ASSERT_TRUE(gaps >= end_ns / (RUN + AWAY) && gaps <= 2 + 3 * (end_ns / RUN));
	ows_history_close(h);
	snprintf(text, sizeof(text), "a trend of a year in %.1f ms, of all in %.1f ms", year, all);
	TEST_MESSAGE(text);
	TEST_ASSERT_TRUE(year < 1000 && all < 5000);
}

static void test_after_years_each_age_has_what_was_recorded_in_the_detail_that_is_kept(void)
{
	double begun = cpu_ms();
	char text[80];

	record();
	snprintf(text, sizeof(text), "recorded in %.1f s", (cpu_ms() - begun) / 1e3);
	TEST_MESSAGE(text);
	check_retention_and_size();
	check_trends();
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_after_years_each_age_has_what_was_recorded_in_the_detail_that_is_kept);
	return UNITY_END();
}
