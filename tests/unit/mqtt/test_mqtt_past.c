/* SPDX-License-Identifier: MIT */
/* Tests of what a broker has missed: what of the history goes out again, and what is kept. */
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include "unity.h"

#include "src/faces/mqtt/past.h"
#include "src/faces/mqtt/plain.h"
#include "src/ground/signal/value.h"
#include "src/history/file/writer.h"
#include "tests/unit/aid/folder.h"
#include "tests/unit/aid/published.h"

#define S INSTANCE_S
#define KEY 7

static const struct instance_signal signals[] = {
	{"room", "/28.1/temperature", OWS_DOUBLE, false, 0, "28.000000000001"},
	{"lamp", "/29.1/PIO.0", OWS_BOOL, true, 0, ""},
};
enum { ROOM, LAMP, COUNT };

static struct published p;
static struct broker broker;
static struct past past;
static struct config config;
static struct face_arguments arguments;
static const struct face_ops ops = {.program = "owsd-mqtt"};
static struct face face;
static struct history_writer *writer;
static char state[300], kept[320], history[300];
static char again[2000]; /* "room=21 " of each value that goes out again */
static int64_t wall_us;  /* of the last of them */
static bool orderly;     /* each is a millisecond behind the one before it, at least */
static int64_t now_ns, start_ns;

static bool full;    /* the connection takes nothing */
static time_t set_s; /* somebody has set the clock by so much */

/* In place of the library's. */
int clock_gettime(clockid_t clock, struct timespec *at)
{
	int err = (int)syscall(SYS_clock_gettime, clock, at);

	if (clock == CLOCK_REALTIME)
		at->tv_sec += set_s;
	return err;
}

/* In place of the broker's: it answers when the test says so. */
bool broker_mark(struct broker *b)
{
	if (b->marking)
		return false;
	b->marked = false;
	b->marking = true;
	return true;
}

static bool send_past(struct stream *s, const struct past_value *values, int n)
{
	size_t at = strlen(again);

	(void)s;
	if (full)
		return false;
	for (int i = 0; i < n; i++, at = strlen(again)) {
		snprintf(again + at, sizeof(again) - at, "%s=%g ", values[i].row->name,
		         ows_good(values[i].v.quality) ? values[i].v.number : -1);
		orderly = orderly && values[i].wall_us >= wall_us + 1000;
		wall_us = values[i].wall_us;
	}
	return true;
}

static const struct profile profile = {PLAIN, .name = "test", .past = send_past};

static int64_t offset(void)
{
	struct timespec wall;

	clock_gettime(CLOCK_REALTIME, &wall);
	return wall.tv_sec * S + wall.tv_nsec - ows_now();
}

/* The recorder begins. The time of the tests is that of this machine, an hour later. */
static void record(void)
{
	const struct history_options options = {
		.directory = history, .boot = history_boot_present(), .flush_ns = 60 * S};
	/* of the room with the name that it had then */
	static const struct history_signal table[] = {
		{"hall", "", OWS_DOUBLE, 0, 2, "/28.1/temperature"},
		{"lamp", "", OWS_BOOL, 1, -1, "/29.1/PIO.0"}};

	TEST_ASSERT_EQUAL_INT(0, history_writer_open(&options, start_ns, offset(), true, &writer));
	TEST_ASSERT_EQUAL_INT(0, history_writer_signals(writer, table, 2, start_ns));
	history_writer_begin(writer, start_ns);
}

static void room(int64_t at_ns, double value)
{
	history_writer_value(writer, ROOM, at_ns, OWS_Q_GOOD, value_of_double(value), NULL, 0);
}

static void written(int64_t until_ns)
{
	TEST_ASSERT_EQUAL_INT(0, history_writer_flush(writer, until_ns));
}

static void begin(void)
{
	past = (struct past){.face = &face, .stream = &p.s, .broker = &broker};
	past_begin(&past, KEY);
}

/* Go on for so many seconds; the broker answers at once, if it is there. */
static void pump(int seconds)
{
	for (int i = 0; i < 4 * seconds; i++) {
		now_ns += S / 4;
		face.looked_ns = now_ns;
		if (broker.marking) {
			broker.marking = false;
			broker.marked = true;
		}
		past_pump(&past, now_ns);
	}
}

