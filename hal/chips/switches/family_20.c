/* SPDX-License-Identifier: MIT */
/*
 * DS2450 (data sheet 19-5125): four A/D converters whose pins are switches too.
 *
 * Convert has a CRC16 behind the command. So has Write Memory, with an echo; one that is lost may
 * change another byte: all registers are looked at before, and put right after an error. A restart
 * leaves old results: the settings are read behind the results, in the same transaction, and a
 * power-on flag, another range or another resolution has the reading made again. A flag that has
 * come by itself is reported as a restart, once; to write a setting or to convert clears all four.
 */
#include <errno.h>

#include "hal/chips/family.h"

enum { RESULTS = 0, CONTROL = 8, LIMITS = 16 }; /* pages of 8 bytes */
#define SUPPLY_AT 0x1c
#define SUPPLY_ON 0x40

/* First control byte of a channel: resolution, output. Second: range, alarms. */
#define OUTPUT_OFF 0x40
#define OUTPUT_ENABLE 0x80
#define RANGE_HIGH 0x01
#define POR 0x80

/* arg of the voltages. */
#define EIGHT_BIT 1
#define HALF_RANGE 2
/* arg of settings: they end what the power-on flags tell. */
#define ENDS_POWER_ON 4

/* What is known of the chip (device.own). */
struct ds2450 {
	bool por_clear; /* no channel's power-on flag is set */
};

struct visit {
	bool set;     /* the settings of a conversion are as wanted */
	bool started; /* it is under way or over */
	uint8_t supply;
	int64_t begun_ns;
};

static bool power_on_flags(const uint8_t control[8])
{
	return (control[1] | control[3] | control[5] | control[7]) & POR;
}

static int saw_pages(struct txn *txn, unsigned at, uint8_t *bytes, unsigned n)
{
	struct ds2450 *chip = txn->device->own;

	if (at > CONTROL || at + n < CONTROL + 8)
		return 0;
	bool flags = power_on_flags(bytes + CONTROL - at);
	/* A disturbed write can set a flag as well. */
	if (flags && chip->por_clear && !txn->device->base_of)
		txn->restarted = true;
	chip->por_clear = !flags;
	return 0;
}

static void end_power_on(struct txn *txn, uint8_t *want)
{
	for (int i = 1; i < 8 && txn->property->arg & ENDS_POWER_ON; i += 2)
		want[i] = (uint8_t)(want[i] & ~POR);
}

/*
 * Pages that are read in one transaction are of the time between two restarts: a chip that restarts
 * meanwhile is silent from there on. The results are read-only.
 */
static AREA_NAMED(memory, "memory", .size = 32, .block = 8, .row = 1, .fixed = 8,
                  .address_bytes = 2, .read = 0xaa, .check = AREA_CRC16, .write = 0x55,
                  .write_crc16 = true, .echo = true, .saw = saw_pages, .adjust = end_power_on);

/* All four channels with 16 bits, at 80 us for each bit of each channel, and 160 us. */
static const struct conversion ds2450_conversion = {
	.command = {0x3c, 0x0f, 0x00},
	.n = 3,
	.crc16 = true,
	.ns = 6 * TXN_MS,
};

/* Results are fractions of the range. */
static void take_volts(struct txn *txn, const uint8_t results[8])
{
	for (int i = 0; i < 4; i++)
		txn->number[i] = (results[2 * i] | (unsigned)results[2 * i + 1] << 8) *
		                 (txn->property->arg & HALF_RANGE ? 2.56 : 5.12) / 65535;
}

/* An enabled output stays as it is: a measurement switches nothing. */
static void want_conversion(int arg, uint8_t want[8], uint8_t which[8])
{
	for (int i = 0; i < 8; i += 2) {
		want[i] = arg & EIGHT_BIT ? 8 : 0;
		which[i] = (uint8_t) ~(OUTPUT_ENABLE | OUTPUT_OFF);
		want[i + 1] = arg & HALF_RANGE ? 0 : RANGE_HIGH;
		which[i + 1] = RANGE_HIGH | POR;
	}
}

static bool is_set_for(int arg, const uint8_t control[8])
{
	uint8_t want[8], which[8];
	bool set = true;

	want_conversion(arg, want, which);
	for (int i = 0; i < 8; i++)
		set &= ((control[i] ^ want[i]) & which[i]) == 0;
	return set;
}

