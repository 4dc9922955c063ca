/* SPDX-License-Identifier: MIT */
/* DS2450 (data sheet 19-5125): four A/D converters whose pins are switches too. */
#include <errno.h>
#include <string.h>

#include "hal/native/crc.h"
#include "hal/native/ds2450.h"
#include "hal/native/family.h"

#define READ_MEMORY 0xaa
#define WRITE_MEMORY 0x55

enum { RESULTS, CONTROL, LIMITS, CALIBRATION }; /* pages of 8 bytes */
#define SUPPLY_AT 0x1c
#define SUPPLY_ON 0x40

/* First control byte of a channel: resolution, output. Second: range, alarms. */
#define OUTPUT_OFF 0x40
#define OUTPUT_ENABLE 0x80
#define RANGE_HIGH 0x01
#define ENABLE_LOW 0x04
#define ENABLE_HIGH 0x08
#define FLAG_LOW 0x10
#define FLAG_HIGH 0x20
#define POR 0x80

/* arg of the voltages. */
#define EIGHT_BIT 1
#define HALF_RANGE 2
#define HIGH_LIMIT 4

/* note[0]: no channel's power-on flag is set. */

static bool power_on_flags(const uint8_t control[8])
{
	return (control[1] | control[3] | control[5] | control[7]) & POR;
}

static int read_page(struct txn *txn, unsigned page, uint8_t bytes[8])
{
	uint8_t command[] = {READ_MEMORY, (uint8_t)(page * 8), 0x00};
	struct device *device = txn->device;
	int err = txn_command(txn, command, sizeof(command));

	if (!err)
		err = txn_read_crc16(txn, command, sizeof(command), bytes, 8);
	if (err || page != CONTROL)
		return err;
	if (power_on_flags(bytes) && device->note[0])
		txn->restarted = true;
	device->note[0] = !power_on_flags(bytes);
	return 0;
}

static int write_byte(struct txn *txn, unsigned address, uint8_t byte)
{
	uint8_t command[] = {WRITE_MEMORY, (uint8_t)address, 0x00, byte}, in[3];
	int err = txn_command(txn, command, sizeof(command));

	if (!err)
		err = txn_read(txn, in, sizeof(in));
	if (err)
		return err;
	if (!onewire_crc16_matches(onewire_crc16(0, command, sizeof(command)), in))
		return -EBADMSG;
	return in[2] == byte ? 0 : -EIO;
}

/*
 * Make bytes of a page as wanted, one per call; 0 when all are. mem[0]: the page was read,
 * mem[8..15]: what it holds.
 */
static int make_page(struct txn *txn, unsigned page, const uint8_t want[8])
{
	uint8_t *have = txn->mem + 8;

	for (unsigned i = 0; i < 8; i++) {
		if (have[i] == want[i])
			continue;
		int err = write_byte(txn, page * 8 + i, want[i]);
		have[i] = want[i];
		if (page == CONTROL && !err)
			txn->device->note[0] = !power_on_flags(have);
		return err ? err : TXN_MORE;
	}
	return 0;
}

/* Settings that are written end what the power-on flags tell. */
static int make_control(struct txn *txn, uint8_t want[8])
{
	for (int i = 1; i < 8; i += 2)
		want[i] = (uint8_t)(want[i] & ~POR);
	return make_page(txn, CONTROL, want);
}

static int load_page(struct txn *txn, unsigned page)
{
	if (txn->mem[0])
		return 0;
	int err = read_page(txn, page, txn->mem + 8);
	txn->mem[0] = 1;
	return err ? err : TXN_MORE;
}

/* Results are fractions of the range; limits are steps of 20 or 10 mV. */
static double volts(unsigned raw, int arg)
{
	return raw * (arg & HALF_RANGE ? 2.56 : 5.12) / 65535;
}

static double limit_unit(int arg)
{
	return arg & HALF_RANGE ? 0.01 : 0.02;
}

