/* SPDX-License-Identifier: MIT */
/* Switches: their registers are attributes, without checksums. */
#include <errno.h>
#include <string.h>

#include "hal/w1/switches.h"

#define OLD_NS INT64_C(10000000000)

/* --- DS2408 --- */

/* Control register of the DS2408. */
#define LATCHES 0x01 /* the condition is about the latches, not the pins */
#define ALL_OF 0x02
#define POR 0x08
#define NEVER_SET 0x70
#define VCC 0x80

enum { PINS, OUTPUT, ACTIVITY, MASK, POLARITY, CONTROL, REGISTERS };
static const char *const registers[REGISTERS] = {
	"state",         "output", "activity", "cond_search_mask", "cond_search_polarity",
	"status_control"};

static int read_register(struct w1_slave *slave, unsigned which, uint8_t *value)
{
	int err = which < REGISTERS ? w1_slave_read(slave, registers[which], 0, value, 1) : -ENOENT;

	if (err)
		return err;
	if (which >= MASK)
		slave->condition[which - MASK] = *value;
	return which == CONTROL && *value & NEVER_SET ? -EBADE : 0;
}

static int read_registers(struct w1_slave *slave, unsigned at, uint8_t *bytes, unsigned n)
{
	int err = 0;

	for (unsigned i = 0; i < n && !err; i++)
		err = read_register(slave, at + i, &bytes[i]);
	return err;
}

static int read_output(struct w1_slave *slave, unsigned at, uint8_t *bytes, unsigned n)
{
	return read_registers(slave, OUTPUT + at, bytes, n);
}

static int write_output(struct w1_slave *slave, unsigned at, const uint8_t *bytes, unsigned n)
{
	return w1_slave_write(slave, "output", at, bytes, n);
}

/* Whatever is written, all latches are cleared. */
static int clear_latches(struct w1_slave *slave, unsigned at, const uint8_t *bytes, unsigned n)
{
	static const uint8_t ones = 0xff;

	(void)at, (void)bytes, (void)n;
	return w1_slave_write(slave, "activity", 0, &ones, 1);
}

static int read_condition(struct w1_slave *slave, unsigned at, uint8_t *bytes, unsigned n)
{
	return read_registers(slave, MASK + at, bytes, n);
}

/*
 * What differs from what was read last: some drivers do not let mask and polarity be changed, and
 * their attributes refuse it. With the control register the driver compares what it reads back, the
 * supply's bit included; where the compiler's char has a sign it finds that bit different and
 * returns an error, though the chip took the value: the caller reads it back.
 */
static int write_condition(struct w1_slave *slave, unsigned at, const uint8_t *bytes, unsigned n)
{
	int err = 0;

	slave->condition_ns = 0;
	for (unsigned i = at; i < at + n && i < sizeof(slave->condition) && !err; i++) {
		uint8_t now = slave->condition[i], value = bytes[i - at];

		if (MASK + i == CONTROL)
			value |= now & VCC;
		if (value != now)
			err = w1_slave_write(slave, registers[MASK + i], 0, &value, 1);
		if (MASK + i == CONTROL && err == -EIO)
			err = 0;
	}
	return err;
}

static int ds2408_alarm(struct w1_slave *slave)
{
	const uint8_t *condition = slave->condition;
	uint8_t control, level;
	int err = read_register(slave, CONTROL, &control);

	if (err)
		return err == -EBADMSG ? -EIO : err;
	if (control & POR) {
		slave->condition_ns = 0;
		return 1;
	}
	if (!slave->condition_ns || bus_now(slave->tree->env) - slave->condition_ns > OLD_NS) {
		err = read_register(slave, MASK, &level);
		if (!err)
			err = read_register(slave, POLARITY, &level);
		slave->condition_ns = err ? 0 : bus_now(slave->tree->env);
	}
	if (!err)
		err = read_register(slave, control & LATCHES ? ACTIVITY : PINS, &level);
	if (err)
		return err;
	uint8_t meets = (uint8_t) ~(level ^ condition[POLARITY - MASK]) & condition[0];
	return control & ALL_OF ? condition[0] && meets == condition[0] : meets != 0;
}

static const struct w1_part ds2408[] = {
	{.area = "registers", .read = read_registers},
	{.area = "output", .read = read_output, .write = write_output},
	{.area = "latches", .write = clear_latches},
	{.area = "condition", .read = read_condition, .write = write_condition},
};
static const struct w1_property ds2408_properties[] = {
	{.name = "PIO"},
	{.name = "latch", .file = "activity"},
	{.name = "por", .file = "status_control"},
	{.name = "power", .file = "status_control"},
	{.name = "sensed", .file = "state"},
	{.name = "set_alarm", .file = "cond_search_mask"},
	{.name = "strobe", .file = "status_control"},
};

