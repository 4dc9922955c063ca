/* SPDX-License-Identifier: MIT */
/*
 * Reads a recording by libows, by the layout's header and by ows.py, each of which finds all
 * values.
 */
#include <errno.h>
#include <math.h>
#include <stdio.h>

#include "unity.h"

#include "src/memory/libows/handle.h"
#include "src/memory/shm/reader.h"
#include "tests/unit/aid/needs.h"
#include "tests/unit/aid/recorded_readers.h"
#include "tests/unit/aid/recording.h"

static const struct {
	const char *text;
	uint8_t quality;
} expected[COUNT + 1] = {
	[BOOL_] = {"1", OWS_Q_GOOD},
	[BYTE_] = {"255", OWS_Q_GOOD},
	[SHORT_] = {"-32768", OWS_Q_DEVICE},
	[LONG_] = {"-2147483648", OWS_Q_STALE},
	[WORD_] = {"65535", OWS_Q_HIGH},
	[DWORD_] = {"4294967295", OWS_Q_GOOD},
	[FLOAT_] = {"45.5", OWS_Q_GOOD},
	[DOUBLE_] = {"-21.0625", OWS_Q_GOOD},
	[LARGE_] = {"-9223372036854775808", OWS_Q_GOOD},
	[STRING_] = {LONG_TEXT, OWS_Q_GOOD},
	[EMPTY_] = {"", OWS_Q_GOOD},
	[NEVER_] = {"0", OWS_Q_INITIAL},
};

static void check_signal(struct ows *h, uint32_t record)
{
	const char *name = signals[record - 1].name;
	bool never = record == NEVER_;
	struct ows_sample sample;
	struct ows_info info;
	struct ows_value v;
	char text[TEXT_CAP + 1];
	int err = ows_get_text(h, ows_find(h, name), NOW_NS, &v, text, sizeof(text));

	TEST_ASSERT_EQUAL_MESSAGE(0, err, name);
	TEST_ASSERT_EQUAL_STRING_MESSAGE(expected[record].text, text, name);
	TEST_ASSERT_EQUAL_MESSAGE(signals[record - 1].type, v.type, name);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(never ? 0 : expected[record].quality, v.quality, name);
	TEST_ASSERT_EQUAL_INT64_MESSAGE(never ? 0 : NOW_NS - record * S, v.measured_ns, name);
	TEST_ASSERT_EQUAL_INT64_MESSAGE(never ? 0 : NOW_NS - record * S / 2, v.tried_ns, name);
	TEST_ASSERT_EQUAL_INT64_MESSAGE(never ? 10 * S : record * S, v.age_ns, name);
	TEST_ASSERT_EQUAL_MESSAGE(record == SHORT_ ? -EIO : 0, v.err, name);
	TEST_ASSERT_EQUAL_MESSAGE(never ? 0 : 100 + record, v.count, name);
	TEST_ASSERT_EQUAL_MESSAGE(0, v.applied, name); /* this handle commanded nothing */
	TEST_ASSERT_TRUE(reader_sample(map_record(&h->map, record), &sample));
	TEST_ASSERT_EQUAL_MESSAGE(never ? 0 : 200 + record, sample.confirmed, name);
	TEST_ASSERT_EQUAL_MESSAGE(never ? 0 : record % 4, v.detail, name);
	TEST_ASSERT_EQUAL_MESSAGE(never ? 0 : record % 2, v.target, name);
	TEST_ASSERT_EQUAL(0, ows_info(h, (int)record - 1, &info));
	TEST_ASSERT_EQUAL_STRING(name, info.name);
	TEST_ASSERT_EQUAL_STRING(signals[record - 1].path, info.path);
	TEST_ASSERT_EQUAL_STRING(signals[record - 1].identity ? signals[record - 1].identity
	                                                      : signals[record - 1].path,
	                         info.identity);
	TEST_ASSERT_EQUAL(signals[record - 1].per_factor, info.per_factor);
	TEST_ASSERT_EQUAL_INT64(signals[record - 1].stale_after_ns, info.stale_after_ns);
	TEST_ASSERT_EQUAL((signals[record - 1].flags & OWS_RECORD_OUTPUT) != 0, info.output);
	TEST_ASSERT_EQUAL((signals[record - 1].flags & OWS_RECORD_FRESH) != 0, info.fresh);
	TEST_ASSERT_EQUAL((signals[record - 1].flags & OWS_RECORD_ALARM) != 0, info.alarm);
}

