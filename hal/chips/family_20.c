/* SPDX-License-Identifier: MIT */
/* DS2450 (data sheet 19-5125): four A/D converters whose pins are switches too. */
#include <errno.h>
#include <string.h>

#include "hal/chips/ds2450.h"
#include "hal/chips/family.h"
#include "hal/wire/crc.h"

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

static void look_for_restart(struct txn *txn, const uint8_t control[8])
{
	struct device *device = txn->device;

	/* A disturbed write can set a flag as well. */
	if (power_on_flags(control) && device->note[0] && !device->base_of)
		txn->restarted = true;
	device->note[0] = !power_on_flags(control);
}

/*
 * n pages in one transaction: a chip that restarts meanwhile is silent from there on, so all of
 * them are of the time between two restarts.
 */
static int read_pages(struct txn *txn, unsigned page, uint8_t *bytes, unsigned n)
{
	uint8_t command[] = {READ_MEMORY, (uint8_t)(page * 8), 0x00};
	int err = txn_command(txn, command, sizeof(command));

	if (!err)
		err = txn_read_pages(txn, command, sizeof(command), bytes, 8, n);
	if (!err && page <= CONTROL && page + n > CONTROL)
		look_for_restart(txn, bytes + 8 * (CONTROL - page));
	return err;
}

