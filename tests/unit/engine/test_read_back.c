/* SPDX-License-Identifier: MIT */
/* Outputs that are read back: where they do not have their command, that is seen, and told once. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "src/ground/text/log.h"
#include "tests/unit/aid/scene.h"

static struct scene s;
static FILE *out;

#define PIO "/29.B89115000000/PIO.BYTE"
#define POR "/29.B89115000000/por"
#define OUT 1

static struct config_item *an_output(void)
{
	struct config_item *item = scene_output(&s, "out", PIO, OWS_BYTE);

	item->read_back_ns = 10 * SCENE_S;
	scene_put(&s, PIO, "0", 0);
	return item;
}

static void begin(void)
{
	scene_start(&s);
	scene_up(&s);
	scene_set(&s, OUT, 255);
	scene_run(&s, SCENE_S);
	scene_clear_trace(&s);
}

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

/* How many lines of the log have the text. */
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

static void shows(uint8_t quality, int value)
{
	TEST_ASSERT_EQUAL_HEX8(quality, scene_sample(&s, OUT).quality);
	TEST_ASSERT_EQUAL_INT(value, (int)scene_number(&s, OUT));
	TEST_ASSERT_EQUAL_INT64(255, scene_attrs(&s, OUT).commanded);
}

static unsigned entered(enum ows_alarm_event event)
{
	unsigned n = 0;

	for (unsigned k = 0; k < s.image.header->alarm_head && k < OWS_JOURNAL; k++)
		n += s.image.alarms[k].kind == OWS_ALARM_DIFFERS &&
		     s.image.alarms[k].event == event;
	return n;
}

static void test_an_output_is_read_back_past_the_cache_at_its_own_pace(void)
{
	an_output();
	begin();
	scene_run(&s, 60 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(6, s.reads);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
	TEST_ASSERT_EQUAL_STRING_LEN("r " PIO "\n", s.trace, strlen("r " PIO "\n"));
	shows(OWS_Q_GOOD, 255);
	TEST_ASSERT_LESS_THAN_INT64_MESSAGE(11 * SCENE_S,
	                                    s.now_ns - scene_sample(&s, OUT).measured_ns,
	                                    "its age is that of the last look");
}

static void test_without_a_command_nothing_is_read(void)
{
	an_output();
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, 60 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(0, s.reads);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_INITIAL, scene_sample(&s, OUT).quality);
}

static void test_a_command_that_is_lost_is_told_once_and_not_written(void)
{
	an_output();
	begin();
	scene_put(&s, PIO, "0", 0);
	scene_run(&s, 60 * SCENE_S);
	shows(OWS_Q_DIFFERS, 0);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
	TEST_ASSERT_EQUAL_UINT(1, logged("not as commanded: it reads 0, and 255 was written"));
	TEST_ASSERT_EQUAL_UINT(1, entered(OWS_ALARM_RAISED));
	TEST_ASSERT_EQUAL_INT64(255, s.image.alarms[0].before);
	TEST_ASSERT_EQUAL_INT64(0, s.image.alarms[0].after);
	TEST_ASSERT_EQUAL_UINT(0, entered(OWS_ALARM_RETURNED));
	scene_put(&s, PIO, "255", 0);
	scene_run(&s, 11 * SCENE_S);
	shows(OWS_Q_GOOD, 255);
	TEST_ASSERT_EQUAL_UINT(1, logged("as commanded again"));
	TEST_ASSERT_EQUAL_UINT(1, entered(OWS_ALARM_RETURNED));
}

static void forget_once(struct scene *scene, const char *path)
{
	static unsigned reads;

	(void)path;
	if (++reads == 2)
		scene_put(scene, PIO, "255", 0);
}

static void test_one_reading_that_differs_decides_nothing(void)
{
	an_output();
	begin();
	scene_put(&s, PIO, "0", 0);
	s.on_read = forget_once;
	scene_run(&s, 30 * SCENE_S);
	shows(OWS_Q_GOOD, 255);
	TEST_ASSERT_EQUAL_UINT(0, logged("not as commanded"));
	TEST_ASSERT_EQUAL_UINT(0, entered(OWS_ALARM_RAISED));
}