static void check_meta(struct ows *h)
{
	struct ows_info info;

	TEST_ASSERT_EQUAL(0, ows_info(h, DOUBLE_ - 1, &info));
	TEST_ASSERT_EQUAL_STRING("\xc2\xb0"
	                         "C",
	                         info.unit);
	TEST_ASSERT_EQUAL_STRING("cold room 3", info.description);
	TEST_ASSERT_EQUAL_STRING("DS18B20", info.family);
	TEST_ASSERT_EQUAL_STRING("28.000000000001", info.device);
	TEST_ASSERT_EQUAL_STRING("2026-11-22", info.calibrated);
	TEST_ASSERT_EQUAL_STRING("0:0 100:99.5", info.points);
	TEST_ASSERT_EQUAL(2, info.decimals);
	TEST_ASSERT_EQUAL_DOUBLE(1.25, info.scale);
	TEST_ASSERT_EQUAL_DOUBLE(-0.5, info.offset);
	TEST_ASSERT_EQUAL_DOUBLE(-40, info.min);
	TEST_ASSERT_EQUAL_DOUBLE(60, info.max);
	TEST_ASSERT_EQUAL_DOUBLE(30, info.limit_hh);
	TEST_ASSERT_EQUAL_DOUBLE(20, info.limit_h);
	TEST_ASSERT_TRUE(isnan(info.limit_l));
	TEST_ASSERT_EQUAL_DOUBLE(-30, info.limit_ll);
	TEST_ASSERT_EQUAL_DOUBLE(10, info.filter_s);
	TEST_ASSERT_EQUAL_DOUBLE(0.25, info.deadband);
	TEST_ASSERT_EQUAL(0, ows_info(h, BYTE_ - 1, &info));
	TEST_ASSERT_EQUAL_STRING("", info.unit);
	TEST_ASSERT_EQUAL(-1, info.decimals);
	TEST_ASSERT_EQUAL_DOUBLE(1, info.scale);
	TEST_ASSERT_TRUE(isnan(info.max) && isnan(info.limit_hh));
}

/* By the layout alone, as a reader in another language does. */
static void check_entries(struct ows *h)
{
	const struct ows_map *map = &h->map;
	const struct ows_change_entry *change;
	struct ows_controller_entry controller;
	struct ows_origin_entry origin;
	struct ows_shelf_entry shelf;
	struct ows_journal_entry command;

	TEST_ASSERT_EQUAL(OWS_CONTROLLERS, map_count(map, OWS_AREA_CONTROLLERS));
	TEST_ASSERT_TRUE(reader_entry(map_entry(map, OWS_AREA_CONTROLLERS, 1), &controller,
	                              sizeof(controller)));
	TEST_ASSERT_EQUAL(777, controller.who.pid);
	TEST_ASSERT_EQUAL(12, controller.commands);
	TEST_ASSERT_EQUAL_HEX32(ows_check(&controller.flags, 28), controller.check);
	TEST_ASSERT_TRUE(
		reader_entry(map_entry(map, OWS_AREA_ORIGINS, BYTE_), &origin, sizeof(origin)));
	TEST_ASSERT_EQUAL(OWS_REASON_SET, origin.reason);
	TEST_ASSERT_EQUAL_STRING("hmi", origin.who.name);
	TEST_ASSERT_EQUAL_HEX32(ows_check(&origin.reason, 24), origin.check);
	TEST_ASSERT_TRUE(reader_entry(map_entry(map, OWS_AREA_SHELVES, 0), &shelf, sizeof(shelf)));
	TEST_ASSERT_EQUAL(DOUBLE_, shelf.record);
	TEST_ASSERT_EQUAL_STRING("sensor is being moved", shelf.why);
	TEST_ASSERT_EQUAL_HEX32(ows_check(&shelf.record, 44), shelf.check);
	TEST_ASSERT_EQUAL(1, map->image->command_head);
	TEST_ASSERT_TRUE(
		reader_entry(map_entry(map, OWS_AREA_COMMANDS, 0), &command, sizeof(command)));
	TEST_ASSERT_EQUAL_INT64(255, command.after);
	TEST_ASSERT_EQUAL_STRING("Jana", command.who.person);
	TEST_ASSERT_EQUAL_HEX32(ows_check(&command.record, 48), command.check);
	TEST_ASSERT_EQUAL(2, map->image->change_head);
	change = map_entry(map, OWS_AREA_CHANGES, 1);
	TEST_ASSERT_EQUAL(1, change->number);
	TEST_ASSERT_EQUAL(DOUBLE_, change->record);
}

