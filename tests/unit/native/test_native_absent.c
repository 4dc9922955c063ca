/* SPDX-License-Identifier: MIT */
/*
 * Devices that are nowhere, asked for by their bare ids behind couplers: they do not make readings
 * of others old, nor the start long, and are found when they come.
 */
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/one_bus.h"

#define THERMOMETERS 10
#define KEYS 8
#define ALL (THERMOMETERS + KEYS)
#define RUN_NS (40 * HOST_S)
#define AGAIN_NS (100 * HOST_MS) /* between an answer and the next request: a period of owsd */

/* Of what is nowhere. */
#define KEY "keys"
#define THERMOMETER "thermometers"

static char scenario[4096];
static char paths[ALL][64];
static uint8_t texts[ALL][64];
static struct bus_req requests[ALL];
static int64_t due[ALL]; /* the next request; 0: one is under way */
static int64_t zero, began, patience_ns;
static int64_t found_ns; /* of what came last */

static struct {
	int64_t measured_ns[THERMOMETERS]; /* of the newest value; 0: there is none */
	int64_t oldest_ns;                 /* the greatest age of a value that was seen */
	int64_t start_ns;                  /* until each had a value */
	unsigned values;
	unsigned absent[KEYS]; /* answers */
	int64_t first_ns[KEYS];
	int64_t asked_ns[KEYS], longest_ns; /* until the answer "no such device" */
} seen;

void setUp(void)
{
}

void tearDown(void)
{
	one_bus_end();
}

static void __attribute__((format(printf, 1, 2))) line(const char *format, ...)
{
	size_t used = strlen(scenario);
	va_list args;

	va_start(args, format);
	int n = vsnprintf(scenario + used, sizeof(scenario) - used, format, args);
	va_end(args);
	TEST_ASSERT_LESS_THAN_size_t(sizeof(scenario) - used, (size_t)n);
}

struct row {
	const char *touch, *absent;
	unsigned khz, couplers;
};

/* Ten thermometers: some on the wire, the others on the branches of the couplers in turn. */
static void plant(const struct row *row, const char *more)
{
	scenario[0] = '\0';
	line("i2c speed %u\nchip DS2482-100 0x18\n", row->khz);
	for (unsigned i = 0; i < row->couplers; i++)
		line("DS2409 1F.00000000000%X as c%u\n", i + 1, i);
	for (unsigned i = 0; i < THERMOMETERS; i++) {
		unsigned branch = i % (2 * row->couplers + 1);

		if (branch)
			line("branch c%u %s\n", (branch - 1) / 2, branch % 2 ? "main" : "aux");
		else
			line("channel 0\n");
		line("DS18B20 28.0000000000B%X\n", i);
		snprintf(paths[i], sizeof(paths[i]), "/28.0000000000B%X/temperature", i);
	}
	for (unsigned i = 0; i < KEYS; i++) {
		bool key = strcmp(row->absent, KEY) == 0;

		snprintf(paths[THERMOMETERS + i], sizeof(paths[0]), "/%s.00000000001%X/%s",
		         key ? "01" : "28", i, key ? "present" : "temperature");
	}
	line("%s", more);
}

static void begin(const char *touch)
{
	char why[80] = "";

	memset(&seen, 0, sizeof(seen));
	patience_ns = 20 * HOST_S;
	simulate(scenario);
	zero = host.now;
	TEST_ASSERT_EQUAL_INT(0, bus_option(bus, "Touch", touch, why, sizeof(why)));
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host.now + HOST_S));
	TEST_ASSERT_EQUAL_UINT8(BUS_UP, host.event[0].news);
	began = host.now;
	for (unsigned i = 0; i < ALL; i++)
		due[i] = host.now;
}

