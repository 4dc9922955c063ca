/* SPDX-License-Identifier: MIT */
/*
 * Segments recorded from an earlier release, read by today's libows, ows.py and owsctl, value by
 * value; and what readers do with the layouts of releases to come. Runs python3 and owsctl in the
 * directory of the sources. `test_recorded record` writes the recording again: only for a new file.
 */
#include "src/libows/ows.h"
#include "src/shm/commands.h"
#include "src/shm/image.h"
#include "src/signal/value.h"
#include "unity.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define RECORDING "tests/unit/data/segments-0.1.0."
#define S         INT64_C(1000000000)
#define START_NS  (1000 * S)
#define NOW_NS    (1010 * S)
#define TEXT_CAP  64
#define SIZE_MAX_ 65536
#define LONG_TEXT "K\xc3\xbchlraum 3, Verdampfer \xc2\xb0""C: text of sixty-four bytes, all used!"

enum { BOOL_ = 1, BYTE_, SHORT_, LONG_, WORD_, DWORD_, FLOAT_, DOUBLE_, LARGE_, STRING_, EMPTY_, NEVER_ };
#define COUNT NEVER_

static const struct image_signal signals[COUNT] = {
	{"bool", "/29.000000000001/PIO.0", OWS_BOOL, OWS_RECORD_OUTPUT, 0, 1, 11, 0, true, true, 1, 0},
	{"byte", "/29.000000000001/PIO.BYTE", OWS_BYTE, OWS_RECORD_OUTPUT, 0, 2, 12, 0, false, true,
	 0, 255},
	{"short", "/20.000000000001/volt.A", OWS_SHORT, 0, 0, 3, 13, 5 * S},
	{"long", "/1D.000000000001/a", OWS_LONG, OWS_RECORD_FRESH, 0, 4, 14, 2 * S},
	{"word", "/1D.000000000001/b", OWS_WORD, 0, 0, 5, 15, 0},
	{"dword", "/1D.000000000001/counters.A", OWS_DWORD, 0, 0, 6, 16, 0},
	{"float", "/26.000000000001/humidity", OWS_FLOAT, 0, 0, 7, 17, 0},
	{"room.temperature", "/28.000000000001/temperature", OWS_DOUBLE, 0, 0, 4294967295u, 18, 20 * S},
	{"large", "/null", OWS_LARGE, OWS_RECORD_OUTPUT, 0, 9, 19, 0},
	{"label", "/23.000000000001/memory", OWS_STRING, OWS_RECORD_OUTPUT, TEXT_CAP, 10, 20, 0},
	{"empty", "/23.000000000002/memory", OWS_STRING, 0, TEXT_CAP, 11, 21, 0},
	{"never", "/29.000000000001/alarm", OWS_BOOL, OWS_RECORD_ALARM, 0, 12, 22, 0},
};
static const char *const targets[] = {"localhost:4304", "i2c:/dev/i2c-1"};
static const uint32_t groups[] = {0, 0};
static const struct image_counter counters[] = {{"alarms", UINT32_MAX}, {"crc_errors", 1}};

static char instance[40], here[128];
static _Alignas(64) char image_memory[SIZE_MAX_], command_memory[SIZE_MAX_];
static struct image image;
static struct commands commands;

/* --- The recording made ----------------------------------------------------------------------- */

static struct image_plan image_plan(void)
{
	return (struct image_plan){
		.signals = signals,
		.signal_count = COUNT,
		.targets = targets,
		.target_count = 2,
		.groups = groups,
		.counters = counters,
		.counter_count = 2,
		.served = "owserver:/run/owsd/OWS.sock",
		.generation = 7,
		.start_id = 0x12345679,
		.pid = 4321,
		.start_ns = START_NS,
		.start_wall_ns = 1700000000 * S,
		.period_ns = S / 10,
	};
}