static double attribute(struct ows *h, const char *name)
{
	struct ows_value v;

	TEST_ASSERT_EQUAL_MESSAGE(0, ows_get(h, ows_find(h, name), NOW_NS, &v), name);
	return v.number;
}

static void check_attributes(struct ows *h)
{
	TEST_ASSERT_EQUAL_DOUBLE(5000000002.0, attribute(h, "byte_TRANSACTIONS"));
	TEST_ASSERT_EQUAL_DOUBLE(0.5, attribute(h, "byte_Period"));
	TEST_ASSERT_EQUAL_DOUBLE(2, attribute(h, "byte_Age"));
	TEST_ASSERT_EQUAL_DOUBLE(200, attribute(h, "byte_AgeMax"));
	TEST_ASSERT_EQUAL_DOUBLE(2, attribute(h, "byte_PerCount"));
	TEST_ASSERT_EQUAL_DOUBLE(3, attribute(h, "byte_PerMax"));
	TEST_ASSERT_EQUAL_DOUBLE(10, attribute(h, "byte_PendCount"));
	TEST_ASSERT_EQUAL_DOUBLE(402, attribute(h, "byte_PendLast"));
	TEST_ASSERT_EQUAL_DOUBLE(10, attribute(h, "byte_PendMax"));
	TEST_ASSERT_EQUAL_DOUBLE(1, attribute(h, "byte_ReadEnable"));
	TEST_ASSERT_EQUAL_DOUBLE(0, attribute(h, "byte_WE"));
	TEST_ASSERT_EQUAL_DOUBLE(4294967295.0, attribute(h, "room.temperature_PerFactor"));
	TEST_ASSERT_EQUAL_DOUBLE(77, attribute(h, "_TRANSACTIONS"));
	TEST_ASSERT_EQUAL_DOUBLE(3, attribute(h, "_RECONNECTS"));
}

static void check_alarms(struct ows *h)
{
	struct ows_alarm_state state;
	struct ows_alarm alarm;

	TEST_ASSERT_EQUAL(2, ows_alarm_count(h));
	TEST_ASSERT_EQUAL(0, ows_alarm(h, 0, &alarm));
	TEST_ASSERT_EQUAL(NEVER_ - 1, alarm.signal);
	TEST_ASSERT_EQUAL_INT64(1001 * S, alarm.occurred_ns);
	TEST_ASSERT_EQUAL_STRING("1,0,0,1", alarm.text);
	TEST_ASSERT_EQUAL(OWS_ALARM_DEVICE, alarm.kind);
	TEST_ASSERT_EQUAL(OWS_ALARM_RAISED, alarm.event);
	TEST_ASSERT_TRUE(alarm.has_before && alarm.has_after);
	TEST_ASSERT_EQUAL_INT64(1, alarm.after_integer);
	TEST_ASSERT_EQUAL(0, ows_alarm(h, 1, &alarm));
	TEST_ASSERT_EQUAL_DOUBLE(30.5, alarm.before);
	TEST_ASSERT_FALSE(alarm.has_after);
	TEST_ASSERT_EQUAL(OWS_ALARM_ACKNOWLEDGED, alarm.event);
	TEST_ASSERT_EQUAL(-ENOENT, ows_alarm(h, 2, &alarm));
	TEST_ASSERT_EQUAL(0, ows_alarm_state(h, ows_find(h, "room.temperature"), &state));
	TEST_ASSERT_TRUE(state.limits && !state.stands);
	TEST_ASSERT_EQUAL(OWS_LIMIT_RETURNED, state.limit_state);
	TEST_ASSERT_EQUAL(OWS_ALARM_HH, state.limit_kind);
	TEST_ASSERT_EQUAL_INT64(2003 * S, state.until_ns);
	TEST_ASSERT_EQUAL_STRING("sensor is being moved", state.why);
	TEST_ASSERT_EQUAL_STRING("Jana", state.who.person);
}

