/* SPDX-License-Identifier: MIT */
/*
 * DS18B20 (data sheet 19-7487), DS18S20 (19-5474), DS1822 (19-7486), DS1825 (19-7384), DS28EA00
 * (19-5085), and the clones of the DS18B20 by the kinds of the catalogue of Chris Petrich
 * (github.com/cpetrich/counterfeit_DS18B20, whose letters name them; each takes the longest
 * conversion seen). Not simulated: their errors and noise, and commands that no data sheet knows.
 */
#include <errno.h>
#include <math.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/chips/thermometer.h"
#include "hal/sim/families.h"

enum { READ_POWER = 0xB4 };

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

static unsigned resolution(const struct sim_slave *slave)
{
	const struct sim_thermometer *s = slave->state;

	return is_s20(slave) || s->fixed ? 12 : 9u + (s->scratchpad[4] >> 5 & 3);
}

/* The time of a conversion at the present resolution, in ns. */
static int64_t sim_thermometer_conversion(struct sim_slave *slave)
{
	const struct sim_thermometer *s = slave->state;

	/* tCONV: 93.75, 187.5, 375, 750 ms at most. */
	int64_t full = s->clone ? s->clone->ms[resolution(slave) - 9] * NS_PER_MS
	                        : (750 * NS_PER_MS) >> (12 - resolution(slave));

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
	int raw = is_s20(slave) ? 85 * 2 : 85 * 16;

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
	s->scratchpad[0] = (uint8_t)raw;
	s->scratchpad[1] = (uint8_t)(raw >> 8);
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
	double celsius = sim_input_now(slave, SIM_TEMPERATURE);
	int raw;

	celsius = celsius < -55 ? -55 : celsius > 125 ? 125 : celsius;
	raw = (int)sim_round(celsius * 16);
	set_alarm(slave, raw / 16.0);
	if (is_s20(slave)) {
		/* TEMPERATURE = TEMP_READ - 0.25 + (COUNT_PER_C - COUNT_REMAIN) / COUNT_PER_C */
		int shifted = raw + 4, whole = shifted >> 4;

		s->scratchpad[6] = (uint8_t)(16 - (shifted & 15));
		raw = whole * 2 + ((shifted & 15) >= 8);
	} else {
		raw &= ~((1 << (12 - resolution(slave))) - 1);
		/* The data sheet reserves the byte; the genuine chip does this, few clones do. */
		if (s->clone && s->clone->sixth == JOKER)
			s->scratchpad[6] = (uint8_t)(32 - (raw & 15));
		else if (s->clone ? s->clone->sixth == AS_GENUINE : !s->fixed)
			s->scratchpad[6] = (uint8_t)(16 - (raw & 15));
	}
	s->scratchpad[0] = (uint8_t)raw;
	s->scratchpad[1] = (uint8_t)(raw >> 8);
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

static void ds18b20_begin_write(struct sim_slave *slave)
{
	slave->address = 2;
}

static void ds18b20_write_scratchpad(struct sim_slave *slave, uint8_t byte)
{
	struct sim_thermometer *s = slave->state;
	bool overwrites = s->clone && s->clone->overwrites;
	unsigned at = slave->address++;

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

static int ds18b20_option(struct sim_slave *slave, const char *name, double value)
{
	struct sim_thermometer *s = slave->state;
	int64_t whole = sim_round(value);

	if (value != (double)whole)
		return -ERANGE;
	if (strcmp(name, "resolution") == 0 && !is_s20(slave)) {
		if (whole < 9 || whole > 12)
			return -ERANGE;
		s->eeprom[2] = (uint8_t)((whole - 9) << 5 | 0x1F);
	} else if (strcmp(name, "high") == 0 || strcmp(name, "low") == 0) {
		if (whole < -128 || whole > 127)
			return -ERANGE;
		s->eeprom[name[0] == 'l'] = (uint8_t)whole;
	} else if (strcmp(name, "fixed") == 0) {
		s->fixed = whole != 0;
	} else if (strcmp(name, "once") == 0) {
		s->once = whole != 0;
	} else if (strcmp(name, "speed") == 0) {
		if (whole < 1 || whole > 200)
			return -ERANGE;
		s->percent = (int)whole;
	} else if (strcmp(name, "recall") == 0) {
		s->no_recall = whole == 0;
	} else if (strcmp(name, "upset") == 0) {
		s->upset = whole != 0;
	} else if (strcmp(name, "address") == 0 && slave->family->code == FAMILY_1825) {
		if (whole < 0 || whole > 15)
			return -ERANGE;
		s->address = (uint8_t)whole;
	} else {
		return -ENOENT;
	}
	return 0;
}

#define FUNCTIONS \
	{.code = 0x44, .start = ds18b20_convert}, \
		{.code = 0xBE, .start = ds18b20_read_scratchpad}, \
		{.code = 0x4E, .start = ds18b20_begin_write, .byte = ds18b20_write_scratchpad}, \
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
	[SIM_TEMPERATURE] = {SIM_TEMPERATURE_INPUT},
	{0},
};
static const struct sim_input ea00_inputs[] = {
	[SIM_TEMPERATURE] = {SIM_TEMPERATURE_INPUT},
	[SIM_PIN_A] = {SIM_PIN("pin.A")},
	[SIM_PIN_B] = {SIM_PIN("pin.B")},
	{0},
};

#define THERMOMETER(part, family, ...) \
	.name = part, .code = family, .state_size = sizeof(struct sim_thermometer), \
	.starves = true, .create = ds18b20_create, .power_on = ds18b20_power_on, \
	.alarm = ds18b20_alarm, .bit = ds18b20_bit, .worked = ds18b20_worked, \
	.option = ds18b20_option, __VA_ARGS__
#define PLAIN .inputs = inputs, .functions = functions

const struct sim_family sim_ds18b20 = {THERMOMETER("DS18B20", 0x28, PLAIN)};
const struct sim_family sim_ds18s20 = {THERMOMETER("DS18S20", FAMILY_S20, PLAIN)};
const struct sim_family sim_ds1822 = {THERMOMETER("DS1822", 0x22, PLAIN)};
const struct sim_family sim_ds1825 = {THERMOMETER("DS1825", FAMILY_1825, PLAIN)};
const struct sim_family sim_ds28ea00 = {THERMOMETER("DS28EA00", FAMILY_EA00, .inputs = ea00_inputs,
                                                    .functions = ea00_functions, .overdrive = true,
                                                    .advance = sim_pins_follow)};

/* --- The clones ------------------------------------------------------------------------------ */

#define HALVED(full) (full) / 8, (full) / 4, (full) / 2, (full)
#define SAME(full) (full), (full), (full), (full)
#define FIRST(high, low, six, seven) 0x50, 0x05, (high), (low), 0x7F, 0xFF, (six), (seven)
#define FIRST_25(five, six) 0x90, 0x01, 0x55, 0x05, 0x7F, (five), (six), 0x66
#define ENOUGH .copies = 255
#define CLONE(name, part, ...) \
	static const struct sim_clone clone_##name = {__VA_ARGS__}; \
	const struct sim_family sim_ds18b20_##name = { \
		THERMOMETER(part, 0x28, PLAIN, .kind = &clone_##name)};

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
