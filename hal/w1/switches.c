/* SPDX-License-Identifier: MIT */
/* DS2405, DS2406 and DS2408: their registers are attributes, without checksums. */
#include <errno.h>
#include <string.h>

#include "hal/chips/ds2408.h"
#include "hal/w1/w1.h"

#define SETTINGS 0x07 /* bits of the DS2408's control register that are written */
#define POR 0x08
#define NEVER_SET 0x70 /* bits of the DS2408's control register */
#define VCC 0x80

static int byte_of(struct txn *txn, const char *file, uint8_t *byte)
{
	int n = w1_slave_read(w1_master_of(txn), txn->device->rom, file, byte, 1);

	txn->on_wire = true;
	return n < 0 ? n : n == 1 ? 0 : -EIO;
}

static int put_byte(struct txn *txn, const char *file, uint8_t byte)
{
	txn->on_wire = true;
	return w1_slave_write(w1_master_of(txn), txn->device->rom, file, &byte, 1);
}

static void saw_output(struct txn *txn, uint8_t output)
{
	struct device *device = txn->device;

	if (device->shadow_known && device->shadow != output)
		txn->restarted = true;
	device->shadow = output;
	device->shadow_known = true;
}

/* --- DS2408 --- */

static int control(struct txn *txn, uint8_t *value)
{
	struct ds2408 *ds2408 = txn->device->own;
	int err = byte_of(txn, "status_control", value);

	if (err)
		return err;
	txn->silent = *value == 0xff;
	if (*value & NEVER_SET)
		return -EBADMSG;
	if (*value & POR && ds2408->por_clear)
		txn->restarted = true;
	ds2408->por_clear = !(*value & POR);
	txn->device->power = *value & VCC ? POWER_EXTERNAL : POWER_PARASITE;
	txn->heard = true;
	return 0;
}

/* All ones is also what one hears of a chip that is not there: the control register tells. */
static int reg(struct txn *txn, const char *file, uint8_t *value)
{
	uint8_t status;
	int err = byte_of(txn, file, value);

	return err || *value != 0xff ? err : control(txn, &status);
}

static int read_pins(struct txn *txn)
{
	uint8_t value = 0;
	int err = reg(txn, "state", &value);

	txn->bits = value;
	return err;
}

static int read_latches(struct txn *txn)
{
	uint8_t value = 0;
	int err = reg(txn, "activity", &value);

	txn->bits = value;
	return err;
}

static int read_output(struct txn *txn)
{
	uint8_t value = 0;
	int err = reg(txn, "output", &value);

	if (!err)
		saw_output(txn, value);
	txn->bits = value ^ 0xff;
	return err;
}

static int write_output(struct txn *txn)
{
	uint8_t value = (uint8_t)~txn->bits, now = 0;
	int err = put_byte(txn, "output", value);

	txn->device->shadow_known = false;
	if (!err)
		err = reg(txn, "output", &now);
	if (err)
		return err;
	saw_output(txn, now);
	return now == value ? 0 : -EIO;
}

/* Whatever is written, all latches are cleared. */
static int clear_latches(struct txn *txn)
{
	return put_byte(txn, "activity", 0xff);
}

static int read_flag(struct txn *txn)
{
	uint8_t value = 0;
	int err = control(txn, &value);

	txn->number[0] = (value >> txn->property->field.shift & 1) != 0;
	return err;
}

/*
 * The driver compares with what it reads back, the supply's bit included; where the compiler's char
 * has a sign it finds that bit different and tells an error, though the chip took the value.
 */
static int put_control(struct txn *txn, uint8_t value)
{
	struct ds2408 *ds2408 = txn->device->own;
	uint8_t now = 0;

	if (!(value & POR))
		ds2408->por_clear = false;
	int err = put_byte(txn, "status_control", value);
	if (err && err != -EIO)
		return err;
	err = control(txn, &now);
	return err ? err : (now ^ value) & SETTINGS || now & ~value & POR ? -EIO : 0;
}

static int write_flag(struct txn *txn)
{
	uint8_t value = 0, bit = (uint8_t)(1 << txn->property->field.shift);
	int err = control(txn, &value);

	if (err)
		return err;
	return put_control(txn, txn->number[0] != 0 ? value | bit : (uint8_t)(value & ~bit));
}

static int condition(struct txn *txn, uint8_t *mask, uint8_t *polarity, uint8_t *status)
{
	int err = control(txn, status);

	if (!err)
		err = byte_of(txn, "cond_search_mask", mask);
	if (!err)
		err = byte_of(txn, "cond_search_polarity", polarity);
	return err;
}

