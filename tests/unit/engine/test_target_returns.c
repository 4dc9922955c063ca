/* SPDX-License-Identifier: MIT */
/*
 * A target that was down proves nothing of its devices: no signal is good again before it was read
 * or written, and nothing is written that nobody asked for.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "src/ground/text/log.h"
#include "tests/unit/aid/scene.h"

#define D "/29.B89115000000"
#define PIO D "/PIO.BYTE"
#define SENSED D "/sensed.BYTE"
#define ROW 1

static struct scene s;
static FILE *out;
static char message[80];

enum kind { NOT_READ, READ_BACK, RESTORED, READABLE, INIT_VALUE, NOT_WRITABLE, INPUT, KINDS };
static const char *const kinds[] = {"ReadBack 0", "ReadBack",     "Restore",       "Readable",
                                    "InitValue",  "not writable", "PerFactor 1000"};

void setUp(void)
{
	scene_init(&s);
	s.log = log_create(LOG_LEVEL_INFO);
	out = tmpfile();
	TEST_ASSERT_NOT_NULL(out);
}
void tearDown(void)
{
	struct log *log = s.log;

	scene_end(&s);
	log_destroy(log);
	fclose(out);
}

static unsigned logged(const char *text)
{
	char line[512];
	unsigned n = 0;

	log_drain(s.log, fileno(out), 0);
	rewind(out);
	while (fgets(line, sizeof(line), out))
		n += strstr(line, text) != NULL;
	return n;
}

static void begin(enum kind kind)
{
	struct config_item *item = kind == INPUT ? scene_input(&s, "row", SENSED, OWS_BYTE)
	                                         : scene_output(&s, "row", PIO, OWS_BYTE);

	snprintf(message, sizeof(message), "%s", kinds[kind]);
	if (kind == INPUT)
		item->per_factor = 1000;
	if (kind == READ_BACK || kind == RESTORED)
		item->read_back_ns = 10 * SCENE_S;
	item->restores = kind == RESTORED;
	item->readable |= kind == READABLE;
	item->has_init = kind == INIT_VALUE;
	item->init_value = 85;
	item->init_text = "85";
	scene_put(&s, PIO, "0", 0);
	scene_put(&s, SENSED, "85", 0);
	s.config.timeout_ns = 2 * SCENE_S;
	scene_start(&s);
	scene_up(&s);
	if (kind != INPUT && kind != INIT_VALUE)
		scene_set(&s, ROW, 85);
	scene_run(&s, SCENE_S);
	if (kind == NOT_WRITABLE)
		scene_enable_writes(&s, ROW, false);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_GOOD, scene_sample(&s, ROW).quality, message);
	TEST_ASSERT_EQUAL_INT64_MESSAGE(85, scene_sample(&s, ROW).value, message);
	scene_clear_trace(&s);
}

/* The target goes and comes; meanwhile the board has lost what was written to it, or not. */
static void goes(bool board_lost)
{
	scene_down(&s, -ENOTCONN);
	scene_run(&s, 4 * SCENE_S);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_TARGET, scene_sample(&s, ROW).quality, message);
	if (board_lost)
		scene_put(&s, PIO, "0", 0);
}

static void each(void (*check)(enum kind kind))
{
	for (unsigned kind = 0; kind < KINDS; kind++) {
		tearDown();
		setUp();
		check((enum kind)kind);
	}
}