static void test_a_new_command_is_no_difference(void)
{
	an_output();
	s.bus[0].depth = 4;
	s.bus[0].slow = PIO;
	s.bus[0].slow_ns = 300 * SCENE_MS; /* writes and readings overtake each other */
	begin();
	for (int i = 0; i < 400; i++) {
		scene_set(&s, OUT, i % 2 ? 255 : 1);
		scene_run(&s, (100 + 7 * (i % 61)) * SCENE_MS);
		TEST_ASSERT_NOT_EQUAL_HEX8(OWS_Q_DIFFERS, scene_sample(&s, OUT).quality);
	}
	TEST_ASSERT_EQUAL_UINT(0, entered(OWS_ALARM_RAISED));
}

static void answer_the_old_one(struct scene *scene, const char *path)
{
	scene_put(scene, path, "255", 0);
	scene->on_read = NULL;
}

static void give_the_new_one(struct scene_bus *bus, const struct bus_req *req)
{
	/* the reading that was begun before the write is over */
	if (req->op == BUS_READ && !bus->scene->on_read)
		scene_put(bus->scene, PIO, "1", 0);
}

static void test_a_reading_that_a_write_overtook_is_not_published(void)
{
	struct config_item *item = an_output();

	item->readable = true;
	item->per_factor = 10;
	s.bus[0].depth = 2;
	s.bus[0].slow = PIO;
	s.bus[0].slow_ns = SCENE_MS;
	begin();
	s.bus[0].slow_ns = 200 * SCENE_MS;
	while (s.reads == 0 || s.bus[0].pending_count == 0)
		scene_run(&s, SCENE_MS);
	s.bus[0].slow_ns = SCENE_MS;
	s.on_read = answer_the_old_one;
	s.on_done = give_the_new_one;
	scene_clear_trace(&s);
	scene_set(&s, OUT, 1);
	for (int i = 0; i < 400; i++) {
		scene_run(&s, SCENE_MS);
		if (i > 20) {
			TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, OUT).quality);
			TEST_ASSERT_EQUAL_INT(1, (int)scene_number(&s, OUT));
		}
	}
	TEST_ASSERT_NULL_MESSAGE(s.on_read, "the old one came");
	TEST_ASSERT_EQUAL_STRING_LEN_MESSAGE("W " PIO "=1\nR " PIO "\n", s.trace,
	                                     strlen("W " PIO "=1\nR " PIO "\n"),
	                                     "and it is read again");
}

static void test_the_value_of_a_cache_is_asked_for_again(void)
{
	struct config_item *item = an_output();

	item->readable = true;
	item->per_factor = 10;
	begin();
	scene_run(&s, 5500 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING_LEN("R " PIO "\n", s.trace, strlen("R " PIO "\n"));
	scene_put(&s, PIO, "0", 0);
	scene_clear_trace(&s);
	scene_run(&s, 1500 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING_LEN("R " PIO "\nr " PIO "\n", s.trace,
	                             strlen("R " PIO "\nr " PIO "\n"));
	shows(OWS_Q_DIFFERS, 0);
}

/* A server whose cache keeps what was written, while the device has lost it. */
static void keep_what_was_written(struct scene_bus *bus, const struct bus_req *req)
{
	if (req->op == BUS_READ)
		scene_put(bus->scene, PIO, req->fresh ? "0" : "255", 0);
}

static void test_no_cache_hides_it_where_the_output_is_read_in_the_cycle_too(void)
{
	an_output()->readable = true;
	begin();
	scene_run(&s, 8 * SCENE_S);
	TEST_ASSERT_NULL_MESSAGE(strstr(s.trace, "r " PIO), "the cycle takes what the cache has");
	s.on_done = keep_what_was_written;
	scene_run(&s, 3 * SCENE_S);
	shows(OWS_Q_DIFFERS, 0);
	s.no_trace = true;
	for (int i = 0; i < 300; i++) {
		scene_run(&s, 100 * SCENE_MS);
		shows(OWS_Q_DIFFERS, 0);
	}
	TEST_ASSERT_EQUAL_UINT(1, entered(OWS_ALARM_RAISED));
	TEST_ASSERT_EQUAL_UINT(0, entered(OWS_ALARM_RETURNED));
}

static void test_a_device_that_is_gone_is_absent_and_gets_its_command_again(void)
{
	an_output();
	begin();
	scene_put(&s, PIO, NULL, -ENODEV);
	scene_run(&s, 20 * SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_NO_DEVICE, scene_sample(&s, OUT).quality);
	scene_put(&s, PIO, "0", 0);
	scene_run(&s, 60 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING("255", scene_at(&s, PIO));
	shows(OWS_Q_GOOD, 255);
	TEST_ASSERT_EQUAL_UINT(0, entered(OWS_ALARM_RAISED));
}

static void test_a_write_that_fails_is_not_hidden_by_a_reading(void)
{
	an_output();
	begin();
	scene_refuse_writes(&s, PIO, -EIO);
	scene_set(&s, OUT, 1);
	scene_run(&s, 60 * SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_DEVICE, scene_sample(&s, OUT).quality);
	scene_refuse_writes(&s, PIO, 0);
	scene_run(&s, 70 * SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, OUT).quality);
}

static void test_a_new_command_ends_the_difference_when_the_device_has_it(void)
{
	an_output();
	begin();
	scene_put(&s, PIO, "0", 0);
	scene_run(&s, 11 * SCENE_S);
	shows(OWS_Q_DIFFERS, 0);
	scene_set(&s, OUT, 255); /* the same is no change */
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
	scene_set(&s, OUT, 3);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, OUT).quality);
	TEST_ASSERT_EQUAL_UINT(1, entered(OWS_ALARM_RETURNED));
	scene_put(&s, PIO, "0", 0);
	scene_run(&s, 11 * SCENE_S);
	scene_slot(&s, OUT)->one_shot++; /* so it is written again by hand */
	scene_ring(&s, OUT);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("3", scene_at(&s, PIO));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, OUT).quality);
}

