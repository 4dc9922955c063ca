/* SPDX-License-Identifier: MIT */
/*
 * Microprocessor boards of Hobby Boards: UVI meter, moisture meter, hub, barometer, hygrometer, six
 * thermometers. A command reads or writes one value, low byte first, without a checksum. No manual
 * can be had; the facts are those of OWFS's driver and manual page.
 */
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

/* A value of the board: the commands that read and write it, 0 for none, and its bytes. */
struct variable {
	uint8_t read, write, size, at;                                /* at: of a setting */
	void (*measure)(const struct sim_slave *slave, uint8_t *out); /* not a setting */
	void (*act)(struct sim_slave *slave, const uint8_t *bytes);
};

struct hobby {
	uint8_t settings[SETTINGS];
	uint8_t channels; /* of the hub: those that are on */
	const struct variable *variable;
	uint8_t bytes[LOCATION_BYTES];
};

static enum kind board_of(const struct sim_slave *slave)
{
	return *(const enum kind *)slave->family->kind;
}

static int setting16(const struct sim_slave *slave, unsigned at)
{
	return (int16_t)sim_get(sim_state(slave, hobby)->settings + at, 2);
}

static void put_rounded(uint8_t *out, double value)
{
	sim_put(out, 2, sim_round(value));
}

static void hobby_boards_create(struct sim_slave *slave)
{
	uint8_t *settings = sim_state(slave, hobby)->settings;
	enum kind kind = board_of(slave);

	memset(settings, 0, SETTINGS);
	settings[VERSION + 1] = 1;
	settings[POLLING] = 1;
	memcpy(settings + LOCATION, "nowhere", sizeof("nowhere"));
	if (kind == MOISTURE) {
		put_rounded(settings + LEAF_MAX, 3000);
		put_rounded(settings + LEAF_MIN, 500);
	}
}

/* The hub comes up with all channels off. */
static void hobby_boards_power_on(struct sim_slave *slave)
{
	sim_state(slave, hobby)->channels = 0;
}

static void board_type(const struct sim_slave *slave, uint8_t *out)
{
	out[0] = (uint8_t)board_of(slave);
}

static void polling_available(const struct sim_slave *slave, uint8_t *out)
{
	(void)slave;
	out[0] = 0x07;
}

static void reboot_board(struct sim_slave *slave, const uint8_t *bytes)
{
	(void)bytes;
	hobby_boards_power_on(slave);
}

static void reset_settings(struct sim_slave *slave, const uint8_t *bytes)
{
	(void)bytes;
	hobby_boards_create(slave);
}

/* Half degrees. */
static void uvi_temperature(const struct sim_slave *slave, uint8_t *out)
{
	put_rounded(out, sim_input_now(slave, 1) * 2 + setting16(slave, TEMPERATURE_OFFSET));
}

static void uvi_index(const struct sim_slave *slave, uint8_t *out)
{
	int8_t offset = (int8_t)sim_state(slave, hobby)->settings[UVI_OFFSET];

	out[0] = (uint8_t)sim_within(sim_input_now(slave, 0) * 10 + offset, 0, 160);
}

static void moisture_raw(const struct sim_slave *slave, uint8_t *out)
{
	for (unsigned i = 0; i < 4; i++)
		put_rounded(out + 2 * i, sim_input_now(slave, i));
}

/* A watermark sensor reads 0 to 199, a leaf's is scaled to 0 to 99. */
static void moisture(const struct sim_slave *slave, uint8_t *out)
{
	double least = setting16(slave, LEAF_MIN), most = setting16(slave, LEAF_MAX);

	for (unsigned i = 0; i < 4; i++) {
		bool leaf = sim_state(slave, hobby)->settings[LEAF] >> i & 1;
		double raw = sim_input_now(slave, i);

		if (leaf)
			raw = most > least ? (raw - least) * LEAF_MOST / (most - least) : 0;
		out[i] = (uint8_t)sim_within(raw, 0, leaf ? LEAF_MOST : WATERMARK_MOST);
	}
}

static void hub_channels(const struct sim_slave *slave, uint8_t *out)
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
	unsigned n = board_of(slave) == MULTITEMP ? 6 : 1;

	for (unsigned i = 0; i < n; i++)
		put_rounded(out + 2 * i, sim_input_now(slave, i) * 10);
}

static void pressure(const struct sim_slave *slave, uint8_t *out)
{
	put_rounded(out, sim_input_now(slave, 1) / 10); /* kPa of mbar */
}

/* Of the standard atmosphere, near enough: 8.3 m a mbar. */
static void pressure_altitude(const struct sim_slave *slave, uint8_t *out)
{
	put_rounded(out, (1013.25 - sim_input_now(slave, 1)) * 8.3);
}

static void humidity_raw(const struct sim_slave *slave, uint8_t *out)
{
	put_rounded(out, sim_input_now(slave, 1) * 100);
}

static void humidity_now(const struct sim_slave *slave, uint8_t *out)
{
	put_rounded(out, sim_input_now(slave, 1) * 100 + setting16(slave, HUMIDITY_OFFSET));
}

#define COMMON \
	{.read = 0x11, .size = 2, .at = VERSION}, \
	{ \
		.read = 0x12, .size = 1, .measure = board_type \
	}
#define BOARD \
	{.read = 0x14, .write = 0x94, .size = 1, .at = POLLING}, \
		{.read = 0x15, .size = 1, .measure = polling_available}, \
		{.read = 0x16, .write = 0x96, .size = LOCATION_BYTES, .at = LOCATION}, \
		{.read = 0x61, .write = 0xE1, .size = 1, .at = CONFIG}, \
		{.write = 0xF1, .act = reboot_board}, \
	{ \
		.write = 0xF7, .act = reset_settings \
	}