static int look_at_settings(struct txn *txn)
{
	struct visit *visit = txn_own(txn, struct visit);
	uint8_t bytes[24];
	int err = area_fetch(txn, &memory, CONTROL, bytes, sizeof(bytes));

	if (!err)
		err = saw_pages(txn, CONTROL, bytes, sizeof(bytes));
	if (err)
		return err;
	visit->supply = bytes[SUPPLY_AT - CONTROL];
	visit->set = is_set_for(txn->property->arg, bytes) && !txn->device->base_of;
	txn->phase = 1;
	return TXN_MORE;
}

static int family_20_convert(struct txn *txn)
{
	struct visit *visit = txn_own(txn, struct visit);
	uint8_t bytes[16], which[8];
	int err;

	if (txn->phase == 0)
		return look_at_settings(txn);
	if (!visit->set) {
		want_conversion(txn->property->arg, bytes, which);
		err = area_write(txn, &memory, CONTROL, bytes, which, 8);
		visit->set = err == 0;
		return err < 0 ? err : TXN_MORE;
	}
	if (!visit->started) {
		visit->started = true;
		return conversion_start(txn, &ds2450_conversion, visit->supply != SUPPLY_ON);
	}
	/* A restart since the settings were made sets the flags, or the settings are others. */
	err = area_fetch(txn, &memory, RESULTS, bytes, sizeof(bytes));
	if (!err)
		err = saw_pages(txn, RESULTS, bytes, sizeof(bytes));
	if (err)
		return err;
	if (!is_set_for(txn->property->arg, bytes + CONTROL))
		return -EIO;
	take_volts(txn, bytes);
	return 0;
}

/*
 * One conversion, of 6 ms, serves all requests for its volts in the same way. The latest result is
 * never taken: nothing tells it from what a restart left.
 */
static int read_volt(struct txn *txn)
{
	static const char conversions[4];
	const void *what = &conversions[txn->property->arg & (EIGHT_BIT | HALF_RANGE)];
	struct visit *visit = txn_own(txn, struct visit);
	int err;

	if (!visit->begun_ns) {
		if (txn_shared(txn, what, 0, txn->number, 4 * sizeof(txn->number[0])))
			return 0;
		visit->begun_ns = txn_now(txn);
	}
	err = family_20_convert(txn);
	if (!err)
		txn_share(txn, what, 0, txn->number, 4 * sizeof(txn->number[0]), visit->begun_ns);
	return err;
}

/* As owserver has it, and against its manual: 0 conducts, 1 does not, enabled or not. */
static int read_pio(struct txn *txn)
{
	uint8_t byte = 0;
	int err = area_read(txn, &memory, CONTROL + 2 * (unsigned)txn->element, &byte, 1);

	txn->number[0] = (byte & (OUTPUT_ENABLE | OUTPUT_OFF)) != OUTPUT_ENABLE;
	return err;
}

/* Any other byte is none: a conversion then takes its power from the wire. */
static int read_power(struct txn *txn)
{
	uint8_t byte = 0;
	int err = area_read(txn, &memory, SUPPLY_AT, &byte, 1);

	txn->number[0] = byte == SUPPLY_ON;
	return err;
}

static int write_pio(struct txn *txn)
{
	uint8_t byte = (uint8_t)(OUTPUT_ENABLE | (txn->number[0] != 0 ? OUTPUT_OFF : 0));

	return area_write(txn, &memory, CONTROL + 2 * (unsigned)txn->element, &byte,
	                  TXN_BYTES(0xf0));
}

/* The power-on flags of all channels. */
static int write_unset(struct txn *txn)
{
	static const uint8_t which[8] = {0, POR, 0, POR, 0, POR, 0, POR}, none[8];

	return area_write(txn, &memory, CONTROL, txn->number[0] != 0 ? which : none, which, 8);
}

/* A K30 sensor on a DS2450: A has 1 V per 1000 ppm, B is its reference of 3.2 V, D its supply. */
static int read_co2_ppm(struct txn *txn)
{
	int err = read_volt(txn);

	txn->number[0] = (double)(unsigned)(txn->number[0] * 1000);
	return err;
}

static int read_co2_status(struct txn *txn)
{
	int err = read_volt(txn);

	txn->number[0] = txn->number[1] > 3.0 && txn->number[1] < 3.4;
	return err;
}

static int read_co2_supply(struct txn *txn)
{
	int err = read_volt(txn);

	txn->number[0] = txn->number[3] > 4.5;
	return err;
}

enum { MEMORY = 1 };
static const struct area *const areas[] = {[MEMORY] = &memory};

#define WAYS(X) \
	X(VOLT, .read = read_volt) \
	X(PIO, .read = read_pio, .write = write_pio) \
	X(POWER, .read = read_power) \
	X(UNSET, .write = write_unset) \
	X(CO2_PPM, .read = read_co2_ppm) \
	X(CO2_STATUS, .read = read_co2_status) \
	X(CO2_SUPPLY, .read = read_co2_supply)
