/* SPDX-License-Identifier: MIT */
/*
 * DS18B20 (data sheet 19-7487), DS18S20 (19-5474), DS1822 (19-7486), DS1825 (19-7384), DS28EA00
 * (19-5085), and the clones of the DS18B20 by the kinds of the catalogue of Chris Petrich
 * (github.com/cpetrich/counterfeit_DS18B20, whose letters name them; each takes the longest
 * conversion seen). Not simulated: their errors and noise, and commands that no data sheet knows.
 */
#include <math.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/chips/thermometer.h"
#include "hal/sim/families.h"

enum { READ_POWER = 0xB4 };

/*
 * All that the register holds, in sixteenths: no chip measures below -55 and above 125 degrees, and
 * yet some answer so, with a right checksum, after a bad contact.
 */
#define REGISTER_LEAST (-128 * 16)
#define REGISTER_MOST (128 * 16 - 1)
#define REGISTER_INPUT \
	.name = "temperature", .start = 20, .least = REGISTER_LEAST / 16.0, \
	.most = REGISTER_MOST / 16.0

#define FAMILY_S20 0x10
#define FAMILY_1825 0x3B
#define FAMILY_EA00 0x42

/* A clone's busy slots begin as late as this. */
#define LATE_NS NS_PER_MS

/* tWR of the EEPROM, all data sheets: 10 ms at most. */
#define COPY_NS (10 * NS_PER_MS)

static bool is_s20(const struct sim_slave *slave)
{
	return slave->family->code == FAMILY_S20;
}

static unsigned resolution_bits(const struct sim_slave *slave)
{
	const struct sim_thermometer *s = slave->state;

	return is_s20(slave) || s->fixed ? 12 : 9u + (s->scratchpad[4] >> 5 & 3);
}

/* The time of a conversion at the present resolution, in ns. */
static int64_t sim_thermometer_conversion(struct sim_slave *slave)
{
	const struct sim_thermometer *s = slave->state;

	/* tCONV: 93.75, 187.5, 375, 750 ms at most. */
	int64_t full = s->clone ? s->clone->ms[resolution_bits(slave) - 9] * NS_PER_MS
	                        : (750 * NS_PER_MS) >> (12 - resolution_bits(slave));

	return s->percent ? full / 100 * s->percent : full;
}

/* The register's configuration byte with its fixed bits. */
static uint8_t config_byte(const struct sim_slave *slave, uint8_t written)
{
	const struct sim_thermometer *s = slave->state;

	if (s->fixed)
		written = 0x7F;
	if (slave->family->code == FAMILY_1825)
		return (uint8_t)((written & 0x60) | 0x10 | s->address);
	return (uint8_t)((written & 0x60) | 0x1F);
}

static void ds18b20_recall(struct sim_slave *slave)
{
	struct sim_thermometer *s = slave->state;

	s->scratchpad[2] = s->eeprom[0];
	s->scratchpad[3] = s->eeprom[1];
	s->scratchpad[4] = is_s20(slave) ? 0xFF : config_byte(slave, s->eeprom[2]);
}

static void ds18b20_create(struct sim_slave *slave)
{
	struct sim_thermometer *s = slave->state;

	s->clone = slave->family->kind;
	if (s->clone) {
		memcpy(s->eeprom, s->clone->first + 2, 3);
		s->fixed = s->clone->fixed;
		return;
	}
	s->eeprom[0] = 75;
	s->eeprom[1] = 70;
	s->eeprom[2] = 0x7F;
}

static void ds18b20_power_on(struct sim_slave *slave)
{
	struct sim_thermometer *s = slave->state;
	if (slave->family->code == FAMILY_EA00)
		sim_pins_start(slave, SIM_PIN_A, 2);
	s->alarm = false;
	if (s->clone) {
		if (s->clone->keeps && slave->power_ons > 1)
			return;
		memcpy(s->scratchpad, s->clone->first, 8);
		ds18b20_recall(slave);
		return;
	}
	sim_put(s->scratchpad, 2, is_s20(slave) ? 85 * 2 : 85 * 16);
	s->scratchpad[5] = 0xFF;
	s->scratchpad[6] = 0x0C;
	s->scratchpad[7] = 0x10;
	ds18b20_recall(slave);
}

