/* SPDX-License-Identifier: MIT */
/*
 * Microprocessor boards of Hobby Boards: UVI meter, moisture meter, hub, barometer, hygrometer, six
 * thermometers. A command reads or writes one value, low byte first, without a checksum. No manual
 * can be had; the facts are those of OWFS's driver and manual page.
 */
#include <errno.h>
#include <string.h>

#include "hal/sim/families.h"

enum kind { UVI = 1, MOISTURE = 2, HUB = 5, BAROMETER = 6, HUMIDITY = 7, MULTITEMP = 9 };

/* Where the settings lie in the board's EEPROM. */
enum {
	VERSION = 0, /* minor, major */
	POLLING = 2,
	CONFIG = 3,
	LOCATION = 4,
	LOCATION_BYTES = 21,
	OWN = LOCATION + LOCATION_BYTES, /* what the kinds have of their own */
	SETTINGS = OWN + 8,
};
enum { TEMPERATURE_OFFSET = OWN, UVI_OFFSET = OWN + 2, IN_CASE = OWN + 3 };
enum { LEAF = OWN, LEAF_MAX = OWN + 1, LEAF_MIN = OWN + 3 };
enum { HUB_CONFIG = CONFIG, SINGLE_CHANNEL = 0x02, ON = 0x10 };
enum { ALTITUDE = OWN, HUMIDITY_OFFSET = OWN };
enum { NEW_MOISTURE = 1 << 8 | 80 }; /* this version has other commands */
enum { WATERMARK_MOST = 199, LEAF_MOST = 99 };

/* A command, and the bytes that it reads or writes. */
struct variable {
	uint8_t code, size, at; /* at: of a setting */
	bool writes;
	void (*measure)(const struct sim_slave *slave, uint8_t *out); /* not a setting */
	void (*act)(struct sim_slave *slave, const uint8_t *bytes);
};

struct hobby {
	uint8_t settings[SETTINGS];
	uint8_t channels; /* of the hub: those that are on */
	const struct variable *variable;
	uint8_t bytes[LOCATION_BYTES];
};

static enum kind kind_of(const struct sim_slave *slave)
{
	return *(const enum kind *)slave->family->kind;
}

static int setting16(const struct sim_slave *slave, unsigned at)
{
	const uint8_t *from = sim_state(slave, hobby)->settings + at;

	return (int16_t)(from[0] | from[1] << 8);
}

static void hobby_boards_put16(uint8_t *out, double value)
{
	int64_t whole = sim_round(value);

	out[0] = (uint8_t)whole;
	out[1] = (uint8_t)(whole >> 8);
}

static double between(double value, double least, double most)
{
	return value < least ? least : value > most ? most : value;
}

static void hobby_boards_create(struct sim_slave *slave)
{
	uint8_t *settings = sim_state(slave, hobby)->settings;
	enum kind kind = kind_of(slave);

	memset(settings, 0, SETTINGS);
	settings[VERSION + 1] = 1;
	settings[POLLING] = 1;
	memcpy(settings + LOCATION, "nowhere", sizeof("nowhere"));
	if (kind == MOISTURE) {
		hobby_boards_put16(settings + LEAF_MAX, 3000);
		hobby_boards_put16(settings + LEAF_MIN, 500);
	}
}

/* The hub comes up with all channels off. */
static void hobby_boards_power_on(struct sim_slave *slave)
{
	sim_state(slave, hobby)->channels = 0;
}

static void type(const struct sim_slave *slave, uint8_t *out)
{
	out[0] = (uint8_t)kind_of(slave);
}

static void polling_available(const struct sim_slave *slave, uint8_t *out)
{
	(void)slave;
	out[0] = 0x07;
}

static void reboot(struct sim_slave *slave, const uint8_t *bytes)
{
	(void)bytes;
	hobby_boards_power_on(slave);
}

static void factory(struct sim_slave *slave, const uint8_t *bytes)
{
	(void)bytes;
	hobby_boards_create(slave);
}

/* Half degrees. */
static void uvi_temperature(const struct sim_slave *slave, uint8_t *out)
{
	hobby_boards_put16(out, sim_input_now(slave, 1) * 2 + setting16(slave, TEMPERATURE_OFFSET));
}

static void uvi(const struct sim_slave *slave, uint8_t *out)
{
	int8_t offset = (int8_t)sim_state(slave, hobby)->settings[UVI_OFFSET];

	out[0] = (uint8_t)sim_round(between(sim_input_now(slave, 0) * 10 + offset, 0, 160));
}

