/* SPDX-License-Identifier: MIT */
/*
 * Alarms that cannot be armed: one restart of a device is one restart, however long its por stands.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/ground/text/log.h"
#include "tests/unit/aid/alarm_scene.h"

static struct scene s;
static bool por_stuck, out_stuck; /* what is written there is taken, and not done */
static bool restarted;

void setUp(void)
{
	scene_init(&s);
	por_stuck = out_stuck = restarted = false;
}
void tearDown(void)
{
	scene_end(&s);
}

#define PIO D "/PIO.BYTE"
#define RELAYS 2 /* their record; 1 is the alarm item's */

static void relays(void)
{
	struct config_item *out = scene_output(&s, "relays", PIO, OWS_BYTE);

	out->has_init = true;
	out->init_value = 3;
}

static void on_read(struct scene *scene, const char *path)
{
	if (por_stuck && restarted)
		scene_put(scene, D "/por", "1", 0);
	if (out_stuck)
		scene_put(scene, PIO, "0", 0);
	alarm_on_read(scene, path);
}

/* The board with its relays at 7, by command. */
static void board(struct config_item *item)
{
	(void)item;
	relays();
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
	s.on_read = on_read;
	scene_set(&s, RELAYS, 7);
	scene_run(&s, 200 * SCENE_MS);
	scene_clear_trace(&s);
}

static unsigned count(const char *line)
{
	unsigned n = 0;

	for (const char *at = s.trace; (at = strstr(at, line)) != NULL; at += strlen(line))
		n++;
	return n;
}

/* Restarts in the journal. */
static unsigned journal(void)
{
	unsigned n = 0;

	for (uint32_t k = 0; k < s.image.header->alarm_head; k++)
		n += s.image.alarms[k].kind == OWS_ALARM_POR;
	return n;
}

static bool unarmed(unsigned record)
{
	return scene_attrs(&s, record).flags & OWS_ATTR_ALARM_UNARMED;
}

/* Its power fails: the relays let go, por is set. */
static void lose_power(void)
{
	restarted = true;
	scene_put(&s, PIO, "0", 0);
	scene_put(&s, D "/por", "1", 0);
}

static struct config_item *no_set_alarm(void)
{
	return alarm_item(&s, "inputs", D "/sensed.BYTE", "latch.BYTE", "por", NULL,
	                  "latch.BYTE=0");
}

static struct config_item *no_equals(void)
{
	return alarm_item(&s, "inputs", D "/sensed.BYTE", "latch.BYTE", "por", "set_alarm",
	                  "latch.BYTE=0");
}

static struct config_item *refused(void)
{
	scene_put(&s, D "/set_alarm", "133333333", 0);
	scene_refuse_writes(&s, D "/set_alarm", -EACCES);
	return figure_3_3(&s);
}

static struct config_item *por_refused(void)
{
	scene_put(&s, D "/por", "0", 0);
	scene_refuse_writes(&s, D "/por", -EIO);
	return figure_3_3(&s);
}

static struct config_item *por_untouched(void)
{
	por_stuck = true;
	return figure_3_3(&s);
}

/* Makes the item so that its por cannot be cleared; mends that. */
static const struct cause {
	const char *name;
	struct config_item *(*make)(void);
	int err;
	unsigned inits; /* InitValue by the machine, before the command */
} causes[] = {
	{"SetAlarm is not defined", no_set_alarm, -EBADRQC, 0},
	{"SetAlarm has no '='", no_equals, -EBADRQC, 0},
	{"SetAlarm is refused", refused, -EACCES, 0},
	{"por is refused", por_refused, -EIO, 1},
	{"por is taken and stays set", por_untouched, -EUCLEAN, 1},
};
#define CAUSES (sizeof(causes) / sizeof(causes[0]))

static void again(void)
{
	scene_end(&s);
	setUp();
}