static void set_alarm(struct sim_slave *slave, double celsius)
{
	struct sim_thermometer *s = slave->state;
	int whole = (int)floor(celsius);

	s->alarm = whole >= (int8_t)s->scratchpad[2] || whole <= (int8_t)s->scratchpad[3];
}

static void latch_temperature(struct sim_slave *slave)
{
	struct sim_thermometer *s = slave->state;
	int raw = sim_within(sim_input_now(slave, SIM_TEMPERATURE) * 16, REGISTER_LEAST,
	                     REGISTER_MOST);

	set_alarm(slave, raw / 16.0);
	if (is_s20(slave)) {
		/* TEMPERATURE = TEMP_READ - 0.25 + (COUNT_PER_C - COUNT_REMAIN) / COUNT_PER_C */
		int shifted = raw + 4, whole = shifted >> 4;
		int counts = s->counts ? s->counts : 16;

		s->scratchpad[6] = (uint8_t)(counts - (shifted & 15) * counts / 16);
		s->scratchpad[7] = (uint8_t)counts;
		raw = whole * 2 + ((shifted & 15) >= 8);
	} else {
		raw &= ~((1 << (12 - resolution_bits(slave))) - 1);
		/* The data sheet reserves the byte; the genuine chip does this, few clones do. */
		if (s->clone && s->clone->sixth == JOKER)
			s->scratchpad[6] = (uint8_t)(32 - (raw & 15));
		else if (s->clone ? s->clone->sixth == AS_GENUINE : !s->fixed)
			s->scratchpad[6] = (uint8_t)(16 - (raw & 15));
	}
	sim_put(s->scratchpad, 2, raw);
	slave->conversions++;
}

/* A copy stores what the scratchpad holds when the copy ends. */
static void ds18b20_worked(struct sim_slave *slave)
{
	struct sim_thermometer *s = slave->state;

	if (!s->copying)
		latch_temperature(slave);
	else if (!s->clone || s->clone->copies == 255 || s->copies++ < s->clone->copies)
		memcpy(s->eeprom, s->scratchpad + 2, 3);
}

/* A clone that needs a supply line, and has none. */
static bool is_dead(struct sim_slave *slave)
{
	struct sim_thermometer *s = slave->state;
	bool dead = slave->parasite && s->clone && s->clone->no_parasite;

	if (dead)
		sim_end(slave);
	return dead;
}

static void ds18b20_convert(struct sim_slave *slave)
{
	struct sim_thermometer *s = slave->state;

	if (is_dead(slave))
		return;
	/* No data sheet says what it does while it converts. */
	if (s->once && slave->busy && !s->copying) {
		sim_send_bits(slave);
		return;
	}
	s->copying = false;
	sim_work(slave, sim_thermometer_conversion(slave));
}

static void ds18b20_copy(struct sim_slave *slave)
{
	if (is_dead(slave))
		return;
	sim_state(slave, sim_thermometer)->copying = true;
	sim_work(slave, COPY_NS);
}

static bool ds18b20_bit(struct sim_slave *slave)
{
	const struct sim_clone *clone = sim_state(slave, sim_thermometer)->clone;

	if (slave->function->code == READ_POWER)
		return !slave->parasite;
	if (clone &&
	    (clone->never_polls || (clone->polls_late && slave->now < slave->since + LATE_NS)))
		return true;
	return !slave->busy;
}

static void recall_eeprom(struct sim_slave *slave)
{
	if (sim_state(slave, sim_thermometer)->no_recall) {
		sim_end(slave);
		return;
	}
	ds18b20_recall(slave);
	sim_send_bits(slave);
}

