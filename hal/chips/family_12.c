/* SPDX-License-Identifier: MIT */
/* DS2406 and DS2407 (data sheet 19-6076): one or two switches, and 1 kbit of EPROM. */
#include <errno.h>

#include "hal/chips/memory.h"
#include "hal/wire/crc.h"

#define READ_STATUS 0xaa
#define WRITE_STATUS 0x55
#define CHANNEL_ACCESS 0xf5
/* Channel control: read, channel A, CRC16 behind each byte; and the latches' reset. */
#define ACCESS_READ_A 0x45
#define ACCESS_RESET_LATCHES 0x80

#define INFO_TWO_CHANNELS 0x40
#define INFO_SUPPLY 0x80
#define STATUS 7            /* the byte, and which registers it is for txn_base() */
#define STATUS_OUTPUTS 0x60 /* 1: does not conduct */

static const struct chip_memory memory = {.size = 128, .page = 32};

static bool is_checked(const uint8_t command[3], const uint8_t in[4])
{
	return onewire_crc16_matches(onewire_crc16(onewire_crc16(0, command, 3), in, 2), in + 2);
}

static int channel_info(struct txn *txn, uint8_t control, uint8_t *info)
{
	uint8_t command[] = {CHANNEL_ACCESS, control, 0xff}, in[4];
	struct device *device = txn->device;
	int err = txn_command(txn, command, sizeof(command));

	if (!err)
		err = txn_read(txn, in, sizeof(in));
	if (!err && !is_checked(command, in)) {
		/* That it was told to clear its latches: this is what they were. */
		command[1] ^= ACCESS_RESET_LATCHES;
		if ((control & ACCESS_RESET_LATCHES) || !is_checked(command, in))
			err = -EBADMSG;
	}
	if (err)
		return err;
	*info = in[0];
	if (device->shadow_known && device->shadow != (in[0] & 3))
		txn->restarted = true;
	device->shadow = in[0] & 3;
	device->shadow_known = true;
	return 0;
}

static int read_info_bits(struct txn *txn)
{
	uint8_t info = 0;
	int err = channel_info(txn, ACCESS_READ_A, &info);

	txn->bits = info >> txn->property->arg & 3;
	return err;
}

static int read_pio(struct txn *txn)
{
	int err = read_info_bits(txn);

	txn->bits ^= 3;
	return err;
}

static int read_info(struct txn *txn)
{
	uint8_t info = 0;
	int err = channel_info(txn, ACCESS_READ_A, &info);

	txn->number[0] = info;
	return err;
}

static int read_channels(struct txn *txn)
{
	int err = read_info(txn);

	txn->number[0] = (unsigned)txn->number[0] & INFO_TWO_CHANNELS ? 2 : 1;
	return err;
}

static int read_power(struct txn *txn)
{
	int err = read_info(txn);

	txn->number[0] = ((unsigned)txn->number[0] & INFO_SUPPLY) != 0;
	return err;
}

static int write_latch(struct txn *txn)
{
	uint8_t info;

	return channel_info(txn, ACCESS_READ_A | ACCESS_RESET_LATCHES, &info);
}

static int read_status(struct txn *txn, uint8_t *status)
{
	uint8_t command[] = {READ_STATUS, 0x07, 0x00};
	int err = txn_command(txn, command, sizeof(command));

	return err ? err : txn_read_crc16(txn, command, sizeof(command), status, 1);
}

/* Change the status byte's bits of mask: read, write, read back. */
static int change_status(struct txn *txn, uint8_t mask, uint8_t bits)
{
	uint8_t command[] = {WRITE_STATUS, 0x07, 0x00, 0}, status = 0;
	int err;

	switch (txn->phase++) {
	case 0:
		err = read_status(txn, &status);
		if (err)
			return err;
		txn_base(txn, STATUS, &status, 1);
		txn_keep(txn, STATUS, &status, 1);
		txn->mem[0] = (uint8_t)((status & ~mask) | bits) & 0x7f;
		return TXN_MORE;
	case 1:
		txn->device->shadow_known = false;
		command[3] = txn->mem[0];
		err = txn_command(txn, command, sizeof(command));
		if (!err)
			err = txn_read_crc16(txn, command, sizeof(command), &status, 0);
		/* Eight slots more make it take effect. */
		if (!err)
			err = txn_read(txn, &status, 1);
		return err ? err : TXN_MORE;
	default:
		err = read_status(txn, &status);
		if (err)
			return err;
		if ((status & 0x7f) != txn->mem[0])
			return -EIO;
		txn_changed(txn);
		return 0;
	}
}

/* The outputs ahead of a change of one: not those that a change that failed has left. */
static int merge_pio(struct txn *txn)
{
	uint8_t status = 0;
	int err = read_status(txn, &status);

	if (!err)
		txn_base(txn, STATUS, &status, 1);
	txn->bits = (uint32_t)(~status >> 5 & 3);
	return err;
}

static int write_pio(struct txn *txn)
{
	return change_status(txn, STATUS_OUTPUTS, (uint8_t)((~txn->bits & 3) << 5));
}

