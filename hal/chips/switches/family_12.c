/* SPDX-License-Identifier: MIT */
/*
 * DS2406 and DS2407 (data sheet 19-6076): one or two switches, and 1 kbit of EPROM.
 *
 * Channel Access and Write Status have a CRC16; what is written is read back, and a write that
 * failed is made again from what stood before it. A disturbed command can clear the latches: then
 * they are lost.
 */
#include <errno.h>

#include "hal/chips/family.h"
#include "hal/wire/crc.h"

#define CHANNEL_ACCESS 0xf5
/* Channel control: read, channel A, CRC16 behind each byte; and the latches' reset. */
#define ACCESS_READ_A 0x45
#define ACCESS_RESET_LATCHES 0x80

#define STATUS_SUPPLY 0x80 /* is no setting */

static bool is_checked(const uint8_t command[3], const uint8_t in[4])
{
	return onewire_crc16_matches(onewire_crc16(onewire_crc16(0, command, 3), in, 2), in + 2);
}

static int channel_info(struct txn *txn, uint8_t control, uint8_t *info)
{
	uint8_t command[] = {CHANNEL_ACCESS, control, 0xff}, in[4];
	int err = txn_ask(txn, command, sizeof(command), in, sizeof(in));

	if (!err && !is_checked(command, in)) {
		/* That it was told to clear its latches: this is what they were. */
		command[1] ^= ACCESS_RESET_LATCHES;
		if ((control & ACCESS_RESET_LATCHES) || !is_checked(command, in))
			err = txn_checked(txn, false);
	}
	if (!err)
		*info = in[0];
	return err;
}

static int load_info(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                     unsigned n)
{
	(void)area, (void)at, (void)n;
	return channel_info(txn, ACCESS_READ_A, bytes);
}

static int write_latch(struct txn *txn)
{
	uint8_t info;

	return channel_info(txn, ACCESS_READ_A | ACCESS_RESET_LATCHES, &info);
}

/* EPROM takes pulses of 12 V, which no master here gives: it has no row. */
static AREA_NAMED(memory, "memory", .size = 128, .address_bytes = 2, .read = 0xf0);
static AREA_NAMED(info, "info", .size = 1, .load = load_info);
static AREA_NAMED(status, "status", .at = 7, .size = 1, .address_bytes = 2, .read = 0xaa,
                  .block = 1, .check = AREA_CRC16, .counts = (uint8_t)~STATUS_SUPPLY, .row = 1,
                  .write = 0x55, .write_crc16 = true, .hidden = true);

/* Three digits: channels, source, polarity. */
static int read_alarm(struct txn *txn)
{
	uint8_t byte = 0;
	int err = area_read(txn, &status, 0, &byte, 1);

	txn->number[0] = (byte >> 3 & 3) * 100 + (byte >> 1 & 3) * 10 + (byte & 1);
	return err;
}

static int write_alarm(struct txn *txn)
{
	unsigned digits = (unsigned)txn->number[0];
	uint8_t byte = (uint8_t)((digits / 100 & 3) << 3 | (digits / 10 % 10 & 3) << 1 |
	                         (digits % 10 & 1));

	return area_write(txn, &status, 0, &byte, TXN_BYTES(0x1f));
}

/* The boards TAI8570 and T8A: not part of one, as far as can be told. */
static int not_there(struct txn *txn)
{
	(void)txn;
	return -ENOENT;
}

enum { MEMORY = 1, INFO, STATUS };
static const struct area *const areas[] = {[MEMORY] = &memory, [INFO] = &info, [STATUS] = &status};

enum { WAY_PIO = 1, WAY_LATCH, WAY_ALARM, WAY_NOT_THERE };
static const struct property_how how[] = {
	[WAY_PIO] = {SET(STATUS, .shift = 5, .inverted = true)},
	[WAY_LATCH] = {.write = write_latch},
	[WAY_ALARM] = {.read = read_alarm, .write = write_alarm},
	[WAY_NOT_THERE] = {.read = not_there},
};