/* The checksum is that of what is sent, so it is right whatever was disturbed. */
static void ds18b20_read_scratchpad(struct sim_slave *slave)
{
	const struct sim_thermometer *s = slave->state;
	uint8_t bytes[8];

	if (is_dead(slave))
		return;
	memcpy(bytes, s->scratchpad, sizeof(bytes));
	if (s->upset && slave->busy && !s->copying)
		bytes[0] ^= 0x06;
	sim_send_crc8(slave, bytes, 8);
}

static void ds18b20_write_scratchpad(struct sim_slave *slave, uint8_t byte)
{
	struct sim_thermometer *s = slave->state;
	bool overwrites = s->clone && s->clone->overwrites;
	unsigned at = 2u + slave->address++;

	if (at <= 4)
		s->scratchpad[at] = at == 4 ? config_byte(slave, byte) : byte;
	else
		s->scratchpad[at + 1] = byte;
	if (at == 4 && overwrites)
		s->scratchpad[6] = byte;
	if (at == (is_s20(slave) ? 3 : overwrites ? 6 : 4))
		sim_end(slave);
}

static bool ds18b20_alarm(struct sim_slave *slave)
{
	return sim_state(slave, sim_thermometer)->alarm;
}

static void set_resolution(struct sim_slave *slave, int64_t bits)
{
	sim_state(slave, sim_thermometer)->eeprom[2] = (uint8_t)((bits - 9) << 5 | 0x1F);
}

static void set_recall(struct sim_slave *slave, int64_t knows)
{
	sim_state(slave, sim_thermometer)->no_recall = !knows;
}

#define OPTIONS \
	SIM_OPTION(sim_thermometer, "high", -128, 127, eeprom[0]), \
		SIM_OPTION(sim_thermometer, "low", -128, 127, eeprom[1]), \
		SIM_OPTION(sim_thermometer, "fixed", 0, 1, fixed), \
		SIM_OPTION(sim_thermometer, "once", 0, 1, once), \
		SIM_OPTION(sim_thermometer, "upset", 0, 1, upset), \
		SIM_OPTION(sim_thermometer, "speed", 1, 200, percent), \
	{ \
		"recall", 0, 1, .set = set_recall \
	}
#define RESOLUTION \
	{ \
		"resolution", 9, 12, .set = set_resolution \
	}
static const struct sim_option s20_options[] = {
	OPTIONS, SIM_OPTION(sim_thermometer, "counts", 1, 255, counts), {0}};
static const struct sim_option options[] = {OPTIONS, RESOLUTION, {0}};
static const struct sim_option ds1825_options[] = {
	OPTIONS, RESOLUTION, SIM_OPTION(sim_thermometer, "address", 0, 15, address), {0}};

#define FUNCTIONS \
	{.code = 0x44, .start = ds18b20_convert}, \
		{.code = 0xBE, .start = ds18b20_read_scratchpad}, \
		{.code = 0x4E, .byte = ds18b20_write_scratchpad}, \
		{.code = 0x48, .start = ds18b20_copy}, {.code = 0xB8, .start = recall_eeprom}, \
	{ \
		.code = READ_POWER, .start = sim_send_bits \
	}
static const struct sim_function functions[] = {FUNCTIONS, {0}};
static const struct sim_function ea00_functions[] = {
	FUNCTIONS,
	{SIM_PINS_READ(0xF5)},
	{SIM_PINS_WRITE(0xA5)},
	{0},
};

static const struct sim_input inputs[] = {
	[SIM_TEMPERATURE] = {REGISTER_INPUT},
	{0},
};
static const struct sim_input ea00_inputs[] = {
	[SIM_TEMPERATURE] = {REGISTER_INPUT},
	[SIM_PIN_A] = {SIM_PIN("pin.A")},
	[SIM_PIN_B] = {SIM_PIN("pin.B")},
	{0},
};

#define THERMOMETER(part, family, ...) \
	.name = part, .code = family, .state_size = sizeof(struct sim_thermometer), \
	.starves = true, .create = ds18b20_create, .power_on = ds18b20_power_on, \
	.alarm = ds18b20_alarm, .bit = ds18b20_bit, .worked = ds18b20_worked, __VA_ARGS__