/* The fields of record i are functions of i, so that each is another. */
static void put(uint32_t record, int64_t value, uint8_t quality, const char *text)
{
	struct ows_sample sample = {
		.value = value,
		.measured_ns = NOW_NS - record * S,
		.tried_ns = NOW_NS - record * S / 2,
		.err = record == SHORT_ ? -EIO : 0,
		.quality = quality,
		.detail = (uint8_t)(record % 4),
		.target = (uint8_t)(record % 2),
		.flags = record == BYTE_ ? OWS_SAMPLE_PENDING : 0,
		.count = 100 + record,
		.applied = 200 + record,
		.len = text ? (uint32_t)strlen(text) : 0,
	};
	struct ows_attrs attrs = {
		.transactions = 5000000000u + record,
		.update_ns = record * S / 4,
		.age_max_ns = record * 100 * S,
		.commanded = value,
		.per_base = 1000 - record,
		.per_max = 3,
		.pend_base = 990,
		.pend_last = 400 + record,
		.pend_max = 5,
		.alarms = record == NEVER_ ? 2 : 0,
		.flags = OWS_ATTR_READ_ENABLE | (record == BYTE_ ? OWS_ATTR_IN_WORK | OWS_ATTR_COMMANDED : 0) |
		         (record == DOUBLE_ ? OWS_ATTR_LIMITS : 0) |
		         (record == NEVER_ ? OWS_ATTR_ALARM_STANDS : 0),
		.limit_state = record == DOUBLE_ ? OWS_LIMIT_RETURNED : 0,
		.limit_condition = record == DOUBLE_ ? OWS_ALARM_HH : 0,
	};

	image_publish(&image, record, &sample, &attrs, text);
}

static void put_all(void)
{
	put(BOOL_, 1, OWS_Q_GOOD, NULL);
	put(BYTE_, 255, OWS_Q_GOOD, NULL);
	put(SHORT_, -32768, OWS_Q_DEVICE, NULL);
	put(LONG_, INT32_MIN, OWS_Q_GOOD, NULL);
	put(WORD_, 65535, OWS_Q_HIGH, NULL);
	put(DWORD_, UINT32_MAX, OWS_Q_GOOD, NULL);
	put(FLOAT_, value_of_double(45.5), OWS_Q_GOOD, NULL);
	put(DOUBLE_, value_of_double(-21.0625), OWS_Q_GOOD, NULL);
	put(LARGE_, INT64_MIN, OWS_Q_GOOD, NULL);
	put(STRING_, 0, OWS_Q_GOOD, LONG_TEXT);
	put(EMPTY_, 0, OWS_Q_GOOD, "");
}

static void put_alarms(void)
{
	struct ows_alarm_entry device = {
		.record = NEVER_,
		.occurred_ns = 1001 * S,
		.before = 0,
		.kind = OWS_ALARM_DEVICE,
		.event = OWS_ALARM_RAISED,
		.quality = OWS_Q_GOOD,
		.flags = OWS_ALARM_BEFORE,
		.latch = "1,0,0,1",
	};
	struct ows_alarm_entry limit = {
		.record = DOUBLE_,
		.occurred_ns = 1002 * S,
		.before = value_of_double(30.5),
		.kind = OWS_ALARM_HH,
		.event = OWS_ALARM_ACKNOWLEDGED,
		.quality = OWS_Q_GOOD,
		.flags = OWS_ALARM_BEFORE,
	};

	image_alarm_after(&image, image_alarm(&image, &device), 1);
	image_alarm(&image, &limit);
}