static void moisture_raw(const struct sim_slave *slave, uint8_t *out)
{
	for (unsigned i = 0; i < 4; i++)
		hobby_boards_put16(out + 2 * i, sim_input_now(slave, i));
}

/* A watermark sensor reads 0 to 199, a leaf's is scaled to 0 to 99. */
static void moisture(const struct sim_slave *slave, uint8_t *out)
{
	double least = setting16(slave, LEAF_MIN), most = setting16(slave, LEAF_MAX);

	for (unsigned i = 0; i < 4; i++) {
		double raw = sim_input_now(slave, i);

		if (sim_state(slave, hobby)->settings[LEAF] >> i & 1)
			raw = most > least ? between((raw - least) * LEAF_MOST / (most - least), 0,
			                             LEAF_MOST)
			                   : 0;
		out[i] = (uint8_t)sim_round(between(raw, 0, WATERMARK_MOST));
	}
}

static void channels(const struct sim_slave *slave, uint8_t *out)
{
	out[0] = sim_state(slave, hobby)->channels;
}

static void shorted(const struct sim_slave *slave, uint8_t *out)
{
	out[0] = 0;
	for (unsigned i = 0; i < 4; i++)
		if (sim_input_now(slave, i) >= 0.5)
			out[0] |= (uint8_t)(1u << i);
}

/* Bits 0 to 3 are switched on, or off; one of them alone takes the others off if so set up. */
static void switch_channels(struct sim_slave *slave, const uint8_t *bytes)
{
	struct hobby *s = slave->state;
	uint8_t which = bytes[0] & 15;

	if (!(bytes[0] & ON))
		s->channels &= (uint8_t)~which;
	else if (!(s->settings[HUB_CONFIG] & SINGLE_CHANNEL))
		s->channels |= which;
	else if (which)
		s->channels = (uint8_t)(which & -which);
}

/* Tenths of a degree, of one sensor or of six. */
static void temperatures(const struct sim_slave *slave, uint8_t *out)
{
	unsigned n = kind_of(slave) == MULTITEMP ? 6 : 1;

	for (unsigned i = 0; i < n; i++)
		hobby_boards_put16(out + 2 * i, sim_input_now(slave, i) * 10);
}

static void pressure(const struct sim_slave *slave, uint8_t *out)
{
	hobby_boards_put16(out, sim_input_now(slave, 1) / 10); /* kPa of mbar */
}

/* Of the standard atmosphere, near enough: 8.3 m a mbar. */
static void pressure_altitude(const struct sim_slave *slave, uint8_t *out)
{
	hobby_boards_put16(out, (1013.25 - sim_input_now(slave, 1)) * 8.3);
}

static void humidity_raw(const struct sim_slave *slave, uint8_t *out)
{
	hobby_boards_put16(out, sim_input_now(slave, 1) * 100);
}

static void humidity(const struct sim_slave *slave, uint8_t *out)
{
	hobby_boards_put16(out, sim_input_now(slave, 1) * 100 + setting16(slave, HUMIDITY_OFFSET));
}

#define COMMON \
	{.code = 0x11, .size = 2, .at = VERSION}, \
	{ \
		.code = 0x12, .size = 1, .measure = type \
	}
#define BOARD \
	{.code = 0x14, .size = 1, .at = POLLING}, \
		{.code = 0x94, .size = 1, .at = POLLING, .writes = true}, \
		{.code = 0x15, .size = 1, .measure = polling_available}, \
		{.code = 0x16, .size = LOCATION_BYTES, .at = LOCATION}, \
		{.code = 0x96, .size = LOCATION_BYTES, .at = LOCATION, .writes = true}, \
		{.code = 0x61, .size = 1, .at = CONFIG}, \
		{.code = 0xE1, .size = 1, .at = CONFIG, .writes = true}, \
		{.code = 0xF1, .act = reboot}, \
	{ \
		.code = 0xF7, .act = factory \
	}

