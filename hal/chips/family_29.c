/* SPDX-License-Identifier: MIT */
/* DS2408 (data sheet 19-5702): eight switches with activity latches. */
#include <errno.h>
#include <string.h>

#include "hal/chips/family.h"
#include "hal/chips/lcd.h"

#define READ_REGISTERS 0xf0
#define WRITE_OUTPUT 0x5a
#define WRITE_CONDITION 0xcc
#define RESET_LATCHES 0xc3
#define CONFIRMED 0xaa

#define VISIT_NS (2 * TXN_MS)

/* The registers from 0x88 on. */
enum { PIN, OUTPUT, ACTIVITY, MASK, POLARITY, CONTROL, REGISTERS = 8 };

#define CONTROL_STROBE 0x04 /* ROS */
#define CONTROL_POR 0x08
#define CONTROL_VCC 0x80

/* note[0]: the power-on flag has been seen clear. */

static int registers(struct txn *txn, uint8_t value[REGISTERS])
{
	static const uint8_t command[] = {READ_REGISTERS, 0x88, 0x00};
	struct device *device = txn->device;
	int err = txn_command(txn, command, sizeof(command));

	if (!err)
		err = txn_read_crc16(txn, command, sizeof(command), value, REGISTERS);
	if (err)
		return err;
	bool por = value[CONTROL] & CONTROL_POR;
	if ((por && device->note[0]) || (device->shadow_known && device->shadow != value[OUTPUT]))
		txn->restarted = true;
	device->note[0] = !por;
	device->shadow = value[OUTPUT];
	device->shadow_known = true;
	device->power = value[CONTROL] & CONTROL_VCC ? POWER_EXTERNAL : POWER_PARASITE;
	return 0;
}

/*
 * The power-on flag and the latches that a visit of the alarm machine asks for one after the other
 * are read once. No write fits in between, as it would take longer.
 */
static int visited(struct txn *txn, uint8_t value[REGISTERS])
{
	struct device *device = txn->device;
	int err;

	if (!txn->visit)
		return registers(txn, value);
	if (device->registers_ns && txn_now(txn) - device->registers_ns < VISIT_NS) {
		memcpy(value, device->registers, REGISTERS);
		device->registers_ns = 0;
		return 0;
	}
	err = registers(txn, value);
	memcpy(device->registers, value, REGISTERS);
	device->registers_ns = err ? 0 : txn_now(txn);
	return err;
}

/* An output bit of 1 does not conduct. */
static int read_bits(struct txn *txn)
{
	uint8_t value[REGISTERS];
	int err = txn->property->arg == ACTIVITY ? visited(txn, value) : registers(txn, value);

	if (err)
		return err;
	txn->bits = value[txn->property->arg];
	if (txn->property->arg == OUTPUT)
		txn->bits ^= 0xff;
	return 0;
}

static int read_flag(struct txn *txn)
{
	uint8_t value[REGISTERS];
	int err = txn->property->arg == CONTROL_POR ? visited(txn, value) : registers(txn, value);

	if (!err)
		txn->number[0] = (value[CONTROL] & txn->property->arg) != 0;
	return err;
}

/* The way out of the test mode in which a slow supply can leave the chip (data sheet, page 39). */
static int leave_test_mode(struct txn *txn)
{
	uint8_t bytes[10] = {0x96};

	memcpy(bytes + 1, txn->device->rom, 8);
	bytes[9] = 0x3c;
	return txn_raw(txn, bytes, sizeof(bytes));
}

/*
 * Each byte is confirmed, and then its effect on the pins told, before the next. Where a link does
 * not take a write behind a read, each has a transaction of its own.
 */
int ds2408_put(struct txn *txn, const uint8_t *bytes, unsigned n)
{
	uint8_t command[] = {WRITE_OUTPUT, 0, 0}, answer[2];
	int err = 0;

	txn->device->shadow_known = false;
	for (unsigned i = 0; i < n; i++) {
		command[1] = bytes[i];
		command[2] = (uint8_t)~bytes[i];
		err = i ? txn_write(txn, command + 1, 2) : -EOPNOTSUPP;
		if (err == -EOPNOTSUPP)
			err = txn_command(txn, command, sizeof(command));
		if (!err)
			err = txn_read(txn, answer, sizeof(answer));
		if (err)
			return err;
		if (answer[0] == CONFIRMED)
			continue;
		bool silent = txn->silent;
		err = leave_test_mode(txn);
		txn->silent = silent;
		return err ? err : silent ? -EBADMSG : -EIO;
	}
	return 0;
}

static int write_pio(struct txn *txn)
{
	uint8_t value[REGISTERS], byte = (uint8_t)~txn->bits;
	int err;

	if (txn->phase == 0) {
		err = ds2408_put(txn, &byte, 1);
		txn->mem[0] = byte;
		txn->phase = 1;
		return err ? err : TXN_MORE;
	}
	txn->device->shadow_known = false;
	err = registers(txn, value);
	return err ? err : value[OUTPUT] == txn->mem[0] ? 0 : -EIO;
}

static int write_latch(struct txn *txn)
{
	static const uint8_t command = RESET_LATCHES;
	uint8_t answer;
	int err = txn_command(txn, &command, 1);

	if (!err)
		err = txn_read(txn, &answer, 1);
	return err ? err : answer == CONFIRMED ? 0 : -EBADMSG;
}

/* Mask, polarity and control, written and read back. The power-on flag stays unless told. */

