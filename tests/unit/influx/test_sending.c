/* SPDX-License-Identifier: MIT */
/* Tests of what is sent when, of each answer of a server, and of what it missed meanwhile. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "unity.h"

#include "src/faces/influx/sending.h"
#include "src/faces/kit/face.h"
#include "src/faces/kit/look.h"
#include "src/faces/kit/post.h"
#include "src/ground/signal/value.h"
#include "src/history/file/writer.h"
#include "tests/unit/aid/folder.h"
#include "tests/unit/aid/instance.h"

#define S INSTANCE_S

static const struct instance_signal signals[] = {
	{"room", "/28.1/temperature", OWS_DOUBLE, false, 0},
	{"lamp", "/29.1/PIO.0", OWS_BOOL, true, 0},
};
enum { ROOM, LAMP, COUNT };

static struct instance in;
static struct pushing *p;
static struct config config;
static struct face_arguments arguments;
static const struct face_ops ops = {.program = "owsd-influx"};
static struct face face;
static struct history_writer *writer;
static char history[300], state[300];
static int64_t now_ns, start_ns;
static bool busy;
static char posted[BATCH_BYTES + 1]; /* the last POST */

/* In place of libcurl. */
bool post_is_busy(const struct post *post)
{
	(void)post;
	return busy;
}

int post_begin(struct post *post, const struct post_what *what)
{
	(void)post;
	memcpy(posted, what->data, what->len);
	posted[what->len] = '\0';
	busy = true;
	return 0;
}

/* The image of the test is always that of the rows. */
bool look_is_current(const struct face *of)
{
	return of;
}

static int64_t offset(void)
{
	struct timespec wall;

	clock_gettime(CLOCK_REALTIME, &wall);
	return wall.tv_sec * S + wall.tv_nsec - ows_now();
}

static bool info_of(void *ctx, int row, struct ows_info *info)
{
	(void)ctx;
	*info = (struct ows_info){.name = signals[row].name,
	                          .identity = signals[row].path,
	                          .type = signals[row].type};
	return true;
}

static const struct history_signal table[] = {{"room", "", OWS_DOUBLE, 0, 2, "/28.1/temperature"},
                                              {"lamp", "", OWS_BOOL, 1, -1, "/29.1/PIO.0"}};

static void record_boot(int64_t boot)
{
	const struct history_options options = {
		.directory = history, .boot = boot, .flush_ns = 60 * S};

	TEST_ASSERT_EQUAL_INT(0, history_writer_open(&options, start_ns, offset(), true, &writer));
	TEST_ASSERT_EQUAL_INT(0, history_writer_signals(writer, table, COUNT, start_ns));
	history_writer_begin(writer, start_ns);
}

static void record(void)
{
	record_boot(history_boot_present());
}

static void room(int64_t at_ns, double value)
{
	history_writer_value(writer, ROOM, at_ns, OWS_Q_GOOD, value_of_double(value), NULL, 0);
}

/* The recorder writes what is behind all that the server can have missed. */
static void written(void)
{
	static int64_t lamp;

	history_writer_value(writer, LAMP, now_ns, OWS_Q_GOOD, ++lamp % 2, NULL, 0);
	TEST_ASSERT_EQUAL_INT(0, history_writer_flush(writer, now_ns));
}

static void begin(void)
{
	p->missed = (struct missed){
		.face = &face, .peer = "the server", .what = "influx", .info = info_of, .ctx = p};
	missed_begin(&p->missed, 1, now_ns);
	p->missed_ns = now_ns;
}