static const struct variable of_uvi[] = {
	COMMON,
	{.code = 0x21, .size = 2, .measure = uvi_temperature},
	{.code = 0x22, .size = 2, .at = TEMPERATURE_OFFSET, .writes = true},
	{.code = 0x23, .size = 2, .at = TEMPERATURE_OFFSET},
	{.code = 0x24, .size = 1, .measure = uvi},
	{.code = 0x25, .size = 1, .at = UVI_OFFSET, .writes = true},
	{.code = 0x26, .size = 1, .at = UVI_OFFSET},
	{.code = 0x27, .size = 1, .at = IN_CASE, .writes = true},
	{.code = 0x28, .size = 1, .at = IN_CASE},
	{0},
};
static const struct variable of_old_moisture[] = {
	COMMON,
	{.code = 0x21, .size = 4, .measure = moisture},
	{.code = 0x22, .size = 1, .at = LEAF, .writes = true},
	{.code = 0x23, .size = 1, .at = LEAF},
	{.code = 0x24, .size = 2, .at = LEAF_MAX, .writes = true},
	{.code = 0x25, .size = 2, .at = LEAF_MAX},
	{.code = 0x26, .size = 2, .at = LEAF_MIN, .writes = true},
	{.code = 0x27, .size = 2, .at = LEAF_MIN},
	{.code = 0x31, .size = 8, .measure = moisture_raw},
	{0},
};
static const struct variable of_new_moisture[] = {
	COMMON,
	{.code = 0x21, .size = 4, .measure = moisture},
	{.code = 0xA2, .size = 1, .at = LEAF, .writes = true},
	{.code = 0x22, .size = 1, .at = LEAF},
	{.code = 0xA3, .size = 2, .at = LEAF_MAX, .writes = true},
	{.code = 0x23, .size = 2, .at = LEAF_MAX},
	{.code = 0xA4, .size = 2, .at = LEAF_MIN, .writes = true},
	{.code = 0x24, .size = 2, .at = LEAF_MIN},
	{.code = 0x31, .size = 8, .measure = moisture_raw},
	{0},
};
static const struct variable of_hub[] = {
	COMMON,
	{.code = 0x21, .size = 1, .act = switch_channels},
	{.code = 0x22, .size = 1, .measure = channels},
	{.code = 0x23, .size = 1, .measure = shorted},
	{.code = 0x60, .size = 1, .at = HUB_CONFIG, .writes = true},
	{.code = 0x61, .size = 1, .at = HUB_CONFIG},
	{0},
};
static const struct variable of_barometer[] = {
	COMMON,
	BOARD,
	{.code = 0x40, .size = 2, .measure = temperatures},
	{.code = 0x22, .size = 2, .measure = pressure},
	{.code = 0x24, .size = 2, .measure = pressure_altitude},
	{.code = 0x26, .size = 2, .at = ALTITUDE},
	{.code = 0xA6, .size = 2, .at = ALTITUDE, .writes = true},
	{0},
};
static const struct variable of_humidity[] = {
	COMMON,
	BOARD,
	{.code = 0x40, .size = 2, .measure = temperatures},
	{.code = 0x21, .size = 2, .measure = humidity},
	{.code = 0x22, .size = 2, .measure = humidity_raw},
	{.code = 0x24, .size = 2, .at = HUMIDITY_OFFSET},
	{.code = 0xA4, .size = 2, .at = HUMIDITY_OFFSET, .writes = true},
	{0},
};
static const struct variable of_multitemp[] = {
	COMMON,
	BOARD,
	{.code = 0x21, .size = 12, .measure = temperatures},
	{0},
};

static const struct variable *hobby_boards_find(const struct sim_slave *slave, uint8_t code)
{
	static const struct variable *const tables[] = {
		[UVI] = of_uvi,           [MOISTURE] = of_old_moisture,
		[HUB] = of_hub,           [BAROMETER] = of_barometer,
		[HUMIDITY] = of_humidity, [MULTITEMP] = of_multitemp,
	};
	enum kind kind = kind_of(slave);
	const struct variable *v = tables[kind];

	if (kind == MOISTURE && setting16(slave, VERSION) >= NEW_MOISTURE)
		v = of_new_moisture;
	while (v->code && v->code != code)
		v++;
	return v->code ? v : NULL;
}

static void hobby_boards_command(struct sim_slave *slave)
{
	struct hobby *s = slave->state;
	const struct variable *v = hobby_boards_find(slave, slave->function->code);

	s->variable = v;
	slave->address = 0;
	if (!v) {
		sim_end(slave);
	} else if (v->act && !v->size) {
		v->act(slave, NULL);
		sim_end(slave);
	} else if (v->measure) {
		v->measure(slave, s->bytes);
		sim_send(slave, s->bytes, v->size);
	} else if (!v->writes && !v->act) {
		sim_send(slave, s->settings + v->at, v->size);
	}
}