static void is_not_good_before_it_is_read(enum kind kind)
{
	unsigned asked;
	uint32_t count;

	begin(kind);
	goes(true);
	count = scene_sample(&s, ROW).count;
	asked = s.reads + s.writes;
	scene_up(&s);
	for (unsigned ms = 0; ms < 5000; ms++) {
		struct ows_sample sample = scene_sample(&s, ROW);

		if (ows_good(sample.quality))
			TEST_ASSERT_GREATER_THAN_UINT32_MESSAGE(count, sample.count, message);
		TEST_ASSERT_FALSE_MESSAGE(ows_good(sample.quality) && sample.err, message);
		TEST_ASSERT_FALSE_MESSAGE(sample.quality == OWS_Q_LAST_USABLE && sample.err,
		                          message);
		scene_run(&s, SCENE_MS);
	}
	if (kind == NOT_READ || kind == INIT_VALUE || kind == NOT_WRITABLE) {
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_LAST_USABLE, scene_sample(&s, ROW).quality,
		                               message);
		TEST_ASSERT_EQUAL_UINT_MESSAGE(asked, s.reads + s.writes, message);
		TEST_ASSERT_EQUAL_UINT_MESSAGE(1, logged("1 of its outputs (row) is not read back"),
		                               message);
		return;
	}
	TEST_ASSERT_EQUAL_UINT_MESSAGE(0, logged("of its outputs"), message);
	if (kind == READ_BACK)
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_DIFFERS, scene_sample(&s, ROW).quality,
		                               message);
	else
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_GOOD, scene_sample(&s, ROW).quality, message);
	TEST_ASSERT_EQUAL_STRING_MESSAGE(kind == RESTORED ? "85" : "0", scene_at(&s, PIO), message);
}

static void test_no_signal_is_good_before_it_was_read_or_written(void)
{
	each(is_not_good_before_it_is_read);
}

static void is_good_when_it_has_kept_its_command(enum kind kind)
{
	begin(kind);
	goes(false);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(0, s.writes, message);
	if (kind == READ_BACK || kind == RESTORED || kind == READABLE || kind == INPUT)
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_GOOD, scene_sample(&s, ROW).quality, message);
}

static void test_nothing_is_written_when_the_target_returns(void)
{
	each(is_good_when_it_has_kept_its_command);
}

/* Set again with the value that was written before the loss. */
static void a_set_is_written(enum kind kind)
{
	if (kind == INPUT || kind == NOT_WRITABLE || kind == RESTORED || kind == READABLE)
		return;
	begin(kind);
	goes(true);
	scene_up(&s);
	scene_run(&s, 2 * SCENE_S);
	scene_set(&s, ROW, 85);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING_MESSAGE("85", scene_at(&s, PIO), message);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(1, s.writes, message);
	if (kind != READ_BACK) /* its next reading ends the difference */
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_GOOD, scene_sample(&s, ROW).quality, message);
	/* from then on the same value is no change, as ever */
	scene_set(&s, ROW, 85);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(1, s.writes, message);
}

static void test_the_next_set_is_written_though_the_value_is_the_same(void)
{
	each(a_set_is_written);
}

/* ... and no program is told before that its command is in the device. */
static void a_set_while_down_is_written(enum kind kind)
{
	uint32_t applied;

	if (kind == INPUT || kind == NOT_WRITABLE)
		return;
	begin(kind);
	goes(true);
	applied = scene_applied(&s, ROW);
	scene_set(&s, ROW, 85);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT32_MESSAGE(applied, scene_applied(&s, ROW), message);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_NOT_EQUAL_MESSAGE(applied, scene_applied(&s, ROW), message);
	TEST_ASSERT_EQUAL_STRING_MESSAGE("85", scene_at(&s, PIO), message);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_GOOD, scene_sample(&s, ROW).quality, message);
}

static void test_a_set_of_the_same_value_while_the_target_is_down_is_written(void)
{
	each(a_set_while_down_is_written);
}

/* SafeValue is a command as any other: what the output has is not known. */
static void test_safevalue_is_written_though_the_value_is_the_same(void)
{
	struct config_item *item = scene_output(&s, "row", PIO, OWS_BYTE);

	item->has_safe = true;
	item->safe_value = 85;
	item->safe_text = "85";
	scene_put(&s, PIO, "0", 0);
	s.config.timeout_ns = 2 * SCENE_S;
	scene_start(&s);
	scene_up(&s);
	scene_set(&s, ROW, 85);
	scene_beat(&s, 1, 500, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("85", scene_at(&s, PIO));
	scene_down(&s, -ENOTCONN);
	scene_beat(&s, 1, 500, 4 * SCENE_S);
	scene_put(&s, PIO, "0", 0);
	scene_up(&s);
	scene_beat(&s, 1, 500, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("0", scene_at(&s, PIO));
	scene_run(&s, 2 * SCENE_S); /* the program hangs */
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter(&s, "safe_outputs"));
	TEST_ASSERT_EQUAL_STRING("85", scene_at(&s, PIO));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, ROW).quality);
}