static void test_whatever_keeps_por_set_a_restart_is_written_and_told_once(void)
{
	for (unsigned i = 0; i < CAUSES; i++) {
		const struct cause *c = &causes[i];

		board(c->make());
		lose_power();
		scene_run(&s, 10 * SCENE_S);
		TEST_ASSERT_EQUAL_UINT_MESSAGE(1, count("W " PIO "=7\n"), c->name);
		TEST_ASSERT_EQUAL_UINT_MESSAGE(c->inits, count("W " PIO "=3\n"), c->name);
		TEST_ASSERT_EQUAL_STRING_MESSAGE("7", scene_at(&s, PIO), c->name);
		TEST_ASSERT_EQUAL_UINT_MESSAGE(1, journal(), c->name);
		TEST_ASSERT_EQUAL_UINT64_MESSAGE(1, scene_counter(&s, "power_on_resets"), c->name);
		TEST_ASSERT_TRUE_MESSAGE(unarmed(1), c->name);
		TEST_ASSERT_EQUAL_INT32_MESSAGE(c->err, scene_sample(&s, 1).err, c->name);
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_GOOD, scene_sample(&s, 1).quality, c->name);
		/*
		 * 1 + MaxRetries tries at once, then after 1, 2, 4 ... s; two readings each at most
		 */
		TEST_ASSERT_LESS_OR_EQUAL_UINT_MESSAGE(2 * (1 + s.config.max_retries + 4),
		                                       count("r " D "/por\n"), c->name);
		s.no_trace = true;
		scene_run(&s, 3600 * SCENE_S);
		TEST_ASSERT_EQUAL_UINT_MESSAGE(1, journal(), c->name);
		TEST_ASSERT_EQUAL_UINT64_MESSAGE(1, scene_counter(&s, "power_on_resets"), c->name);
		TEST_ASSERT_EQUAL_STRING_MESSAGE("7", scene_at(&s, PIO), c->name);
		TEST_ASSERT_TRUE_MESSAGE(unarmed(1), c->name);
		again();
	}
}

static void test_the_value_of_an_alarm_that_cannot_be_armed_is_read_as_an_input(void)
{
	board(no_set_alarm());
	lose_power();
	scene_run(&s, 2 * SCENE_S);
	scene_put(&s, D "/sensed.BYTE", "254", 0);
	scene_run(&s, 300 * SCENE_MS);
	TEST_ASSERT_EQUAL_INT64(254, scene_sample(&s, 1).value);
}

static void test_other_alarms_of_the_wire_go_on_at_full_speed(void)
{
	no_set_alarm();
	relays();
	alarm_item(&s, "others", E "/sensed.BYTE", "latch.BYTE", "", "", "latch.BYTE=0");
	scene_put(&s, E "/sensed.BYTE", "1", 0);
	scene_put(&s, E "/latch.BYTE", "0", 0);
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
	lose_power();
	scene_run(&s, 5 * SCENE_S);
	for (unsigned i = 1; i <= 20; i++) {
		scene_put(&s, E "/latch.BYTE", "4", 0);
		scene_run(&s, 200 * SCENE_MS);
		TEST_ASSERT_EQUAL_UINT32(i, scene_attrs(&s, 3).alarms);
	}
}

static void test_a_cause_that_heals_ends_it_and_the_next_por_is_another_restart(void)
{
	board(refused());
	lose_power();
	scene_run(&s, 30 * SCENE_S);
	TEST_ASSERT_TRUE(unarmed(1));
	scene_clear_trace(&s);
	scene_refuse_writes(&s, D "/set_alarm", 0);
	scene_run(&s, 60 * SCENE_S);
	TEST_ASSERT_FALSE(unarmed(1));
	TEST_ASSERT_EQUAL_INT32(0, scene_sample(&s, 1).err);
	TEST_ASSERT_EQUAL_STRING("0", scene_at(&s, D "/por"));
	TEST_ASSERT_EQUAL_UINT(0, count("W " PIO)); /* they have what is commanded */
	TEST_ASSERT_EQUAL_UINT(1, journal());
	lose_power();
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(2, journal());
	TEST_ASSERT_EQUAL_UINT(1, count("W " PIO "=3\n"));
	TEST_ASSERT_EQUAL_UINT(1, count("W " PIO "=7\n"));
}

static void test_a_por_that_somebody_else_cleared_ends_it_at_once(void)
{
	board(no_set_alarm());
	lose_power();
	scene_run(&s, 60 * SCENE_S);
	TEST_ASSERT_TRUE(unarmed(1));
	scene_put(&s, D "/por", "0", 0);
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_FALSE(unarmed(1));
	lose_power();
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(2, journal());
	TEST_ASSERT_EQUAL_STRING("7", scene_at(&s, PIO));
}

static void test_a_list_that_misses_the_device_is_no_restart(void)
{
	board(no_set_alarm());
	lose_power();
	scene_run(&s, 10 * SCENE_S);
	s.on_read = NULL;
	for (unsigned i = 0; i < 20; i++) {
		scene_put(&s, "/alarm", i % 2 ? "/alarm" D "\n" : "", 0);
		scene_run(&s, 100 * SCENE_MS);
	}
	TEST_ASSERT_EQUAL_UINT(1, journal());
	TEST_ASSERT_EQUAL_UINT(1, count("W " PIO));
}

