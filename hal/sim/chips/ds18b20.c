/* SPDX-License-Identifier: MIT */
/*
 * DS18B20 (data sheet 19-7487), DS18S20 (19-5474), DS1822 (19-7486), DS1825 (19-7384), DS28EA00
 * (19-5085).
 */
#include <errno.h>
#include <math.h>
#include <string.h>

#include "hal/sim/chips/families.h"
#include "hal/sim/chips/thermometer.h"
#include "hal/sim/crc.h"

enum {
	CONVERT = 0x44,
	READ_SCRATCHPAD = 0xBE,
	WRITE_SCRATCHPAD = 0x4E,
	COPY_SCRATCHPAD = 0x48,
	RECALL = 0xB8,
	READ_POWER = 0xB4,
	PIO_READ = 0xF5,  /* DS28EA00 */
	PIO_WRITE = 0xA5, /* DS28EA00 */
};

#define FAMILY_S20 0x10
#define FAMILY_1825 0x3B
#define FAMILY_EA00 0x42

#define MS INT64_C(1000000)
/* tWR of the EEPROM, all data sheets: 10 ms at most. */
#define COPY_NS (10 * MS)
/* tSPON: the strong pull-up has to come within 10 us of the command's last slot. */
#define STRONG_WITHIN_NS 100000

static struct sim_thermometer *state(struct sim_slave *slave)
{
	return sim_state(slave, sim_thermometer);
}

static bool is_s20(const struct sim_slave *slave)
{
	return slave->family->code == FAMILY_S20;
}

static unsigned resolution(const struct sim_slave *slave)
{
	const struct sim_thermometer *s = slave->state;

	return is_s20(slave) || s->fixed ? 12 : 9u + (s->scratchpad[4] >> 5 & 3);
}

/* ns of a conversion at the resolution set. */
static int64_t sim_thermometer_conversion(const struct sim_slave *slave)
{
	const struct sim_thermometer *s = slave->state;
	/* tCONV: 93.75, 187.5, 375, 750 ms at most. */
	int64_t full = (750 * MS) >> (12 - resolution(slave));

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

static void recall(struct sim_slave *slave)
{
	struct sim_thermometer *s = state(slave);

	s->scratchpad[2] = s->eeprom[0];
	s->scratchpad[3] = s->eeprom[1];
	s->scratchpad[4] = is_s20(slave) ? 0xFF : config_byte(slave, s->eeprom[2]);
}

static void create(struct sim_slave *slave)
{
	struct sim_thermometer *s = state(slave);

	s->eeprom[0] = 75;
	s->eeprom[1] = 70;
	s->eeprom[2] = 0x7F;
}

static void power_on(struct sim_slave *slave, int64_t t)
{
	struct sim_thermometer *s = state(slave);
	int raw = is_s20(slave) ? 85 * 2 : 85 * 16;

	(void)t;
	s->scratchpad[0] = (uint8_t)raw;
	s->scratchpad[1] = (uint8_t)(raw >> 8);
	s->scratchpad[5] = 0xFF;
	s->scratchpad[6] = 0x0C;
	s->scratchpad[7] = 0x10;
	s->converting = s->copying = s->alarm = false;
	s->command = 0;
	s->latch = 3;
	recall(slave);
}

static void set_alarm(struct sim_slave *slave, double celsius)
{
	struct sim_thermometer *s = state(slave);
	int whole = (int)floor(celsius);

	s->alarm = whole >= (int8_t)s->scratchpad[2] || whole <= (int8_t)s->scratchpad[3];
}

static void latch_temperature(struct sim_slave *slave, int64_t t)
{
	struct sim_thermometer *s = state(slave);
	double celsius = sim_input_at(slave, SIM_TEMPERATURE, t);
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
		/* The data sheet reserves the byte; the genuine chip does this, clones do not. */
		if (!s->fixed)
			s->scratchpad[6] = (uint8_t)(16 - (raw & 15));
	}
	s->scratchpad[0] = (uint8_t)raw;
	s->scratchpad[1] = (uint8_t)(raw >> 8);
	slave->conversions++;
}

/* A part that is fed by the wire restarts when it wants current and gets none. */
static void starve(struct sim_slave *slave, int64_t t)
{
	sim_slave_power_on(slave, t);
}

static void advance(struct sim_slave *slave, int64_t t)
{
	struct sim_thermometer *s = state(slave);

	if (!s->converting && !s->copying)
		return;
	if (slave->parasite && !slave->strong && t > s->busy_since + STRONG_WITHIN_NS) {
		starve(slave, t);
		return;
	}
	if (t < s->busy_until)
		return;
	if (s->converting)
		latch_temperature(slave, s->busy_until);
	else
		memcpy(s->eeprom, s->scratchpad + 2, 3);
	s->converting = s->copying = false;
}

/* advance() came first: busy still means that it goes away too early. */
static void strong(struct sim_slave *slave, bool on, int64_t t)
{
	struct sim_thermometer *s = state(slave);

	if (!on && slave->parasite && (s->converting || s->copying))
		starve(slave, t);
}

static void work(struct sim_slave *slave, bool *which, int64_t takes, int64_t t)
{
	struct sim_thermometer *s = state(slave);

	*which = true;
	s->busy_since = t;
	s->busy_until = t + takes;
	sim_send_bits(slave);
}

static bool bit(struct sim_slave *slave, int64_t t)
{
	const struct sim_thermometer *s = slave->state;

	(void)t;
	if (s->command == READ_POWER)
		return !slave->parasite;
	return !s->converting && !s->copying;
}