static void test_a_one_shot_makes_an_output_good_again(void)
{
	begin(NOT_READ);
	goes(true);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	scene_slot(&s, ROW)->one_shot++;
	scene_ring(&s, ROW);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("85", scene_at(&s, PIO));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, ROW).quality);
}

/* The target is silent, which is not told by the bus, and answers again. */
static void test_a_target_that_was_stuck_proves_no_more(void)
{
	scene_input(&s, "other", D "/sensed.0", OWS_BYTE);
	scene_put(&s, D "/sensed.0", "1", 0);
	scene_output(&s, "row", PIO, OWS_BYTE);
	scene_put(&s, PIO, "0", 0);
	s.config.timeout_ns = SCENE_S;
	scene_start(&s);
	scene_up(&s);
	scene_set(&s, 2, 85);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 2).quality);
	s.bus[0].mute = true;
	scene_run(&s, 4 * SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_TARGET, scene_sample(&s, 2).quality);
	s.bus[0].mute = false;
	TEST_ASSERT_EQUAL_UINT(1, s.bus[0].swallowed_count);
	s.bus[0].swallowed_count = 0;
	scene_answer(&s, s.bus[0].swallowed[0]->id, 0, "1", s.bus[0].swallowed[0]);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_LAST_USABLE, scene_sample(&s, 2).quality);
	TEST_ASSERT_EQUAL_UINT(1, s.writes);
}

static void test_a_limit_alarm_of_an_output_stays_until_it_was_written(void)
{
	struct config_item *item = scene_output(&s, "row", PIO, OWS_BYTE);

	item->limits.any = item->limits.has[CONFIG_LIMIT_HH] = true;
	item->limits.limit[CONFIG_LIMIT_HH] = 200;
	scene_put(&s, PIO, "0", 0);
	scene_start(&s);
	scene_up(&s);
	scene_set(&s, ROW, 85);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT8(OWS_LIMIT_NORMAL, scene_attrs(&s, ROW).limit_state);
	goes(true);
	TEST_ASSERT_EQUAL_UINT8(OWS_LIMIT_UNACKNOWLEDGED, scene_attrs(&s, ROW).limit_state);
	scene_up(&s);
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT8(OWS_LIMIT_UNACKNOWLEDGED, scene_attrs(&s, ROW).limit_state);
	scene_set(&s, ROW, 85);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT8(OWS_LIMIT_RETURNED, scene_attrs(&s, ROW).limit_state);
}

static void test_what_was_not_known_is_not_known_after_a_reload_either(void)
{
	begin(NOT_READ);
	goes(true);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	scene_reload(&s, NULL);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_LAST_USABLE, scene_sample(&s, ROW).quality);
	scene_set(&s, ROW, 85);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("85", scene_at(&s, PIO));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_no_signal_is_good_before_it_was_read_or_written);
	RUN_TEST(test_nothing_is_written_when_the_target_returns);
	RUN_TEST(test_the_next_set_is_written_though_the_value_is_the_same);
	RUN_TEST(test_a_set_of_the_same_value_while_the_target_is_down_is_written);
	RUN_TEST(test_safevalue_is_written_though_the_value_is_the_same);
	RUN_TEST(test_a_one_shot_makes_an_output_good_again);
	RUN_TEST(test_a_target_that_was_stuck_proves_no_more);
	RUN_TEST(test_a_limit_alarm_of_an_output_stays_until_it_was_written);
	RUN_TEST(test_what_was_not_known_is_not_known_after_a_reload_either);
	return UNITY_END();
}