static void test_a_device_that_was_lost_and_is_back_has_restarted_again(void)
{
	board(no_set_alarm());
	lose_power();
	scene_run(&s, 10 * SCENE_S);
	scene_tell(&s, 0, BUS_LOST, D);
	scene_run(&s, SCENE_S);
	scene_tell(&s, 0, BUS_FOUND, D);
	lose_power();
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(2, journal());
	/* when its por is seen, and before that if no list is due when it is found */
	TEST_ASSERT_GREATER_OR_EQUAL_UINT(2, count("W " PIO "=7\n"));
	TEST_ASSERT_LESS_OR_EQUAL_UINT(3, count("W " PIO "=7\n"));
	TEST_ASSERT_TRUE(unarmed(1));
}

/* How often the log has the text of late. */
static unsigned logged(FILE *out, const char *text)
{
	unsigned n = 0;
	char line[512];

	log_drain(s.log, fileno(out), 0);
	rewind(out);
	while (fgets(line, sizeof(line), out))
		n += strstr(line, text) != NULL;
	return n;
}

/* A plant that is switched on with owsd has restarted too, and that is no news. */
static void test_a_restart_before_owsd_began_is_for_the_verbose_log_alone(void)
{
	static const struct {
		enum log_level level;
		const char *por;
		unsigned before;
	} cases[] = {
		{LOG_LEVEL_NOTICE, "1", 0},
		{LOG_LEVEL_INFO, "1", 1},
		{LOG_LEVEL_INFO, "0", 0},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		FILE *out = tmpfile();
		struct log *log = log_create(cases[i].level);

		s.log = log;
		figure_3_3(&s);
		relays();
		alarm_device(&s, "0", cases[i].por);
		alarm_begin(&s);
		scene_run(&s, SCENE_S);
		TEST_ASSERT_EQUAL_UINT(*cases[i].por - '0', journal());
		TEST_ASSERT_EQUAL_STRING("0", scene_at(&s, D "/por"));
		TEST_ASSERT_EQUAL_UINT(cases[i].before, logged(out, "has restarted before owsd"));
		lose_power();
		scene_run(&s, SCENE_S);
		TEST_ASSERT_EQUAL_UINT(*cases[i].por - '0' + 1, journal());
		TEST_ASSERT_EQUAL_UINT(1, logged(out, "the device has restarted\n"));
		fclose(out);
		scene_end(&s);
		log_destroy(log);
		setUp();
	}
	board(no_set_alarm());
}

static void test_a_device_that_is_back_is_not_said_to_be_armed_while_it_is_not(void)
{
	FILE *out = tmpfile();
	struct log *log = log_create(LOG_LEVEL_NOTICE);

	s.log = log;
	board(refused());
	lose_power();
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, logged(out, "the alarm cannot be armed"));
	scene_tell(&s, 0, BUS_LOST, D);
	scene_run(&s, SCENE_S);
	scene_tell(&s, 0, BUS_FOUND, D);
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_TRUE(unarmed(1));
	TEST_ASSERT_EQUAL_UINT(0, logged(out, "armed again"));
	scene_refuse_writes(&s, D "/set_alarm", 0);
	scene_run(&s, 60 * SCENE_S);
	TEST_ASSERT_FALSE(unarmed(1));
	TEST_ASSERT_EQUAL_UINT(1, logged(out, "armed again"));
	fclose(out);
	scene_end(&s);
	log_destroy(log);
	setUp();
	board(no_set_alarm());
}