static void argument(struct sim_slave *slave, uint8_t byte)
{
	struct hobby *s = slave->state;
	const struct variable *v = s->variable;

	s->bytes[slave->address++] = byte;
	if (slave->address < v->size)
		return;
	if (v->act)
		v->act(slave, s->bytes);
	else
		memcpy(s->settings + v->at, s->bytes, v->size);
	sim_end(slave);
}

static int hobby_boards_option(struct sim_slave *slave, const char *name, double value)
{
	if (strcmp(name, "version") != 0)
		return -ENOENT;
	if (value < 0 || value > 0xFFFF)
		return -ERANGE;
	hobby_boards_put16(sim_state(slave, hobby)->settings + VERSION, value);
	return 0;
}

#define COMMAND(code_) .code = (code_), .start = hobby_boards_command, .byte = argument
static const struct sim_function functions[] = {
	{COMMAND(0x11)}, {COMMAND(0x12)}, {COMMAND(0x14)},
	{COMMAND(0x15)}, {COMMAND(0x16)}, {COMMAND(0x21)},
	{COMMAND(0x22)}, {COMMAND(0x23)}, {COMMAND(0x24)},
	{COMMAND(0x25)}, {COMMAND(0x26)}, {COMMAND(0x27)},
	{COMMAND(0x28)}, {COMMAND(0x31)}, {COMMAND(0x40)},
	{COMMAND(0x60)}, {COMMAND(0x61)}, {COMMAND(0x94)},
	{COMMAND(0x96)}, {COMMAND(0xA2)}, {COMMAND(0xA3)},
	{COMMAND(0xA4)}, {COMMAND(0xA6)}, {COMMAND(0xE1)},
	{COMMAND(0xF1)}, {COMMAND(0xF7)}, {0},
};

#define TEMPERATURE(text) .name = (text), .start = 20, .least = -55, .most = 125
#define RAW(text) .name = (text), .start = 100, .least = 0, .most = 4095
static const struct sim_input uvi_inputs[] = {
	{.name = "uvi", .start = 3, .least = 0, .most = 16}, {TEMPERATURE("temperature")}, {0}};
static const struct sim_input moisture_inputs[] = {
	{RAW("sensor.0")}, {RAW("sensor.1")}, {RAW("sensor.2")}, {RAW("sensor.3")}, {0}};
static const struct sim_input hub_inputs[] = {{SIM_CONDITION("short.0")},
                                              {SIM_CONDITION("short.1")},
                                              {SIM_CONDITION("short.2")},
                                              {SIM_CONDITION("short.3")},
                                              {0}};
static const struct sim_input barometer_inputs[] = {
	{TEMPERATURE("temperature")},
	{.name = "pressure", .start = 1010, .least = 300, .most = 1100},
	{0}};
static const struct sim_input humidity_inputs[] = {
	{TEMPERATURE("temperature")},
	{.name = "humidity", .start = 50, .least = 0, .most = 100},
	{0}};
static const struct sim_input multitemp_inputs[] = {{TEMPERATURE("temperature.0")},
                                                    {TEMPERATURE("temperature.1")},
                                                    {TEMPERATURE("temperature.2")},
                                                    {TEMPERATURE("temperature.3")},
                                                    {TEMPERATURE("temperature.4")},
                                                    {TEMPERATURE("temperature.5")},
                                                    {0}};

#define HB(part, family, which, inputs_) \
	.name = (part), .code = (family), .state_size = sizeof(struct hobby), \
	.kind = &(const enum kind){which}, .functions = functions, .inputs = (inputs_), \
	.create = hobby_boards_create, .power_on = hobby_boards_power_on, \
	.option = hobby_boards_option, SIM_MEMORY(hobby, settings, SETTINGS)

const struct sim_family sim_hb_uvi_meter = {HB("HB_UVI_METER", 0xEE, UVI, uvi_inputs)};
const struct sim_family sim_hb_moisture_meter = {
	HB("HB_MOISTURE_METER", 0xEF, MOISTURE, moisture_inputs)};
const struct sim_family sim_hb_hub = {HB("HB_HUB", 0xEF, HUB, hub_inputs)};
const struct sim_family sim_hb_barometer = {HB("HB_BAROMETER", 0xEF, BAROMETER, barometer_inputs)};
const struct sim_family sim_hb_humidity = {HB("HB_HUMIDITY", 0xEF, HUMIDITY, humidity_inputs)};
const struct sim_family sim_hb_multitemp = {HB("HB_MULTITEMP", 0xEF, MULTITEMP, multitemp_inputs)};
