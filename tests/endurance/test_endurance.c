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
#include "invariants.h"

#include "unity.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define EPISODE (1200 * FIELD_S)
#define FAULTS  (400 * FIELD_S) /* of an episode */
#define ALONE   (100 * FIELD_S) /* the longest fault */
#define LOOK    (10 * FIELD_S)  /* it may be looked for a target that comes and goes by itself */
#define EVENTS  10
#define BEAT_MS 3000
#define CLIENT  3

struct world {
	const char *name;
	const char *targets; /* %0 is the first part's target; comma and bar as in the file */
	const struct part_ops *parts[STATION_PARTS];
	unsigned wires[STATION_PARTS];
	bool moody;          /* a target of it is never quiet for long */
	void (*devices)(void);
	unsigned hours;      /* among the unit tests */
};

static const struct world *world;
static unsigned hours;
static uint32_t seed = 1;
static bool chosen;
static const char *log_from;
static char history[EVENTS][100];
static uint64_t events, faults;
static unsigned variant;
static bool beats;
static uint32_t beat, stamp = 1001;

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

static void note(const char *what)
{
	snprintf(history[events % EVENTS], sizeof(history[0]), "%.1f %s",
	         (double)(station.now - station.start) / 1e9, what);
	events++;
	if (station.log && station.now >= station.log_from_ns)
		printf("--- %s\n", what), fflush(stdout);
}

/* --- Its configuration ----------------------------------------------------------------------- */

enum { WITHOUT_SECOND = 1, OTHER_PERIOD = 2, SLOWER = 4, WITHOUT_LAST_TARGET = 8, VARIANTS = 16 };

static size_t put_item(char *rio, size_t size, const struct item *item)
{
	const char *id = item->device < 0 ? "" : field.device[item->device].id;

	switch (item->kind) {
	case ITEM_TEMPERATURE:
		return (size_t)snprintf(
			rio, size,
			"  Item { Name \"%s\" Path \"/%s/temperature%s\" Type double IO input\n"
			"         Uncached on PerFactor %d }\n",
			item->name, id, world->moody ? "" : "12", variant & SLOWER ? 2 : 1);
	case ITEM_PINS:
		return (size_t)snprintf(
			rio, size,
			"  Item { Name \"%s\" Path \"/%s/sensed.BYTE\" Type byte IO input\n"
			"         Alarm on\n"
			"         LatchAlarm \"latch.BYTE\" PorAlarm \"por\"\n"
			"         SetAlarm \"set_alarm=133333333\" ResetLatch \"latch.BYTE=0\" }\n",
			item->name, id);
	case ITEM_RELAYS:
		return (size_t)snprintf(
			rio, size,
			"  Item { Name \"%s\" Path \"/%s/PIO.BYTE\" Type byte IO output\n"
			"         InitValue \"0\" SafeValue \"0\" }\n",
			item->name, id);
	case ITEM_TEXT:
		return (size_t)snprintf(rio, size,
		                        "  Item { Name \"%s\" Path \"/%s/type\" Type string\n"
		                        "         IO input PerFactor 20 }\n",
		                        item->name, id);
	}
	return 0;
}

static size_t put_targets(char *rio, size_t size)
{
	size_t n = 0, len = strlen(world->targets);

	if (variant & WITHOUT_LAST_TARGET && strchr(world->targets, ','))
		len = (size_t)(strrchr(world->targets, ',') - world->targets);
	for (size_t i = 0; i < len; i++) {
		if (world->targets[i] == '%')
			n += (size_t)snprintf(rio + n, size - n, "%s",
			                      station.part[world->targets[++i] - '0'].target);
		else
			rio[n++] = world->targets[i];
	}
	rio[n] = '\0';
	return n;
}

static const char *configuration(void)
{
	static char rio[8192];
	size_t n = 0;

	n += (size_t)snprintf(rio, sizeof(rio), "OwsDrv {\n  TargetName \"");
	n += put_targets(rio + n, sizeof(rio) - n);
	n += (size_t)snprintf(rio + n, sizeof(rio) - n, "\"\n  Period %d\n  AlarmPeriod 2\n",
	                      variant & OTHER_PERIOD ? 7 : 10);
	for (unsigned i = 0; i < item_count; i++)
		if (i != 1 || !(variant & WITHOUT_SECOND))
			n += put_item(rio + n, sizeof(rio) - n, &items[i]);
	snprintf(rio + n, sizeof(rio) - n, "}\n");
	return rio;
}