static void make_image(void)
{
	struct image_plan plan = image_plan();
	struct ows_sample beat = {.value = 3, .measured_ns = NOW_NS, .quality = OWS_Q_GOOD};
	struct ows_attrs driver = {.per_base = 1000, .transactions = 77};

	TEST_ASSERT_LESS_THAN(sizeof(image_memory), image_size(&plan));
	memset(image_memory, 0, sizeof(image_memory));
	image_build(&plan, image_memory, &image);
	for (int i = 0; i < 2; i++) {
		image_publish(&image, 0, &beat, &driver, NULL);
		put_all();
	}
	put(DOUBLE_, value_of_double(-21.0625), OWS_Q_GOOD, NULL);
	put_alarms();
	image_target(&image, 0, 2, 4);
	image_target(&image, 1, 1, 5);
	image_moves(&image, 1, 6);
	image_counter(&image, 0, 2);
	image_counter(&image, 1, UINT64_C(0x123456789a));
	image_state(&image, OWS_STATE_LIVE);
}

static void make_commands(void)
{
	struct command_signal command[COUNT];
	struct command_plan plan = {
		.signals = command,
		.signal_count = COUNT,
		.text_cap = TEXT_CAP,
		.generation = 7,
		.start_id = 0x12345679,
		.pid = 4321,
	};

	for (uint32_t i = 0; i < COUNT; i++)
		command[i] = (struct command_signal){signals[i].name, signals[i].path, signals[i].type};
	TEST_ASSERT_LESS_THAN(sizeof(command_memory), commands_size(&plan));
	memset(command_memory, 0, sizeof(command_memory));
	commands_forget(&commands);
	TEST_ASSERT_EQUAL(0, commands_build(&plan, command_memory, &commands));
	commands_put(&commands, BYTE_, 254, NULL, 0);
	commands_stamp(&commands, BYTE_, 202);
	commands_put(&commands, LARGE_, INT64_MIN + 1, NULL, 0);
	commands_stamp(&commands, LARGE_, 209);
	commands_put(&commands, STRING_, 0, "north", 5);
	commands_stamp(&commands, STRING_, 210);
	commands_state(&commands, OWS_STATE_LIVE);
}

/* Rows of 32 bytes that are not all zero, with their offsets; the size stands first. */
static void write_recording(const char *kind, const char *memory, uint32_t size)
{
	static const char zero[32];
	char path[96];
	FILE *file;

	snprintf(path, sizeof(path), RECORDING "%s", kind);
	file = fopen(path, "w");
	TEST_ASSERT_NOT_NULL(file);
	fprintf(file, "size %x\n", size);
	for (uint32_t at = 0; at < size; at += 32) {
		if (memcmp(memory + at, zero, 32) == 0)
			continue;
		fprintf(file, "%05x:", at);
		for (int i = 0; i < 32; i++)
			fprintf(file, " %02x", (unsigned char)memory[at + (uint32_t)i]);
		fprintf(file, "\n");
	}
	fclose(file);
}

static void record(void)
{
	make_image();
	make_commands();
	write_recording("image", image_memory, image.header->size);
	write_recording("command", command_memory, commands.size);
}

/* --- The recording shown ---------------------------------------------------------------------- */

static uint32_t read_recording(const char *kind, char *memory)
{
	char path[96], line[160];
	uint32_t size;
	FILE *file;

	snprintf(path, sizeof(path), RECORDING "%s", kind);
	file = fopen(path, "r");
	TEST_ASSERT_NOT_NULL_MESSAGE(file, path);
	TEST_ASSERT_NOT_NULL(fgets(line, sizeof(line), file));
	TEST_ASSERT_EQUAL(1, sscanf(line, "size %x", &size));
	TEST_ASSERT_LESS_THAN(SIZE_MAX_, size);
	memset(memory, 0, SIZE_MAX_);
	while (fgets(line, sizeof(line), file)) {
		char *rest;
		unsigned long at = strtoul(line, &rest, 16);

		TEST_ASSERT_TRUE(at + 32 <= size && *rest == ':');
		rest++;
		for (int i = 0; i < 32; i++)
			memory[at + (unsigned)i] = (char)strtoul(rest, &rest, 16);
	}
	fclose(file);
	return size;
}

static const char *file_of(const char *kind)
{
	static char path[96];

	snprintf(path, sizeof(path), "/dev/shm/owsd.%s.%s", instance, kind);
	return path;
}