void setUp(void)
{
	static int folders;
	struct ows *ows;

	snprintf(state, sizeof(state), "%s/state%d", folder_dir()->path, folders);
	snprintf(history, sizeof(history), "%s/history%d", folder_dir()->path, folders++);
	setenv("STATE_DIRECTORY", state, 1);
	instance_start(&in, "sending", signals, COUNT);
	TEST_ASSERT_EQUAL_INT(0, ows_open(in.name, OWS_READ, &ows));
	config = (struct config){.recorder.directory = history};
	arguments = (struct face_arguments){.instance = in.name};
	p = calloc(1, sizeof(*p));
	TEST_ASSERT_NOT_NULL(p);
	face = (struct face){.ops = &ops,
	                     .arguments = &arguments,
	                     .config = &config,
	                     .own = p,
	                     .ows = ows,
	                     .live = true};
	start_ns = now_ns = face.looked_ns = ows_now();
	p->on = p->believed = true;
	p->most = BATCH_BYTES;
	p->options.every_ns = S;
	p->clock.offset_ns = offset();
	TEST_ASSERT_EQUAL_INT(0, points_make(&p->points, ows, "ows", "OWS", &p->pending, now_ns));
	writer = NULL;
	busy = false;
	posted[0] = '\0';
}

void tearDown(void)
{
	history_writer_close(writer, now_ns);
	missed_drop(&p->missed);
	points_free(&p->points);
	pending_free(&p->pending);
	free(p);
	ows_close(face.ows);
	instance_end(&in);
}

/* Go on for that time. True: a batch is under way. */
static bool after(int64_t ns)
{
	now_ns += ns;
	face.looked_ns = now_ns;
	sending_advance(&face, false, now_ns);
	return busy;
}

static void answer(long status)
{
	struct post_result result = {.status = status, .words = "words"};

	TEST_ASSERT_TRUE(busy);
	busy = false;
	sending_finished(&face, &result, now_ns);
}

static void add(int number)
{
	char fields[32];

	snprintf(fields, sizeof(fields), "value=%d", number);
	pending_add(&p->pending, now_ns, "s", fields);
}

/* All that the server gets from now on, if it takes each batch; NUL-terminated, to be freed. */
static char *taken(int seconds)
{
	char *text;
	size_t len;
	FILE *out = open_memstream(&text, &len);

	TEST_ASSERT_NOT_NULL(out);
	for (int i = 0; i < 4 * seconds; i++)
		if (after(S / 4)) {
			fputs(posted, out);
			answer(204);
		}
	fclose(out);
	return text;
}

static void has(const char *text, const char *line)
{
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(text, line), line);
}

static void test_a_batch_goes_each_every_and_stays_until_the_server_has_it(void)
{
	begin();
	p->cut_ns = now_ns + S;
	add(1);
	TEST_ASSERT_FALSE(after(S - 1));
	TEST_ASSERT_TRUE(after(1));
	TEST_ASSERT_EQUAL_UINT(1, p->pending.lines);
	add(2);
	answer(503);
	TEST_ASSERT_EQUAL_UINT(2, p->pending.lines);
	TEST_ASSERT_TRUE(p->next_ns > now_ns);
	TEST_ASSERT_FALSE(after(0));
	TEST_ASSERT_TRUE(after(p->next_ns - now_ns));
	has(posted, "s value=1 ");
	has(posted, "s value=2 ");
	answer(200);
	TEST_ASSERT_EQUAL_UINT(0, p->pending.lines);
	TEST_ASSERT_EQUAL_UINT64(2, p->sent);
}

static void test_a_batch_that_is_too_large_goes_in_halves_and_one_line_is_refused(void)
{
	begin();
	for (int i = 1; i <= 4; i++)
		add(i);
	TEST_ASSERT_TRUE(after(0));
	answer(413);
	TEST_ASSERT_EQUAL_UINT(4, p->pending.lines);
	TEST_ASSERT_TRUE(after(0));
	TEST_ASSERT_NULL(strstr(posted, "value=4"));
	while (p->batch_lines > 1) {
		answer(413);
		TEST_ASSERT_TRUE(after(0));
	}
	answer(413);
	TEST_ASSERT_EQUAL_UINT64(1, p->refused_lines);
	TEST_ASSERT_EQUAL_UINT(3, p->pending.lines);
}