/* The registers as they are, ahead of a change of mask, polarity or control. */
static int before_condition(struct txn *txn)
{
	int err = registers(txn, txn->mem);

	if (err)
		return err;
	txn_base(txn, txn->device->family, txn->mem + MASK, 3);
	txn_keep(txn, txn->device->family, txn->mem + MASK, 3);
	return 0;
}

static int write_condition(struct txn *txn, uint8_t mask, uint8_t polarity, uint8_t control)
{
	uint8_t command[] = {WRITE_CONDITION, 0x8b, 0x00, mask, polarity, control};
	uint8_t value[REGISTERS];
	int err;

	if (txn->phase == 1) {
		err = txn_command(txn, command, sizeof(command));
		txn->phase = 2;
		return err ? err : TXN_MORE;
	}
	if (!(control & CONTROL_POR))
		txn->device->note[0] = 0;
	err = registers(txn, value);
	if (err)
		return err;
	if (value[MASK] != mask || value[POLARITY] != polarity ||
	    ((value[CONTROL] ^ control) & 0x07) || (value[CONTROL] & ~control & CONTROL_POR))
		return -EIO;
	/* Cleared by a write that was disturbed, it can only be said, not set. */
	if (control & ~value[CONTROL] & CONTROL_POR)
		txn->restarted = true;
	txn_changed(txn);
	return 0;
}

static int read_alarm(struct txn *txn)
{
	uint8_t value[REGISTERS];
	uint32_t digits;
	int err = registers(txn, value);

	if (err)
		return err;
	digits = value[CONTROL] & 3;
	for (int i = 7; i >= 0; i--)
		digits = 10 * digits + (value[MASK] >> i & 1) * 2u + (value[POLARITY] >> i & 1);
	txn->number[0] = digits;
	return 0;
}

static int write_alarm(struct txn *txn)
{
	uint32_t digits = (uint32_t)txn->number[0];
	uint8_t mask = 0, polarity = 0;

	if (txn->phase == 0) {
		int err = before_condition(txn);

		txn->phase = 1;
		return err ? err : TXN_MORE;
	}
	for (int i = 0; i < 8; i++, digits /= 10) {
		mask |= (uint8_t)((digits % 10 >> 1 & 1) << i);
		polarity |= (uint8_t)((digits % 10 & 1) << i);
	}
	return write_condition(
		txn, mask, polarity,
		(uint8_t)((txn->mem[CONTROL] & (CONTROL_STROBE | CONTROL_POR)) | (digits & 3)));
}

/* por and strobe are bits of the control register. */
static int write_flag(struct txn *txn)
{
	uint8_t bit = (uint8_t)txn->property->arg;

	if (txn->phase == 0) {
		int err = before_condition(txn);

		txn->phase = 1;
		return err ? err : TXN_MORE;
	}
	uint8_t control = (uint8_t)(txn->mem[CONTROL] & 0x0f & ~bit);
	if (txn->number[0] != 0)
		control |= bit;
	return write_condition(txn, txn->mem[MASK], txn->mem[POLARITY], control);
}

int ds2408_strobe(struct txn *txn)
{
	if (txn->phase == 0) {
		int err = before_condition(txn);

		if (err || txn->mem[CONTROL] & CONTROL_STROBE)
			return err;
		txn->phase = 1;
		return TXN_MORE;
	}
	return write_condition(txn, txn->mem[MASK], txn->mem[POLARITY],
	                       (uint8_t)((txn->mem[CONTROL] & 0x0f) | CONTROL_STROBE));
}

static int write_test_mode(struct txn *txn)
{
	return txn->number[0] == 0 ? 0 : leave_test_mode(txn);
}

/* clang-format off */
#define BITS(text, life_, access_, where, writes)                                         \
	{.name = (text), .type = PROPERTY_BITS, .life = (life_), .access = (access_),      \
	 .array = {8, INDEX_NUMBERS, true}, .arg = (where), .read = read_bits, .write = (writes)}
#define FLAG(text, life_, access_, bit, writes)                                           \
	{.name = (text), .type = PROPERTY_YESNO, .life = (life_), .access = (access_),     \
	 .arg = (bit), .read = read_flag, .write = (writes)}

static const struct property properties[] = {
	LCD_PROPERTIES,
	BITS("PIO", LIFE_STABLE, ACCESS_BOTH, OUTPUT, write_pio),
	BITS("latch", LIFE_VOLATILE, ACCESS_BOTH, ACTIVITY, write_latch),
	{.name = "out_of_testmode", .type = PROPERTY_YESNO, .life = LIFE_VOLATILE,
	 .access = ACCESS_WRITE, .write = write_test_mode},
	FLAG("por", LIFE_STABLE, ACCESS_BOTH, CONTROL_POR, write_flag),
	FLAG("power", LIFE_VOLATILE, ACCESS_READ, CONTROL_VCC, NULL),
	BITS("sensed", LIFE_VOLATILE, ACCESS_READ, PIN, NULL),
	{.name = "set_alarm", .type = PROPERTY_UNSIGNED, .life = LIFE_STABLE, .access = ACCESS_BOTH,
	 .digits = "333333333", .read = read_alarm, .write = write_alarm},
	FLAG("strobe", LIFE_STABLE, ACCESS_BOTH, CONTROL_STROBE, write_flag),
};
/* clang-format on */

const struct family family_29 = {
	.code = 0x29,
	.alarms = true,
	.type = "DS2408",
	PROPERTIES(properties),
};