static void show(const char *kind, const char *memory, uint32_t size)
{
	FILE *file = fopen(file_of(kind), "w");

	TEST_ASSERT_NOT_NULL(file);
	TEST_ASSERT_EQUAL(size, fwrite(memory, 1, size, file));
	TEST_ASSERT_EQUAL(0, fclose(file));
}

void setUp(void)
{
	snprintf(instance, sizeof(instance), "recorded.%ld", (long)getpid());
	show("image", image_memory, read_recording("image", image_memory));
	show("command", command_memory, read_recording("command", command_memory));
}

void tearDown(void)
{
	unlink(file_of("image"));
	unlink(file_of("command"));
	commands_forget(&commands);
}

/* --- What is in it ---------------------------------------------------------------------------- */

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
	TEST_ASSERT_EQUAL_MESSAGE(never ? 0 : 200 + record, v.applied, name);
	TEST_ASSERT_EQUAL_MESSAGE(never ? 0 : record % 4, v.detail, name);
	TEST_ASSERT_EQUAL_MESSAGE(never ? 0 : record % 2, v.target, name);
	TEST_ASSERT_EQUAL(0, ows_info(h, (int)record - 1, &info));
	TEST_ASSERT_EQUAL_STRING(name, info.name);
	TEST_ASSERT_EQUAL_STRING(signals[record - 1].path, info.path);
	TEST_ASSERT_EQUAL(signals[record - 1].per_factor, info.per_factor);
	TEST_ASSERT_EQUAL_INT64(signals[record - 1].stale_after_ns, info.stale_after_ns);
	TEST_ASSERT_EQUAL((signals[record - 1].flags & OWS_RECORD_OUTPUT) != 0, info.output);
	TEST_ASSERT_EQUAL((signals[record - 1].flags & OWS_RECORD_FRESH) != 0, info.fresh);
	TEST_ASSERT_EQUAL((signals[record - 1].flags & OWS_RECORD_ALARM) != 0, info.alarm);
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
	TEST_ASSERT_EQUAL_STRING("1,0,0,1", alarm.latch);
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

static void check_all(struct ows *h)
{
	TEST_ASSERT_EQUAL(COUNT, ows_count(h));
	for (uint32_t record = 1; record <= COUNT; record++)
		check_signal(h, record);
	check_attributes(h);
	check_alarms(h);
	check_targets(h);
}

static void test_libows_reads_a_recorded_image(void)
{
	struct ows_daemon daemon;
	struct ows *h;

	TEST_ASSERT_EQUAL(0, ows_open(instance, OWS_READ, &h));
	check_all(h);
	TEST_ASSERT_EQUAL(0, ows_daemon(h, NOW_NS, &daemon));
	TEST_ASSERT_EQUAL(4321, daemon.pid);
	TEST_ASSERT_EQUAL(7, daemon.generation);
	TEST_ASSERT_EQUAL_INT64(START_NS, daemon.start_ns);
	TEST_ASSERT_EQUAL_INT64(S / 10, daemon.period_ns);
	TEST_ASSERT_TRUE(daemon.alive);
	ows_close(h);
}

static void test_what_was_commanded_is_carried_from_a_recorded_segment(void)
{
	char recorded[SIZE_MAX_], text[TEXT_CAP + 1];
	uint32_t size = read_recording("command", recorded);
	struct command c;

	make_commands();
	commands_put(&commands, BYTE_, 0, NULL, 0);
	commands_stamp(&commands, BYTE_, 0);
	commands_put(&commands, STRING_, 0, "", 0);
	TEST_ASSERT_EQUAL(3, commands_carry(&commands, recorded, size, true));
	commands_load(&commands, BYTE_, &c);
	TEST_ASSERT_EQUAL_INT64(254, c.value);
	TEST_ASSERT_EQUAL(202, c.stamp);
	commands_load(&commands, LARGE_, &c);
	TEST_ASSERT_EQUAL_INT64(INT64_MIN + 1, c.value);
	TEST_ASSERT_EQUAL(5, commands_text(&commands, STRING_, text));
	TEST_ASSERT_EQUAL_STRING("north", text);
}