static void test_lines_that_are_refused_are_dropped_and_counted(void)
{
	begin();
	add(1);
	add(2);
	TEST_ASSERT_TRUE(after(0));
	add(3);
	answer(400);
	TEST_ASSERT_EQUAL_UINT64(2, p->refused_lines);
	TEST_ASSERT_EQUAL_UINT(1, p->pending.lines);
	TEST_ASSERT_TRUE(p->refused);
	TEST_ASSERT_TRUE(after(S));
	answer(204);
	TEST_ASSERT_FALSE(p->refused);
}

/* Longer than memory holds: what it had to drop is in the history. */
static void fill_memory(void)
{
	static char fields[1000];

	memset(fields, 'x', sizeof(fields) - 1);
	for (int i = 0; i < 6000; i++)
		pending_add(&p->pending, now_ns + i * (S / 100), "s", fields);
	now_ns += 60 * S;
	TEST_ASSERT_TRUE(p->pending.dropped > 0);
}

static void test_what_memory_could_not_hold_comes_from_the_history(void)
{
	char *text;

	record();
	room(now_ns, 20);
	history_writer_flush(writer, now_ns + S);
	begin();
	now_ns += 5 * S;
	add(1);
	TEST_ASSERT_TRUE(after(0));
	answer(204);
	now_ns += 5 * S;
	TEST_ASSERT_TRUE(p->missed.there);
	room(now_ns + S, 21);
	room(now_ns + 2 * S, 22);
	fill_memory();
	written();
	text = taken(60);
	has(text, "signal=room value=21,quality=192i ");
	has(text, "signal=room value=22,quality=192i ");
	TEST_ASSERT_EQUAL_UINT(0, p->pending.lines);
	TEST_ASSERT_EQUAL_INT(0, p->missed.count);
	free(text);
}

static void test_what_was_not_running_is_a_stretch_and_a_gap_has_a_quality_alone(void)
{
	char *text;

	record();
	room(now_ns, 20);
	history_writer_flush(writer, now_ns + S);
	begin();
	missed_keep(&p->missed, 0, now_ns);
	room(now_ns + 20 * S, 21);
	history_writer_gap(writer, now_ns + 30 * S, now_ns + 40 * S, OWS_HISTORY_OWSD_LOST);
	room(now_ns + 41 * S, 22);
	now_ns += 60 * S;
	written();
	begin();
	add(1);
	text = taken(60);
	has(text, "signal=room value=21,quality=192i ");
	has(text, "signal=room quality=20i ");
	has(text, "signal=lamp quality=20i ");
	has(text, "signal=room value=22,quality=192i ");
	TEST_ASSERT_EQUAL_INT(0, p->missed.count);
	free(text);
}

static void test_what_was_written_when_a_signal_had_another_type_is_not_sent(void)
{
	static const struct history_signal other[] = {
		{"room", "", OWS_LARGE, 0, -1, "/28.1/temperature"},
		{"lamp", "", OWS_BOOL, 1, -1, "/29.1/PIO.0"}};
	char *text;

	record();
	written();
	begin();
	missed_keep(&p->missed, 0, now_ns);
	history_writer_signals(writer, other, COUNT, now_ns);
	history_writer_value(writer, ROOM, now_ns + 10 * S, OWS_Q_GOOD, 7, NULL, 0);
	history_writer_flush(writer, now_ns + 15 * S);
	history_writer_signals(writer, table, COUNT, now_ns + 19 * S);
	room(now_ns + 20 * S, 21);
	now_ns += 60 * S;
	written();
	begin();
	add(1);
	text = taken(60);
	has(text, "signal=room value=21,quality=192i ");
	TEST_ASSERT_NULL_MESSAGE(strstr(text, "signal=room value=7"), text);
	TEST_ASSERT_NULL_MESSAGE(strstr(text, "signal=room value=0"), text);
	free(text);
}