static int take_results(struct txn *txn)
{
	uint8_t bytes[8];
	int err = read_page(txn, RESULTS, bytes);

	if (err)
		return err;
	for (int i = 0; i < 4; i++)
		txn->number[i] = volts(bytes[2 * i] | (unsigned)bytes[2 * i + 1] << 8,
		                       txn->property->arg);
	return 0;
}

/* The power-on flags, too, bring a device into the alarm search: a visit looks at them. */
static int read_latest(struct txn *txn)
{
	uint8_t bytes[8];

	if (!txn->visit || txn->phase)
		return take_results(txn);
	int err = read_page(txn, CONTROL, bytes);
	txn->phase = 1;
	return err ? err : TXN_MORE;
}

static int start_conversion(struct txn *txn, bool powered)
{
	static const uint8_t command[] = {DS2450_CONVERT, 0x0f, 0x00};
	uint8_t none;
	int err = txn_command(txn, command, sizeof(command));

	if (!err)
		err = txn_read_crc16(txn, command, sizeof(command), &none, 0);
	if (err)
		return err;
	if (powered)
		return txn_wait(txn, DS2450_CONVERT_NS);
	/* The CRC's last slot is over: the pull-up is armed with one more. */
	return txn_bit_strong(txn, DS2450_CONVERT_NS);
}

static int convert(struct txn *txn, int arg)
{
	uint8_t want[8];
	int err;

	switch (txn->phase) {
	case 0:
		err = load_page(txn, CALIBRATION);
		if (err)
			return err;
		txn->mem[1] = txn->mem[8 + SUPPLY_AT % 8] == SUPPLY_ON;
		txn->mem[0] = 0;
		txn->phase = 1;
		return TXN_MORE;
	case 1:
		err = load_page(txn, CONTROL);
		if (err)
			return err;
		for (int i = 0; i < 8; i += 2) {
			want[i] = arg & EIGHT_BIT ? 8 : 0;
			want[i + 1] = (uint8_t)((txn->mem[8 + i + 1] & ~RANGE_HIGH) |
			                        (arg & HALF_RANGE ? 0 : RANGE_HIGH));
		}
		err = make_control(txn, want);
		if (err)
			return err;
		txn->phase = 2;
		return TXN_MORE;
	case 2:
		txn->phase = 3;
		return start_conversion(txn, txn->mem[1]);
	default:
		return take_results(txn);
	}
}

static int read_volt(struct txn *txn)
{
	return convert(txn, txn->property->arg);
}

/* arg: the byte of the channel's two, and the bit. */
#define AT(byte, bit) ((byte) << 8 | (bit))

static int read_bit(struct txn *txn)
{
	uint8_t bytes[8];
	int err = read_page(txn, CONTROL, bytes);
	int byte = bytes[2 * txn->element + (txn->property->arg >> 8)];

	txn->number[0] = (byte & txn->property->arg & 0xff) != 0;
	return err;
}

static int write_bit(struct txn *txn)
{
	uint8_t want[8], bit = (uint8_t)txn->property->arg;
	int err = load_page(txn, CONTROL), at = 2 * txn->element + (txn->property->arg >> 8);

	if (err)
		return err;
	memcpy(want, txn->mem + 8, 8);
	want[at] = (uint8_t)(txn->number[0] != 0 ? want[at] | bit : want[at] & ~bit);
	return make_control(txn, want);
}

/* As owserver has it, and against its manual: 0 conducts, 1 does not, enabled or not. */
static int read_pio(struct txn *txn)
{
	uint8_t bytes[8];
	int err = read_page(txn, CONTROL, bytes);

	txn->number[0] = (bytes[2 * txn->element] & (OUTPUT_ENABLE | OUTPUT_OFF)) != OUTPUT_ENABLE;
	return err;
}

static int write_pio(struct txn *txn)
{
	uint8_t want[8];
	int err = load_page(txn, CONTROL), at = 2 * txn->element;

	if (err)
		return err;
	memcpy(want, txn->mem + 8, 8);
	want[at] = (uint8_t)((want[at] & 0x0f) | OUTPUT_ENABLE |
	                     (txn->number[0] != 0 ? OUTPUT_OFF : 0));
	return make_control(txn, want);
}