static void test_restore_writes_the_command_again(void)
{
	an_output()->restores = true;
	begin();
	scene_put(&s, PIO, "0", 0);
	scene_run(&s, 11 * SCENE_S);
	TEST_ASSERT_EQUAL_STRING("255", scene_at(&s, PIO));
	TEST_ASSERT_EQUAL_UINT(1, s.writes);
	shows(OWS_Q_GOOD, 255);
	TEST_ASSERT_EQUAL_UINT(1, logged("the command is written again"));
	TEST_ASSERT_EQUAL_UINT(1, entered(OWS_ALARM_RAISED));
	TEST_ASSERT_EQUAL_UINT(1, entered(OWS_ALARM_RETURNED));
}

static void lose_it(struct scene *scene, const char *path)
{
	scene_put(scene, path, "0", 0);
}

static void test_restore_does_not_hammer_a_device_that_keeps_nothing(void)
{
	an_output()->restores = true;
	begin();
	s.on_read = lose_it;
	scene_run(&s, 600 * SCENE_S);
	shows(OWS_Q_DIFFERS, 0);
	TEST_ASSERT_LESS_THAN_UINT(13, s.writes);
	TEST_ASSERT_GREATER_THAN_UINT(5, s.writes);
	TEST_ASSERT_EQUAL_UINT(1, logged("not as commanded"));
	TEST_ASSERT_EQUAL_UINT(1, entered(OWS_ALARM_RAISED));
}

static void test_restore_writes_nothing_where_writing_is_disabled(void)
{
	an_output()->restores = true;
	begin();
	scene_enable_writes(&s, OUT, false);
	scene_put(&s, PIO, "0", 0);
	scene_run(&s, 30 * SCENE_S);
	shows(OWS_Q_DIFFERS, 0);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
}