/* The broker is there: the recorder writes what is behind the birth, and all before it goes out. */
static void settle(void)
{
	static int64_t lamp;

	pump(1);
	history_writer_value(writer, LAMP, now_ns, OWS_Q_GOOD, ++lamp % 2, NULL, 0);
	written(now_ns);
	pump(40);
	TEST_ASSERT_EQUAL_INT(0, past.missed.count);
}

void setUp(void)
{
	static int folders;

	snprintf(state, sizeof(state), "%s/state%d", folder_dir()->path, folders);
	snprintf(kept, sizeof(kept), "%s/reached", state);
	snprintf(history, sizeof(history), "%s/history%d", folder_dir()->path, folders++);
	setenv("STATE_DIRECTORY", state, 1);
	published_start(&p, signals, COUNT, &profile);
	p.s.clock_set = p.s.announced = true;
	config = (struct config){.recorder.directory = history};
	arguments = (struct face_arguments){.instance = p.in.name};
	face = (struct face){.ops = &ops, .arguments = &arguments, .config = &config};
	broker = (struct broker){0};
	writer = NULL;
	again[0] = '\0';
	full = false;
	set_s = 0;
	start_ns = now_ns = ows_now();
	face.looked_ns = now_ns;
}

void tearDown(void)
{
	past_end(&past);
	history_writer_close(writer, now_ns);
	published_end(&p);
}

/* --- What goes out again --- */

static void test_what_was_recorded_while_the_broker_was_away_goes_out_again(void)
{
	int64_t away_ns;

	record();
	room(now_ns, 20);
	written(now_ns + S);
	begin();
	settle();
	again[0] = '\0';
	away_ns = now_ns;
	past_lost(&past);
	room(away_ns + 20 * S, 21);
	room(away_ns + 30 * S, 22);
	now_ns = away_ns + 60 * S;
	settle();
	TEST_ASSERT_EQUAL_STRING("room=21 room=22 ", again);
	TEST_ASSERT_INT64_WITHIN(2000000, (away_ns + 30 * S + offset()) / 1000, wall_us);
	TEST_ASSERT_EQUAL_INT64(INT64_MAX, past_next(&past));
	again[0] = '\0';
	pump(20);
	TEST_ASSERT_EQUAL_STRING("", again);
}

static void test_a_batch_that_waits_goes_by_the_clock_that_is_set_meanwhile(void)
{
	int64_t away_ns;

	record();
	room(now_ns, 20);
	written(now_ns + S);
	begin();
	settle();
	again[0] = '\0';
	away_ns = now_ns;
	past_lost(&past);
	room(away_ns + 20 * S, 21);
	now_ns = away_ns + 60 * S;
	full = true;
	pump(1);
	history_writer_value(writer, LAMP, now_ns, OWS_Q_GOOD, 1, NULL, 0);
	written(now_ns);
	pump(40);
	TEST_ASSERT_TRUE(past.read);
	TEST_ASSERT_EQUAL_STRING("", again);
	set_s = 7200;
	full = false;
	pump(40);
	TEST_ASSERT_EQUAL_STRING("room=21 ", again);
	TEST_ASSERT_INT64_WITHIN(2000000, (away_ns + 20 * S + offset()) / 1000, wall_us);
}

/* A file of version 3, before the recorder has found its signals in it. */
static void test_rows_without_an_identity_are_of_the_signal_of_their_name(void)
{
	char path[400];
	sqlite3 *db;

	record();
	room(now_ns, 20);
	written(now_ns + S);
	snprintf(path, sizeof(path), "%s/history.sqlite", history);
	TEST_ASSERT_EQUAL_INT(SQLITE_OK, sqlite3_open(path, &db));
	TEST_ASSERT_EQUAL_INT(SQLITE_OK, sqlite3_exec(db,
	                                              "update signal set identity = null,"
	                                              " name = 'room' where name = 'hall'",
	                                              NULL, NULL, NULL));
	sqlite3_close(db);
	begin();
	settle();
	again[0] = '\0';
	past_lost(&past);
	room(now_ns + 20 * S, 21);
	now_ns += 60 * S;
	settle();
	TEST_ASSERT_EQUAL_STRING("room=21 ", again);
}

static void test_a_burst_keeps_its_order_by_the_millisecond(void)
{
	int64_t away_ns;

	record();
	room(now_ns, 20);
	written(now_ns + S);
	begin();
	settle();
	again[0] = '\0';
	wall_us = 0;
	orderly = true;
	away_ns = now_ns;
	past_lost(&past);
	for (int i = 1; i <= 20; i++)
		room(away_ns + 20 * S + i * (S / 3000), 20 + i);
	now_ns = away_ns + 60 * S;
	settle();
	TEST_ASSERT_NOT_NULL(strstr(again, "room=21 room=22 room=23 "));
	TEST_ASSERT_TRUE(orderly);
}