/* A digit for each channel, 2 selected + 1 high; before them the source. */
static int read_alarm(struct txn *txn)
{
	uint8_t mask = 0, polarity = 0, status = 0;
	int err = condition(txn, &mask, &polarity, &status);
	uint32_t digits = status & 3;

	for (int i = 7; i >= 0; i--)
		digits = 10 * digits + (mask >> i & 1) * 2u + (polarity >> i & 1);
	txn->number[0] = digits;
	return err;
}

/* Drivers let nobody change mask and polarity: then the attributes refuse it. */
static int write_alarm(struct txn *txn)
{
	uint8_t mask = 0, polarity = 0, status = 0, new_mask = 0, new_polarity = 0;
	uint32_t digits = (uint32_t)txn->number[0];
	int err = condition(txn, &mask, &polarity, &status);

	for (int i = 0; i < 8; i++, digits /= 10) {
		new_mask |= (uint8_t)((digits % 10 >> 1 & 1) << i);
		new_polarity |= (uint8_t)((digits % 10 & 1) << i);
	}
	w1_slave_of(w1_master_of(txn), txn->device->rom)->condition_ns = 0;
	if (!err && mask != new_mask)
		err = put_byte(txn, "cond_search_mask", new_mask);
	if (!err && polarity != new_polarity)
		err = put_byte(txn, "cond_search_polarity", new_polarity);
	if (err || (status & 3) == (digits & 3))
		return err;
	return put_control(txn, (uint8_t)((status & ~3) | (digits & 3)));
}

static const struct w1_way ds2408[] = {
	{.property = "PIO", .read = read_output, .write = write_output},
	{.property = "latch", .file = "activity", .read = read_latches, .write = clear_latches},
	{.property = "por", .file = "status_control", .read = read_flag, .write = write_flag},
	{.property = "power", .file = "status_control", .read = read_flag},
	{.property = "sensed", .file = "state", .read = read_pins},
	{.property = "set_alarm",
         .file = "cond_search_mask",
         .read = read_alarm,
         .write = write_alarm},
	{.property = "strobe", .file = "status_control", .read = read_flag, .write = write_flag},
};

/* --- DS2406: a digit, bit 0 and 1 the latches of A and B; 1 does not conduct. --- */

static int read_digit(struct txn *txn, const char *file, unsigned most, uint8_t *value)
{
	int err = byte_of(txn, file, value);

	if (!err && (*value < '0' || *value > '0' + most))
		err = -EIO;
	*value -= '0';
	return err;
}

static int read_flipflop(struct txn *txn)
{
	uint8_t value = 0;
	int err = read_digit(txn, "state", 3, &value);

	if (!err)
		saw_output(txn, value);
	txn->bits = value;
	return err;
}

static int read_switches(struct txn *txn)
{
	int err = read_flipflop(txn);

	txn->bits ^= 3;
	return err;
}

static int write_switches(struct txn *txn)
{
	uint8_t value = ~txn->bits & 3, now = 0;
	int err = put_byte(txn, "output", (uint8_t)('0' + value));

	txn->device->shadow_known = false;
	if (!err)
		err = read_digit(txn, "state", 3, &now);
	if (err)
		return err;
	saw_output(txn, now);
	return now == value ? 0 : -EIO;
}

static const struct w1_way ds2406[] = {
	{.property = "PIO", .read = read_switches, .write = write_switches},
	{.property = "flipflop", .read = read_flipflop},
};

/* --- DS2405: the digit 0 conducts. --- */

static int read_switch(struct txn *txn)
{
	uint8_t value = 0;
	int err = read_digit(txn, "output", 1, &value);

	txn->number[0] = !value;
	return err;
}

static int read_pin(struct txn *txn)
{
	uint8_t value = 0;
	int err = read_digit(txn, "state", 1, &value);

	txn->number[0] = value;
	return err;
}

static int write_switch(struct txn *txn)
{
	uint8_t want = txn->number[0] == 0, now = 0;
	int err = put_byte(txn, "output", (uint8_t)('0' + want));

	if (!err)
		err = read_digit(txn, "output", 1, &now);
	return err ? err : now == want ? 0 : -EIO;
}

static const struct w1_way ds2405[] = {
	{.property = "PIO", .read = read_switch, .write = write_switch},
	{.property = "sensed", .file = "state", .read = read_pin},
};

const struct w1_driver w1_switches[3] = {
	{.family = 0x05, .files = {"output"}, W1_WAYS(ds2405)},
	{.family = 0x12, .files = {"output"}, W1_WAYS(ds2406)},
	{.family = 0x29, .files = {"output"}, W1_WAYS(ds2408)},
};