static void add_item(const char *name, enum item_kind kind, int device, const char *text)
{
	static const int64_t due_s[] = {
		[ITEM_TEMPERATURE] = 20, [ITEM_PINS] = 70, [ITEM_RELAYS] = 20, [ITEM_TEXT] = 200,
	};

	items[item_count++] =
		(struct item){ name, kind, device, due_s[kind] * FIELD_S, text };
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
	field.device[0] =
		(struct field_device){ .id = "28.000000000001", .name = "room", .mean = 21.5 };
	field.device[1] = (struct field_device){ .id = "29.000000000002", .name = "board",
		                                 .is_switch = true };
	add_item("room", ITEM_TEMPERATURE, 0, NULL);
	add_item("again", ITEM_TEMPERATURE, 0, NULL);
	add_item("relays", ITEM_RELAYS, 1, NULL);
}

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
#define WORLDS (sizeof(worlds) / sizeof(worlds[0]))

/* --- A control program ----------------------------------------------------------------------- */

static struct ows_command_slot *slot_of(uint32_t record)
{
	const struct commands *c = &station.now_serving->commands;

	return (struct ows_command_slot *)(void *)(c->base + c->slot_off) + record;
}

static void mark_dirty(uint32_t record)
{
	const struct commands *c = &station.now_serving->commands;
	uint32_t *dirty = (uint32_t *)(void *)(c->base + c->dirty_off);

	dirty[record / 32] |= 1u << record % 32;
	station_ring();
}

static struct ows_client *client(void)
{
	const struct commands *c = &station.now_serving->commands;

	return (struct ows_client *)(void *)(c->base + c->client_off) + CLIENT;
}

static void set_relays(unsigned value, bool beating)
{
	uint32_t record = record_of("relays");
	struct ows_command_slot *slot = slot_of(record);

	slot->value = value;
	slot->client = beating ? CLIENT + 1 : 0;
	slot->stamp = stamp += 2; /* odd: none that was scribbled */
	mark_dirty(record);
	commanded = (int)value;
}

/* Each second. It dies with the heartbeat, and what it set goes to SafeValue. */
static void program_runs(void)
{
	if (!beats)
		return;
	*client() = (struct ows_client){ .pid = 42, .beat = ++beat, .period_ms = 1000 * BEAT_MS };
}

static void program_dies(void)
{
	note("the program dies");
	set_relays(1 + world_random(15), true);
	beats = true;
	program_runs();
	station_run(station.now + (int64_t)world_random(20) * FIELD_S);
	beats = false;
	*client() = (struct ows_client){ .pid = 42, .beat = beat, .period_ms = BEAT_MS };
	station_run(station.now + FIELD_S);
	commanded = 0; /* SafeValue */
}

/* Everything that a program may write, and no program should. */
static void scribble(void)
{
	const struct commands *c = &station.now_serving->commands;
	uint32_t n = station.now_serving->config->item_count, header = 256 / 4;

	note("scribbles");
	for (unsigned i = 0; i < 20; i++) {
		uint32_t record = 1 + world_random(n), word = world_random(8);
		uint32_t *slot = (uint32_t *)(void *)slot_of(record);

		/* a table believes what it is told, also of a temperature */
		if (world->moody && record != record_of("relays") && word == 5)
			continue;
		slot[word] = world_random(2) ? world_random(4) : world_random(1 << 24) << 8;
		mark_dirty(record);
	}
	for (unsigned i = 0; i < 4; i++)
		((uint32_t *)(void *)c->base)[world_random(header)] = world_random(1 << 24);
	((uint32_t *)(void *)(c->base + c->client_off))[world_random(OWS_CLIENTS * 8)] =
		world_random(1 << 24);
	((uint32_t *)(void *)(c->base + c->dirty_off))[0] = world_random(1 << 24);
	station_ring();
	station_run(station.now + (1 + world_random(30)) * FIELD_S);
	/* and sets it right */
	memset(c->base + c->client_off, 0, OWS_CLIENTS * sizeof(struct ows_client));
	for (uint32_t record = 1; record <= n; record++) {
		struct ows_command_slot *slot = slot_of(record);
		bool output = record == record_of("relays");

		slot->read_enable = output ? 1 : 2;
		slot->write_enable = output ? 2 : 1;
		mark_dirty(record);
	}
	set_relays(world_random(16), false);
	station_run(station.now + FIELD_S);
	invariants_excuse();
}

/* --- What happens ---------------------------------------------------------------------------- */

