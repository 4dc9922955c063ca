/* SPDX-License-Identifier: MIT */
/*
 * Battery gauges with 256 addresses: DS2740, DS2751, DS2755, DS2760, DS2770, DS2780, DS2781, and
 * the DS2720, which protects a cell and measures nothing (data sheets), each a kind that says where
 * the part has its registers. The DS2755's data sheet could not be had: it has the registers of the
 * DS2756 here, without the suspend mode. Nor could the page of the DS2751's that has the power-on
 * bit: the bit is where OWFS has it. The capacities that a DS2780 computes are not simulated, and
 * its flags of them are inputs.
 */
#include "hal/sim/chips/gauge.h"
#include "hal/sim/families.h"

#define RULE(from, to, bits) .used = true, .first = (from), .last = (to), .write = (bits)
#define ACR \
	{ \
		RULE(ACCUMULATED, ACCUMULATED + 1, 0xFF) \
	}
#define SRAM \
	{ \
		RULE(0x80, 0x8F, 0xFF) \
	}
#define EEPROM_RULE(at) .used = true, .first = (at), .last = (at), .set = LOCK

static const struct gauge_kind ds2720 = {
	.block = {{0x20, 4}, {0x30, 4}},
	.rules = {{.used = true, .write = CE | DE, .clear = OV | UV | DOC},
                  {EEPROM_RULE(0x07)},
                  {RULE(0x08, 0x08, OT | PSF)}},
	.eeprom = 0x07,
	.special = 0x08,
	.por = PSF,
	.por_at = 0x08,
	.protects = true,
	.no_gauge = true,
};
static const struct gauge_kind ds2740 = {
	.rules = {{RULE(STATUS, STATUS, 0x50)}, {RULE(0x08, 0x08, 0x40)}, ACR},
	.special = 0x08,
	.pio = 0x40,
	.fine = true,
};
static const struct gauge_kind ds2751 = {
	.block = {{0x20, 16}, {0x30, 16}},
	.rules = {{EEPROM_RULE(0x07)},
                  {.used = true, .first = 8, .last = 8, .write = 0x40, .clear = 1},
                  ACR,
                  SRAM},
	.eeprom = 0x07,
	.defaults = 0x38,
	.from = 0x31,
	.special = 0x08,
	.pio = 0x40,
	.por = 0x01,
	.por_at = 0x08,
	.celsius = 0x18,
	.bias = 0x33,
	.volt = 4.88e-3,
};
static const struct gauge_kind ds2755 = {
	.block = {{0x20, 32}, {0x40, 32}, {0x60, 32}},
	.rules = {{EEPROM_RULE(0x07)},
                  {.used = true, .first = 8, .last = 8, .write = 0x44, .clear = 0x80},
                  ACR,
                  SRAM},
	.eeprom = 0x07,
	.defaults = 0xFF,
	.from = 0x31,
	.special = 0x08,
	.pio = 0x40,
	.por = 0x80,
	.por_at = 0x08,
	.celsius = 0x18,
	.average = 0x1A,
	.accumbias = 0x33,
	.volt = 4.88e-3,
};
static const struct gauge_kind ds2760 = {
	.block = {{0x20, 16}, {0x30, 16}},
	.rules = {{.used = true, .write = CE | DE, .clear = OV | UV | COC | DOC},
                  {EEPROM_RULE(0x07)},
                  {.used = true, .first = 8, .last = 8, .write = 0x40, .set = PSF},
                  ACR,
                  SRAM},
	.eeprom = 0x07,
	.defaults = 0x38,
	.from = 0x31,
	.special = 0x08,
	.pio = 0x40,
	.por = PSF,
	.por_at = 0x08,
	.celsius = 0x18,
	.bias = 0x33,
	.volt = 4.88e-3,
	.protects = true,
	.conditions = FLAGS,
};
static const struct gauge_kind ds2770 = {
	.block = {{0x20, 16}, {0x30, 16}, {0x40, 8}},
	.rules = {{.used = true, .first = STATUS, .last = STATUS, .clear = 0},
                  {RULE(0x02, 0x03, 0xFF)},
                  {RULE(0x06, 0x06, 0xFF)},
                  {EEPROM_RULE(0x07)},
                  ACR,
                  SRAM},
	.eeprom = 0x07,
	.defaults = 0x33,
	.from = 0x31,
	.celsius = 0x18,
	.bias = 0x32,
	.wide_bias = true,
	.fine = true,
	.volt = 4.88e-3,
};

#define DS278X_RULES \
	{ \
		{.used = true, .first = STATUS, .last = STATUS, .clear = UVF | PORF}, ACR, \
			{RULE(0x14, 0x14, 0xFF)}, {RULE(0x15, 0x15, 0x01)}, \
		{ \
			EEPROM_RULE(0x1F) \
		} \
	}
