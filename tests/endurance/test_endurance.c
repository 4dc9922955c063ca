/* SPDX-License-Identifier: MIT */
/*
 * A month of owsd's life with everything that can go wrong: the engine and the real backends on a
 * virtual clock, faults of all layers at random and over each other, and what must be true looked
 * at after each step of the engine. Twenty minutes at a time: faults for some of them, then quiet,
 * at whose end all is well again.
 *
 * The unit tests live through some hours of each world; `test_endurance 720 SEED` (make soak)
 * through a month, `test_endurance 720 SEED WORLD` in one of them; a number behind that is the
 * second from which on the engine's log is shown.
 */
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "unity.h"

#include "tests/endurance/happen.h"
#include "tests/endurance/program.h"
#include "tests/endurance/world.h"

#define EPISODE (1200 * FIELD_S)
#define FAULTS (400 * FIELD_S) /* of an episode */
#define LOOK (10 * FIELD_S)    /* it may be looked for a target that comes and goes by itself */
#define EVENTS 10

const struct world *world;
static unsigned hours;
static uint32_t seed = 1;
static bool chosen;
static const char *log_from;
static char history[EVENTS][100];
static uint64_t events;

void setUp(void)
{
}

void tearDown(void)
{
}

_Noreturn void world_fails(const char *what, const char *signal)
{
	printf("%s: %s%s%s at %.3f s, seed %u;", world->name, what, *signal ? ": " : "", signal,
	       (double)(station.now - station.start) / 1e9, seed);
	for (uint64_t i = events > EVENTS ? events - EVENTS : 0; i < events; i++)
		printf(" %s;", history[i % EVENTS]);
	printf("\nrepeat it: build/unit/test_endurance %u %u %s\n", hours, seed, world->name);
	if (chosen)
		printf("%u passed, 1 failed\n", (unsigned)Unity.NumberOfTests - 1);
	else
		printf("\n-----------------------\n1 Tests 1 Failures 0 Ignored\nFAIL\n");
	fflush(stdout);
	_Exit(1);
}

void world_note(const char *what)
{
	snprintf(history[events % EVENTS], sizeof(history[0]), "%.1f %s",
	         (double)(station.now - station.start) / 1e9, what);
	events++;
	if (station.log && station.now >= station.log_from_ns)
		printf("--- %s\n", what), fflush(stdout);
}

static void add_item(const char *name, enum item_kind kind, int device, const char *text)
{
	static const int64_t due_s[] = {
		[ITEM_TEMPERATURE] = 20,
		[ITEM_PINS] = 70,
		[ITEM_RELAYS] = 20,
		[ITEM_TEXT] = 200,
	};

	items[item_count++] = (struct item){name, kind, device, due_s[kind] * FIELD_S, text};
}

static void standard_devices(void)
{
	field_begin(station.now);
	add_item("boiler", ITEM_TEMPERATURE, 0, NULL);
	add_item("hot", ITEM_TEMPERATURE, 1, NULL);
	add_item("outside", ITEM_TEMPERATURE, 2, NULL);
	add_item("sensed", ITEM_PINS, 3, NULL);
	add_item("relays", ITEM_RELAYS, 3, NULL);
	add_item("type", ITEM_TEXT, 0, "DS18B20");
}

static void roaming_devices(void)
{
	standard_devices();
	field.device[1].wire = 1;
	field.device[2].wire = 2;
}

static void table_devices(void)
{
	field_begin(station.now);
	field.devices = 2;
	field.device[0] = (struct field_device){
		.id = "28.000000000001", .name = "room", .mean = 21.5};
	field.device[1] = (struct field_device){
		.id = "29.000000000002", .name = "board", .is_switch = true};
	add_item("room", ITEM_TEMPERATURE, 0, NULL);
	add_item("again", ITEM_TEMPERATURE, 0, NULL);
	add_item("relays", ITEM_RELAYS, 1, NULL);
}

/* clang-format off */
static const struct world worlds[] = {
	{ .name = "native", .targets = "%0", .parts = { &part_native }, .devices = standard_devices,
	  .hours = 6 },
	{ .name = "late", .targets = "%0", .parts = { &part_late }, .moody = true,
	  .devices = table_devices, .hours = 24 },
	{ .name = "server", .targets = "%0", .parts = { &part_server }, .devices = standard_devices,
	  .hours = 6 },
	{ .name = "sysfs", .targets = "%0", .parts = { &part_sysfs }, .devices = standard_devices,
	  .hours = 6 },
	{ .name = "netlink", .targets = "%0", .parts = { &part_netlink },
	  .devices = standard_devices, .hours = 6 },
	/* two ways to one wire, and two wires beside it; a thermometer goes from wire to wire */
	{ .name = "mixed", .targets = "%0 | %1, %2, %3",
	  .parts = { &part_server, &part_server, &part_netlink, &part_sysfs },
	  .wires = { 0, 0, 1, 2 }, .devices = roaming_devices, .hours = 6 },
};
/* clang-format on */
#define WORLDS (sizeof(worlds) / sizeof(worlds[0]))

/* --- A life ---------------------------------------------------------------------------------- */

static void live_until(int64_t t)
{
	while (station.now < t) {
		int64_t next = station.now + FIELD_S;

		program_runs();
		station_run(program_beats() && next < t ? next : t);
	}
}