static void test_a_recorded_segment_can_be_commanded(void)
{
	uint32_t stamp;
	struct ows *h;

	TEST_ASSERT_EQUAL(0, ows_open(instance, OWS_CONTROL, &h));
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "byte"), 7, &stamp));
	TEST_ASSERT_EQUAL(203, stamp);
	TEST_ASSERT_EQUAL(0, ows_set_text(h, ows_find(h, "label"), "south", &stamp));
	TEST_ASSERT_EQUAL(211, stamp);
	TEST_ASSERT_EQUAL(0, ows_acknowledge(h, ows_find(h, "room.temperature")));
	ows_close(h);
}

/* What readers in other languages rely on: not one byte elsewhere, as long as this is the layout. */
static void test_todays_writer_lays_the_same_out_in_the_same_way(void)
{
	char recorded[SIZE_MAX_];
	uint32_t size = read_recording("image", recorded);

	if (((const struct ows_image_header *)(const void *)recorded)->minor != OWS_LAYOUT_MINOR)
		TEST_IGNORE_MESSAGE("the recording is of an earlier minor version");
	make_image();
	TEST_ASSERT_EQUAL(size, image.header->size);
	TEST_ASSERT_EQUAL_MEMORY(recorded, image_memory, size);
	size = read_recording("command", recorded);
	make_commands();
	TEST_ASSERT_EQUAL(size, commands.size);
	TEST_ASSERT_EQUAL_MEMORY(recorded, command_memory, size);
}

/* --- By other programs ------------------------------------------------------------------------ */

static const char *run(const char *command)
{
	static char output[8192];
	FILE *pipe = popen(command, "r");
	size_t n;

	TEST_ASSERT_NOT_NULL(pipe);
	n = fread(output, 1, sizeof(output) - 1, pipe);
	output[n] = '\0';
	TEST_ASSERT_EQUAL_MESSAGE(0, pclose(pipe), output);
	return output;
}

static const char *python(const char *code)
{
	char command[4096];

	snprintf(command, sizeof(command),
	         "PYTHONDONTWRITEBYTECODE=1 PYTHONIOENCODING=utf-8 PYTHONPATH=src/libows python3 -c '"
	         "import ows, sys\n%s' %s 2>&1",
	         code, instance);
	return run(command);
}

