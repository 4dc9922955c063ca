/* SPDX-License-Identifier: MIT */
/* Tests of what the recorder does with the news of owsd: what is in the history after them. */
#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "src/faces/kit/face.h"
#include "src/ground/signal/value.h"
#include "src/history/recorder/recording.h"
#include "src/public/ows_history.h"
#include "tests/unit/aid/folder.h"
#include "tests/unit/aid/instance.h"

#define S INSTANCE_S
#define MS (S / 1000)
#define ITEMS 200

static const struct instance_signal signals[] = {
	{"room", "/28.1/temperature", OWS_DOUBLE, false, 0, "28.000000000001"},
	{"lamp", "/29.1/PIO.0", OWS_BOOL, true, 0, "29.000000000001"},
};
enum { ROOM, LAMP, COUNT };

static struct instance in;
static struct config config;
static struct face_arguments arguments;
static const struct face_ops ops = {.program = "owsd-recorder"};
static struct face face;
static char directory[300], other[300];
static struct ows_history_item items[ITEMS];
static int folders;

static void new_directories(void)
{
	snprintf(directory, sizeof(directory), "%s/recording%d", folder_dir()->path, folders);
	snprintf(other, sizeof(other), "%s/other%d", folder_dir()->path, folders++);
}

void setUp(void)
{
	new_directories();
	instance_start(&in, "recording", signals, COUNT);
	instance_put_double(&in, ROOM + 1, 20, ows_now());
	instance_put(&in, LAMP + 1, 0, ows_now());
	config = (struct config){.recorder = {.flush_ns = 60 * S, .record = {.change = true}}};
	arguments = (struct face_arguments){.instance = in.name, .option = directory};
	face = (struct face){.ops = &ops, .arguments = &arguments, .config = &config};
	TEST_ASSERT_EQUAL_INT(0, ows_open(in.name, OWS_READ, &face.ows));
}

void tearDown(void)
{
	ows_close(face.ows);
	instance_end(&in);
}

static void news(enum face_news what)
{
	const struct face_event event = {.news = what};

	recording_event(&face, &event);
}

/* As the loop does it. */
static void found(void)
{
	face.live = true;
	face.looked_ns = ows_now();
	news(FACE_FOUND);
	recording_changes(&face, NULL, 0);
}

static void lost(void)
{
	face.live = false;
	news(FACE_LOST);
}

/* A value that was measured now. */
static void room(double value)
{
	int signal = ROOM;

	instance_put_double(&in, ROOM + 1, value, ows_now());
	recording_changes(&face, &signal, 1);
	face.looked_ns = ows_now();
}

/* All that the history has of room; the recording is closed. */
static int written_at(const char *place)
{
	struct ows_history *h;
	int n, index;

	TEST_ASSERT_EQUAL_INT(0, ows_history_open(NULL, place, &h));
	index = ows_history_find(h, "room");
	TEST_ASSERT_GREATER_OR_EQUAL(0, index);
	TEST_ASSERT_EQUAL_INT(0, ows_history_read(h, index, 0, INT64_MAX));
	n = ows_history_next(h, items, ITEMS);
	TEST_ASSERT_GREATER_OR_EQUAL(0, n);
	ows_history_close(h);
	/* the last one is the end of what is written */
	if (n)
		TEST_ASSERT_EQUAL_UINT8(0, items[n - 1].known);
	return n ? n - 1 : 0;
}

static int written(void)
{
	recording_close(&face);
	return written_at(directory);
}

static void is_gap(int i, uint8_t reason)
{
	TEST_ASSERT_EQUAL_UINT8(0, items[i].known);
	TEST_ASSERT_EQUAL_UINT8(reason, items[i].reason);
}

static void is_value(int i, double value)
{
	TEST_ASSERT_EQUAL_UINT8(1, items[i].known);
	TEST_ASSERT_EQUAL_DOUBLE(value, items[i].number);
}

static void test_values_are_kept_when_they_change_with_their_times(void)
{
	int64_t from_ns = ows_now();

	TEST_ASSERT_EQUAL_INT(0, recording_open(&face));
	found();
	room(20);
	room(21);
	room(21);
	room(22);
	TEST_ASSERT_EQUAL_INT(3, written());
	is_value(0, 20);
	is_value(1, 21);
	is_value(2, 22);
	for (int i = 0; i < 3; i++)
		TEST_ASSERT_TRUE(items[i].boot_ns >= from_ns - 1000 &&
		                 items[i].boot_ns <= ows_now());
	TEST_ASSERT_TRUE(items[0].boot_ns <= items[1].boot_ns);
	TEST_ASSERT_TRUE(items[1].boot_ns <= items[2].boot_ns);
}

