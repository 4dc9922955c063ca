/* SPDX-License-Identifier: MIT */
/* Requests of the alarm machine that are refused: told once, by key and property, and rarer. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/ground/text/log.h"
#include "tests/unit/aid/alarm_scene.h"

static struct scene s;
static FILE *out;

void setUp(void)
{
	out = tmpfile();
	scene_init(&s);
	s.log = log_create(LOG_LEVEL_NOTICE);
}
void tearDown(void)
{
	struct log *log = s.log;

	scene_end(&s);
	log_destroy(log);
	fclose(out);
}

static uint8_t shown(void)
{
	uint32_t flags = scene_attrs(&s, 1).flags;

	return flags & OWS_ATTR_ALARM_UNARMED
	               ? (uint8_t)(1 + ((flags & OWS_ATTR_ALARM_WHY) >> OWS_ATTR_ALARM_WHY_SHIFT))
	               : 0;
}

/* How many lines of the log have the text. */
static unsigned logged(const char *text)
{
	unsigned n = 0;
	char line[512];

	log_drain(s.log, fileno(out), 0);
	rewind(out);
	while (fgets(line, sizeof(line), out))
		n += strstr(line, text) != NULL;
	return n;
}

static unsigned asked(const char *request)
{
	unsigned n = 0;

	for (const char *at = s.trace; (at = strstr(at, request)) != NULL; at += strlen(request))
		n++;
	return n;
}

static unsigned failed_entries(const char *text)
{
	unsigned n = 0;

	for (uint32_t k = 0; k < s.image.header->alarm_head && k < OWS_JOURNAL; k++)
		n += s.image.alarms[k].event == OWS_ALARM_FAILED &&
		     strstr(s.image.alarms[k].text, text) != NULL;
	return n;
}

/* Each property that a visit asks for, mistyped; the mend is that the target has it after all. */
static const struct refusal {
	const char *latch, *por, *reset;
	const char *request, *property; /* in the trace; on the target */
	uint8_t unarmed;
	const char *line, *entry, *healed;
} refusals[] = {
	{"latch.BYT", "por", "latch.BYTE=0", "r " D "/latch.BYT\n", D "/latch.BYT",
         OWS_UNARMED_LATCH, "the alarm cannot be read: LatchAlarm: latch.BYT cannot be read: ",
         "cannot be read: LatchAlarm: ", "the alarm can be read again"},
	{"latch.BYTE", "pro", "latch.BYTE=0", "r " D "/pro\n", D "/pro", OWS_UNARMED_POR_READ,
         "the alarm cannot be read: PorAlarm: pro cannot be read: ", "cannot be read: PorAlarm: ",
         "the alarm can be read again"},
	{"latch.BYTE", "por", "latch.BYT=0", "W /alarm" D "/latch.BYT=0\n", D "/latch.BYT",
         OWS_UNARMED_RESET, "the alarm cannot be reset: ResetLatch: latch.BYT cannot be written: ",
         "cannot be reset: ResetLatch: ", "the alarm can be reset again"},
};
#define REFUSALS (sizeof(refusals) / sizeof(refusals[0]))

static void begin(const struct refusal *r)
{
	alarm_item(&s, "inputs", D "/sensed.BYTE", r->latch, r->por, "set_alarm=133333333",
	           r->reset);
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
	scene_put(&s, r->property, NULL, -ENOENT);
	scene_put(&s, D "/latch.BYTE", "8", 0);
	scene_clear_trace(&s);
}

static void again(void)
{
	tearDown();
	setUp();
}