static void reload(unsigned next)
{
	variant = next;
	station_reload(configuration());
	accounts_reloaded();
	invariants_excuse();
}

static unsigned any_variant(void)
{
	return world_random(VARIANTS);
}

static void storm(void)
{
	unsigned n = 5 + world_random(25);

	note("a storm of reloads");
	while (n--) {
		reload(any_variant());
		station_run(station.now + (1 + world_random(100)) * FIELD_MS);
	}
}

static void come_back(void *ctx)
{
	struct field_device *d = ctx;

	d->away = false;
	for (unsigned i = 0; i < station.part_count; i++)
		if (station.part[i].wire == d->wire)
			station.part[i].ops->plug(&station.part[i], (unsigned)(d - field.device),
			                          true);
}

static void go_away(unsigned device, int64_t ns)
{
	struct field_device *d = &field.device[device];

	if (d->away)
		return;
	note(d->name);
	d->away = true;
	for (unsigned i = 0; i < station.part_count; i++)
		if (station.part[i].wire == d->wire)
			station.part[i].ops->plug(&station.part[i], device, false);
	world_after(ns, come_back, d);
}

static void each_part(void (*act)(struct part *part))
{
	for (unsigned i = 0; i < station.part_count; i++)
		act(&station.part[i]);
}

static void tell_pins(struct part *part)
{
	part->ops->pins(part);
}

static void gap(void)
{
	int64_t ns = (1 + world_random(3600)) * FIELD_S;

	note("suspend");
	station_gap(ns);
	invariants_excuse();
}

static void happen(void)
{
	int64_t ns = (1 + world_random(ALONE / FIELD_S)) * FIELD_S;
	struct part *part = &station.part[world_random(station.part_count)];
	unsigned device = world_random(field.devices), what = world_random(100);

	faults++;
	if (what < 45) {
		note(part->ops->fault(part, ns));
	} else if (what < 55) {
		go_away(device, ns);
	} else if (what < 60) {
		note("a restart");
		if (!field.device[device].away && field.device[device].wire == part->wire)
			part->ops->restart(part, device);
	} else if (what < 70) {
		field_set_pins(field_pins() ^ 1u << world_random(4), station.now);
		each_part(tell_pins);
	} else if (what < 80) {
		set_relays(world_random(16), false);
	} else if (what < 84) {
		program_dies();
	} else if (what < 89) {
		scribble();
	} else if (what < 96) {
		note("a reload");
		reload(any_variant());
	} else if (what < 98) {
		storm();
	} else {
		gap();
	}
}

/* --- A life ---------------------------------------------------------------------------------- */

static void live_until(int64_t t)
{
	while (station.now < t) {
		int64_t next = station.now + FIELD_S;

		program_runs();
		station_run(beats && next < t ? next : t);
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
	if (variant)
		reload(0);
	live_until(station.now + EPISODE - FAULTS);
	all_is_well();
	field_set_pins(field_pins() ^ 1u << world_random(4), station.now);
	each_part(tell_pins);
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
	variant = 0;
	item_count = 0;
	events = faults = 0;
	beats = false;
	world->devices();
	for (unsigned i = 0; i < STATION_PARTS && world->parts[i]; i++) {
		struct part *part = &station.part[i];

		part->ops = world->parts[i];
		part->wire = world->wires[i];
		part->ops->begin(part, part->target, sizeof(part->target));
		station.part_count++;
	}
	invariants_begin();
	station_begin(configuration());
}

static void live(const struct world *in)
{
	int64_t end;
	clock_t begun = clock();
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
	         (unsigned long long)faults, (unsigned long long)station.reloads,
	         (unsigned long long)invariants_checked(), (unsigned long long)invariants_good(),
	         (double)(clock() - begun) / CLOCKS_PER_SEC);
	TEST_MESSAGE(message);
	TEST_ASSERT_GREATER_THAN_UINT64(hours * 300, invariants_good());
	TEST_ASSERT_GREATER_THAN_UINT64(hours * 5, faults);
	station_end();
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
	{ "native", test_native_bus_tells_nothing_false_and_gets_well },
	{ "late", test_late_bus_tells_nothing_false_and_gets_well },
	{ "server", test_owserver_bus_tells_nothing_false_and_gets_well },
	{ "sysfs", test_kernel_files_tell_nothing_false_and_get_well },
	{ "netlink", test_kernel_netlink_tells_nothing_false_and_gets_well },
	{ "mixed", test_several_targets_tell_nothing_false_and_get_well },
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