/* --- Drivers that give digits --- */

static int read_digit(struct w1_slave *slave, const char *file, unsigned most, uint8_t *value)
{
	int err = w1_slave_read(slave, file, 0, value, 1);

	if (!err && (*value < '0' || *value > '0' + most))
		err = -EIO;
	*value -= '0';
	return err;
}

static int put_digit(struct w1_slave *slave, const char *file, uint8_t value)
{
	value += '0';
	return w1_slave_write(slave, file, 0, &value, 1);
}

/* --- DS2406: bit 0 and 1 are the latches of A and B; 1 does not conduct. --- */

static int read_info(struct w1_slave *slave, unsigned at, uint8_t *bytes, unsigned n)
{
	(void)at, (void)n;
	return read_digit(slave, "state", 3, bytes);
}

#define STATUS_SHIFT 5
static int read_status(struct w1_slave *slave, unsigned at, uint8_t *bytes, unsigned n)
{
	int err = read_info(slave, at, bytes, n);

	*bytes = (uint8_t)(*bytes << STATUS_SHIFT);
	return err;
}

static int write_status(struct w1_slave *slave, unsigned at, const uint8_t *bytes, unsigned n)
{
	(void)at, (void)n;
	return put_digit(slave, "output", *bytes >> STATUS_SHIFT & 3);
}

static const struct w1_part ds2406[] = {
	{.area = "info", .read = read_info},
	{.area = "status", .read = read_status, .write = write_status},
};
static const struct w1_property ds2406_properties[] = {
	{.name = "PIO"},
	{.name = "flipflop"},
};

/* --- DS2405: the digit 0 conducts. --- */

static int read_pin(struct w1_slave *slave, unsigned at, uint8_t *bytes, unsigned n)
{
	(void)at, (void)n;
	return read_digit(slave, "state", 1, bytes);
}

static int read_switch(struct w1_slave *slave, unsigned at, uint8_t *bytes, unsigned n)
{
	(void)at, (void)n;
	return read_digit(slave, "output", 1, bytes);
}

static int write_switch(struct w1_slave *slave, unsigned at, const uint8_t *bytes, unsigned n)
{
	(void)at, (void)n;
	return put_digit(slave, "output", *bytes & 1);
}

static int ds2405_alarm(struct w1_slave *slave)
{
	uint8_t digit;
	int err = w1_slave_read(slave, "output", 0, &digit, 1);

	return err ? err : digit == '0';
}

static const struct w1_part ds2405[] = {
	{.area = "pin", .read = read_pin},
	{.area = "output", .read = read_switch, .write = write_switch},
};
static const struct w1_property ds2405_properties[] = {
	{.name = "PIO"},
	{.name = "sensed", .file = "state"},
};

/* --- DS2413: some kernels give its whole byte, some the lower half; they have compared the two. */

/* The pins, the latches, and the half. */
static int read_halves(struct w1_slave *slave, unsigned at, uint8_t *bytes, unsigned n)
{
	uint8_t state = 0;
	int err = w1_slave_read(slave, "state", 0, &state, 1);
	const uint8_t parts[] = {(uint8_t)((state & 1) | (state >> 1 & 2)),
	                         (uint8_t)((state >> 1 & 1) | (state >> 2 & 2)), state & 0xf};

	memcpy(bytes, parts + at, n);
	return err;
}

static int read_latches(struct w1_slave *slave, unsigned at, uint8_t *bytes, unsigned n)
{
	return read_halves(slave, 1 + at, bytes, n);
}

static int write_latches(struct w1_slave *slave, unsigned at, const uint8_t *bytes, unsigned n)
{
	uint8_t byte = bytes[0] | 0xfc;

	(void)at, (void)n;
	return w1_slave_write(slave, "output", 0, &byte, 1);
}

static const struct w1_part ds2413[] = {
	{.area = "status", .read = read_halves},
	{.area = "latches", .read = read_latches, .write = write_latches},
};
static const struct w1_property ds2413_properties[] = {
	{.name = "PIO"},
	{.name = "piostate"},
	{.name = "sensed"},
};

/* clang-format off */
#define DRIVER(code, file, chip, alarm_) \
	{.family = (code), .files = {file}, W1_PARTS(chip), W1_PROPERTIES(chip##_properties), \
	 .alarm = (alarm_)}

const struct w1_driver w1_switches[] = {
	DRIVER(0x05, "output", ds2405, ds2405_alarm),
	DRIVER(0x12, "output", ds2406, NULL),
	DRIVER(0x29, "output", ds2408, ds2408_alarm),
	DRIVER(0x3a, "state", ds2413, NULL),
	{.family = 0},
};
/* clang-format on */