static void test_a_refused_request_is_told_once_and_asked_ever_rarer(void)
{
	for (size_t k = 0; k < REFUSALS; k++) {
		const struct refusal *r = &refusals[k];

		begin(r);
		scene_run(&s, 16 * SCENE_S);
		TEST_ASSERT_EQUAL_UINT8_MESSAGE(r->unarmed, shown(), r->line);
		TEST_ASSERT_EQUAL_INT32_MESSAGE(-ENOENT, scene_sample(&s, 1).err, r->line);
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_GOOD, scene_sample(&s, 1).quality, r->line);
		TEST_ASSERT_EQUAL_UINT_MESSAGE(1, logged(r->line), r->line);
		TEST_ASSERT_EQUAL_UINT_MESSAGE(1, failed_entries(r->entry), r->line);
		/* 1 + MaxRetries in a row, then after 1, 2, 4, 8 s */
		TEST_ASSERT_GREATER_THAN_UINT_MESSAGE(s.config.max_retries + 2, asked(r->request),
		                                      r->line);
		TEST_ASSERT_LESS_OR_EQUAL_UINT_MESSAGE(s.config.max_retries + 5, asked(r->request),
		                                       r->line);
		s.no_trace = true;
		scene_run(&s, 3600 * SCENE_S);
		TEST_ASSERT_EQUAL_UINT_MESSAGE(1, logged(r->line), r->line);
		TEST_ASSERT_EQUAL_UINT_MESSAGE(1, failed_entries(""), r->line);
		again();
	}
}

static void test_its_value_is_read_as_an_input_meanwhile(void)
{
	begin(&refusals[2]);
	scene_run(&s, 5 * SCENE_S);
	scene_put(&s, D "/sensed.BYTE", "254", 0);
	scene_run(&s, 300 * SCENE_MS);
	TEST_ASSERT_EQUAL_INT64(254, scene_sample(&s, 1).value);
}

static void test_what_heals_is_told_and_the_alarm_comes(void)
{
	for (size_t k = 0; k < REFUSALS; k++) {
		const struct refusal *r = &refusals[k];

		begin(r);
		scene_run(&s, 5 * SCENE_S);
		TEST_ASSERT_EQUAL_UINT8_MESSAGE(r->unarmed, shown(), r->line);
		scene_put(&s, r->property, r->unarmed == OWS_UNARMED_POR_READ ? "0" : "8", 0);
		scene_run(&s, 61 * SCENE_S);
		TEST_ASSERT_EQUAL_UINT8_MESSAGE(0, shown(), r->line);
		TEST_ASSERT_EQUAL_INT32_MESSAGE(0, scene_sample(&s, 1).err, r->line);
		TEST_ASSERT_EQUAL_UINT_MESSAGE(1, logged(r->healed), r->line);
		TEST_ASSERT_GREATER_THAN_UINT_MESSAGE(0, scene_attrs(&s, 1).alarms, r->line);
		again();
	}
}

static void test_a_failure_that_is_over_within_the_retries_is_not_told(void)
{
	begin(&refusals[2]);
	scene_run(&s, SCENE_MS);
	scene_put(&s, D "/latch.BYT", "0", 0);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT8(0, shown());
	TEST_ASSERT_EQUAL_UINT(0, logged("the alarm can"));
}

static void test_a_device_that_is_back_is_asked_at_once(void)
{
	begin(&refusals[2]);
	scene_run(&s, 100 * SCENE_S);
	scene_tell(&s, 0, BUS_LOST, D);
	scene_run(&s, SCENE_S);
	scene_tell(&s, 0, BUS_FOUND, D);
	scene_put(&s, D "/latch.BYT", "0", 0);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT8(0, shown());
}

static void test_a_reload_keeps_what_is_shown(void)
{
	begin(&refusals[2]);
	scene_run(&s, 5 * SCENE_S);
	scene_reload(&s, NULL);
	TEST_ASSERT_EQUAL_UINT8(OWS_UNARMED_RESET, shown());
	TEST_ASSERT_EQUAL_INT32(-ENOENT, scene_sample(&s, 1).err);
	scene_run(&s, 60 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, logged("cannot be reset"));
}

static void test_an_alarm_of_a_device_is_in_the_log_without_v(void)
{
	figure_3_3(&s);
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
	scene_put(&s, D "/latch.BYTE", "8", 0);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, logged("inputs: alarm, latch.BYTE is 8"));
}

