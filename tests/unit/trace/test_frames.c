/* SPDX-License-Identifier: MIT */
/* The exchanges with an owserver are recorded, and replayed without it. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "hal/sim/replay.h"
#include "hal/trace/trace.h"
#include "tests/unit/aid/folder.h"
#include "tests/unit/aid/owserver_scene.h"

static struct trace *trace;
static char *text, file[300];
static size_t len;
static FILE *out;

void setUp(void)
{
	owserver_begin();
	snprintf(file, sizeof(file), "%s", folder_file("it", "trace"));
	out = open_memstream(&text, &len);
	trace = trace_record(out, false, false);
	host.env.tap = &trace->tap;
}

void tearDown(void)
{
	owserver_end();
	free(text);
	text = NULL;
}

static void replay(void)
{
	char why[200] = "";
	FILE *made;

	one_bus_end();
	stop_peer();
	trace_end(trace);
	fclose(out);
	made = fopen(file, "w");
	fputs(text, made);
	fclose(made);
	host_init_real(&host);
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, replay_bus.create(file, &host.env, &bus, why, sizeof(why)),
	                              why);
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host_now(&host) + PATIENCE));
	TEST_ASSERT_EQUAL_UINT8_MESSAGE(BUS_UP, host.event[0].news, host.event[0].text);
}

static void test_a_replay_answers_as_the_server_did(void)
{
	char before[64];

	serve("");
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	snprintf(before, sizeof(before), "%.12s", (const char *)room);
	memset(room, 0, 64);
	replay();
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_STRING_LEN(before, (const char *)room, 12);
}

static void test_a_server_that_closed_closes_again(void)
{
	serve("x");
	int err = read_temperature();

	replay();
	TEST_ASSERT_EQUAL_INT(err, read_temperature());
}

static void test_a_path_that_was_not_asked_is_told(void)
{
	serve("");
	replay();
	TEST_ASSERT_LESS_THAN_INT(0, read_temperature());
	TEST_ASSERT_GREATER_THAN_UINT(0, host_events(&host, BUS_NOTE));
}

/* Its answer is in no file, as no replay could read that; nor in memory. */
static void test_a_server_that_never_ends_fills_no_file(void)
{
	static const uint8_t bytes[4096];

	trace->tap.sent(&trace->tap, &host.env, bytes, 1);
	for (size_t i = 0; i < TRACE_MOST / sizeof(bytes); i++)
		trace->tap.received(&trace->tap, &host.env, bytes, sizeof(bytes));
	trace->tap.sent(&trace->tap, &host.env, bytes, 1);
	TEST_ASSERT_EQUAL_size_t(0, trace->left);
	fflush(out);
	TEST_ASSERT_LESS_THAN_size_t(100, len);
	TEST_ASSERT_NOT_NULL(strstr(text, "# it is full"));
	trace_end(trace);
	fclose(out);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_replay_answers_as_the_server_did);
	RUN_TEST(test_a_server_that_closed_closes_again);
	RUN_TEST(test_a_path_that_was_not_asked_is_told);
	RUN_TEST(test_a_server_that_never_ends_fills_no_file);
	return UNITY_END();
}