static void submit(unsigned i)
{
	requests[i] = (struct bus_req){
		.id = i,
		.op = BUS_READ,
		.prio = BUS_INPUT,
		.fresh = true,
		.path = paths[i],
		.data = texts[i],
		.len = sizeof(texts[i]),
		.deadline_ns = host.now + (i < THERMOMETERS ? 20 * HOST_S : patience_ns)};
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &requests[i]));
	due[i] = 0;
	if (i >= THERMOMETERS)
		seen.asked_ns[i - THERMOMETERS] = host.now;
}

static void take_key(unsigned i, const struct bus_answer *answer)
{
	int64_t took = host.now - seen.asked_ns[i];

	/* The first one may have come. */
	TEST_ASSERT_EQUAL_INT(i || answer->err ? -ENODEV : 0, answer->err);
	if (!answer->err) {
		if (texts[THERMOMETERS][0] == '1' && !found_ns)
			found_ns = host.now;
		return;
	}
	if (!seen.absent[i]++)
		seen.first_ns[i] = host.now - began;
	seen.longest_ns = took > seen.longest_ns ? took : seen.longest_ns;
}

static void take_answers(void)
{
	for (unsigned k = 0; k < host.answers; k++) {
		const struct bus_answer *answer = &host.answer[k];
		unsigned i = answer->id;

		due[i] = host.now + AGAIN_NS;
		if (i >= THERMOMETERS) {
			take_key(i - THERMOMETERS, answer);
			continue;
		}
		TEST_ASSERT_EQUAL_INT(0, answer->err);
		seen.measured_ns[i] = answer->measured_ns;
		seen.values++;
	}
	if (host_events(&host, BUS_FOUND) && !found_ns)
		found_ns = host.now;
	host.answers = host.events = 0;
}

static void look_at_ages(void)
{
	bool all = true;

	for (unsigned i = 0; i < THERMOMETERS; i++) {
		int64_t age = host.now - seen.measured_ns[i];

		all &= seen.measured_ns[i] != 0;
		if (seen.start_ns && age > seen.oldest_ns)
			seen.oldest_ns = age;
	}
	if (all && !seen.start_ns)
		seen.start_ns = host.now - began;
}

/* The thermometers, and so many keys that are nowhere, are asked for all the time. */
static void run(unsigned keys, int64_t until_ns)
{
	while (host.now < until_ns) {
		for (unsigned i = 0; i < THERMOMETERS + keys; i++)
			if (due[i] && due[i] <= host.now)
				submit(i);
		int64_t next = bus_step(bus, host.now);
		next = next > until_ns ? until_ns : next;
		for (unsigned i = 0; i < THERMOMETERS + keys; i++)
			next = due[i] > host.now && due[i] < next ? due[i] : next;
		if (!host.answers && next > host.now)
			host.now = next;
		look_at_ages();
		take_answers();
	}
}

static const struct row rows[] = {
	{"on", KEY, 400, 4},          {"on", KEY, 100, 4},          {"off", KEY, 400, 4},
	{"off", KEY, 400, 2},         {"on", THERMOMETER, 400, 4},  {"on", THERMOMETER, 100, 4},
	{"off", THERMOMETER, 400, 2}, {"off", THERMOMETER, 400, 0},
};

static void test_what_is_nowhere_makes_no_reading_old(void)
{
	for (unsigned k = 0; k < sizeof(rows) / sizeof(rows[0]); k++) {
		const struct row *row = &rows[k];
		char text[160];

		plant(row, "");
		begin(row->touch);
		run(0, began + RUN_NS);
		int64_t alone = seen.oldest_ns;
		one_bus_end();
		begin(row->touch);
		run(KEYS, began + RUN_NS);
		snprintf(text, sizeof(text),
		         "%u kHz, %u couplers, touch %s, %s: start %u ms, oldest %u, alone %u",
		         row->khz, row->couplers, row->touch, row->absent,
		         (unsigned)(seen.start_ns / HOST_MS), (unsigned)(seen.oldest_ns / HOST_MS),
		         (unsigned)(alone / HOST_MS));
		TEST_ASSERT_LESS_THAN_INT64_MESSAGE(2 * alone, seen.oldest_ns, text);
		TEST_ASSERT_GREATER_THAN_INT64_MESSAGE(0, seen.start_ns, text);
		TEST_ASSERT_LESS_THAN_INT64_MESSAGE(10 * HOST_S, seen.start_ns, text);
		for (unsigned i = 0; i < KEYS; i++)
			TEST_ASSERT_GREATER_THAN_UINT_MESSAGE(2, seen.absent[i], text);
		one_bus_end();
	}
}