static const struct variable of_uvi[] = {
	COMMON,
	{.read = 0x21, .size = 2, .measure = uvi_temperature},
	{.read = 0x23, .write = 0x22, .size = 2, .at = TEMPERATURE_OFFSET},
	{.read = 0x24, .size = 1, .measure = uvi_index},
	{.read = 0x26, .write = 0x25, .size = 1, .at = UVI_OFFSET},
	{.read = 0x28, .write = 0x27, .size = 1, .at = IN_CASE},
	{0},
};
static const struct variable of_old_moisture[] = {
	COMMON,
	{.read = 0x21, .size = 4, .measure = moisture},
	{.read = 0x23, .write = 0x22, .size = 1, .at = LEAF},
	{.read = 0x25, .write = 0x24, .size = 2, .at = LEAF_MAX},
	{.read = 0x27, .write = 0x26, .size = 2, .at = LEAF_MIN},
	{.read = 0x31, .size = 8, .measure = moisture_raw},
	{0},
};
static const struct variable of_new_moisture[] = {
	COMMON,
	{.read = 0x21, .size = 4, .measure = moisture},
	{.read = 0x22, .write = 0xA2, .size = 1, .at = LEAF},
	{.read = 0x23, .write = 0xA3, .size = 2, .at = LEAF_MAX},
	{.read = 0x24, .write = 0xA4, .size = 2, .at = LEAF_MIN},
	{.read = 0x31, .size = 8, .measure = moisture_raw},
	{0},
};
static const struct variable of_hub[] = {
	COMMON,
	{.write = 0x21, .size = 1, .act = switch_channels},
	{.read = 0x22, .size = 1, .measure = hub_channels},
	{.read = 0x23, .size = 1, .measure = shorted},
	{.read = 0x61, .write = 0x60, .size = 1, .at = HUB_CONFIG},
	{0},
};
static const struct variable of_barometer[] = {
	COMMON,
	BOARD,
	{.read = 0x40, .size = 2, .measure = temperatures},
	{.read = 0x22, .size = 2, .measure = pressure},
	{.read = 0x24, .size = 2, .measure = pressure_altitude},
	{.read = 0x26, .write = 0xA6, .size = 2, .at = ALTITUDE},
	{0},
};
static const struct variable of_humidity[] = {
	COMMON,
	BOARD,
	{.read = 0x40, .size = 2, .measure = temperatures},
	{.read = 0x21, .size = 2, .measure = humidity_now},
	{.read = 0x22, .size = 2, .measure = humidity_raw},
	{.read = 0x24, .write = 0xA4, .size = 2, .at = HUMIDITY_OFFSET},
	{0},
};
static const struct variable of_multitemp[] = {
	COMMON,
	BOARD,
	{.read = 0x21, .size = 12, .measure = temperatures},
	{0},
};

static const struct variable *hobby_boards_find(const struct sim_slave *slave, uint8_t code)
{
	static const struct variable *const tables[] = {
		[UVI] = of_uvi,           [MOISTURE] = of_old_moisture,
		[HUB] = of_hub,           [BAROMETER] = of_barometer,
		[HUMIDITY] = of_humidity, [MULTITEMP] = of_multitemp,
	};
	enum kind kind = board_of(slave);
	const struct variable *v = tables[kind];

	if (kind == MOISTURE && setting16(slave, VERSION) >= NEW_MOISTURE)
		v = of_new_moisture;
	for (; v->read || v->write; v++)
		if (v->read == code || v->write == code)
			return v;
	return NULL;
}

static void hobby_boards_command(struct sim_slave *slave)
{
	struct hobby *s = slave->state;
	const struct variable *v = hobby_boards_find(slave, slave->code);

	s->variable = v;
	if (!v) {
		sim_end(slave);
	} else if (slave->code == v->read) {
		if (v->measure)
			v->measure(slave, s->bytes);
		else
			memcpy(s->bytes, s->settings + v->at, v->size);
		sim_send(slave, s->bytes, v->size);
	} else if (!v->size) {
		v->act(slave, NULL);
		sim_end(slave);
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

static void set_version(struct sim_slave *slave, int64_t version)
{
	sim_put(sim_state(slave, hobby)->settings + VERSION, 2, version);
}

static const struct sim_option options[] = {{"version", 0, 0xFFFF, .set = set_version}, {0}};

static const struct sim_function functions[] = {
	{.any = true, .start = hobby_boards_command, .byte = argument}, {0}};

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
	.create = hobby_boards_create, .power_on = hobby_boards_power_on, .options = options, \
	SIM_MEMORY(hobby, settings, SETTINGS)

const struct sim_family sim_hb_uvi_meter = {HB("HB_UVI_METER", 0xEE, UVI, uvi_inputs)};
const struct sim_family sim_hb_moisture_meter = {
	HB("HB_MOISTURE_METER", 0xEF, MOISTURE, moisture_inputs)};
const struct sim_family sim_hb_hub = {HB("HB_HUB", 0xEF, HUB, hub_inputs)};
const struct sim_family sim_hb_barometer = {HB("HB_BAROMETER", 0xEF, BAROMETER, barometer_inputs)};
const struct sim_family sim_hb_humidity = {HB("HB_HUMIDITY", 0xEF, HUMIDITY, humidity_inputs)};
const struct sim_family sim_hb_multitemp = {HB("HB_MULTITEMP", 0xEF, MULTITEMP, multitemp_inputs)};