/* The one gap of the history's journal: when it began, and how long it was at least. */
static void is_in_the_journal(int64_t time_ns, int64_t least_ns)
{
	struct ows_history_event event;
	struct ows_history *h;

	TEST_ASSERT_EQUAL_INT(0, ows_history_open(NULL, directory, &h));
	TEST_ASSERT_EQUAL_INT(0, ows_history_events(h, 0, INT64_MAX, 1u << OWS_HISTORY_GAP));
	TEST_ASSERT_EQUAL_INT(1, ows_history_next_event(h, &event));
	TEST_ASSERT_EQUAL_UINT8(OWS_HISTORY_OWSD_LOST, event.reason);
	TEST_ASSERT_EQUAL_INT64(time_ns, event.time_ns);
	TEST_ASSERT_GREATER_OR_EQUAL_INT64(event.time_ns + least_ns, event.until_ns);
	TEST_ASSERT_LESS_THAN_INT64(event.time_ns + least_ns + 60 * S, event.until_ns);
	TEST_ASSERT_EQUAL_INT(0, ows_history_next_event(h, &event));
	ows_history_close(h);
}

static void test_while_owsd_is_lost_nothing_is_known_and_no_value_reaches_in(void)
{
	int64_t lost_ns, back_ns;

	TEST_ASSERT_EQUAL_INT(0, recording_open(&face));
	found();
	room(20);
	lost_ns = ows_now();
	lost();
	usleep(20000); /* pace */
	back_ns = ows_now();
	/* the value of before is there yet, and was not measured anew */
	found();
	TEST_ASSERT_GREATER_OR_EQUAL(3, written());
	is_value(0, 20);
	is_gap(1, OWS_HISTORY_OWSD_LOST);
	is_value(2, 20);
	TEST_ASSERT_TRUE(items[1].boot_ns <= lost_ns);
	TEST_ASSERT_TRUE(items[1].boot_ns >= items[0].boot_ns);
	TEST_ASSERT_TRUE(items[2].boot_ns >= back_ns - 1000);
	is_in_the_journal(items[1].time_ns, back_ns - lost_ns);
}

/* It ends again before its next heartbeat: the values of its return are of a moment alone. */
static void test_an_owsd_that_is_lost_again_at_once_makes_a_gap_of_its_own(void)
{
	TEST_ASSERT_EQUAL_INT(0, recording_open(&face));
	found();
	for (unsigned i = 0; i < 2; i++) {
		lost();
		usleep(20000); /* pace */
		found();
	}
	TEST_ASSERT_EQUAL_INT(5, written());
	is_value(0, 20);
	is_gap(1, OWS_HISTORY_OWSD_LOST);
	is_value(2, 20);
	is_gap(3, OWS_HISTORY_OWSD_LOST);
	is_value(4, 20);
	TEST_ASSERT_LESS_THAN_INT64(items[2].boot_ns + MS, items[3].boot_ns);
	TEST_ASSERT_GREATER_OR_EQUAL_INT64(items[3].boot_ns + 18 * MS, items[4].boot_ns);
}

/* Since the last look the last values may have changed: the gap begins at what is known. */
static void test_the_gap_of_a_lost_owsd_begins_at_its_last_heartbeat_not_at_its_loss(void)
{
	int64_t beat_ns;

	TEST_ASSERT_EQUAL_INT(0, recording_open(&face));
	found();
	beat_ns = ows_now();
	instance_beat(&in, beat_ns, 0);
	usleep(20000); /* pace */
	face.looked_ns = ows_now();
	lost();
	TEST_ASSERT_EQUAL_INT(1, written());
	is_value(0, 20);
	is_gap(1, OWS_HISTORY_OWSD_LOST);
	TEST_ASSERT_INT64_WITHIN(MS, beat_ns, items[1].boot_ns);
}

static void test_changes_that_were_missed_are_a_gap_since_the_last_look(void)
{
	int64_t looked_ns;

	TEST_ASSERT_EQUAL_INT(0, recording_open(&face));
	found();
	room(20);
	looked_ns = face.looked_ns;
	usleep(20000); /* pace */
	news(FACE_OVERRUN);
	instance_put_double(&in, ROOM + 1, 20, ows_now());
	recording_changes(&face, NULL, 0);
	TEST_ASSERT_EQUAL_INT(3, written());
	is_value(0, 20);
	is_gap(1, OWS_HISTORY_OVERRUN);
	TEST_ASSERT_INT64_WITHIN(1000, looked_ns, items[1].boot_ns);
	/* known again, though it is the same value */
	is_value(2, 20);
	TEST_ASSERT_GREATER_OR_EQUAL_INT64(looked_ns + 19 * MS, items[2].boot_ns);
}