/* The power-on flags of all channels. */
static int write_unset(struct txn *txn)
{
	uint8_t want[8];
	int err = load_page(txn, CONTROL);

	if (err)
		return err;
	memcpy(want, txn->mem + 8, 8);
	for (int i = 1; i < 8; i += 2)
		want[i] = (uint8_t)(txn->number[0] != 0 ? want[i] | POR : want[i] & ~POR);
	return make_page(txn, CONTROL, want);
}

static int read_limit(struct txn *txn)
{
	uint8_t bytes[8];
	int err = read_page(txn, LIMITS, bytes);
	int at = 2 * txn->element + (txn->property->arg & HIGH_LIMIT ? 1 : 0);

	txn->number[0] = bytes[at] * limit_unit(txn->property->arg);
	return err;
}

static int write_limit(struct txn *txn)
{
	double unit = limit_unit(txn->property->arg), steps = txn->number[0] / unit + 0.5;
	int at = 2 * txn->element + (txn->property->arg & HIGH_LIMIT ? 1 : 0);
	uint8_t want[8];
	int err;

	if (!(steps >= 0 && steps < 256))
		return -EINVAL;
	err = load_page(txn, LIMITS);
	if (err)
		return err;
	memcpy(want, txn->mem + 8, 8);
	want[at] = (uint8_t)steps;
	return make_page(txn, LIMITS, want);
}

static int read_power(struct txn *txn)
{
	uint8_t bytes[8];
	int err = read_page(txn, CALIBRATION, bytes);

	if (!err)
		txn->number[0] = bytes[SUPPLY_AT % 8] == SUPPLY_ON;
	return err;
}

static int write_power(struct txn *txn)
{
	return write_byte(txn, SUPPLY_AT, txn->number[0] != 0 ? SUPPLY_ON : 0);
}

static int get_page(struct txn *txn)
{
	txn->len = 8;
	return read_page(txn, (unsigned)txn->element, txn->data);
}

static int put_page(struct txn *txn)
{
	uint8_t want[8];
	int err = load_page(txn, (unsigned)txn->element);

	if (err)
		return err;
	memcpy(want, txn->mem + 8, 8);
	memcpy(want + txn->at, txn->data, txn->len);
	return make_page(txn, (unsigned)txn->element, want);
}

static int get_memory(struct txn *txn)
{
	int err = read_page(txn, txn->phase, txn->data + 8 * txn->phase);

	if (err)
		return err;
	txn->len = 32;
	return ++txn->phase == 4 ? 0 : TXN_MORE;
}

/* phase: pages done. */
static int put_memory(struct txn *txn)
{
	size_t end = txn->at + txn->len, first = txn->at / 8 * 8, page = first + 8 * txn->phase;
	size_t from = page < txn->at ? txn->at : page, to = page + 8 < end ? page + 8 : end;
	uint8_t want[8];

	if (txn->len == 0)
		return 0;
	int err = load_page(txn, (unsigned)page / 8);
	if (err)
		return err;
	memcpy(want, txn->mem + 8, 8);
	memcpy(want + (from - page), txn->data + (from - txn->at), to - from);
	err = make_page(txn, (unsigned)page / 8, want);
	if (err)
		return err;
	txn->mem[0] = 0;
	txn->phase++;
	return to == end ? 0 : TXN_MORE;
}

/* A K30 sensor on a DS2450: A has 1 V per 1000 ppm, B is its reference of 3.2 V, D its supply. */
enum { CO2_PPM, CO2_STATUS, CO2_SUPPLY };

static int read_co2(struct txn *txn)
{
	int err = convert(txn, 0);

	if (err)
		return err;
	switch (txn->property->arg) {
	case CO2_PPM << 8:
		txn->number[0] = (double)(unsigned)(txn->number[0] * 1000);
		break;
	case CO2_STATUS << 8:
		txn->number[0] = txn->number[1] > 3.0 && txn->number[1] < 3.4;
		break;
	default:
		txn->number[0] = txn->number[3] > 4.5;
	}
	return 0;
}

