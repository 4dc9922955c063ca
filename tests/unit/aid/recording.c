/* SPDX-License-Identifier: MIT */
/* Makes the image of a recording, and reads one that an earlier owsd made. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "src/ground/signal/value.h"
#include "src/memory/shm/entries.h"
#include "src/public/ows.h"
#include "tests/unit/aid/folder.h"
#include "tests/unit/aid/recording.h"

#define DATA "tests/unit/data/"

static const struct image_meta room = {
	.unit = "\xc2\xb0"
		"C",
	.description = "cold room 3",
	.family = "DS18B20",
	.device = "28.000000000001",
	.calibrated = "2026-11-22",
	.points = "0:0 100:99.5",
	.decimals = 2,
	.scale = 1.25,
	.offset = -0.5,
	.min = -40,
	.max = 60,
	.limit_hh = 30,
	.limit_h = 20,
	.limit_l = NAN,
	.limit_ll = -30,
	.filter_s = 10,
	.deadband = 0.25,
};
const struct image_signal signals[COUNT] = {
	{"bool", "/29.000000000001/PIO.0", OWS_BOOL, OWS_RECORD_OUTPUT, 0, 1, 11, 0, true, true, 1,
         0},
	{"byte", "/29.000000000001/PIO.BYTE", OWS_BYTE, OWS_RECORD_OUTPUT, 0, 2, 12, 0, false, true,
         0, 255},
	{"short", "/20.000000000001/volt.A", OWS_SHORT, 0, 0, 3, 13, 5 * S},
	{"long", "/1D.000000000001/a", OWS_LONG, OWS_RECORD_FRESH, 0, 4, 14, 2 * S},
	{"word", "/1D.000000000001/b", OWS_WORD, 0, 0, 5, 15, 0},
	{"dword", "/1D.000000000001/counters.A", OWS_DWORD, 0, 0, 6, 16, 0},
	{"float", "/26.000000000001/humidity", OWS_FLOAT, 0, 0, 7, 17, 0},
	{"room.temperature", "/28.000000000001/temperature", OWS_DOUBLE, 0, 0, 4294967295u, 18,
         20 * S, .starts_last = true, .meta = &room, .identity = "/28.0000000000FF/temperature"},
	{"large", "/null", OWS_LARGE, OWS_RECORD_OUTPUT, 0, 9, 19, 0},
	{"label", "/23.000000000001/memory", OWS_STRING, OWS_RECORD_OUTPUT, TEXT_CAP, 10, 20, 0},
	{"empty", "/23.000000000002/memory", OWS_STRING, 0, TEXT_CAP, 11, 21, 0},
	{"never", "/29.000000000001/alarm", OWS_BOOL, OWS_RECORD_ALARM, 0, 12, 22, 0},
};
static const char *const targets[] = {"localhost:4304", "i2c:/dev/i2c-1"};
static const uint32_t groups[] = {0, 0};
static const struct image_counter counters[] = {{"alarms", UINT32_MAX}, {"crc_errors", 1}};

char instance[40];
_Alignas(64) char image_memory[SIZE_MAX_];
struct image image;

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

/* The fields of record i are functions of i, so that all differ. */
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
		.confirmed = 200 + record,
		.len = text ? (uint32_t)strlen(text) : 0,
	};
	struct ows_attrs attrs = {
		.transactions = 5000000000u + record,
		.update_ns = record * S / 4,
		.age_max_ns = record * 100 * S,
		.commanded = value,
		.raw = value + 1,
		.per_base = 1000 - record,
		.per_max = 3,
		.pend_base = 990,
		.pend_last = 400 + record,
		.pend_max = 5,
		.alarms = record == NEVER_ ? 2 : 0,
		.flags = OWS_ATTR_READ_ENABLE |
	                 (record == BYTE_ ? OWS_ATTR_IN_WORK | OWS_ATTR_COMMANDED : 0) |
	                 (record == DOUBLE_ ? OWS_ATTR_LIMITS : 0) |
	                 (record == NEVER_ ? OWS_ATTR_ALARM_STANDS : 0),
		.limit_state = record == DOUBLE_ ? OWS_LIMIT_RETURNED : 0,
		.limit_condition = record == DOUBLE_ ? OWS_ALARM_HH : 0,
		.shelved = record == DOUBLE_,
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
	struct ows_journal_entry device = {
		.record = NEVER_,
		.occurred_ns = 1001 * S,
		.before = 0,
		.kind = OWS_ALARM_DEVICE,
		.event = OWS_ALARM_RAISED,
		.quality = OWS_Q_GOOD,
		.flags = OWS_JOURNAL_BEFORE,
		.text = "1,0,0,1",
	};
	struct ows_journal_entry limit = {
		.record = DOUBLE_,
		.occurred_ns = 1002 * S,
		.before = value_of_double(30.5),
		.kind = OWS_ALARM_HH,
		.event = OWS_ALARM_ACKNOWLEDGED,
		.quality = OWS_Q_GOOD,
		.flags = OWS_JOURNAL_BEFORE,
	};

	image_alarm_after(&image, image_alarm(&image, &device), 1);
	image_alarm(&image, &limit);
}