static void check_commands(struct ows *h)
{
	struct ows_commanded command;

	TEST_ASSERT_EQUAL(1, ows_command_count(h));
	TEST_ASSERT_EQUAL(0, ows_command_entry(h, 0, &command));
	TEST_ASSERT_EQUAL(BYTE_ - 1, command.signal);
	TEST_ASSERT_EQUAL_INT64(255, command.integer);
	TEST_ASSERT_EQUAL_INT64(1002 * S, command.taken_ns);
	TEST_ASSERT_EQUAL(OWS_REASON_SET, command.reason);
	TEST_ASSERT_EQUAL(4, command.more);
	TEST_ASSERT_EQUAL(1000, command.who.uid);
	TEST_ASSERT_EQUAL_STRING("hmi", command.who.name);
	TEST_ASSERT_EQUAL(-ENOENT, ows_command_entry(h, 1, &command));
}

static void check_targets(struct ows *h)
{
	struct ows_target target;
	struct ows_counter counter;

	TEST_ASSERT_EQUAL(0, ows_target(h, 0, &target));
	TEST_ASSERT_EQUAL_STRING("localhost:4304", target.name);
	TEST_ASSERT_EQUAL(2, target.state);
	TEST_ASSERT_EQUAL(4, target.reconnects);
	TEST_ASSERT_EQUAL(0, ows_target(h, 1, &target));
	TEST_ASSERT_EQUAL_STRING("i2c:/dev/i2c-1", target.name);
	TEST_ASSERT_EQUAL(0, target.group);
	TEST_ASSERT_EQUAL(6, target.moves);
	TEST_ASSERT_EQUAL(-ENOENT, ows_target(h, 2, &target));
	TEST_ASSERT_EQUAL(0, ows_counter(h, 1, &counter));
	TEST_ASSERT_EQUAL_STRING("crc_errors", counter.name);
	TEST_ASSERT_EQUAL(1, counter.target);
	TEST_ASSERT_EQUAL_UINT64(0x123456789a, counter.value);
	TEST_ASSERT_EQUAL_STRING("owserver:/run/owsd/OWS.sock", ows_served(h));
}

void check_all(struct ows *h)
{
	TEST_ASSERT_EQUAL(COUNT, ows_count(h));
	for (uint32_t record = 1; record <= COUNT; record++)
		check_signal(h, record);
	check_attributes(h);
	check_alarms(h);
	check_commands(h);
	check_meta(h);
	check_entries(h);
	check_targets(h);
}

static const char *output_until_its_end(FILE *pipe)
{
	static char output[8192];
	size_t n;

	TEST_ASSERT_NOT_NULL(pipe);
	n = fread(output, 1, sizeof(output) - 1, pipe);
	output[n] = '\0';
	TEST_ASSERT_EQUAL_MESSAGE(0, pclose(pipe), output);
	return output;
}

const char *output_of(const char *command)
{
	return output_until_its_end(popen(command, "r"));
}

const char *python(const char *code)
{
	return output_until_its_end(needs_python3_run(code, instance));
}