#define VOLT(text, how, reads)                                                            \
	{.name = (text), .type = PROPERTY_FLOAT, .life = LIFE_VOLATILE, .access = ACCESS_READ, \
	 .array = {4, INDEX_LETTERS, true}, .arg = (how), .read = (reads)}
#define FLAG(text, life_, bit)                                                            \
	{.name = (text), .type = PROPERTY_YESNO, .life = (life_), .access = ACCESS_BOTH,    \
	 .array = {4, INDEX_LETTERS, false}, .arg = (bit), .read = read_bit, .write = write_bit}
#define LIMIT(text, how)                                                                  \
	{.name = (text), .type = PROPERTY_FLOAT, .life = LIFE_STABLE, .access = ACCESS_BOTH, \
	 .array = {4, INDEX_LETTERS, false}, .arg = (how), .read = read_limit,              \
	 .write = write_limit}
#define CO2(text, kind, what)                                                             \
	{.name = (text), .type = (kind), .life = LIFE_VOLATILE, .access = ACCESS_READ,      \
	 .arg = (what) << 8, .read = read_co2}

static const struct property properties[] = {
	PROPERTY_DIR("8bit"),
	VOLT("8bit/latestvolt", EIGHT_BIT, read_latest),
	VOLT("8bit/latestvolt2", EIGHT_BIT | HALF_RANGE, read_latest),
	VOLT("8bit/volt", EIGHT_BIT, read_volt),
	VOLT("8bit/volt2", EIGHT_BIT | HALF_RANGE, read_volt),
	PROPERTY_DIR("CO2"),
	CO2("CO2/Vdd", PROPERTY_YESNO, CO2_SUPPLY),
	CO2("CO2/ppm", PROPERTY_UNSIGNED, CO2_PPM),
	CO2("CO2/status", PROPERTY_FLOAT, CO2_STATUS),
	{.name = "PIO", .type = PROPERTY_YESNO, .life = LIFE_STABLE, .access = ACCESS_BOTH,
	 .array = {4, INDEX_LETTERS, false}, .read = read_pio, .write = write_pio},
	PROPERTY_DIR("alarm"),
	FLAG("alarm/high", LIFE_VOLATILE, AT(1, FLAG_HIGH)),
	FLAG("alarm/low", LIFE_VOLATILE, AT(1, FLAG_LOW)),
	VOLT("latestvolt", 0, read_latest),
	VOLT("latestvolt2", HALF_RANGE, read_latest),
	{.name = "memory", .type = PROPERTY_BINARY, .life = LIFE_VOLATILE, .access = ACCESS_BOTH,
	 .size = 32, .read = get_memory, .write = put_memory},
	PROPERTY_DIR("pages"),
	{.name = "pages/page", .type = PROPERTY_BINARY, .life = LIFE_VOLATILE,
	 .access = ACCESS_BOTH, .array = {4, INDEX_NUMBERS, false}, .size = 8, .read = get_page,
	 .write = put_page},
	{.name = "power", .type = PROPERTY_YESNO, .life = LIFE_STABLE, .access = ACCESS_BOTH,
	 .read = read_power, .write = write_power},
	PROPERTY_DIR("set_alarm"),
	FLAG("set_alarm/high", LIFE_STABLE, AT(1, ENABLE_HIGH)),
	FLAG("set_alarm/low", LIFE_STABLE, AT(1, ENABLE_LOW)),
	{.name = "set_alarm/unset", .type = PROPERTY_YESNO, .life = LIFE_STABLE,
	 .access = ACCESS_WRITE, .write = write_unset},
	LIMIT("set_alarm/volt2high", HALF_RANGE | HIGH_LIMIT),
	LIMIT("set_alarm/volt2low", HALF_RANGE),
	LIMIT("set_alarm/volthigh", HIGH_LIMIT),
	LIMIT("set_alarm/voltlow", 0),
	VOLT("volt", 0, read_volt),
	VOLT("volt2", HALF_RANGE, read_volt),
};

const struct family family_20 = {
	.code = 0x20, .alarms = true, .type = "DS2450", PROPERTIES(properties),
};