static void test_the_option_goes_before_the_key_of_the_file(void)
{
	config.recorder.directory = other;
	TEST_ASSERT_EQUAL_INT(0, recording_open(&face));
	found();
	room(20);
	TEST_ASSERT_EQUAL_INT(1, written());
	TEST_ASSERT_EQUAL_INT(-1, access(other, F_OK));
	arguments.option = NULL;
	TEST_ASSERT_EQUAL_INT(0, recording_open(&face));
	found();
	recording_close(&face);
	TEST_ASSERT_EQUAL_INT(0, access(other, F_OK));
}

static void test_a_directory_with_too_long_a_name_is_refused_at_the_start(void)
{
	char longest[HISTORY_PATH + 1];

	memset(longest, 'x', sizeof(longest) - 1);
	longest[0] = '/';
	longest[sizeof(longest) - 1] = '\0';
	arguments.option = longest;
	TEST_ASSERT_EQUAL_INT(-ENAMETOOLONG, recording_open(&face));
}

static void test_a_file_read_again_that_says_the_same_makes_no_gap(void)
{
	TEST_ASSERT_EQUAL_INT(0, recording_open(&face));
	found();
	room(20);
	news(FACE_FILE);
	news(FACE_RELOADED);
	recording_changes(&face, NULL, 0);
	room(21);
	TEST_ASSERT_GREATER_OR_EQUAL(2, written());
	for (int i = 0; i < 2; i++)
		TEST_ASSERT_EQUAL_UINT8(1, items[i].known);
}

/* Each of these has the writer begin anew, and what was before it stays. */
static void test_another_option_of_keeping_is_taken_over_at_a_reload(void)
{
	for (unsigned option = 0; option < 5; option++) {
		int n, gaps = 0;

		new_directories();
		instance_put_double(&in, ROOM + 1, 20, ows_now());
		config.recorder = (struct config_recorder){.flush_ns = 60 * S,
		                                           .record = {.change = true}};
		TEST_ASSERT_EQUAL_INT(0, recording_open(&face));
		found();
		room(20);
		config.recorder.keep_days += option == 0;
		config.recorder.keep_minutes += option == 1;
		config.recorder.keep_hours += option == 2;
		config.recorder.size_mb += 100 * (option == 3);
		config.recorder.flush_ns += option == 4;
		news(FACE_FILE);
		room(21);
		n = written();
		for (int i = 0; i < n; i++)
			gaps += !items[i].known;
		TEST_ASSERT_EQUAL_INT_MESSAGE(1, gaps, "the writer did not begin anew");
		is_value(0, 20);
		is_value(n - 1, 21);
	}
}

static void test_another_directory_is_taken_over_at_a_reload(void)
{
	arguments.option = NULL;
	config.recorder.directory = directory;
	TEST_ASSERT_EQUAL_INT(0, recording_open(&face));
	found();
	room(20);
	config.recorder.directory = other;
	news(FACE_FILE);
	room(21);
	recording_close(&face);
	TEST_ASSERT_EQUAL_INT(1, written_at(directory));
	is_value(0, 20);
	TEST_ASSERT_GREATER_OR_EQUAL(1, written_at(other));
	is_value(written_at(other) - 1, 21);
}

static void test_a_signal_that_is_off_is_not_kept(void)
{
	config.recorder.record.off = true;
	TEST_ASSERT_EQUAL_INT(0, recording_open(&face));
	found();
	room(20);
	room(21);
	TEST_ASSERT_EQUAL_INT(0, written());
}

/* How many events the history has. */
static int events(void)
{
	static struct ows_history_event event;
	struct ows_history *h;
	int n = 0;

	TEST_ASSERT_EQUAL_INT(0, ows_history_open(NULL, directory, &h));
	TEST_ASSERT_EQUAL_INT(0, ows_history_events(h, 0, INT64_MAX, 1u << OWS_HISTORY_ALARM));
	while (ows_history_next_event(h, &event) > 0)
		n++;
	ows_history_close(h);
	return n;
}