static bool is_well(void)
{
	for (unsigned i = 0; i < item_count; i++) {
		uint32_t record = record_of(items[i].name);
		struct ows_sample s = sample_of(record);

		bool young = items[i].kind == ITEM_RELAYS ||
		             station.now - s.measured_ns < items[i].due_ns + 30 * FIELD_S;

		if (!ows_good(s.quality) || !young)
			return false;
	}
	return true;
}

static void all_is_well(void)
{
	for (unsigned i = 0; world->moody && i < 60 && !is_well(); i++)
		live_until(station.now + LOOK);
	if (!station_settled())
		world_fails("a bus that a reload ended is still there", "");
	invariants_well();
	accounts_well();
}

static void episode(void)
{
	int64_t begun = station.now, quiet = begun + FAULTS - ALONE;

	while (station.now < quiet) {
		happen();
		live_until(station.now + (1 + world_random(20000)) * FIELD_MS);
	}
	happen_over();
	live_until(station.now + EPISODE - FAULTS);
	all_is_well();
	happen_pin();
	live_until(station.now + 10 * FIELD_S);
	all_is_well();
}

static void begin(void)
{
	memset(&station, 0, sizeof(station));
	station.now = station.start = 1000 * FIELD_S;
	station.random = seed;
	station.stepped = invariants_step;
	if (log_from) {
		station.log = log_create(LOG_LEVEL_DEBUG);
		station.log_from_ns = station.start + strtoll(log_from, NULL, 10) * FIELD_S;
	}
	item_count = 0;
	events = 0;
	happen_begin();
	program_begin();
	world->devices();
	for (unsigned i = 0; i < STATION_PARTS && world->parts[i]; i++) {
		struct part *part = &station.part[i];

		part->ops = world->parts[i];
		part->wire = world->wires[i];
		part->ops->begin(part, part->target, sizeof(part->target));
		station.part_count++;
	}
	invariants_begin();
	station_begin(world_configuration(0));
}

static void live(const struct world *in)
{
	int64_t end;
	clock_t begun = clock();
	int input = fcntl(STDIN_FILENO, F_GETFD);
	char message[200];

	world = in;
	hours = chosen ? hours : world->hours;
	begin();
	end = station.start + hours * 3600 * FIELD_S;
	live_until(station.start + 300 * FIELD_S);
	all_is_well();
	while (station.now < end)
		episode();
	snprintf(message, sizeof(message),
	         "%s: %u hours, seed %u: %llu steps, %llu faults, %llu reloads, "
	         "%llu samples looked at, %llu good, %.1f s",
	         world->name, hours, seed, (unsigned long long)station.engine_steps,
	         (unsigned long long)happened(), (unsigned long long)station.reloads,
	         (unsigned long long)invariants_checked(), (unsigned long long)invariants_good(),
	         (double)(clock() - begun) / CLOCKS_PER_SEC);
	TEST_MESSAGE(message);
	/* not half of the usual, which a run of one hour in a quiet world has too */
	TEST_ASSERT_GREATER_THAN_UINT64(hours * 150, invariants_good());
	TEST_ASSERT_GREATER_THAN_UINT64(hours, happened());
	station_end();
	TEST_ASSERT_EQUAL_INT_MESSAGE(input, fcntl(STDIN_FILENO, F_GETFD),
	                              "descriptor 0 was closed");
}

static void test_native_bus_tells_nothing_false_and_gets_well(void)
{
	live(&worlds[0]);
}

static void test_late_bus_tells_nothing_false_and_gets_well(void)
{
	live(&worlds[1]);
}

static void test_owserver_bus_tells_nothing_false_and_gets_well(void)
{
	live(&worlds[2]);
}

static void test_kernel_files_tell_nothing_false_and_get_well(void)
{
	live(&worlds[3]);
}

static void test_kernel_netlink_tells_nothing_false_and_gets_well(void)
{
	live(&worlds[4]);
}

static void test_several_targets_tell_nothing_false_and_get_well(void)
{
	live(&worlds[5]);
}

static const struct {
	const char *name;
	void (*test)(void);
} tests[WORLDS] = {
	{"native", test_native_bus_tells_nothing_false_and_gets_well},
	{"late", test_late_bus_tells_nothing_false_and_gets_well},
	{"server", test_owserver_bus_tells_nothing_false_and_gets_well},
	{"sysfs", test_kernel_files_tell_nothing_false_and_get_well},
	{"netlink", test_kernel_netlink_tells_nothing_false_and_gets_well},
	{"mixed", test_several_targets_tell_nothing_false_and_get_well},
};

int main(int argc, char **argv)
{
	chosen = argc > 1;
	if (argc > 1)
		hours = (unsigned)strtoul(argv[1], NULL, 10);
	if (argc > 2)
		seed = (uint32_t)strtoul(argv[2], NULL, 10);
	log_from = argc > 4 ? argv[4] : NULL;
	UNITY_BEGIN();
	for (unsigned i = 0; i < WORLDS; i++)
		if (argc < 4 || strcmp(argv[3], tests[i].name) == 0)
			UnityDefaultTestRun(tests[i].test, tests[i].name, __LINE__);
	UNITY_END();
	if (argc > 1)
		printf("%u passed, %u failed\n",
		       (unsigned)(Unity.NumberOfTests - Unity.TestFailures),
		       (unsigned)Unity.TestFailures);
	return Unity.TestFailures || !Unity.NumberOfTests;
}