static void test_an_output_that_changed_by_itself_tells_of_another_restart(void)
{
	no_set_alarm();
	relays();
	s.items[1].readable = true;
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
	s.on_read = on_read;
	scene_set(&s, RELAYS, 7);
	scene_run(&s, 200 * SCENE_MS);
	lose_power();
	scene_run(&s, 20 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, journal());
	scene_put(&s, PIO, "0", 0);
	scene_run(&s, 61 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(2, journal());
	TEST_ASSERT_EQUAL_STRING("7", scene_at(&s, PIO));
	scene_run(&s, 600 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(2, journal());
}

/* Whatever is seen first: the output that differs, or the por that can be cleared at last. */
static void test_a_restart_while_por_stands_loses_no_command(void)
{
	for (int64_t after = 0; after < 40 * SCENE_S; after += 500 * SCENE_MS) {
		board(refused());
		s.items[1].read_back_ns = 10 * SCENE_S;
		lose_power();
		scene_run(&s, 300 * SCENE_MS + after);
		lose_power();
		scene_refuse_writes(&s, D "/set_alarm", 0);
		scene_run(&s, 120 * SCENE_S);
		TEST_ASSERT_FALSE(unarmed(1));
		TEST_ASSERT_EQUAL_STRING("7", scene_at(&s, PIO));
		again();
	}
	board(no_set_alarm());
}

static void test_an_output_that_never_is_what_was_written_tells_of_none(void)
{
	no_set_alarm();
	relays();
	s.items[1].readable = true;
	out_stuck = true;
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
	s.on_read = on_read;
	scene_set(&s, RELAYS, 7);
	scene_run(&s, 200 * SCENE_MS);
	lose_power();
	s.no_trace = true;
	scene_run(&s, 600 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, journal());
}

/* Two items of one device, which restarts; the second has this SetAlarm. */
static void restart_with_two_items(const char *set_alarm)
{
	no_set_alarm();
	relays();
	alarm_item(&s, "pin", D "/sensed.0", "latch.0", "por", set_alarm, "latch.0=0");
	scene_put(&s, D "/sensed.0", "1", 0);
	scene_put(&s, D "/latch.0", "0", 0);
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
	lose_power();
	scene_run(&s, 60 * SCENE_S);
}

static void test_several_items_of_one_device_tell_of_one_restart(void)
{
	restart_with_two_items(NULL);
	TEST_ASSERT_EQUAL_UINT(1, journal());
	TEST_ASSERT_TRUE(unarmed(1) && unarmed(3));
	TEST_ASSERT_EQUAL_UINT(1, count("W " PIO));
}

static void test_an_item_that_can_end_the_restart_does_so_for_the_others(void)
{
	restart_with_two_items("set_alarm=133333333");
	TEST_ASSERT_EQUAL_STRING("0", scene_at(&s, D "/por"));
	TEST_ASSERT_EQUAL_UINT(1, journal());
	TEST_ASSERT_FALSE(unarmed(1) || unarmed(3));
}

static void test_a_reload_keeps_the_restart_in_mind(void)
{
	board(no_set_alarm());
	lose_power();
	scene_run(&s, 10 * SCENE_S);
	scene_clear_trace(&s);
	scene_reload(&s, NULL);
	TEST_ASSERT_TRUE(unarmed(1));
	TEST_ASSERT_EQUAL_INT32(-EBADRQC, scene_sample(&s, 1).err);
	scene_run(&s, 60 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, journal());
	TEST_ASSERT_EQUAL_UINT(0, count("W " PIO));
}

static void test_a_por_that_somebody_cleared_before_a_reload_ends_it_after_that(void)
{
	board(no_set_alarm());
	lose_power();
	scene_run(&s, 60 * SCENE_S);
	TEST_ASSERT_TRUE(unarmed(1));
	scene_put(&s, D "/por", "0", 0);
	scene_reload(&s, NULL);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_FALSE(unarmed(1));
	lose_power();
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(2, journal());
	TEST_ASSERT_EQUAL_STRING("7", scene_at(&s, PIO));
}

static void mend(struct config *config)
{
	config->items[0].set_alarm = "set_alarm=133333333";
}

static void test_a_reload_that_mends_the_file_arms_it_at_once(void)
{
	board(no_set_alarm());
	lose_power();
	scene_run(&s, 60 * SCENE_S);
	scene_clear_trace(&s);
	scene_reload(&s, mend);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_FALSE(unarmed(1));
	TEST_ASSERT_EQUAL_STRING("0", scene_at(&s, D "/por"));
	TEST_ASSERT_EQUAL_UINT(1, journal());
	TEST_ASSERT_EQUAL_UINT(0, count("W " PIO));
}

static void test_a_target_that_comes_and_goes_is_no_restart(void)
{
	board(no_set_alarm());
	lose_power();
	for (unsigned i = 0; i < 10; i++) {
		scene_run(&s, 2 * SCENE_S);
		scene_down(&s, -ECONNRESET);
		scene_run(&s, SCENE_S);
		scene_up(&s);
	}
	TEST_ASSERT_EQUAL_UINT(1, journal());
	TEST_ASSERT_EQUAL_UINT(1, count("W " PIO));
}

/* --- SetAlarm at start ------------------------------------------------------------------------ */

static void test_a_set_alarm_that_is_refused_at_start_is_told_and_tried_again(void)
{
	struct config_item *item = refused();

	item->por_alarm = "";
	relays();
	alarm_device(&s, "0", "0");
	scene_put(&s, D "/set_alarm", "100000000", 0);
	alarm_begin(&s);
	scene_run(&s, 20 * SCENE_S);
	TEST_ASSERT_TRUE(unarmed(1));
	TEST_ASSERT_EQUAL_INT32(-EACCES, scene_sample(&s, 1).err);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	TEST_ASSERT_LESS_OR_EQUAL_UINT(8, count("W " D "/set_alarm"));
	scene_refuse_writes(&s, D "/set_alarm", 0);
	scene_run(&s, 60 * SCENE_S);
	TEST_ASSERT_FALSE(unarmed(1));
	TEST_ASSERT_EQUAL_STRING("133333333", scene_at(&s, D "/set_alarm"));
}

static int64_t tried_ns[16];
static unsigned tries;

static void on_done(struct scene_bus *bus, const struct bus_req *req)
{
	if (req->op == BUS_WRITE && strcmp(req->path, D "/set_alarm") == 0 && tries < 16)
		tried_ns[tries++] = bus->scene->now_ns;
}

/* Nothing else wakes the engine meanwhile: the list of alarms is looked at later. */
static void test_a_refused_set_alarm_is_tried_again_when_its_back_off_ends(void)
{
	struct config_item *item = refused();

	item->por_alarm = "";
	s.config.alarm_period_ns = 10 * SCENE_S;
	alarm_device(&s, "0", "0");
	scene_put(&s, D "/set_alarm", "100000000", 0);
	tries = 0;
	s.on_done = on_done;
	alarm_begin(&s);
	scene_run(&s, 20 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(8, tries);
	for (unsigned i = 0; i < 4; i++)
		TEST_ASSERT_INT64_WITHIN(20 * SCENE_MS, SCENE_S << i,
		                         tried_ns[i + 4] - tried_ns[i + 3]);
}

static void test_a_set_alarm_that_can_only_be_written_is_written(void)
{
	figure_3_3(&s);
	relays();
	alarm_device(&s, "0", "0");
	scene_put(&s, D "/set_alarm", NULL, -EACCES);
	s.on_read = alarm_on_read;
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_NOT_NULL(strstr(s.trace, "W " D "/set_alarm=133333333\n"));
}

static void test_a_failure_now_and_then_is_not_told(void)
{
	board(refused());
	lose_power();
	scene_run(&s, 60 * SCENE_MS);
	scene_refuse_writes(&s, D "/set_alarm", 0);
	scene_run(&s, 500 * SCENE_MS);
	TEST_ASSERT_FALSE(unarmed(1));
	TEST_ASSERT_EQUAL_STRING("0", scene_at(&s, D "/por"));
	TEST_ASSERT_EQUAL_UINT(1, journal());
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_whatever_keeps_por_set_a_restart_is_written_and_told_once);
	RUN_TEST(test_the_value_of_an_alarm_that_cannot_be_armed_is_read_as_an_input);
	RUN_TEST(test_other_alarms_of_the_wire_go_on_at_full_speed);
	RUN_TEST(test_a_cause_that_heals_ends_it_and_the_next_por_is_another_restart);
	RUN_TEST(test_a_por_that_somebody_else_cleared_ends_it_at_once);
	RUN_TEST(test_a_list_that_misses_the_device_is_no_restart);
	RUN_TEST(test_a_device_that_was_lost_and_is_back_has_restarted_again);
	RUN_TEST(test_a_restart_before_owsd_began_is_for_the_verbose_log_alone);
	RUN_TEST(test_a_device_that_is_back_is_not_said_to_be_armed_while_it_is_not);
	RUN_TEST(test_an_output_that_changed_by_itself_tells_of_another_restart);
	RUN_TEST(test_a_restart_while_por_stands_loses_no_command);
	RUN_TEST(test_an_output_that_never_is_what_was_written_tells_of_none);
	RUN_TEST(test_several_items_of_one_device_tell_of_one_restart);
	RUN_TEST(test_an_item_that_can_end_the_restart_does_so_for_the_others);
	RUN_TEST(test_a_reload_keeps_the_restart_in_mind);
	RUN_TEST(test_a_por_that_somebody_cleared_before_a_reload_ends_it_after_that);
	RUN_TEST(test_a_reload_that_mends_the_file_arms_it_at_once);
	RUN_TEST(test_a_target_that_comes_and_goes_is_no_restart);
	RUN_TEST(test_a_set_alarm_that_is_refused_at_start_is_told_and_tried_again);
	RUN_TEST(test_a_refused_set_alarm_is_tried_again_when_its_back_off_ends);
	RUN_TEST(test_a_set_alarm_that_can_only_be_written_is_written);
	RUN_TEST(test_a_failure_now_and_then_is_not_told);
	return UNITY_END();
}
