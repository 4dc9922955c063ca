/* SPDX-License-Identifier: MIT */
/* What goes over a wire is recorded, and replayed with other ids. */
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "hal/owfs/path.h"
#include "hal/sim/replay.h"
#include "hal/trace/anonymous.h"
#include "hal/trace/lines.h"
#include "hal/trace/trace.h"
#include "tests/unit/aid/folder.h"
#include "tests/unit/aid/native_scene.h"

#define SENSORS 5

static struct trouble trouble;
static struct trace *trace;
static struct sim_slave *sensor[SENSORS];
static char *text, file[300];
static size_t len;
static FILE *out;
static int (*wait_in_time)(void *ctx, int fd, short events, int64_t until_ns);

static const uint8_t mask[TRACE_MASK] = {0x5a, 0xff, 0x13, 0x81};

void setUp(void)
{
	native_begin();
	wire_init(&host, 1, 1);
	for (unsigned i = 0; i < SENSORS; i++) {
		sensor[i] = wire_add(0, "DS18B20", i * 41 + 1);
		wire_set(sensor[i], "temperature", 20 + i);
	}
	trouble = (struct trouble){.random = 1};
	trouble_none(&trouble);
	wire_net.trouble = &trouble; /* with it the link has triplets */
	snprintf(file, sizeof(file), "%s", folder_file("it", "trace"));
	out = open_memstream(&text, &len);
	trace = trace_record(out, false, false);
	host.env.tap = &trace->tap;
	start();
}

static void end_recording(void)
{
	if (!out)
		return;
	trace_end(trace);
	fclose(out);
	out = NULL;
}

void tearDown(void)
{
	native_end();
	end_recording();
	free(text);
	text = NULL;
}

/* The text in a file, and the bus on it. */
static void replay(void)
{
	char why[200] = "";
	FILE *made;

	one_bus_end();
	end_recording();
	made = fopen(file, "w");
	fputs(text, made);
	fclose(made);
	native_begin();
	host.env.tap = NULL;
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, replay_bus.create(file, &host.env, &bus, why, sizeof(why)),
	                              why);
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host.now + HOST_S));
	TEST_ASSERT_EQUAL_UINT8(BUS_UP, host.event[0].news);
}

/* Some waits end late, as others run. */
static int starved_wait(void *ctx, int fd, short events, int64_t until_ns)
{
	int ready = wait_in_time(ctx, fd, events, until_ns);
	struct host *starved = ctx;

	if (starved->waits % 16 == 0)
		starved->now += 60 * HOST_MS;
	return ready;
}

/* Lists all and reads each; what a person would look at. */
static void look(char values[SENSORS][16], char *list, size_t size)
{
	char *save, *line, copy[500];
	uint32_t id = ask(BUS_DIR, BUS_GUEST, true, "/", NULL);
	unsigned n = 0;

	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	data[id][answer_to(id)->len] = 0;
	snprintf(list, size, "%s", (char *)data[id]);
	snprintf(copy, sizeof(copy), "%s", list);
	for (line = strtok_r(copy, "\n", &save); line; line = strtok_r(NULL, "\n", &save)) {
		char path[100];

		if (strncmp(line, "/28.", 4) != 0)
			continue;
		snprintf(path, sizeof(path), "%s/temperature", line);
		id = ask(BUS_READ, BUS_GUEST, true, path, NULL);
		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		TEST_ASSERT_LESS_THAN_UINT(SENSORS, n);
		snprintf(values[n++], 16, "%.*s", (int)answer_to(id)->len, (char *)data[id]);
	}
	TEST_ASSERT_EQUAL_UINT(SENSORS, n);
}

static void test_a_replay_answers_as_recorded(void)
{
	char before[SENSORS][16], after[SENSORS][16], list[500], again[500];

	look(before, list, sizeof(list));
	replay();
	look(after, again, sizeof(again));
	TEST_ASSERT_EQUAL_STRING(list, again);
	for (unsigned i = 0; i < SENSORS; i++)
		TEST_ASSERT_EQUAL_STRING(before[i], after[i]);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(0, host_events(&host, BUS_NOTE), host.event[1].text);
}