static void test_a_limit_alarm_has_it_as_bad(void)
{
	struct config_item *item = an_output();

	item->limits.any = item->limits.has[CONFIG_LIMIT_HH] = true;
	item->limits.limit[CONFIG_LIMIT_HH] = 256;
	begin();
	TEST_ASSERT_EQUAL_UINT8(OWS_LIMIT_NORMAL, scene_attrs(&s, OUT).limit_state);
	scene_put(&s, PIO, "0", 0);
	scene_run(&s, 11 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT8(OWS_LIMIT_UNACKNOWLEDGED, scene_attrs(&s, OUT).limit_state);
	TEST_ASSERT_EQUAL_UINT8(OWS_ALARM_BAD, scene_attrs(&s, OUT).limit_condition);
}

static void without_read_back(struct config *config)
{
	config->items[0].read_back_ns = 0;
}

static void test_a_reload_carries_the_difference_over(void)
{
	an_output();
	begin();
	scene_put(&s, PIO, "0", 0);
	scene_run(&s, 11 * SCENE_S);
	scene_reload(&s, NULL);
	scene_run(&s, 30 * SCENE_S);
	shows(OWS_Q_DIFFERS, 0);
	TEST_ASSERT_EQUAL_UINT(1, logged("not as commanded"));
	scene_reload(&s, without_read_back);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_LAST_USABLE, scene_sample(&s, OUT).quality);
	TEST_ASSERT_EQUAL_UINT(1, entered(OWS_ALARM_RETURNED));
	TEST_ASSERT_EQUAL_UINT(0, logged("as commanded again"));
}

static void disable_writes(struct scene *scene, const char *path)
{
	(void)path;
	if (scene_sample(scene, OUT).quality == OWS_Q_DIFFERS)
		scene_enable_writes(scene, OUT, false);
	scene_put(scene, PIO, "0", 0);
}

static void test_a_difference_that_is_compared_no_longer_ends_in_the_journal(void)
{
	struct config_item *item = an_output();

	item->restores = item->readable = true;
	item->per_factor = 1;
	begin();
	scene_refuse_writes(&s, PIO, -EIO); /* so the command is not confirmed any more */
	s.on_read = disable_writes;
	scene_run(&s, 60 * SCENE_S);
	TEST_ASSERT_NOT_EQUAL_HEX8(OWS_Q_DIFFERS, scene_sample(&s, OUT).quality);
	TEST_ASSERT_EQUAL_UINT(1, entered(OWS_ALARM_RAISED));
	TEST_ASSERT_EQUAL_UINT(1, entered(OWS_ALARM_RETURNED));
}

/* --- Restarts -------------------------------------------------------------------------------- */

static void a_board(const char *por)
{
	an_output()->has_por = true;
	scene_put(&s, POR, por, 0);
	begin();
	scene_run(&s, 25 * SCENE_S);
	scene_clear_trace(&s);
}

static void it_restarts(void)
{
	scene_put(&s, POR, "1", 0);
	scene_put(&s, PIO, "0", 0);
	scene_run(&s, 25 * SCENE_S);
}

static unsigned restarts(void)
{
	unsigned n = 0;

	for (unsigned k = 0; k < s.image.header->alarm_head && k < OWS_JOURNAL; k++)
		n += s.image.alarms[k].kind == OWS_ALARM_POR;
	return n;
}

static void test_a_device_that_tells_of_its_restart_gets_its_command_again(void)
{
	a_board("0");
	it_restarts();
	TEST_ASSERT_EQUAL_STRING("255", scene_at(&s, PIO));
	TEST_ASSERT_EQUAL_UINT(1, s.writes);
	shows(OWS_Q_GOOD, 255);
	TEST_ASSERT_EQUAL_UINT(1, restarts());
	TEST_ASSERT_EQUAL_UINT(1, logged("the device has restarted"));
	TEST_ASSERT_EQUAL_UINT64(1, scene_counter_of(&s, 0, "power_on_resets"));
}

/* Who saves a configuration works at the board. */
static void test_a_reload_keeps_what_is_known_of_the_flag(void)
{
	a_board("0");
	scene_reload(&s, NULL);
	it_restarts();
	TEST_ASSERT_EQUAL_STRING("255", scene_at(&s, PIO));
	shows(OWS_Q_GOOD, 255);
	TEST_ASSERT_EQUAL_UINT(1, restarts());
}

static void another_target(struct config *config)
{
	config->targets[0].text = "other";
}

static void test_of_another_target_the_flag_is_not_known(void)
{
	a_board("0");
	scene_bus(&s, "other", 0);
	s.config.target_count = 1;
	scene_reload(&s, another_target);
	scene_put(&s, POR, "1", 0);
	scene_up_on(&s, 1);
	scene_run(&s, 25 * SCENE_S);
	it_restarts();
	TEST_ASSERT_EQUAL_UINT(0, restarts());
}