#define BITS(text, access_, shift_, how_, alarm_) \
	PROPERTY(text, BITS, VOLATILE, access_, AGGREGATE(2, LETTERS), \
	         FIELD(INFO, .shift = (shift_)), .how = (how_), .alarm = (alarm_))
#define NOT_THERE(text, kind, life_, ...) \
	PROPERTY(text, kind, life_, READ, .how = WAY_NOT_THERE, __VA_ARGS__)
/* 10 to 1100 mbar within 15, -40 to +125 */
#define MS5534_PRESSURE MEASURES(-5, 1115, 2, "mbar")
#define MS5534_CELSIUS MEASURES(-42, 127, 2, DEGREES_C)

static const struct property properties[] = {
	PROPERTY("PIO", BITS, STABLE, BOTH, AGGREGATE(2, LETTERS), FIELD(INFO, .inverted = true),
                 .holds = true, .how = WAY_PIO),
	PROPERTY("T8A", DIRECTORY, STATIC, NONE, .kinds = KIND(0)),
	NOT_THERE("T8A/volt", FLOAT, VOLATILE, ELEMENTS(8, NUMBERS), IN_UNIT("V"),
                  .kinds = KIND(0)),
	PROPERTY_DIR("TAI8570"),
	NOT_THERE("TAI8570/C", UNSIGNED, STATIC, AGGREGATE(6, NUMBERS), .hidden = true),
	NOT_THERE("TAI8570/D1", UNSIGNED, VOLATILE, .hidden = true),
	NOT_THERE("TAI8570/D2", UNSIGNED, VOLATILE, .hidden = true),
	PROPERTY_DIR("TAI8570/DA5534"),
	NOT_THERE("TAI8570/DA5534/pressure", PRESSURE, VOLATILE, MS5534_PRESSURE),
	NOT_THERE("TAI8570/DA5534/temperature", TEMPERATURE, VOLATILE, MS5534_CELSIUS),
	PROPERTY_DIR("TAI8570/DA5540"),
	NOT_THERE("TAI8570/DA5540/pressure", PRESSURE, VOLATILE, MS5534_PRESSURE),
	NOT_THERE("TAI8570/DA5540/temperature", TEMPERATURE, VOLATILE, MS5534_CELSIUS),
	NOT_THERE("TAI8570/pressure", PRESSURE, VOLATILE, MS5534_PRESSURE),
	NOT_THERE("TAI8570/sibling", ASCII, STABLE, .size = 16),
	NOT_THERE("TAI8570/temperature", TEMPERATURE, VOLATILE, MS5534_CELSIUS),
	PROPERTY_BRANCH("aux", .arg = 0),
	PROPERTY("channels", UNSIGNED, STABLE, READ,
                 FIELD(INFO, .shift = 6, .bits = 1, .offset = 1)),
	BITS("flipflop", READ, 0, 0, 0),
	PROPERTY("infobyte", UNSIGNED, VOLATILE, READ, FIELD(INFO), .hidden = true),
	BITS("latch", BOTH, 4, WAY_LATCH, ALARM_LATCH | ALARM_STAYS | ALARM_CLEARS),
	AREA_MEMORY(MEMORY, 128),
	PROPERTY_DIR("pages"),
	AREA_PAGES(MEMORY, 4, 32),
	PROPERTY("power", YESNO, VOLATILE, READ, FIELD(INFO, .shift = 7)),
	BITS("sensed", READ, 2, 0, ALARM_LATCH),
	PROPERTY("set_alarm", UNSIGNED, STABLE, BOTH, .digits = 331, .how = WAY_ALARM),
};

CHIP_FAMILY(12, "DS2406", PRESENCE, .alarms = true, .latches = true, .flags = FLAG_ALARM,
            SCAN({"sensed.BYTE", "inputs"}, {"PIO.BYTE", "outputs"}), AREAS(areas), HOW(how),
            PROPERTIES(properties));