static void test_python_reads_a_recorded_image(void)
{
	TEST_ASSERT_EQUAL_STRING(
		"bool|True|192|1|1.0|101|201|0|1|1009000000000|1009500000000\n"
		"byte|255|192|2|2.0|102|202|0|0|1008000000000|1009000000000\n"
		"short|-32768|12|3|3.0|103|203|-5|1|1007000000000|1008500000000\n"
		"long|-2147483648|20|0|4.0|104|204|0|0|1006000000000|1008000000000\n"
		"word|65535|86|1|5.0|105|205|0|1|1005000000000|1007500000000\n"
		"dword|4294967295|192|2|6.0|106|206|0|0|1004000000000|1007000000000\n"
		"float|45.5|192|3|7.0|107|207|0|1|1003000000000|1006500000000\n"
		"room.temperature|-21.0625|192|0|8.0|108|208|0|0|1002000000000|1006000000000\n"
		"large|-9223372036854775808|192|1|9.0|109|209|0|1|1001000000000|1005500000000\n"
		"label|" LONG_TEXT "|192|2|10.0|110|210|0|0|1000000000000|1005000000000\n"
		"empty||192|3|11.0|111|211|0|1|999000000000|1004500000000\n"
		"never|False|0|0|10.0|0|0|0|0|0|0\n",
		python("s = ows.Ows(sys.argv[1])\n"
		       "for n in s.names():\n"
		       "    v = s.get(n, 1010 * 10**9)\n"
		       "    print(n, v.value, v.quality, v.detail, v.age, v.count, v.applied, v.err,"
		       " v.target, v.measured_ns, v.tried_ns, sep=\"|\")\n"));
	TEST_ASSERT_EQUAL_STRING(
		"5000000002 0.5 2.0 200.0 2 3 10 402 10 True False 77 3\n"
		"0 localhost:4304 suspended 4 0 0\n"
		"1 i2c:/dev/i2c-1 up 5 0 6\n"
		"0 never 1001000000000 False True device raised 192 1,0,0,1\n"
		"1 room.temperature 1002000000000 30.5 None high high acknowledged 192 \n"
		"0 False False True returned to normal unacknowledged high high\n"
		"Info(name=\"long\", path=\"/1D.000000000001/a\", type=4, output=False, fresh=True,"
		" alarm=False, per_factor=4, stale_after_ns=2000000000)\n",
		python("s = ows.Ows(sys.argv[1])\nN = 1010 * 10**9\n"
		       "print(*(s.get(\"byte_\" + a, N).value for a in (\"TRANSACTIONS\", \"Period\", \"Age\","
		       " \"AgeMax\", \"PerCount\", \"PerMax\", \"PendCount\", \"PendLast\", \"PendMax\","
		       " \"ReadEnable\", \"WE\")), s.get(\"_TRANSACTIONS\", N).value,"
		       " s.get(\"_RECONNECTS\", N).value)\n"
		       "for t in s.targets(): print(*t)\n"
		       "for a in s.alarms(): print(*a)\n"
		       "print(*s.alarm_state(\"room.temperature\"))\n"
		       "print(str(s.info(\"long\")).replace(chr(39), chr(34)))\n"));
}

/* Its clock is the real one, for which this owsd died long ago: no value is good, all are told. */
static void test_owsctl_reads_a_recorded_image(void)
{
	const char *runner = getenv("RUNNER");
	char command[512];

	snprintf(command, sizeof(command),
	         "for n in bool byte short long word dword float room.temperature large label empty;"
	         " do %s %s/../owsctl -n %s get $n; done 2>/dev/null; true",
	         runner ? runner : "", here, instance);
	TEST_ASSERT_EQUAL_STRING("1\n255\n-32768\n-2147483648\n65535\n4294967295\n45.5\n-21.0625\n"
	                         "-9223372036854775808\n" LONG_TEXT "\n\n",
	                         run(command));
}

/* --- Layouts to come -------------------------------------------------------------------------- */

/* Entries of the image with 16 bytes more each, and a field more behind the header's. */
static uint32_t move(char *to, uint32_t at, uint32_t *off, uint32_t *size, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		memcpy(to + at + i * (*size + 16), image_memory + *off + i * *size, *size);
		memset(to + at + i * (*size + 16) + *size, 0xa5, 16);
	}
	*off = at;
	*size += 16;
	return at + count * *size;
}

static void show_larger_entries(uint16_t minor)
{
	static _Alignas(64) char larger[2 * SIZE_MAX_];
	struct ows_image_header *h = (void *)larger;
	uint32_t at = ((const struct ows_image_header *)(const void *)image_memory)->size;

	memcpy(larger, image_memory, at);
	memset(larger + h->record_off, 0x5a, h->text_off - h->record_off);
	memcpy(larger + h->name_off, image_memory + h->name_off, h->record_count * 8);
	h->minor = minor;
	at = move(larger, at, &h->record_off, &h->record_size, h->record_count);
	at = move(larger, at, &h->info_off, &h->info_size, h->record_count);
	at = move(larger, at, &h->target_off, &h->target_size, h->target_count);
	at = move(larger, at, &h->counter_off, &h->counter_size, h->counter_count);
	at = move(larger, at, &h->alarm_off, &h->alarm_size, h->alarm_count);
	h->size = at;
	show("image", larger, at);
}

