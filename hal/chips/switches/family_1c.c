/* SPDX-License-Identifier: MIT */
/*
 * DS28E04-100 (data sheet 19-6134): 4 kbit of EEPROM, two switches with activity latches. Its
 * registers are those of a DS2408, without a checksum.
 *
 * Reset Activity Latches and PIO Access Write are confirmed (AAh); outputs and registers are read
 * back.
 */
#include <errno.h>

#include "hal/chips/family.h"
#include "hal/chips/switches/ds2408.h"

#define WRITE_OUTPUT 0x5a
#define EEPROM_BYTES 512
#define PIN_COUNT 2
#define PINS 0x03

enum { REGISTERS_N = DS2408_CONTROL + 1 };
enum { BIT_POLARITY = 6 }; /* of the control register */
#define SETTINGS 0x03
#define POR (1 << DS2408_POR)

static int saw_registers(struct txn *txn, unsigned at, uint8_t *bytes, unsigned n)
{
	(void)at, (void)n;
	ds2408_saw_control(txn, bytes[DS2408_CONTROL]);
	return 0;
}

static int store_output(struct txn *txn, const struct area *area, unsigned at, const uint8_t *bytes,
                        unsigned n)
{
	uint8_t latches = bytes[0] | (uint8_t)~PINS, answer;
	const uint8_t command[] = {WRITE_OUTPUT, latches, (uint8_t)~latches};
	int err = txn_ask(txn, command, sizeof(command), &answer, 1);

	(void)area, (void)at, (void)n;
	return err ? err : answer == DS2408_CONFIRMED ? 0 : -EBADMSG;
}

static int saw_condition(struct txn *txn, unsigned at, uint8_t *bytes, unsigned n)
{
	(void)at, (void)n;
	ds2408_saw_control(txn, bytes[2]);
	bytes[0] &= PINS;
	bytes[1] &= PINS;
	bytes[2] &= SETTINGS | POR;
	return 0;
}

static void adjust_condition(struct txn *txn, uint8_t *want)
{
	struct ds2408 *chip = txn->device->own;

	if (!(want[2] & POR))
		chip->por_clear = false;
}

#define READ_MEMORY .address_bytes = 2, .read = 0xf0
static AREA_NAMED(memory, "memory", .size = 0x226, READ_MEMORY, .row = 32, .write = 0x0f,
                  .verify = 0xaa, .copy = 0x55, .write_crc16 = true, .strong = true,
                  .copy_ns = 10 * TXN_MS);
static AREA_NAMED(registers, "registers", .at = 0x220, .size = REGISTERS_N, .block = REGISTERS_N,
                  READ_MEMORY, .saw = saw_registers);
static AREA_NAMED(output, "output", .at = 0x220 + DS2408_OUTPUT, .size = 1, READ_MEMORY, .row = 1,
                  .hidden = true, .store = store_output, .counts = PINS);
/* Mask, polarity and control. */
static AREA_NAMED(condition, "condition", .at = 0x220 + DS2408_MASK, .size = 3, .block = 3,
                  READ_MEMORY, .row = 3, .write = 0xcc, .saw = saw_condition,
                  .is_written = ds2408_condition_is_written, .adjust = adjust_condition);

/* No host sets it. */
static int write_por(struct txn *txn)
{
	static const uint8_t clear, mask = POR;

	return txn->number[0] != 0 ? -EOPNOTSUPP
	                           : area_write(txn, &condition, DS2408_CONTROL - DS2408_MASK,
	                                        &clear, &mask, 1);
}

/* What follows the EEPROM protects its pages for good, or is a register. */
static int write_memory(struct txn *txn)
{
	if (txn->at + txn->len > EEPROM_BYTES)
		return -EOPNOTSUPP;
	return area_write(txn, &memory, (unsigned)txn->at, txn->data, NULL, (unsigned)txn->len);
}

static int read_alarm(struct txn *txn)
{
	uint8_t value[3] = {0};
	int err = area_read(txn, &registers, DS2408_MASK, value, sizeof(value));

	txn->number[0] = ds2408_digits(value, PIN_COUNT);
	return err;
}

static int write_alarm(struct txn *txn)
{
	static const uint8_t which[] = {PINS, PINS, SETTINGS};
	uint8_t value[3];

	ds2408_condition_of(txn->number[0], PIN_COUNT, value);
	return area_write(txn, &condition, 0, value, which, sizeof(value));
}

enum { MEMORY = 1, REGISTERS, OUTPUT };
static const struct area *const areas[] = {
	[MEMORY] = &memory,
	[REGISTERS] = &registers,
	[OUTPUT] = &output,
};

enum { WAY_MEMORY = 1, WAY_PIO, WAY_LATCH, WAY_POR, WAY_ALARM };
static const struct property_how how[] = {
	[WAY_MEMORY] = {.write = write_memory},
	[WAY_PIO] = {SET(OUTPUT, .inverted = true)},
	[WAY_LATCH] = {.write = ds2408_write_latch},
	[WAY_POR] = {.write = write_por},
	[WAY_ALARM] = {.read = read_alarm, .write = write_alarm},
};

#define SWITCHES(text, life_, access_, ...) \
	PROPERTY(text, BITS, life_, access_, AGGREGATE(2, NUMBERS), __VA_ARGS__)
#define FLAG(text, access_, bit, ...) \
	PROPERTY(text, YESNO, VOLATILE, access_, \
	         FIELD(REGISTERS, .at = DS2408_CONTROL, .shift = (bit), .bits = 1), __VA_ARGS__)

static const struct property properties[] = {
	SWITCHES("PIO", STABLE, BOTH, FIELD(REGISTERS, .at = DS2408_OUTPUT, .inverted = true),
                 .holds = true, .how = WAY_PIO),
	SWITCHES("latch", VOLATILE, BOTH, FIELD(REGISTERS, .at = DS2408_ACTIVITY), .flag = true,
                 .alarm = ALARM_LATCH | ALARM_STAYS | ALARM_CLEARS, .how = WAY_LATCH),
	PROPERTY("memory", BINARY, VOLATILE, BOTH, .size = 550, FIELD(MEMORY), .how = WAY_MEMORY),
	PROPERTY_DIR("pages"),
	AREA_PAGES(MEMORY, 16, 32),
	FLAG("polarity", READ, BIT_POLARITY, .flag = false),
	FLAG("por", BOTH, DS2408_POR, .flag = true, .alarm = ALARM_POR, .how = WAY_POR),
	FLAG("power", READ, DS2408_VCC, .flag = false),
	SWITCHES("sensed", VOLATILE, READ, FIELD(REGISTERS), .alarm = ALARM_LATCH),
	PROPERTY("set_alarm", UNSIGNED, STABLE, BOTH, .digits = 333, .how = WAY_ALARM),
};

CHIP_FAMILY(1c, "DS28E04", PRESENCE, .alarms = true, .latches = true,
            .flags = FLAG_RESUME | FLAG_ALARM | FLAG_OVERDRIVE,
            SCAN({"sensed.BYTE", "inputs"}, {"PIO.BYTE", "outputs"}), AREAS(areas), HOW(how),
            PROPERTIES(properties));