static int read_page(struct txn *txn, unsigned page, uint8_t bytes[8])
{
	return read_pages(txn, page, bytes, 1);
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
 * The registers that can be written: the pages from CONTROL on. A disturbed write may reach any of
 * them, so all are looked at before one is changed. mem[0]: how many pages have been read,
 * mem[8..31]: what they hold, mem[32..55]: what they are to hold where no change is wanted.
 */
#define REGISTERS 24
#define HAVE 8
#define WANT 32

static int load(struct txn *txn)
{
	unsigned n = txn->mem[0];

	if (n == REGISTERS / 8)
		return 0;
	int err = read_page(txn, CONTROL + n, txn->mem + HAVE + 8 * n);
	if (err)
		return err;
	memcpy(txn->mem + WANT + 8 * n, txn->mem + HAVE + 8 * n, 8);
	if (++txn->mem[0] == REGISTERS / 8)
		txn_base(txn, txn->device->family, txn->mem + WANT, REGISTERS);
	return TXN_MORE;
}

/* What page is to hold. */
static uint8_t *wanted(struct txn *txn, unsigned page)
{
	return txn->mem + WANT + 8 * (page - CONTROL);
}

/* Make the registers as wanted, a byte per call; 0 when all are. */
static int make(struct txn *txn)
{
	uint8_t *have = txn->mem + HAVE, *want = txn->mem + WANT;

	for (unsigned i = 0; i < REGISTERS; i++) {
		if (have[i] == want[i])
			continue;
		txn_keep(txn, txn->device->family, have, REGISTERS);
		int err = write_byte(txn, CONTROL * 8 + i, want[i]);
		have[i] = want[i];
		if (!err)
			txn->device->note[0] = !power_on_flags(have);
		return err ? err : TXN_MORE;
	}
	txn_changed(txn);
	return 0;
}

/* Settings that are written end what the power-on flags tell. */
static int make_control(struct txn *txn)
{
	uint8_t *want = wanted(txn, CONTROL);

	for (int i = 1; i < 8; i += 2)
		want[i] = (uint8_t)(want[i] & ~POR);
	return make(txn);
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

/* control: as it was when the results were. A restart leaves zeros as results. */
static int take_results(struct txn *txn, uint8_t control[8])
{
	uint8_t bytes[16];
	int err = read_pages(txn, RESULTS, bytes, 2);

	if (err || power_on_flags(bytes + 8))
		return err ? err : -EIO;
	memcpy(control, bytes + 8, 8);
	for (int i = 0; i < 4; i++)
		txn->number[i] = volts(bytes[2 * i] | (unsigned)bytes[2 * i + 1] << 8,
		                       txn->property->arg);
	return 0;
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

/* An enabled output stays as it is: a measurement switches nothing. */
static void want_conversion(uint8_t control[8], int arg)
{
	for (int i = 0; i < 8; i += 2) {
		control[i] = (uint8_t)((control[i] & (OUTPUT_ENABLE | OUTPUT_OFF)) |
		                       (arg & EIGHT_BIT ? 8 : 0));
		control[i + 1] = (uint8_t)((control[i + 1] & ~(RANGE_HIGH | POR)) |
		                           (arg & HALF_RANGE ? 0 : RANGE_HIGH));
	}
}

/* A restart since the settings were made sets the power-on flags, or the settings are others. */
static int take_converted(struct txn *txn, int arg)
{
	uint8_t control[8], want[8];
	int err = take_results(txn, control);

	if (err)
		return err;
	memcpy(want, control, 8);
	want_conversion(want, arg);
	return memcmp(want, control, 8) == 0 ? 0 : -EIO;
}

static int convert(struct txn *txn, int arg)
{
	uint8_t bytes[8], want[8];
	int err;

	switch (txn->phase) {
	case 0:
		err = read_page(txn, CALIBRATION, bytes);
		if (err)
			return err;
		txn->mem[1] = bytes[SUPPLY_AT % 8] == SUPPLY_ON;
		txn->phase = 1;
		return TXN_MORE;
	case 1:
		err = read_page(txn, CONTROL, bytes);
		if (err)
			return err;
		memcpy(want, bytes, 8);
		want_conversion(want, arg);
		txn->phase = memcmp(want, bytes, 8) == 0 && !txn->device->base_of ? 3 : 2;
		return TXN_MORE;
	case 2:
		err = load(txn);
		if (err)
			return err;
		want_conversion(wanted(txn, CONTROL), arg);
		err = make_control(txn);
		if (err)
			return err;
		txn->phase = 3;
		return TXN_MORE;
	case 3:
		txn->phase = 4;
		return start_conversion(txn, txn->mem[1]);
	default:
		return take_converted(txn, arg);
	}
}

/*
 * Nothing but zeros may be what a restart left whose flags a setting has cleared since: a conversion
 * gives the truth. mem[2]: a conversion is made.
 */
static int read_latest(struct txn *txn)
{
	uint8_t control[8];

	if (txn->mem[2])
		return convert(txn, txn->property->arg);
	int err = take_results(txn, control);

	for (int i = 0; i < 4 && !err; i++)
		if (txn->number[i] != 0)
			return 0;
	txn->mem[2] = !err;
	return err ? err : TXN_MORE;
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
	uint8_t bit = (uint8_t)txn->property->arg, *want;
	int err = load(txn);

	if (err)
		return err;
	want = wanted(txn, CONTROL) + 2 * txn->element + (txn->property->arg >> 8);
	*want = (uint8_t)(txn->number[0] != 0 ? *want | bit : *want & ~bit);
	return make_control(txn);
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
	int err = load(txn);

	if (err)
		return err;
	uint8_t *want = wanted(txn, CONTROL) + 2 * txn->element;
	*want = (uint8_t)((*want & 0x0f) | OUTPUT_ENABLE | (txn->number[0] != 0 ? OUTPUT_OFF : 0));
	return make_control(txn);
}

/* The power-on flags of all channels. */
static int write_unset(struct txn *txn)
{
	int err = load(txn);

	if (err)
		return err;
	uint8_t *want = wanted(txn, CONTROL);
	for (int i = 1; i < 8; i += 2)
		want[i] = (uint8_t)(txn->number[0] != 0 ? want[i] | POR : want[i] & ~POR);
	return make(txn);
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
	int err;

	if (!(steps >= 0 && steps < 256))
		return -EINVAL;
	err = load(txn);
	if (err)
		return err;
	wanted(txn, LIMITS)[at] = (uint8_t)steps;
	return make(txn);
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
	int err = load(txn);

	if (err)
		return err;
	wanted(txn, CALIBRATION)[SUPPLY_AT % 8] = txn->number[0] != 0 ? SUPPLY_ON : 0;
	return make(txn);
}

static int get_page(struct txn *txn)
{
	txn->len = 8;
	return read_page(txn, (unsigned)txn->element, txn->data);
}

/* Of the memory n bytes from address on. The results are read-only. */
static int put(struct txn *txn, unsigned address, const uint8_t *bytes, size_t n)
{
	size_t results = address < 8 ? 8 - address : 0;
	uint8_t in[8];
	int err;

	if (n == 0)
		return 0;
	if (results > n)
		results = n;
	if (results && txn->phase == 0) {
		err = read_page(txn, RESULTS, in);
		txn->phase = 1;
		return err ? err : memcmp(in + address, bytes, results) == 0 ? TXN_MORE : -EIO;
	}
	err = load(txn);
	if (err)
		return err;
	if (n > results)
		memcpy(txn->mem + WANT + address + results - 8, bytes + results, n - results);
	return make(txn);
}

static int put_page(struct txn *txn)
{
	return put(txn, 8 * (unsigned)txn->element + (unsigned)txn->at, txn->data, txn->len);
}

static int get_memory(struct txn *txn)
{
	txn->len = 32;
	return read_pages(txn, RESULTS, txn->data, 4);
}

static int put_memory(struct txn *txn)
{
	return put(txn, (unsigned)txn->at, txn->data, txn->len);
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

/* clang-format off */
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
/* clang-format on */

const struct family family_20 = {
	.code = 0x20,
	.alarms = true,
	.type = "DS2450",
	PROPERTIES(properties),
};