enum { WAY_NONE, WAYS(WAY_ENUM) };
static const struct property_how how[] = {WAYS(WAY_HOW)};

#define VOLT(text, args, how_, ...) \
	PROPERTY(text, FLOAT, VOLATILE, READ, AGGREGATE(4, LETTERS), .arg = (args), .how = (how_), \
	         __VA_ARGS__)
/* 16 bits of the range */
#define FULL MEASURES(0, 5.12, 5, "V")
#define HALF MEASURES(0, 2.56, 5, "V")
/* Of the channel's second control byte. */
#define FLAG(text, life_, shift_, ...) \
	PROPERTY(text, YESNO, life_, BOTH, ELEMENTS(4, LETTERS), .arg = ENDS_POWER_ON, \
	         FIELD(MEMORY, .at = CONTROL + 1, .stride = 2, .shift = (shift_), .bits = 1), \
	         __VA_ARGS__)
/* Steps of 20 or 10 mV. */
#define LIMIT(text, where, unit_) \
	PROPERTY(text, FLOAT, STABLE, BOTH, ELEMENTS(4, LETTERS), \
	         FIELD(MEMORY, .at = LIMITS + (where), .stride = 2, .unit = (unit_)), \
	         IN_UNIT("V"))

static const struct property properties[] = {
	PROPERTY_DIR("8bit"),
	VOLT("8bit/latestvolt", EIGHT_BIT, WAY_VOLT, FULL),
	VOLT("8bit/latestvolt2", EIGHT_BIT | HALF_RANGE, WAY_VOLT, HALF),
	VOLT("8bit/volt", EIGHT_BIT, WAY_VOLT, FULL),
	VOLT("8bit/volt2", EIGHT_BIT | HALF_RANGE, WAY_VOLT, HALF),
	PROPERTY_DIR("CO2"),
	PROPERTY("CO2/Vdd", YESNO, VOLATILE, READ, .how = WAY_CO2_SUPPLY),
	PROPERTY("CO2/ppm", UNSIGNED, VOLATILE, READ, MEASURES(0, UINT16_MAX, 0, "ppm"),
                 .how = WAY_CO2_PPM),
	PROPERTY("CO2/status", FLOAT, VOLATILE, READ, FULL, .how = WAY_CO2_STATUS),
	PROPERTY("PIO", YESNO, STABLE, BOTH, ELEMENTS(4, LETTERS), .arg = ENDS_POWER_ON,
                 .holds = true, .how = WAY_PIO),
	PROPERTY_DIR("alarm"),
	FLAG("alarm/high", VOLATILE, 5, .alarm = ALARM_LATCH | ALARM_CLEARS),
	FLAG("alarm/low", VOLATILE, 4, .alarm = ALARM_LATCH | ALARM_CLEARS),
	VOLT("latestvolt", 0, WAY_VOLT, FULL),
	VOLT("latestvolt2", HALF_RANGE, WAY_VOLT, HALF),
	AREA_MEMORY(MEMORY, 32),
	PROPERTY_DIR("pages"),
	AREA_PAGES(MEMORY, 4, 8),
	PROPERTY("power", YESNO, STABLE, BOTH,
                 FIELD(MEMORY, .at = SUPPLY_AT, .unit = 1.0 / SUPPLY_ON), .how = WAY_POWER),
	PROPERTY_DIR("set_alarm"),
	FLAG("set_alarm/high", STABLE, 3, .alarm = 0),
	FLAG("set_alarm/low", STABLE, 2, .alarm = 0),
	PROPERTY("set_alarm/unset", YESNO, STABLE, WRITE, .how = WAY_UNSET),
	LIMIT("set_alarm/volt2high", 1, 0.01),
	LIMIT("set_alarm/volt2low", 0, 0.01),
	LIMIT("set_alarm/volthigh", 1, 0.02),
	LIMIT("set_alarm/voltlow", 0, 0.02),
	VOLT("volt", 0, WAY_VOLT, FULL),
	VOLT("volt2", HALF_RANGE, WAY_VOLT, HALF),
};

CHIP_FAMILY(20, "DS2450", CHECKSUM, .alarms = true, .latches = true,
            .flags = FLAG_ALARM | FLAG_OVERDRIVE | FLAG_VOLT,
            SCAN({"volt.A", "volt_a"}, {"volt.B", "volt_b"}, {"volt.C", "volt_c"},
                 {"volt.D", "volt_d"}),
            AREAS(areas), HOW(how), PROPERTIES(properties));