static const struct gauge_kind ds2780 = {
	.block = {{0x20, 16}, {0x60, 32}},
	.rules = DS278X_RULES,
	.eeprom = 0x1F,
	.special = 0x15,
	.pio = 0x01,
	.por = PORF,
	.por_at = STATUS,
	.celsius = 0x0A,
	.average = 0x08,
	.accumbias = 0x61,
	.fine = true,
	.keeps = true,
	.volt = 4.88e-3,
};
static const struct gauge_kind ds2781 = {
	.block = {{0x20, 16}, {0x60, 32}},
	.rules = DS278X_RULES,
	.eeprom = 0x1F,
	.special = 0x15,
	.pio = 0x01,
	.por = PORF,
	.por_at = STATUS,
	.celsius = 0x0A,
	.average = 0x08,
	.bias = 0x7B,
	.add_bias = true,
	.accumbias = 0x61,
	.fine = true,
	.keeps = true,
	.volt = 9.76e-3,
};

static void gauges_create(struct sim_slave *slave)
{
	if (slave->family->code == 0x30) /* factory default: both are enabled */
		sim_state(slave, gauge)->eeprom[1][0] = CE | DE;
}

#define MEASURED \
	[TEMPERATURE] = {SIM_TEMPERATURE_INPUT}, [VOLT] = {.name = "volt", .start = 3.7}, \
	[VIS] = {.name = "vis"} /* mV across the resistor */

static const struct sim_input ds2720_inputs[] = {
	{SIM_CONDITION("overvoltage")},
	{SIM_CONDITION("undervoltage")},
	{SIM_CONDITION("overcurrent")},
	{SIM_CONDITION("overtemperature")},
	{SIM_PIN("ps")},
	{0},
};
static const struct sim_input inputs[] = {MEASURED, [PIN] = {SIM_PIN("pin")}, {0}};
static const struct sim_input ds2760_inputs[] = {
	MEASURED,
	[PIN] = {SIM_PIN("pin")},
	[FLAGS] = {SIM_CONDITION("overvoltage")},
	{SIM_CONDITION("undervoltage")},
	{SIM_CONDITION("charge_overcurrent")},
	{SIM_CONDITION("discharge_overcurrent")},
	{SIM_PIN("ps")},
	{0},
};
static const struct sim_input ds2770_inputs[] = {
	MEASURED,
	[CHARGER] = {SIM_CONDITION("charger")},
	[FULL] = {SIM_CONDITION("full")},
	{0},
};
static const struct sim_input ds278x_inputs[] = {
	MEASURED,
	[PIN] = {SIM_PIN("pin")},
	[FLAGS] = {SIM_CONDITION("charged")},
	{SIM_CONDITION("active_empty")},
	{SIM_CONDITION("standby_empty")},
	{SIM_CONDITION("learning")},
	{0},
};

/* Its memory is recalled from the EEPROM at power-on. */
#define GAUGE(part, family, sizes, commands, measures) \
	GAUGE_OF(part, family, sizes, commands, measures, GAUGE_BLOCKS *GAUGE_BLOCK)
#define GAUGE_OF(part, family, sizes, commands, measures, bytes) \
	.name = (part), .code = (family), .state_size = sizeof(struct gauge), .kind = &(sizes), \
	.functions = (commands), .inputs = (measures), .power_on = sim_gauge_power_on, \
	.begun = sim_gauge_begun, .worked = sim_gauge_worked, .advance = sim_gauge_advance, \
	.create = gauges_create, SIM_MEMORY(gauge, eeprom, bytes)

const struct sim_family sim_ds2720 = {
	GAUGE_OF("DS2720", 0x31, ds2720, sim_gauge_functions, ds2720_inputs, 8)};
const struct sim_family sim_ds2740 = {GAUGE("DS2740", 0x36, ds2740, sim_ds2740_functions, inputs)};
const struct sim_family sim_ds2751 = {GAUGE("DS2751", 0x51, ds2751, sim_gauge_functions, inputs)};
const struct sim_family sim_ds2755 = {GAUGE("DS2755", 0x35, ds2755, sim_gauge_functions, inputs)};
const struct sim_family sim_ds2760 = {
	GAUGE("DS2760", 0x30, ds2760, sim_gauge_functions, ds2760_inputs)};
const struct sim_family sim_ds2770 = {
	GAUGE("DS2770", 0x2E, ds2770, sim_ds2770_functions, ds2770_inputs)};
const struct sim_family sim_ds2780 = {
	GAUGE("DS2780", 0x32, ds2780, sim_gauge_functions, ds278x_inputs)};
const struct sim_family sim_ds2781 = {
	GAUGE("DS2781", 0x3D, ds2781, sim_gauge_functions, ds278x_inputs)};