/* Whoever waits no longer than this gets the answer that the searches before have given. */
static void test_a_short_deadline_is_no_other_error(void)
{
	plant(&rows[4], "");
	begin("off");
	run(0, began + 10 * HOST_S);
	patience_ns = 100 * HOST_MS;
	run(KEYS, began + 30 * HOST_S);
	for (unsigned i = 0; i < KEYS; i++)
		TEST_ASSERT_GREATER_THAN_UINT(50, seen.absent[i]);
	TEST_ASSERT_LESS_OR_EQUAL_INT64(300 * HOST_MS, seen.longest_ns);
}

/*
 * How long until the device x, which comes every 20 s, is found, at most; keys that are nowhere are
 * asked for meanwhile.
 */
static int64_t longest_until_found(const struct row *row, unsigned keys, const char *x)
{
	int64_t longest = 0;
	char text[200];

	snprintf(text, sizeof(text),
	         "%s as x unplugged\nat 20s every 20007ms plug x\n"
	         "at 30s every 20007ms unplug x\n",
	         x);
	plant(row, text);
	begin(row->touch);
	for (unsigned i = 0; i < 12; i++) {
		int64_t at = zero + 20 * HOST_S + 20007 * i * HOST_MS;

		run(keys, at - 2 * HOST_S);
		found_ns = 0;
		run(keys, at + 9 * HOST_S);
		TEST_ASSERT_NOT_EQUAL_INT64_MESSAGE(0, found_ns, x);
		TEST_ASSERT_GREATER_THAN_INT64_MESSAGE(at, found_ns, x);
		longest = found_ns - at > longest ? found_ns - at : longest;
	}
	one_bus_end();
	return longest;
}

/* As docs/native.md has it, "Keys": those that are nowhere add nothing. */
static void test_a_key_that_touches_is_found_as_soon_as_ever(void)
{
	static const struct row wire = {"on", KEY, 100, 0}, branches = {"on", KEY, 400, 2};
	static const char on_wire[] = "DS2401 01.0000000000FF",
			  on_branch[] = "branch c1 main\nDS2401 01.0000000000FF";

	int64_t alone = longest_until_found(&wire, 0, on_wire);
	TEST_ASSERT_LESS_THAN_INT64(130 * HOST_MS, alone);
	TEST_ASSERT_LESS_OR_EQUAL_INT64(alone, longest_until_found(&wire, KEYS, on_wire));
	alone = longest_until_found(&branches, 0, on_branch);
	TEST_ASSERT_LESS_THAN_INT64(400 * HOST_MS, alone);
	TEST_ASSERT_LESS_OR_EQUAL_INT64(alone + 50 * HOST_MS,
	                                longest_until_found(&branches, KEYS, on_branch));
}

static void test_who_is_asked_for_is_found_in_turn(void)
{
	static const struct row row = {"off", KEY, 400, 4};

	TEST_ASSERT_LESS_THAN_INT64(
		6 * HOST_S,
		longest_until_found(&row, KEYS, "branch c1 main\nDS2401 01.000000000010"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_what_is_nowhere_makes_no_reading_old);
	RUN_TEST(test_a_short_deadline_is_no_other_error);
	RUN_TEST(test_a_key_that_touches_is_found_as_soon_as_ever);
	RUN_TEST(test_who_is_asked_for_is_found_in_turn);
	return UNITY_END();
}