/* Three digits: channels, source, polarity. */
static int read_alarm(struct txn *txn)
{
	uint8_t status = 0;
	int err = read_status(txn, &status);

	txn->number[0] = (status >> 3 & 3) * 100 + (status >> 1 & 3) * 10 + (status & 1);
	return err;
}

static int write_alarm(struct txn *txn)
{
	unsigned digits = (unsigned)txn->number[0];

	return change_status(txn, 0x1f,
	                     (uint8_t)((digits / 100 & 3) << 3 | (digits / 10 % 10 & 3) << 1 |
	                               (digits % 10 & 1)));
}

/* EPROM takes pulses of 12 V, which no master here gives. */
static int refuse(struct txn *txn)
{
	(void)txn;
	return -EOPNOTSUPP;
}

/* The boards TAI8570 and T8A: not part of one, as far as can be told. */
static int not_there(struct txn *txn)
{
	(void)txn;
	return -ENOENT;
}

static bool never(const struct device *device)
{
	(void)device;
	return false;
}

/* clang-format off */
#define BITS(text, life_, access_, shift, reads, writes)                                  \
	{.name = (text), .type = PROPERTY_BITS, .life = (life_), .access = (access_),       \
	 .array = {2, INDEX_LETTERS, true}, .arg = (shift), .read = (reads), .write = (writes)}
#define NUMBER(text, kind, life_, reads)                                                  \
	{.name = (text), .type = (kind), .life = (life_), .access = ACCESS_READ, .read = (reads)}

static const struct property properties[] = {
	{.name = "PIO", .type = PROPERTY_BITS, .life = LIFE_STABLE, .access = ACCESS_BOTH,
	 .array = {2, INDEX_LETTERS, true}, .read = read_pio, .write = write_pio,
	 .merge = merge_pio},
	{.name = "T8A", .type = PROPERTY_DIRECTORY, .life = LIFE_STATIC, .visible = never},
	{.name = "T8A/volt", .type = PROPERTY_FLOAT, .life = LIFE_VOLATILE, .access = ACCESS_READ,
	 .array = {8, INDEX_NUMBERS, false}, .visible = never, .read = not_there},
	PROPERTY_DIR("TAI8570"),
	{.name = "TAI8570/C", .type = PROPERTY_UNSIGNED, .life = LIFE_STATIC, .hidden = true,
	 .access = ACCESS_READ, .array = {6, INDEX_NUMBERS, true}, .read = not_there},
	{.name = "TAI8570/D1", .type = PROPERTY_UNSIGNED, .life = LIFE_VOLATILE, .hidden = true,
	 .access = ACCESS_READ, .read = not_there},
	{.name = "TAI8570/D2", .type = PROPERTY_UNSIGNED, .life = LIFE_VOLATILE, .hidden = true,
	 .access = ACCESS_READ, .read = not_there},
	PROPERTY_DIR("TAI8570/DA5534"),
	NUMBER("TAI8570/DA5534/pressure", PROPERTY_PRESSURE, LIFE_VOLATILE, not_there),
	NUMBER("TAI8570/DA5534/temperature", PROPERTY_TEMPERATURE, LIFE_VOLATILE, not_there),
	PROPERTY_DIR("TAI8570/DA5540"),
	NUMBER("TAI8570/DA5540/pressure", PROPERTY_PRESSURE, LIFE_VOLATILE, not_there),
	NUMBER("TAI8570/DA5540/temperature", PROPERTY_TEMPERATURE, LIFE_VOLATILE, not_there),
	NUMBER("TAI8570/pressure", PROPERTY_PRESSURE, LIFE_VOLATILE, not_there),
	{.name = "TAI8570/sibling", .type = PROPERTY_ASCII, .life = LIFE_STABLE,
	 .access = ACCESS_READ, .size = 16, .read = not_there},
	NUMBER("TAI8570/temperature", PROPERTY_TEMPERATURE, LIFE_VOLATILE, not_there),
	{.name = "aux", .type = PROPERTY_DIRECTORY, .life = LIFE_VOLATILE, .size = 8},
	NUMBER("channels", PROPERTY_UNSIGNED, LIFE_STABLE, read_channels),
	BITS("flipflop", LIFE_VOLATILE, ACCESS_READ, 0, read_info_bits, NULL),
	{.name = "infobyte", .type = PROPERTY_UNSIGNED, .life = LIFE_VOLATILE, .hidden = true,
	 .access = ACCESS_READ, .read = read_info},
	BITS("latch", LIFE_VOLATILE, ACCESS_BOTH, 4, read_info_bits, write_latch),
	MEMORY_WHOLE(128, refuse),
	MEMORY_PAGES(4, 32, refuse),
	NUMBER("power", PROPERTY_YESNO, LIFE_VOLATILE, read_power),
	BITS("sensed", LIFE_VOLATILE, ACCESS_READ, 2, read_info_bits, NULL),
	{.name = "set_alarm", .type = PROPERTY_UNSIGNED, .life = LIFE_STABLE, .access = ACCESS_BOTH,
	 .digits = "331", .read = read_alarm, .write = write_alarm},
};
/* clang-format on */

const struct family family_12 = {
	.code = 0x12,
	.alarms = true,
	.type = "DS2406",
	.memory = &memory,
	PROPERTIES(properties),
};