static void test_a_starved_machine_replays_what_an_idle_one_does(void)
{
	char before[SENSORS][16], after[SENSORS][16], list[500], again[500];

	look(before, list, sizeof(list));
	replay();
	wait_in_time = host.env.wait;
	host.env.wait = starved_wait;
	look(after, again, sizeof(again));
	TEST_ASSERT_EQUAL_STRING(list, again);
	for (unsigned i = 0; i < SENSORS; i++)
		TEST_ASSERT_EQUAL_STRING(before[i], after[i]);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(0, host_events(&host, BUS_NOTE), host.event[1].text);
}

static void test_with_other_ids_it_is_the_same(void)
{
	char before[SENSORS][16], after[SENSORS][16], list[500], again[500];

	look(before, list, sizeof(list));
	one_bus_end();
	end_recording();
	trace_anonymous(text, mask);
	for (unsigned i = 0; i < SENSORS; i++) {
		char id[20];

		for (int k = 0; k < 6; k++)
			sprintf(id + 2 * k, "%02X", sensor[i]->rom[k + 1]);
		TEST_ASSERT_NULL_MESSAGE(strstr(text, id), id);
	}
	replay();
	look(after, again, sizeof(again));
	TEST_ASSERT_NOT_EQUAL_INT(0, strcmp(list, again));
	for (unsigned i = 0; i < SENSORS; i++)
		TEST_ASSERT_EQUAL_STRING(before[i], after[i]);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(0, host_events(&host, BUS_NOTE), host.event[1].text);
}

static void test_what_was_never_asked_has_no_answer_and_is_told(void)
{
	look((char[SENSORS][16]){0}, (char[500]){0}, 500);
	replay();
	TEST_ASSERT_LESS_THAN_INT(0, result(BUS_WRITE, of(sensor[0], "temphigh"), "30"));
	TEST_ASSERT_GREATER_THAN_UINT(0, host_events(&host, BUS_NOTE));
}

/* The CRC8 of each scratchpad is changed in the file. */
static void test_a_fault_in_a_recording_is_found(void)
{
	unsigned changed = 0;

	expect(true, of(sensor[1], "temperature"), "          21");
	one_bus_end();
	end_recording();
	for (char *at = text; (at = strstr(at, "BE 9 > ")); at += 7, changed++)
		at[7 + 17] = at[7 + 17] == '0' ? '1' : '0';
	TEST_ASSERT_GREATER_THAN_UINT(0, changed);
	replay();
	TEST_ASSERT_EQUAL_INT(-EBADMSG, result(BUS_READ, of(sensor[1], "temperature"), NULL));
}

static void test_an_error_of_the_link_is_recorded(void)
{
	expect(true, of(sensor[0], "temperature"), "          20");
	wire_net.fault = -EIO;
	wire_net.fault_count = 1;
	expect(true, of(sensor[0], "temperature"), "          20");
	one_bus_end();
	end_recording();
	TEST_ASSERT_NOT_NULL(strstr(text, " > !EIO\n"));
}

static void test_an_answer_of_the_bus_is_compared(void)
{
	uint32_t id = ask(BUS_READ, BUS_GUEST, true, of(sensor[2], "temperature"), NULL);
	struct bus_answer answer = *answer_to(id);

	trace->tap.answered(&trace->tap, &host.env, &req[id], &answer);
	replay();
	trace_replay(&trace, file, (char[100]){0}, 100);
	req[id].data = data[id];
	memcpy(data[id], "          22", 12);
	trace->tap.answered(&trace->tap, &host.env, &req[id], &answer);
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_NOTE));
	data[id][11] = '3';
	trace->tap.answered(&trace->tap, &host.env, &req[id], &answer);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_NOTE));
	TEST_ASSERT_NOT_NULL(strstr(host.event[host.events - 1].text, "22"));
	trace_end(trace);
}