static void test_an_alarm_of_a_signal_that_is_there_is_kept_and_of_no_other(void)
{
	struct ows_alarm alarm = {
		.type = OWS_DOUBLE, .kind = OWS_ALARM_H, .event = OWS_ALARM_RAISED};
	struct face_event event = {.news = FACE_ALARM, .alarm = &alarm};
	static const int rows[] = {ROOM, COUNT - 1, COUNT, -1, INT32_MAX};

	TEST_ASSERT_EQUAL_INT(0, recording_open(&face));
	found();
	for (unsigned i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		alarm.signal = rows[i];
		alarm.occurred_ns = ows_now();
		recording_event(&face, &event);
	}
	recording_close(&face);
	TEST_ASSERT_EQUAL_INT(2, events());
}

/* The loop is asked for at least each second, and an interval when its time has come. */
static void test_the_next_tick_is_within_a_second_and_never_before_now(void)
{
	static const int64_t intervals[] = {0, 100 * MS, S, 60 * S};

	for (unsigned i = 0; i < sizeof(intervals) / sizeof(intervals[0]); i++) {
		int64_t now_ns;

		new_directories();
		config.recorder.record.interval_ns = intervals[i];
		TEST_ASSERT_EQUAL_INT(0, recording_open(&face));
		found();
		for (unsigned n = 0; n < 20; n++) {
			now_ns = ows_now();
			recording_tick(&face, now_ns);
			TEST_ASSERT_GREATER_THAN_INT64(now_ns, face.tick_ns);
			TEST_ASSERT_LESS_OR_EQUAL_INT64(now_ns + S, face.tick_ns);
			if (intervals[i] && intervals[i] < S)
				TEST_ASSERT_LESS_OR_EQUAL_INT64(now_ns + intervals[i] + MS,
				                                face.tick_ns);
		}
		recording_close(&face);
	}
}

/* Also of a float: the file has doubles alone. */
static void test_a_value_is_kept_as_the_bits_of_a_double_or_as_it_is(void)
{
	TEST_ASSERT_EQUAL_INT64(value_of_double(-0.5), series_bits(OWS_DOUBLE, -0.5, 7));
	TEST_ASSERT_EQUAL_INT64(value_of_double(0.1f), series_bits(OWS_FLOAT, 0.1f, 7));
	TEST_ASSERT_EQUAL_INT64(-7, series_bits(OWS_LARGE, 0.5, -7));
	TEST_ASSERT_EQUAL_INT64(1, series_bits(OWS_BOOL, 0.5, 1));
	TEST_ASSERT_EQUAL_INT64(9, series_bits(OWS_STRING, 0.5, 9));
}

static void test_the_status_says_what_is_waited_for_and_what_is_kept(void)
{
	TEST_ASSERT_EQUAL_INT(0, recording_open(&face));
	recording_tick(&face, ows_now());
	TEST_ASSERT_EQUAL_STRING_LEN("waiting for owsd recording", face.status, 26);
	found();
	recording_tick(&face, ows_now());
	TEST_ASSERT_EQUAL_STRING_LEN("2 signals into ", face.status, 15);
	recording_close(&face);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_values_are_kept_when_they_change_with_their_times);
	RUN_TEST(test_while_owsd_is_lost_nothing_is_known_and_no_value_reaches_in);
	RUN_TEST(test_an_owsd_that_is_lost_again_at_once_makes_a_gap_of_its_own);
	RUN_TEST(test_the_gap_of_a_lost_owsd_begins_at_its_last_heartbeat_not_at_its_loss);
	RUN_TEST(test_changes_that_were_missed_are_a_gap_since_the_last_look);
	RUN_TEST(test_the_option_goes_before_the_key_of_the_file);
	RUN_TEST(test_a_directory_with_too_long_a_name_is_refused_at_the_start);
	RUN_TEST(test_a_file_read_again_that_says_the_same_makes_no_gap);
	RUN_TEST(test_another_option_of_keeping_is_taken_over_at_a_reload);
	RUN_TEST(test_another_directory_is_taken_over_at_a_reload);
	RUN_TEST(test_a_signal_that_is_off_is_not_kept);
	RUN_TEST(test_an_alarm_of_a_signal_that_is_there_is_kept_and_of_no_other);
	RUN_TEST(test_the_next_tick_is_within_a_second_and_never_before_now);
	RUN_TEST(test_a_value_is_kept_as_the_bits_of_a_double_or_as_it_is);
	RUN_TEST(test_the_status_says_what_is_waited_for_and_what_is_kept);
	return UNITY_END();
}