/* It is waited for, and nothing is taken for missing. */
static void test_what_the_recorder_has_not_written_yet_is_waited_for(void)
{
	record();
	room(now_ns, 20);
	written(now_ns + S);
	begin();
	settle();
	past_lost(&past);
	again[0] = '\0';
	room(now_ns + 20 * S, 21);
	now_ns += 60 * S;
	pump(10);
	TEST_ASSERT_EQUAL_STRING("", again);
	TEST_ASSERT_EQUAL_INT(1, past.missed.count);
	TEST_ASSERT_TRUE(past_next(&past) > now_ns && past_next(&past) <= now_ns + 30 * S);
	settle();
	TEST_ASSERT_EQUAL_STRING("room=21 ", again);
}

static void test_without_a_right_clock_or_a_birth_nothing_goes_out(void)
{
	bool *needed[] = {&p.s.clock_set, &p.s.announced, &p.s.live};

	record();
	room(now_ns, 20);
	written(now_ns + S);
	begin();
	for (unsigned i = 0; i < 3; i++) {
		*needed[i] = false;
		pump(5);
		TEST_ASSERT_FALSE(broker.marking || broker.marked);
		*needed[i] = true;
	}
	pump(5);
	TEST_ASSERT_TRUE(broker.marking || broker.marked);
}

static void test_a_profile_that_shows_only_what_is_does_nothing(void)
{
	record();
	written(now_ns + S);
	p.s.profile = &profile_plain;
	begin();
	pump(5);
	TEST_ASSERT_FALSE(broker.marking || broker.marked);
	TEST_ASSERT_EQUAL_INT(-1, access(kept, F_OK));
	past_lost(&past);
	p.s.profile = &profile;
}

/* --- What is kept --- */

static int64_t kept_us(void)
{
	FILE *f = fopen(kept, "r");
	unsigned long long key;
	long long boot, us;
	int count;

	TEST_ASSERT_NOT_NULL(f);
	TEST_ASSERT_EQUAL_INT(4, fscanf(f, "owsd 4 %llx %d %lld %lld", &key, &count, &boot, &us));
	fclose(f);
	TEST_ASSERT_EQUAL_UINT64(KEY, key);
	TEST_ASSERT_EQUAL_INT(0, count);
	return us;
}

static void test_up_to_where_the_broker_has_all_is_kept_over_a_restart(void)
{
	int64_t us;

	record();
	room(now_ns, 20);
	written(now_ns + S);
	begin();
	settle();
	past_end(&past);
	us = kept_us();
	TEST_ASSERT_INT64_WITHIN(2000000, now_ns / 1000, us);
	/* while it does not run */
	again[0] = '\0';
	room(now_ns + 20 * S, 21);
	now_ns += 60 * S;
	begin();
	TEST_ASSERT_EQUAL_INT64(us, past.missed.reached.us);
	settle();
	TEST_ASSERT_EQUAL_STRING("room=21 ", again);
}

/* The outage by the kill begins where the one before has ended: no row is of both. */
static void test_what_a_kill_left_half_sent_is_sent_again_once(void)
{
	record();
	room(now_ns, 20);
	written(now_ns + S);
	begin();
	settle();
	past_lost(&past);
	again[0] = '\0';
	room(now_ns + 20 * S, 21);
	room(now_ns + 60 * S, 22);
	now_ns += 60 * S;
	pump(1);
	written(now_ns);
	for (int i = 0; i < 3 && !strstr(again, "room=22"); i++)
		pump(1);
	TEST_ASSERT_EQUAL_STRING("room=21 room=22 ", again);
	again[0] = '\0';
	TEST_ASSERT_EQUAL_INT(0, stream_make(&p.s, p.h));
	p.s.announced = true;
	/* the kill: nothing is kept at this end */
	past.missed.path[0] = '\0';
	past_end(&past);
	begin();
	settle();
	TEST_ASSERT_EQUAL_STRING("room=21 room=22 ", again);
}

