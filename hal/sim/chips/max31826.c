/* SPDX-License-Identifier: MIT */
/*
 * The parts of family 3B other than the DS1825: MAX31826 (data sheet 19-6264), a thermometer with 1
 * kbit of EEPROM, and MAX31850 (19-6725), which measures a thermocouple and its cold junction.
 */
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/chips/thermometer.h"
#include "hal/sim/families.h"

enum { KEY = 0xA5, READ_POWER = 0xB4 };
enum { TEMPERATURE, THERMOCOUPLE, OPEN_CIRCUIT, GROUND_SHORT, VDD_SHORT }; /* inputs */

/* tCONV: 150 ms (MAX31826), 100 ms (MAX31850) at most. */
/* tWR of the EEPROM: 10 ms. */
#define COPY_NS (10 * NS_PER_MS)

static bool is_max31850(const struct sim_slave *slave)
{
	return slave->family == &sim_max31850;
}

static void max31826_create(struct sim_slave *slave)
{
	memset(sim_state(slave, sim_max)->memory, 0xFF, SIM_MAX_MEMORY);
}

static void max31826_power_on(struct sim_slave *slave)
{
	struct sim_max *s = slave->state;

	memset(s->scratchpad, 0xFF, 8);
	sim_put(s->scratchpad, 2, is_max31850(slave) ? 0 : 85 * 16);
	if (is_max31850(slave))
		sim_put(s->scratchpad + 2, 2, 0);
	s->scratchpad[4] = (uint8_t)(0xF0 | s->address);
	s->copying = false;
}

/*
 * The thermocouple has 14 bits of 0.25 above two bits, the lower of which is the fault; the cold
 * junction has 12 bits of 0.0625 above four.
 */
static void measure_thermocouple(struct sim_slave *slave)
{
	struct sim_max *s = slave->state;
	int faults = 0;

	for (unsigned i = 0; i < 3; i++)
		faults |= (sim_input_now(slave, OPEN_CIRCUIT + i) >= 0.5) << i;
	sim_put(s->scratchpad, 2,
	        sim_within(sim_input_now(slave, THERMOCOUPLE) * 4, -270 * 4, 1800 * 4) * 4 +
	                (faults != 0));
	sim_put(s->scratchpad + 2, 2,
	        sim_within(sim_input_now(slave, TEMPERATURE) * 16, -55 * 16, 2047) * 16 + faults);
}

static void max31826_worked(struct sim_slave *slave)
{
	struct sim_max *s = slave->state;

	if (s->copying) {
		memcpy(s->memory + s->target, s->second, SIM_MAX_PAGE);
		return;
	}
	slave->conversions++;
	if (is_max31850(slave))
		measure_thermocouple(slave);
	else
		sim_put(s->scratchpad, 2,
		        sim_within(sim_input_now(slave, TEMPERATURE) * 16, -55 * 16, 125 * 16));
}

static bool max31826_bit(struct sim_slave *slave)
{
	return slave->function->code == READ_POWER ? !slave->parasite : !slave->busy;
}

static void max31826_convert(struct sim_slave *slave)
{
	sim_state(slave, sim_max)->copying = false;
	sim_work(slave, (is_max31850(slave) ? 100 : 150) * NS_PER_MS);
}

static void max31826_read_scratchpad(struct sim_slave *slave)
{
	sim_send_crc8(slave, sim_state(slave, sim_max)->scratchpad, 8);
}

/* --- The memory of the MAX31826: pages of 8 bytes, by a second scratchpad --------------------- */

static void max31826_read_memory(struct sim_slave *slave)
{
	sim_send_memory(slave, sim_state(slave, sim_max)->memory, SIM_MAX_MEMORY, 0);
}

static void set_target(struct sim_slave *slave)
{
	sim_state(slave, sim_max)->target = slave->taken[0] & (SIM_MAX_MEMORY - SIM_MAX_PAGE);
	slave->address = 0;
}

static void write_second(struct sim_slave *slave, uint8_t byte)
{
	sim_state(slave, sim_max)->second[slave->address++] = byte;
	if (slave->address == SIM_MAX_PAGE)
		sim_end(slave);
}

static void read_second(struct sim_slave *slave)
{
	struct sim_max *s = slave->state;

	s->second[0] ^= s->garbled;
	sim_send_crc8(slave, s->second, SIM_MAX_PAGE);
	s->second[0] ^= s->garbled;
}

static void max31826_copy(struct sim_slave *slave)
{
	struct sim_max *s = slave->state;

	if (slave->taken[0] == KEY) {
		s->copies++;
		s->copying = true;
		if (!s->locked)
			sim_work(slave, COPY_NS);
	}
	sim_end(slave);
}

static const struct sim_option options[] = {SIM_OPTION(sim_max, "address", 0, 15, address), {0}};

#define FUNCTIONS \
	{.code = 0x44, .start = max31826_convert}, \
		{.code = 0xBE, .start = max31826_read_scratchpad}, \
	{ \
		.code = READ_POWER, .start = sim_send_bits \
	}
static const struct sim_function max31826_functions[] = {
	FUNCTIONS,
	{.code = 0xF0, .takes = 1, .start = max31826_read_memory, .next = max31826_read_memory},
	/* Write, Read, Copy Scratchpad 2 */
	{.code = 0x0F, .takes = 1, .start = set_target, .byte = write_second},
	{.code = 0xAA, .takes = 1, .start = read_second},
	{.code = 0x55, .takes = 1, .start = max31826_copy},
	{0},
};
static const struct sim_function max31850_functions[] = {FUNCTIONS, {0}};

static const struct sim_input max31826_inputs[] = {{SIM_TEMPERATURE_INPUT}, {0}};
static const struct sim_input max31850_inputs[] = {
	[TEMPERATURE] = {.name = "temperature", .start = 20, .least = -55, .most = 127.9375},
	[THERMOCOUPLE] = {.name = "thermocouple", .start = 20, .least = -270, .most = 1800},
	[OPEN_CIRCUIT] = {SIM_CONDITION("open_circuit")},
	[GROUND_SHORT] = {SIM_CONDITION("ground_short")},
	[VDD_SHORT] = {SIM_CONDITION("vdd_short")},
	{0},
};

#define PART(part, ...) \
	.name = part, .code = 0x3B, .starves = true, .state_size = sizeof(struct sim_max), \
	.create = max31826_create, .power_on = max31826_power_on, .bit = max31826_bit, \
	.worked = max31826_worked, .options = options, __VA_ARGS__

const struct sim_family sim_max31826 = {PART("MAX31826", .functions = max31826_functions,
                                             .inputs = max31826_inputs,
                                             SIM_MEMORY(sim_max, memory, SIM_MAX_MEMORY))};
const struct sim_family sim_max31850 = {
	PART("MAX31850", .functions = max31850_functions, .inputs = max31850_inputs)};