static void test_readers_take_a_later_minor_version_with_larger_entries(void)
{
	struct ows *h;

	show_larger_entries(OWS_LAYOUT_MINOR + 1);
	TEST_ASSERT_EQUAL(0, ows_open(instance, OWS_CONTROL, &h));
	check_all(h);
	ows_close(h);
	TEST_ASSERT_EQUAL_STRING(
		"-21.0625 " LONG_TEXT " /23.000000000002/memory i2c:/dev/i2c-1 30.5\n",
		python("s = ows.Ows(sys.argv[1], control=True)\n"
		       "print(s.get(\"room.temperature\").value, s.get(\"label\").value,"
		       " s.info(\"empty\").path, list(s.targets())[1].name, list(s.alarms())[1].before)\n"));
}

static void test_readers_refuse_entries_that_are_too_small_or_not_aligned(void)
{
	struct ows_image_header *header = (void *)image_memory;
	uint32_t *const sizes[] = {&header->record_size, &header->info_size, &header->target_size,
		                   &header->counter_size, &header->alarm_size};
	struct ows *h;

	for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
		uint32_t size = *sizes[i];

		*sizes[i] = size - 8;
		show("image", image_memory, header->size);
		TEST_ASSERT_EQUAL(-EPROTO, ows_open(instance, OWS_READ, &h));
		*sizes[i] = size + 4;
		show("image", image_memory, header->size);
		TEST_ASSERT_EQUAL(-EPROTO, ows_open(instance, OWS_READ, &h));
		*sizes[i] = size;
	}
}

static void test_readers_refuse_a_later_major_version(void)
{
	struct ows *h;

	((struct ows_image_header *)(void *)image_memory)->major++;
	show("image", image_memory, ((struct ows_image_header *)(void *)image_memory)->size);
	TEST_ASSERT_EQUAL(-EPROTO, ows_open(instance, OWS_READ, &h));
	TEST_ASSERT_EQUAL_STRING("71\n", python("try: ows.Ows(sys.argv[1])\n"
	                                        "except OSError as e: print(e.errno)\n"));
	((struct ows_image_header *)(void *)image_memory)->major--;
	show("image", image_memory, ((struct ows_image_header *)(void *)image_memory)->size);
	((struct ows_command_header *)(void *)command_memory)->major++;
	show("command", command_memory, ((struct ows_command_header *)(void *)command_memory)->size);
	TEST_ASSERT_EQUAL(-EPROTO, ows_open(instance, OWS_CONTROL, &h));
	TEST_ASSERT_EQUAL_STRING("71\n", python("try: ows.Ows(sys.argv[1], control=True)\n"
	                                        "except OSError as e: print(e.errno)\n"));
}

int main(int argc, char **argv)
{
	/* owsctl lies beside the folder of this program */
	snprintf(here, sizeof(here), "%s", argv[0]);
	if (strrchr(here, '/'))
		*strrchr(here, '/') = '\0';
	if (argc == 2 && strcmp(argv[1], "record") == 0) {
		record();
		return 0;
	}
	UNITY_BEGIN();
	RUN_TEST(test_libows_reads_a_recorded_image);
	RUN_TEST(test_python_reads_a_recorded_image);
	RUN_TEST(test_owsctl_reads_a_recorded_image);
	RUN_TEST(test_a_recorded_segment_can_be_commanded);
	RUN_TEST(test_what_was_commanded_is_carried_from_a_recorded_segment);
	RUN_TEST(test_todays_writer_lays_the_same_out_in_the_same_way);
	RUN_TEST(test_readers_take_a_later_minor_version_with_larger_entries);
	RUN_TEST(test_readers_refuse_entries_that_are_too_small_or_not_aligned);
	RUN_TEST(test_readers_refuse_a_later_major_version);
	return UNITY_END();
}