static void test_what_was_kept_for_another_broker_or_is_damaged_does_not_count(void)
{
	static const char *const files[] = {
		"owsd 4 0000000000000008 0 1 5 6 1 5 6 end\n", /* another key */
		"owsd 2 0000000000000007 0 1 5 6 1 5 6 end\n", /* another version */
		"owsd 4 0000000000000007 0 1 5 6 1 5 6\n",     /* cut */
		"owsd 4 0000000000000007 1 1 5 6 1 5 6 end\n", /* a stretch is missing */
		"owsd 4 0000000000000007 17 1 5 6 1 5 6 end\n",
		"owsd 4 0000000000000007 -1 1 5 6 1 5 6 end\n",
		"",
	};
	static const char good[] = "owsd 4 0000000000000007 1 1 5 6 1 4 5 1 2 3 1 4 5 end\n";

	record();
	written(now_ns + S);
	for (unsigned i = 0; i <= sizeof(files) / sizeof(files[0]); i++) {
		bool last = i == sizeof(files) / sizeof(files[0]);
		FILE *f;

		history_make_above(kept);
		f = fopen(kept, "w");
		TEST_ASSERT_NOT_NULL(f);
		fputs(last ? good : files[i], f);
		fclose(f);
		begin();
		if (last)
			TEST_ASSERT_EQUAL_INT64(5, past.missed.reached.us);
		else
			TEST_ASSERT_GREATER_THAN_INT64_MESSAGE(1000, past.missed.reached.us,
			                                       files[i]);
		TEST_ASSERT_EQUAL_INT(last, past.missed.count);
	}
	TEST_ASSERT_EQUAL_INT64(2, past.missed.stretches[0].from.us);
	TEST_ASSERT_EQUAL_INT64(4, past.missed.stretches[0].until.us);
}

/* An error of the disk passes, and what is in the file is of use to the next start. */
static void test_what_cannot_be_read_is_not_written_over(void)
{
	struct stat st;

	record();
	room(now_ns, 20);
	written(now_ns + S);
	TEST_ASSERT_EQUAL_INT(0, mkdir(state, 0700));
	TEST_ASSERT_EQUAL_INT(0, symlink("reached", kept)); /* ELOOP */
	begin();
	settle();
	past_end(&past);
	TEST_ASSERT_EQUAL_INT(0, lstat(kept, &st));
	TEST_ASSERT_TRUE(S_ISLNK(st.st_mode));
	TEST_ASSERT_EQUAL_INT(0, unlink(kept));
	begin();
	TEST_ASSERT_EQUAL_INT(0, access(kept, F_OK));
}

/* A broker that throws out again and again makes no more stretches than there is room for. */
static void test_more_outages_than_stretches_are_one_at_the_end(void)
{
	record();
	room(now_ns, 20);
	written(now_ns + S);
	begin();
	pump(10);
	for (unsigned i = 0; i < 3 * MISSED_STRETCHES; i++) {
		past_lost(&past);
		broker.marking = broker.marked = false;
		now_ns += 20 * S;
		pump(1);
		TEST_ASSERT_LESS_OR_EQUAL(MISSED_STRETCHES, past.missed.count);
	}
	TEST_ASSERT_EQUAL_INT(MISSED_STRETCHES, past.missed.count);
	TEST_ASSERT_INT64_WITHIN(2000000, now_ns / 1000,
	                         past.missed.stretches[MISSED_STRETCHES - 1].until.us);
	for (int i = 1; i < past.missed.count; i++)
		TEST_ASSERT_TRUE(past.missed.stretches[i].from.us >=
		                 past.missed.stretches[i - 1].until.us - 2000000);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_what_was_recorded_while_the_broker_was_away_goes_out_again);
	RUN_TEST(test_rows_without_an_identity_are_of_the_signal_of_their_name);
	RUN_TEST(test_a_burst_keeps_its_order_by_the_millisecond);
	RUN_TEST(test_what_the_recorder_has_not_written_yet_is_waited_for);
	RUN_TEST(test_a_batch_that_waits_goes_by_the_clock_that_is_set_meanwhile);
	RUN_TEST(test_what_cannot_be_read_is_not_written_over);
	RUN_TEST(test_without_a_right_clock_or_a_birth_nothing_goes_out);
	RUN_TEST(test_a_profile_that_shows_only_what_is_does_nothing);
	RUN_TEST(test_up_to_where_the_broker_has_all_is_kept_over_a_restart);
	RUN_TEST(test_what_a_kill_left_half_sent_is_sent_again_once);
	RUN_TEST(test_what_was_kept_for_another_broker_or_is_damaged_does_not_count);
	RUN_TEST(test_more_outages_than_stretches_are_one_at_the_end);
	return UNITY_END();
}
