/* SPDX-License-Identifier: MIT */
/* The kinds of EDS's sensors: registers, limits, flags, inputs (eds.c says where they are from). */
#include <math.h>

#include "hal/sim/chips/eds.h"
#include "hal/sim/families.h"

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static double input_now(struct sim_slave *slave, const char *name)
{
	return sim_input_now(slave, (unsigned)sim_slave_input(slave, name));
}

/* Magnus's formula: the pressure of water vapour over its pressure at 0 degrees, as a logarithm. */
static double magnus(double temperature)
{
	return 17.62 * temperature / (243.12 + temperature);
}

static double humidity_part(struct sim_slave *slave)
{
	return fmax(input_now(slave, "humidity"), 1) / 100;
}

static double dew_point(struct sim_slave *slave)
{
	double gamma = log(humidity_part(slave)) + magnus(input_now(slave, "temperature"));

	return 243.12 * gamma / (17.62 - gamma);
}

static double humidex(struct sim_slave *slave)
{
	double temperature = input_now(slave, "temperature");

	return temperature +
	       5.0 / 9 * (6.112 * exp(magnus(temperature)) * humidity_part(slave) - 10);
}

/* Steadman's simple formula; the chip's own is not known. */
static double heat_index(struct sim_slave *slave)
{
	double f = input_now(slave, "temperature") * 1.8 + 32;

	f = 0.5 * (f + 61 + (f - 68) * 1.2 + humidity_part(slave) * 9.4);
	return (f - 32) / 1.8;
}

static double inches_of_mercury(struct sim_slave *slave)
{
	return input_now(slave, "pressure") / 33.8638866667;
}

/* IEC 60751: a Pt100. */
static double resistance(struct sim_slave *slave)
{
	double c = input_now(slave, "temperature");
	double below = c < 0 ? -4.183e-12 * (c - 100) * c * c * c : 0;

	return 100 * (1 + 3.9083e-3 * c - 5.775e-7 * c * c + below);
}

/* EDS0064 to EDS0068. */
static const struct eds_quantity environment[] = {
	{"temperature", NULL, 1 / 16.0, 0x22, 2, 0x42, 0x43, 1, 0, .coarse = true},
	{"humidity", NULL, 1 / 16.0, 0x24, 2, 0x44, 0x45, 1, 2, .coarse = true},
	{NULL, dew_point, 1 / 16.0, 0x26, 2, 0x46, 0x47, 1, 4, .coarse = true},
	{NULL, humidex, 1 / 16.0, 0x28, 2, 0x48, 0x49, 1, 6, .coarse = true},
	{NULL, heat_index, 1 / 16.0, 0x2A, 2, 0x4A, 0x4B, 1, 8, .coarse = true},
	{"pressure", NULL, 1 / 2048.0, 0x2C, 3, 0x4C, 0x4F, 3, 10},
	{NULL, inches_of_mercury, 1 / 2048.0, 0x2F, 3, 0x52, 0x55, 3, 12},
	{"light", NULL, 1, 0x32, 3, 0x58, 0x5B, 3, 14},
};
enum { WARMTH = 0x01, WATER = 0x1E, AIR = 0x60, LIGHT = 0x80 }; /* bits of them */

/*
 * EDS0070. Its limits have two bytes: that is the distance of their addresses, and the scale ends
 * at 1023.
 */
static const struct eds_quantity vibration[] = {
	{"vibration", NULL, 1, 0x24, 2, 0x44, 0x46, 2, 2, .min = 0x30, .max = 0x28},
};

/* EDS0071, EDS0072. No source says what a conversion's number means. */
static const struct eds_quantity rtd[] = {
	{"temperature", NULL, 1 / 2048.0, 0x22, 3, 0x42, 0x45, 3, 0},
	{NULL, resistance, 1 / 2048.0, 0x25, 3, 0x48, 0x4B, 3, 2},
	{NULL, resistance, 1 / 32768.0, 0x28, 3},
};

/* EDS0080 to EDS0085: mA or volts. */
#define ANALOG(name, i) \
	name "." #i, NULL, 1 / 2048.0, 0x30 + 2 * (i), 2, 0x70 + 4 * (i), 0x72 + 4 * (i), 2, \
		2 * (i), 0x40 + 2 * (i), 0x50 + 2 * (i)
#define ANALOGS(name) \
	{ \
		{ANALOG(name, 0)}, {ANALOG(name, 1)}, {ANALOG(name, 2)}, {ANALOG(name, 3)}, \
			{ANALOG(name, 4)}, {ANALOG(name, 5)}, {ANALOG(name, 6)}, \
		{ \
			ANALOG(name, 7) \
		} \
	}
static const struct eds_quantity currents[] = ANALOGS("current");
static const struct eds_quantity voltages[] = ANALOGS("volt");

#define HUMIDITY_INPUT .name = "humidity", .start = 50, .least = 0, .most = 100
#define PRESSURE_INPUT .name = "pressure", .start = 1013.25, .least = 100, .most = 2000
#define LIGHT_INPUT .name = "light", .start = 100, .least = 0, .most = 0x7FFFFF
#define MILLIAMPERES(i) .name = "current." #i, .start = 4, .least = 0, .most = 24
#define VOLTS(i) .name = "volt." #i, .least = 0, .most = 10

static const struct sim_input inputs_64[] = {{SIM_TEMPERATURE_INPUT}, {0}};
static const struct sim_input inputs_65[] = {{SIM_TEMPERATURE_INPUT}, {HUMIDITY_INPUT}, {0}};
static const struct sim_input inputs_66[] = {{SIM_TEMPERATURE_INPUT}, {PRESSURE_INPUT}, {0}};
static const struct sim_input inputs_67[] = {{SIM_TEMPERATURE_INPUT}, {LIGHT_INPUT}, {0}};
static const struct sim_input inputs_68[] = {
	{SIM_TEMPERATURE_INPUT}, {HUMIDITY_INPUT}, {PRESSURE_INPUT}, {LIGHT_INPUT}, {0}};