static void test_an_alarm_that_can_do_nothing_is_shown_and_its_value_read_as_an_input(void)
{
	static const struct {
		const char *latch, *por;
		enum ows_unarmed unarmed;
	} cases[] = {
		{"latch.BYTE", NULL, OWS_UNARMED_NO_POR},
		{NULL, NULL, OWS_UNARMED_NO_POR},
		{NULL, "por", OWS_UNARMED_NO_LATCH},
		{"", "", OWS_UNARMED_NO_LATCH},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		alarm_item(&s, "inputs", D "/sensed.BYTE", cases[i].latch, cases[i].por,
		           "set_alarm=133333333", "latch.BYTE=0");
		alarm_device(&s, "0", "0");
		alarm_begin(&s);
		TEST_ASSERT_EQUAL_UINT8(cases[i].unarmed, shown());
		scene_tell(&s, 0, BUS_LOST, D);
		scene_tell(&s, 0, BUS_FOUND, D);
		scene_run(&s, SCENE_S);
		TEST_ASSERT_EQUAL_UINT8(cases[i].unarmed, shown());
		scene_put(&s, D "/sensed.BYTE", "7", 0);
		scene_run(&s, SCENE_S);
		TEST_ASSERT_EQUAL_INT64(7, scene_sample(&s, 1).value);
		again();
	}
	figure_3_3(&s);
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
	TEST_ASSERT_EQUAL_UINT8(0, shown());
}

/* The reset writes something else. */
static void test_a_latch_that_nothing_clears_is_shown_until_it_is_cleared(void)
{
	struct config_item *item = alarm_item(&s, "inputs", D "/sensed.BYTE", "latch.BYTE", "por",
	                                      "set_alarm=133333333", "por=0");

	item->latch_stays = true;
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
	scene_put(&s, D "/latch.BYTE", "1", 0);
	scene_run(&s, 60 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT8(0, shown()); /* the first alarm */
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT8(OWS_UNARMED_STAYS, shown());
	TEST_ASSERT_EQUAL_UINT32(2, s.image.header->alarm_head); /* raised, and this */
	TEST_ASSERT_EQUAL_STRING("not cleared by ResetLatch", s.image.alarms[1].text);
	scene_clear_trace(&s);
	scene_run(&s, 60 * SCENE_S);
	TEST_ASSERT_LESS_THAN_UINT(10, asked("r " D "/latch.BYTE\n"));
	scene_put(&s, D "/latch.BYTE", "0", 0);
	scene_run(&s, 61 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT8(0, shown());
}

static void set_again(struct scene *scene, const char *path)
{
	if (strcmp(path, "/alarm") == 0)
		scene_put(scene, D "/latch.BYTE", "1", 0);
	alarm_on_read(scene, path);
}

/* A level or a busy input sets a latch again that the item does clear. */
static void test_a_latch_that_is_always_set_again_is_no_fault(void)
{
	figure_3_3(&s);
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
	s.on_read = set_again;
	scene_put(&s, D "/latch.BYTE", "1", 0);
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT8(0, shown());
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_refused_request_is_told_once_and_asked_ever_rarer);
	RUN_TEST(test_its_value_is_read_as_an_input_meanwhile);
	RUN_TEST(test_what_heals_is_told_and_the_alarm_comes);
	RUN_TEST(test_a_failure_that_is_over_within_the_retries_is_not_told);
	RUN_TEST(test_a_device_that_is_back_is_asked_at_once);
	RUN_TEST(test_a_reload_keeps_what_is_shown);
	RUN_TEST(test_an_alarm_of_a_device_is_in_the_log_without_v);
	RUN_TEST(test_an_alarm_that_can_do_nothing_is_shown_and_its_value_read_as_an_input);
	RUN_TEST(test_a_latch_that_nothing_clears_is_shown_until_it_is_cleared);
	RUN_TEST(test_a_latch_that_is_always_set_again_is_no_fault);
	return UNITY_END();
}