static void test_a_recording_has_an_end(void)
{
	trace->left = 1000;
	look((char[SENSORS][16]){0}, (char[500]){0}, 500);
	one_bus_end();
	TEST_ASSERT_EQUAL_size_t(0, trace->left);
	end_recording();
	TEST_ASSERT_LESS_THAN_size_t(1000 + 100, len);
	TEST_ASSERT_NOT_NULL(strstr(text, "# it is full"));
}

static void refuse(const char *content, const char *word)
{
	char why[200] = "";
	FILE *made = fopen(file, "w");

	fputs(content, made);
	fclose(made);
	one_bus_end();
	TEST_ASSERT_EQUAL_INT(-EINVAL, replay_bus.create(file, &host.env, &bus, why, sizeof(why)));
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(why, word), why);
	bus = NULL;
}

static void test_what_is_no_recording_is_refused(void)
{
	refuse("", "no recording");
	refuse("hello\n", "no recording");
	refuse(TRACE_BEGIN, "no line");
	refuse(TRACE_BEGIN "0 0 bus: read \"/\" > 0\n", "no line");
}

static size_t parse(const char *text_of, uint8_t *bytes, size_t n)
{
	return trace_parse(text_of, bytes, n);
}

static void test_bytes_are_read_as_they_were_written(void)
{
	uint8_t bytes[256], back[300];

	for (int i = 0; i < 256; i++)
		bytes[i] = (uint8_t)i;
	for (enum trace_form form = TRACE_HEX; form <= TRACE_IDS; form++) {
		char *made;
		size_t size;
		FILE *to = open_memstream(&made, &size);

		trace_bytes(to, bytes, 99, form);
		trace_bytes(to, bytes + 99, sizeof(bytes) - 99, form);
		fclose(to);
		TEST_ASSERT_EQUAL_size_t(256, parse(made, back, sizeof(back)));
		TEST_ASSERT_EQUAL_MEMORY(bytes, back, 256);
		TEST_ASSERT_EQUAL_size_t(3, parse(made, back, 3));
		TEST_ASSERT_NULL(strchr(made, '>'));
		free(made);
	}
	TEST_ASSERT_EQUAL_size_t(0, parse("-", back, sizeof(back)));
	TEST_ASSERT_EQUAL_size_t(1, parse("12G", back, sizeof(back)));
	TEST_ASSERT_EQUAL_size_t(1, parse("\"a\n\"", back, sizeof(back)));
	TEST_ASSERT_EQUAL_size_t(2, parse("\"a\"1", back, sizeof(back)) +
	                                    parse("\"a", back, sizeof(back)));
}

static void test_there_are_no_more_links_than_a_bus_can_have(void)
{
	char why[100];
	FILE *made = fopen(file, "w");

	fputs(TRACE_BEGIN, made);
	for (int i = 0; i < 200; i++)
		fprintf(made, "0 0 %d: link > %d\n", i, i);
	fclose(made);
	end_recording();
	TEST_ASSERT_EQUAL_INT(0, trace_replay(&trace, file, why, sizeof(why)));
	TEST_ASSERT_EQUAL_UINT(TRACE_LINKS, trace_links(trace));
	trace_end(trace);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_replay_answers_as_recorded);
	RUN_TEST(test_a_starved_machine_replays_what_an_idle_one_does);
	RUN_TEST(test_with_other_ids_it_is_the_same);
	RUN_TEST(test_what_was_never_asked_has_no_answer_and_is_told);
	RUN_TEST(test_a_fault_in_a_recording_is_found);
	RUN_TEST(test_an_error_of_the_link_is_recorded);
	RUN_TEST(test_an_answer_of_the_bus_is_compared);
	RUN_TEST(test_a_recording_has_an_end);
	RUN_TEST(test_what_is_no_recording_is_refused);
	RUN_TEST(test_bytes_are_read_as_they_were_written);
	RUN_TEST(test_there_are_no_more_links_than_a_bus_can_have);
	return UNITY_END();
}