static const struct sim_input inputs_70[] = {{.name = "vibration", .least = 0, .most = 1023}, {0}};
static const struct sim_input inputs_71[] = {
	{.name = "temperature", .start = 20, .least = -200, .most = 850}, {0}};
static const struct sim_input inputs_80[] = {
	{MILLIAMPERES(0)}, {MILLIAMPERES(1)}, {MILLIAMPERES(2)},
	{MILLIAMPERES(3)}, {MILLIAMPERES(4)}, {MILLIAMPERES(5)},
	{MILLIAMPERES(6)}, {MILLIAMPERES(7)}, {0}};
static const struct sim_input inputs_83[] = {
	{MILLIAMPERES(0)}, {MILLIAMPERES(1)}, {MILLIAMPERES(2)}, {MILLIAMPERES(3)}, {0}};
static const struct sim_input inputs_82[] = {{VOLTS(0)}, {VOLTS(1)}, {VOLTS(2)},
                                             {VOLTS(3)}, {VOLTS(4)}, {VOLTS(5)},
                                             {VOLTS(6)}, {VOLTS(7)}, {0}};
static const struct sim_input inputs_85[] = {{VOLTS(0)}, {VOLTS(1)}, {VOLTS(2)}, {VOLTS(3)}, {0}};
static const struct sim_input inputs_90[] = {
	{SIM_PIN("pin.0")}, {SIM_PIN("pin.1")}, {SIM_PIN("pin.2")},
	{SIM_PIN("pin.3")}, {SIM_PIN("pin.4")}, {SIM_PIN("pin.5")},
	{SIM_PIN("pin.6")}, {SIM_PIN("pin.7")}, {0}};

/* Size of the memory, what of it can be written; registers: alarms, enables, seconds, relay. */
#define KIND(number, text, bytes, from, flags, flag_bytes, enables, time, switches) \
	.memory = {.size = (bytes), .writable = (bytes), .page = 32, .copy_ns = EDS_COPY_NS}, \
	.id = 0x##number, .tag = (text), .writable = (from), .alarm = (flags), \
	.alarm_bytes = (flag_bytes), .enable = (enables), .seconds = (time), .relay = (switches)
#define MEASURES(what, which) \
	.quantities = (what), .quantity_count = COUNT(what), .measures = (which)
#define ENVIRONMENT(number, text, which) \
	KIND(number, text, 0x60, 0x40, 0x3A, 2, 0x40, 0x3C, 0x5E), MEASURES(environment, which)
#define RTD(number, text) \
	KIND(number, text, 0x60, 0x40, 0x36, 1, 0x40, 0x3C, 0x5E), MEASURES(rtd, 0x07), \
		.samples = 0x38, .delay = 0x5D
#define OCTAL(number, text, what, which) \
	KIND(number, text, 0xA0, 0x60, 0x2A, 2, 0x9A, 0x2C, 0x9E), MEASURES(what, which)

/* clang-format off */
#define EDS(part, bytes, its_inputs, ...) \
	static const struct eds_kind kind_##part = __VA_ARGS__; \
	const struct sim_family sim_eds00##part = { \
		.name = "EDS00" #part, .code = 0x7E, .state_size = sizeof(struct eds), \
		.kind = &kind_##part, .functions = eds_functions, .inputs = (its_inputs), \
		.create = eds_create, .power_on = eds_power_on, .bit = sim_scratchpad_bit, \
		.worked = eds_worked, .advance = eds_advance, .alarm = eds_alarm, \
		SIM_MEMORY(eds, memory.memory, bytes), \
	}
EDS(64, 0x60, inputs_64, {ENVIRONMENT(64, "OW-ENV-T", WARMTH)});
EDS(65, 0x60, inputs_65, {ENVIRONMENT(65, "OW-ENV-TH", WARMTH | WATER)});
EDS(66, 0x60, inputs_66, {ENVIRONMENT(66, "OW-ENV-TP", WARMTH | AIR)});
EDS(67, 0x60, inputs_67, {ENVIRONMENT(67, "OW-ENV-TL", WARMTH | LIGHT)});
EDS(68, 0x60, inputs_68, {ENVIRONMENT(68, "OW-ENV-THPL", WARMTH | WATER | AIR | LIGHT)});
EDS(70, 0x60, inputs_70, {KIND(70, "OW-VIBRATION", 0x60, 0x40, 0x36, 1, 0x40, 0x3C, 0x5E),
                    MEASURES(vibration, 0x01), .peak = 0x26});
EDS(71, 0x60, inputs_71, {RTD(71, "OW-RTD-4W")});
EDS(72, 0x60, inputs_71, {RTD(72, "OW-RTD-3W")});
EDS(80, 0xA0, inputs_80, {OCTAL(80, "OW-IO-AI8-420", currents, 0xFF)});
EDS(82, 0xA0, inputs_82, {OCTAL(82, "OW-IO-AI8-10V", voltages, 0xFF)});
EDS(83, 0xA0, inputs_83, {OCTAL(83, "OW-IO-AI4-420", currents, 0x0F)});
EDS(85, 0xA0, inputs_85, {OCTAL(85, "OW-IO-AI4-10V", voltages, 0x0F)});
EDS(90, 0x60, inputs_90, {KIND(90, "OW-IO-DIO8", 0x60, 0x50, 0x2A, 2, 0x50, 0x2C, 0x5E),
                    .digital = true});
/* clang-format on */