/* Rows of the history that are dropped on their way are read again. */
static void test_rows_that_memory_drops_are_read_again(void)
{
	char *text;

	record();
	room(now_ns, 20);
	history_writer_flush(writer, now_ns + S);
	begin();
	missed_keep(&p->missed, 0, now_ns);
	room(now_ns + 20 * S, 21);
	now_ns += 60 * S;
	written();
	begin();
	add(1);
	TEST_ASSERT_TRUE(after(S));
	answer(204);
	TEST_ASSERT_TRUE(after(S));
	has(posted, "signal=room value=21,quality=192i ");
	answer(503);
	fill_memory();
	written();
	text = taken(90);
	has(text, "signal=room value=21,quality=192i ");
	TEST_ASSERT_EQUAL_INT(0, p->missed.count);
	free(text);
}

/* The line of that text in the last POST; to be freed. */
static char *line_of(const char *text)
{
	const char *at = strstr(posted, text);

	TEST_ASSERT_NOT_NULL_MESSAGE(at, posted);
	return strndup(at, strcspn(at, "\n"));
}

static const char *const row = "signal=room value=21,quality=192i ";

/* A row that was recorded in that boot is in memory, and its batch under way. */
static void read_row_of(int64_t boot)
{
	record_boot(boot);
	room(now_ns, 20);
	history_writer_flush(writer, now_ns + S);
	begin();
	p->missed.boot = boot;
	p->missed.reached = missed_point(&p->missed, now_ns);
	missed_keep(&p->missed, 0, now_ns);
	room(now_ns + 20 * S, 21);
	start_ns = now_ns += 60 * S;
	if (boot != history_boot_present()) {
		history_writer_close(writer, now_ns);
		record();
	}
	written();
	begin();
	add(1);
	TEST_ASSERT_TRUE(after(S));
	answer(204);
	TEST_ASSERT_TRUE(after(S));
	has(posted, row);
}

/* The clock is set between two attempts to send what was read. */
static void set_clock_meanwhile(int64_t boot, int64_t moved_ns)
{
	char *before, *then;

	read_row_of(boot);
	before = line_of(row);
	answer(503);
	p->clock.offset_ns += 7200 * S;
	TEST_ASSERT_TRUE(after(p->next_ns - now_ns));
	then = line_of(row);
	TEST_ASSERT_EQUAL_INT64(moved_ns, strtoll(then + strlen(row), NULL, 10) -
	                                          strtoll(before + strlen(row), NULL, 10));
	free(before);
	free(then);
}

static void test_a_row_of_this_boot_gets_its_time_by_the_clock_that_was_set_meanwhile(void)
{
	set_clock_meanwhile(history_boot_present(), 7200 * S);
}

static void test_a_row_of_an_earlier_boot_keeps_its_time(void)
{
	set_clock_meanwhile(history_boot_present() + 1, 0);
}

static void test_rows_of_an_earlier_boot_that_memory_drops_are_read_again(void)
{
	char *text;

	read_row_of(history_boot_present() + 1);
	answer(503);
	fill_memory();
	written();
	text = taken(90);
	has(text, row);
	TEST_ASSERT_EQUAL_INT(0, p->missed.count);
	free(text);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_batch_goes_each_every_and_stays_until_the_server_has_it);
	RUN_TEST(test_a_batch_that_is_too_large_goes_in_halves_and_one_line_is_refused);
	RUN_TEST(test_lines_that_are_refused_are_dropped_and_counted);
	RUN_TEST(test_what_memory_could_not_hold_comes_from_the_history);
	RUN_TEST(test_what_was_not_running_is_a_stretch_and_a_gap_has_a_quality_alone);
	RUN_TEST(test_what_was_written_when_a_signal_had_another_type_is_not_sent);
	RUN_TEST(test_rows_that_memory_drops_are_read_again);
	RUN_TEST(test_a_row_of_this_boot_gets_its_time_by_the_clock_that_was_set_meanwhile);
	RUN_TEST(test_a_row_of_an_earlier_boot_keeps_its_time);
	RUN_TEST(test_rows_of_an_earlier_boot_that_memory_drops_are_read_again);
	return UNITY_END();
}