#define PLAIN(choices) .inputs = inputs, .functions = functions, .options = (choices)

const struct sim_family sim_ds18b20 = {THERMOMETER("DS18B20", 0x28, PLAIN(options))};
const struct sim_family sim_ds18s20 = {THERMOMETER("DS18S20", FAMILY_S20, PLAIN(s20_options))};
const struct sim_family sim_ds1822 = {THERMOMETER("DS1822", 0x22, PLAIN(options))};
const struct sim_family sim_ds1825 = {THERMOMETER("DS1825", FAMILY_1825, PLAIN(ds1825_options))};
const struct sim_family sim_ds28ea00 = {THERMOMETER("DS28EA00", FAMILY_EA00, .inputs = ea00_inputs,
                                                    .functions = ea00_functions, .options = options,
                                                    .overdrive = true, .advance = sim_pins_follow)};

/* --- The clones ------------------------------------------------------------------------------ */

#define HALVED(full) (full) / 8, (full) / 4, (full) / 2, (full)
#define SAME(full) (full), (full), (full), (full)
#define FIRST(high, low, six, seven) 0x50, 0x05, (high), (low), 0x7F, 0xFF, (six), (seven)
#define FIRST_25(five, six) 0x90, 0x01, 0x55, 0x05, 0x7F, (five), (six), 0x66
#define ENOUGH .copies = 255
#define CLONE(name, part, ...) \
	static const struct sim_clone clone_##name = {__VA_ARGS__}; \
	const struct sim_family sim_ds18b20_##name = { \
		THERMOMETER(part, 0x28, PLAIN(options), .kind = &clone_##name)};

CLONE(a2, "DS18B20-A2", {FIRST(0x12, 0x34, 0x0C, 0x10)}, {HALVED(505)}, ENOUGH)
CLONE(a3, "DS18B20-A3", {FIRST(0x7F, 0x80, 0x0C, 0x10)}, {HALVED(621)}, .polls_late = true, ENOUGH)
CLONE(b1, "DS18B20-B1", {FIRST(0x4B, 0x46, 0x0C, 0x10)}, {HALVED(728)}, KEPT, .overwrites = true,
      ENOUGH)
CLONE(b1v2, "DS18B20-B1v2", {FIRST(0x4B, 0x46, 0x0C, 0x10)}, {HALVED(650)}, ENOUGH)
CLONE(b2, "DS18B20-B2", {FIRST(0x55, 0x00, 0x0C, 0x10)}, {HALVED(697)}, KEPT, .overwrites = true,
      ENOUGH)
CLONE(c, "DS18B20-C", {FIRST(0x55, 0x00, 0x0C, 0x10)}, {SAME(30)}, KEPT, .fixed = true, .copies = 8)
/* a capacitor in place of an EEPROM */
CLONE(d1, "DS18B20-D1", {FIRST_25(0x7E, 0x81)}, {SAME(11)}, KEPT, .no_parasite = true,
      .keeps = true, .copies = 0)
CLONE(d2, "DS18B20-D2", {FIRST_25(0x7E, 0x81)}, {SAME(523)}, KEPT, .no_parasite = true, ENOUGH)
CLONE(e, "DS18B20-E", {FIRST(0x4B, 0x46, 0x10, 0x10)}, {SAME(25)}, ENOUGH)
CLONE(f, "DS18B20-F", {FIRST(0x55, 0x00, 0x0C, 0x10)}, {SAME(27)}, KEPT, .fixed = true,
      .never_polls = true, .copies = 0)
CLONE(g, "DS18B20-G", {FIRST(0x55, 0xAA, 0x0C, 0x10)}, {HALVED(320)}, JOKER, .keeps = true, ENOUGH)
CLONE(h, "DS18B20-H", {FIRST(0x55, 0xAA, 0x0C, 0x10)}, {101, 141, 198, 279}, .keeps = true, ENOUGH)
