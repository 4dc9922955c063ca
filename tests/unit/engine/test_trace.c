/* SPDX-License-Identifier: MIT */
/* The trace of requests: what it shows of each, that it is safe for a terminal, and bounded. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "src/daemon/engine/trace.h"
#include "src/ground/text/log.h"
#include "tests/unit/aid/scene.h"

#define T1 "/28.000000000001/temperature"
#define NAME "/28.000000000001/memory"
#define RELAY "/29.000000000003/PIO.0"

static struct scene s;
static FILE *out;
static char said[1 << 20];

void setUp(void)
{
	scene_init(&s);
	s.no_trace = true;
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

static void start(enum log_level level)
{
	s.log = log_create(level);
	scene_start(&s);
	scene_up(&s);
}

/* Let time pass, and keep what is logged. */
static void run(int64_t ns)
{
	for (int64_t end = s.now_ns + ns; s.now_ns < end;) {
		scene_run(&s, 20 * SCENE_MS);
		log_drain(s.log, fileno(out), 0);
	}
	ssize_t n = pread(fileno(out), said, sizeof(said) - 1, 0);
	TEST_ASSERT_TRUE(n >= 0);
	said[n] = '\0';
}

static unsigned count(const char *what)
{
	unsigned n = 0;

	for (const char *at = said; (at = strstr(at, what)) != NULL; at++)
		n++;
	return n;
}

static void has(const char *what)
{
	TEST_ASSERT_TRUE_MESSAGE(strstr(said, what), said);
}

static void test_a_request_is_shown_with_target_path_result_and_duration(void)
{
	scene_input(&s, "room", T1, OWS_DOUBLE)->fresh = true;
	scene_output(&s, "relay", RELAY, OWS_BOOL);
	scene_input(&s, "typo", "/28.000000000001/temprature", OWS_DOUBLE);
	scene_put(&s, T1, "        21.5", 0);
	scene_put(&s, RELAY, "0", 0);
	scene_put(&s, "/28.000000000001/temprature", NULL, -ENOENT);
	start(LOG_LEVEL_TRACE);
	scene_set(&s, 2, 1);
	run(SCENE_S);
	has(": read /uncached" T1 ": \"21.5\", 1.0 ms\n");
	has(": write " RELAY " \"1\": done, 1.0 ms\n");
	has(": read /28.000000000001/temprature: no such property, 1.0 ms\n");
	has("trace: ");
}

static void test_without_the_trace_no_request_is_shown(void)
{
	scene_input(&s, "room", T1, OWS_DOUBLE);
	scene_put(&s, T1, "21.5", 0);
	start(LOG_LEVEL_DEBUG);
	run(SCENE_S);
	TEST_ASSERT_TRUE(s.reads > 0);
	TEST_ASSERT_EQUAL_UINT(0, count("trace:"));
}

static void test_what_a_device_answers_steers_no_terminal_and_fills_no_line(void)
{
	char text[100];

	memset(text, 'a', sizeof(text) - 1);
	text[sizeof(text) - 1] = '\0';
	memcpy(text, "\033[2J\n\x9b\xe2\x80\xae", 9);
	scene_input(&s, "name", NAME, OWS_STRING);
	scene_put(&s, NAME, text, 0);
	start(LOG_LEVEL_TRACE);
	run(SCENE_S);
	has(": read " NAME ": \"?[2J?????aaaaaaaaaaaaaaaaaaaaaaa...\" (99 bytes), ");
	for (const char *c = said; *c; c++)
		TEST_ASSERT_TRUE((*c >= 0x20 && *c < 0x7f) || *c == '\n');
}

static void test_a_request_without_an_answer_is_shown_when_its_time_is_over(void)
{
	scene_input(&s, "room", T1, OWS_DOUBLE);
	scene_put(&s, T1, "21.5", 0);
	start(LOG_LEVEL_TRACE);
	s.bus[0].mute = true;
	run(30 * SCENE_S);
	has(": read " T1 ": no answer in time, ");
}

/* Answers come after a millisecond: up to a thousand a second. */
static void test_a_quick_target_does_not_flood_the_log(void)
{
	static char path[40][64], name[40][16];

	for (int i = 0; i < 40; i++) {
		snprintf(path[i], sizeof(path[i]), "/28.0000000000%02X/temperature", i);
		snprintf(name[i], sizeof(name[i]), "t%d", i);
		scene_input(&s, name[i], path[i], OWS_DOUBLE);
		scene_put(&s, path[i], i ? "21.5" : NULL, i ? 0 : -EIO);
	}
	start(LOG_LEVEL_TRACE);
	run(5 * SCENE_S);
	TEST_ASSERT_GREATER_THAN_UINT(1000, s.reads);
	TEST_ASSERT_LESS_OR_EQUAL_UINT(7 * TRACE_PER_WINDOW, count("\"21.5\""));
	TEST_ASSERT_GREATER_OR_EQUAL_UINT(4 * TRACE_PER_WINDOW, count("\"21.5\""));
	has("more requests in a second");
	/* what fails is shown though the others have used up their lines */
	has(path[0]);
	TEST_ASSERT_EQUAL_UINT64(0, log_dropped(s.log));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_request_is_shown_with_target_path_result_and_duration);
	RUN_TEST(test_without_the_trace_no_request_is_shown);
	RUN_TEST(test_what_a_device_answers_steers_no_terminal_and_fills_no_line);
	RUN_TEST(test_a_request_without_an_answer_is_shown_when_its_time_is_over);
	RUN_TEST(test_a_quick_target_does_not_flood_the_log);
	return UNITY_END();
}