static void test_a_flag_that_nobody_cleared_tells_nothing(void)
{
	a_board("1");
	it_restarts();
	shows(OWS_Q_DIFFERS, 0);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
	TEST_ASSERT_EQUAL_UINT(0, restarts());
	scene_put(&s, POR, "0", 0); /* cleared, and written by hand */
	scene_slot(&s, OUT)->one_shot++;
	scene_ring(&s, OUT);
	scene_run(&s, 25 * SCENE_S);
	shows(OWS_Q_GOOD, 255);
	it_restarts();
	shows(OWS_Q_GOOD, 255);
	TEST_ASSERT_EQUAL_UINT(1, restarts());
}

static void test_what_somebody_else_switched_is_no_restart(void)
{
	a_board("0");
	scene_put(&s, PIO, "0", 0);
	scene_run(&s, 60 * SCENE_S);
	shows(OWS_Q_DIFFERS, 0);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
	TEST_ASSERT_EQUAL_UINT(0, restarts());
}

static void test_a_flag_that_cannot_be_read_tells_nothing(void)
{
	a_board("0");
	scene_put(&s, PIO, "0", 0);
	scene_put(&s, POR, NULL, -EIO);
	scene_run(&s, 60 * SCENE_S);
	shows(OWS_Q_DIFFERS, 0);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
}

static void test_a_flag_that_the_device_does_not_have_is_not_asked_for_each_time(void)
{
	unsigned asked = 0;

	an_output()->has_por = true;
	s.config.items[0].readable = true;
	s.config.items[0].per_factor = 1;
	scene_put(&s, POR, NULL, -ENOENT);
	begin();
	for (unsigned i = 0; i < 150; i++) {
		scene_clear_trace(&s);
		scene_run(&s, SCENE_S);
		asked += strstr(s.trace, POR) != NULL;
	}
	TEST_ASSERT_LESS_THAN_UINT(4, asked);
	scene_put(&s, POR, "0", 0); /* it was a fault */
	scene_run(&s, 61 * SCENE_S);
	it_restarts();
	TEST_ASSERT_EQUAL_UINT(1, restarts());
}

static void test_the_flag_is_read_once_and_not_again(void)
{
	a_board("0");
	scene_run(&s, 60 * SCENE_S);
	TEST_ASSERT_NULL(strstr(s.trace, POR));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_output_is_read_back_past_the_cache_at_its_own_pace);
	RUN_TEST(test_without_a_command_nothing_is_read);
	RUN_TEST(test_a_command_that_is_lost_is_told_once_and_not_written);
	RUN_TEST(test_one_reading_that_differs_decides_nothing);
	RUN_TEST(test_a_new_command_is_no_difference);
	RUN_TEST(test_a_reading_that_a_write_overtook_is_not_published);
	RUN_TEST(test_the_value_of_a_cache_is_asked_for_again);
	RUN_TEST(test_no_cache_hides_it_where_the_output_is_read_in_the_cycle_too);
	RUN_TEST(test_a_device_that_is_gone_is_absent_and_gets_its_command_again);
	RUN_TEST(test_a_write_that_fails_is_not_hidden_by_a_reading);
	RUN_TEST(test_a_new_command_ends_the_difference_when_the_device_has_it);
	RUN_TEST(test_restore_writes_the_command_again);
	RUN_TEST(test_restore_does_not_hammer_a_device_that_keeps_nothing);
	RUN_TEST(test_restore_writes_nothing_where_writing_is_disabled);
	RUN_TEST(test_a_limit_alarm_has_it_as_bad);
	RUN_TEST(test_a_reload_carries_the_difference_over);
	RUN_TEST(test_a_difference_that_is_compared_no_longer_ends_in_the_journal);
	RUN_TEST(test_a_device_that_tells_of_its_restart_gets_its_command_again);
	RUN_TEST(test_a_reload_keeps_what_is_known_of_the_flag);
	RUN_TEST(test_of_another_target_the_flag_is_not_known);
	RUN_TEST(test_a_flag_that_nobody_cleared_tells_nothing);
	RUN_TEST(test_what_somebody_else_switched_is_no_restart);
	RUN_TEST(test_a_flag_that_cannot_be_read_tells_nothing);
	RUN_TEST(test_a_flag_that_the_device_does_not_have_is_not_asked_for_each_time);
	RUN_TEST(test_the_flag_is_read_once_and_not_again);
	return UNITY_END();
}