static void send_scratchpad(struct sim_slave *slave)
{
	struct sim_thermometer *s = state(slave);
	uint8_t out[9];

	memcpy(out, s->scratchpad, 8);
	out[8] = sim_crc8(0, out, 8);
	sim_send(slave, out, sizeof(out));
}

/* DS28EA00, PIO status: pin A, latch A, pin B, latch B, and their complement above. */
static void send_pins(struct sim_slave *slave, int64_t t)
{
	const struct sim_thermometer *s = slave->state;
	unsigned pins = 0;

	for (unsigned i = 0; i < 2; i++) {
		bool latch = s->latch >> i & 1;
		bool pin = latch && sim_input_at(slave, SIM_PIN_A + i, t) >= 0.5;

		pins |= ((pin ? 1u : 0) | (latch ? 2u : 0)) << (2 * i);
	}
	sim_send_byte(slave, (uint8_t)(pins | (~pins & 15) << 4));
}

static void command(struct sim_slave *slave, uint8_t byte, int64_t t)
{
	struct sim_thermometer *s = state(slave);
	bool ea00 = slave->family->code == FAMILY_EA00;

	s->command = byte;
	s->got = 0;
	switch (byte) {
	case CONVERT:
		work(slave, &s->converting, sim_thermometer_conversion(slave), t);
		return;
	case COPY_SCRATCHPAD:
		work(slave, &s->copying, COPY_NS, t);
		return;
	case READ_SCRATCHPAD:
		send_scratchpad(slave);
		return;
	case WRITE_SCRATCHPAD:
		return;
	case RECALL:
		recall(slave);
		sim_send_bits(slave);
		return;
	case READ_POWER:
		sim_send_bits(slave);
		return;
	case PIO_READ:
		if (!ea00)
			break;
		send_pins(slave, t);
		return;
	case PIO_WRITE:
		if (!ea00)
			break;
		return;
	}
	s->command = 0;
	sim_end(slave);
}

static void write_scratchpad(struct sim_slave *slave, uint8_t byte)
{
	struct sim_thermometer *s = state(slave);
	unsigned at = s->got++;

	s->scratchpad[2 + at] = at == 2 ? config_byte(slave, byte) : byte;
	if (s->got == (is_s20(slave) ? 2 : 3))
		sim_end(slave);
}

static void pio_write(struct sim_slave *slave, uint8_t byte)
{
	struct sim_thermometer *s = state(slave);

	s->taken[s->got++] = byte;
	if (s->got < 2)
		return;
	s->got = 0;
	if ((s->taken[0] ^ s->taken[1]) != 0xFF) {
		sim_end(slave);
		return;
	}
	s->latch = s->taken[0] & 3;
	sim_send_byte(slave, 0xAA);
	s->got = 2;
}

static void received(struct sim_slave *slave, uint8_t byte, int64_t t)
{
	switch (state(slave)->command) {
	case WRITE_SCRATCHPAD:
		write_scratchpad(slave, byte);
		break;
	case PIO_WRITE:
		pio_write(slave, byte);
		break;
	default:
		command(slave, byte, t);
		break;
	}
}

static void drained(struct sim_slave *slave, int64_t t)
{
	struct sim_thermometer *s = state(slave);

	if (s->command == PIO_READ) {
		send_pins(slave, t);
	} else if (s->command == PIO_WRITE && s->got == 2) {
		send_pins(slave, t);
		s->got = 3;
	} else if (s->command == PIO_WRITE) {
		s->got = 0;
		sim_receive(slave);
	}
}

static void reset(struct sim_slave *slave, int64_t t)
{
	(void)t;
	state(slave)->command = 0;
}

static bool alarm(struct sim_slave *slave, int64_t t)
{
	(void)t;
	return state(slave)->alarm;
}

static int option(struct sim_slave *slave, const char *name, double value)
{
	struct sim_thermometer *s = state(slave);
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
	} else if (strcmp(name, "speed") == 0) {
		if (whole < 1 || whole > 200)
			return -ERANGE;
		s->percent = (int)whole;
	} else if (strcmp(name, "address") == 0 && slave->family->code == FAMILY_1825) {
		if (whole < 0 || whole > 15)
			return -ERANGE;
		s->address = (uint8_t)whole;
	} else {
		return -ENOENT;
	}
	return 0;
}

static const struct sim_input inputs[] = {
	[SIM_TEMPERATURE] = SIM_TEMPERATURE_INPUT,
	{0},
};
static const struct sim_input ea00_inputs[] = {
	[SIM_TEMPERATURE] = SIM_TEMPERATURE_INPUT,
	[SIM_PIN_A] = SIM_PIN("pin.A"),
	[SIM_PIN_B] = SIM_PIN("pin.B"),
	{0},
};

#define THERMOMETER(part, family, ...) \
	{ \
		.name = part, .code = family, .state_size = sizeof(struct sim_thermometer), \
		.create = create, .power_on = power_on, .reset = reset, .alarm = alarm, \
		.received = received, .drained = drained, .bit = bit, .advance = advance, \
		.strong = strong, .option = option, __VA_ARGS__ \
	}

const struct sim_family sim_ds18b20 = THERMOMETER("DS18B20", 0x28, .inputs = inputs);
const struct sim_family sim_ds18s20 = THERMOMETER("DS18S20", FAMILY_S20, .inputs = inputs);
const struct sim_family sim_ds1822 = THERMOMETER("DS1822", 0x22, .inputs = inputs);
const struct sim_family sim_ds1825 = THERMOMETER("DS1825", FAMILY_1825, .inputs = inputs);
const struct sim_family sim_ds28ea00 = THERMOMETER("DS28EA00", FAMILY_EA00, .inputs = ea00_inputs,
                                                   .overdrive = true);