/* What a controller leaves: itself, a command of its own and its origin, and an alarm it
 * shelved. */
static void put_controller(void)
{
	const struct ows_who who = {
		.serial = 3, .uid = 1000, .pid = 777, .name = "hmi", .person = "Jana"};
	struct ows_controller_entry controller = {
		.flags = OWS_CONTROLLER_CONNECTED | OWS_CONTROLLER_MAY_SET,
		.joined_ns = 1001 * S,
		.who = who,
		.period_ms = 500,
		.commands = 12,
		.refused = 1,
	};
	struct ows_origin_entry origin = {
		.reason = OWS_REASON_SET, .taken_ns = 1002 * S, .who = who};
	struct ows_journal_entry command = {
		.record = BYTE_,
		.occurred_ns = 1002 * S,
		.before = 254,
		.after = 255,
		.kind = OWS_REASON_SET,
		.quality = OWS_Q_GOOD,
		.flags = OWS_JOURNAL_BEFORE | OWS_JOURNAL_AFTER,
		.more = 4,
		.who = who,
	};
	struct ows_shelf_entry shelf = {
		.record = DOUBLE_,
		.since_ns = 1003 * S,
		.until_ns = 2003 * S,
		.who = who,
		.why = "sensor is being moved",
	};

	image_controller(&image, 1, &controller);
	image_origin(&image, BYTE_, &origin);
	image_command(&image, &command);
	image_shelf(&image, 0, &shelf);
	image_change(&image, BYTE_);
	image_change(&image, DOUBLE_);
}

void make_image(void)
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
	put_controller();
	image_target(&image, 0, 2, 4);
	image_target(&image, 1, 1, 5);
	image_moves(&image, 1, 6);
	image_counter(&image, 0, 2);
	image_counter(&image, 1, UINT64_C(0x123456789a));
	image_state(&image, OWS_STATE_LIVE);
}

/* Write the size, then with their offsets the rows of 32 bytes that are not all zero. */
static void write_recording(const char *name, const char *memory, uint32_t size)
{
	static const char zero[32];
	char path[96];
	FILE *file;

	snprintf(path, sizeof(path), DATA "%s", name);
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

void record(void)
{
	make_image();
	write_recording(RECORDED, image_memory, image.header->size);
}

uint32_t read_recording(const char *name, char *memory)
{
	char path[96], line[160];
	uint32_t size;
	FILE *file;

	snprintf(path, sizeof(path), DATA "%s", name);
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

void show(const char *kind, const char *memory, uint32_t size)
{
	FILE *file = fopen(folder_file(instance, kind), "w");

	TEST_ASSERT_NOT_NULL(file);
	TEST_ASSERT_EQUAL(size, fwrite(memory, 1, size, file));
	TEST_ASSERT_EQUAL(0, fclose(file));
}

void recording_begin(void)
{
	snprintf(instance, sizeof(instance), "recorded.%ld", (long)getpid());
	show("image", image_memory, read_recording(RECORDED, image_memory));
}

void recording_end(void)
{
	unlink(folder_file(instance, "image"));
}
