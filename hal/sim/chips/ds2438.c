/* SPDX-License-Identifier: MIT */
/*
 * DS2438 and DS2437 (data sheets, "Smart Battery Monitor"): temperature, two voltages, current, 64
 * bytes. The DS2437 has a clock with a crystal in place of the elapsed time meter, in the same
 * bytes.
 */
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/families.h"

/* Status/configuration, page 0 byte 0. */
enum { IAD = 0x01, CA = 0x02, EE = 0x04, AD = 0x08, TB = 0x10, NVB = 0x20, ADB = 0x40 };

/* tCONV and tWR: 10 ms at most. */
#define WORK_NS (10 * NS_PER_MS)
/* Current register: 0.2441 mV across the sense resistor. */
#define CURRENT_MV 0.2441

enum { TEMPERATURE, VDD, VAD, VSENS };
enum { CONVERT_T = 0x44, CONVERT_V = 0xB4, COPY = 0x48 }; /* commands that take a while */

struct ds2438 {
	uint8_t memory[8][8];     /* pages 0 to 2 in part registers */
	uint8_t scratchpad[8][8]; /* each page has its own */
	uint8_t busy_page;
	uint8_t work;    /* the command that runs; 0: none */
	int64_t started; /* the elapsed time meter was 0 at started */
};

static void ds2438_create(struct sim_slave *slave)
{
	sim_state(slave, ds2438)->memory[0][0] = IAD | CA | EE | AD;
}

static void ds2438_power_on(struct sim_slave *slave)
{
	struct ds2438 *s = slave->state;

	memset(s->memory[0] + 1, 0, 6);
	memset(s->memory[1], 0, 5);
	s->memory[1][7] = 0xFF;
	memset(s->memory[2], 0, 8);
	memcpy(s->scratchpad, s->memory, sizeof(s->memory));
	s->work = 0;
	s->started = slave->now;
}

/*
 * With IAD the chip measures the current 36.41 times a second; the simulation has it fresh always.
 */
static void measure_current(struct sim_slave *slave)
{
	struct ds2438 *s = slave->state;

	if (s->scratchpad[0][0] & IAD)
		sim_put(s->memory[0] + 5, 2,
		        sim_within(sim_input_now(slave, VSENS) / CURRENT_MV, -1023, 1023));
}

static void ds2438_worked(struct sim_slave *slave)
{
	struct ds2438 *s = slave->state;
	unsigned source = s->scratchpad[0][0] & AD ? VDD : VAD;

	switch (s->work) {
	case CONVERT_T: /* 13 bits of 0.03125, left-aligned */
		sim_put(s->memory[0] + 1, 2,
		        sim_within(sim_input_now(slave, TEMPERATURE) * 32, -128 * 32,
		                   128 * 32 - 1) *
		                8);
		slave->conversions++;
		break;
	case CONVERT_V: /* 10 bits of 10 mV */
		sim_put(s->memory[0] + 3, 2,
		        sim_within(sim_input_now(slave, source) * 100, 0, 1023));
		slave->conversions++;
		break;
	case COPY:
		if (s->busy_page == 0) { /* the measured values are read-only */
			s->memory[0][0] = s->scratchpad[0][0] & 15;
			s->memory[0][7] = s->scratchpad[0][7];
		} else {
			memcpy(s->memory[s->busy_page], s->scratchpad[s->busy_page], 8);
		}
		if (s->busy_page == 1)
			s->started = slave->now - (int64_t)sim_get(s->memory[1], 4) * NS_PER_S;
		break;
	}
	s->work = 0;
}

static void ds2438_advance(struct sim_slave *slave)
{
	struct ds2438 *s = slave->state;

	sim_put(s->memory[1], 4, (slave->now - s->started) / NS_PER_S);
}

static unsigned page_of(const struct sim_slave *slave)
{
	return slave->taken[0] & 7;
}

static void ds2438_work(struct sim_slave *slave)
{
	struct ds2438 *s = slave->state;

	s->work = slave->function->code;
	s->busy_page = (uint8_t)page_of(slave);
	sim_work(slave, WORK_NS);
}

static void ds2438_recall(struct sim_slave *slave)
{
	struct ds2438 *s = slave->state;
	unsigned page = page_of(slave);

	if (page == 0)
		measure_current(slave);
	memcpy(s->scratchpad[page], s->memory[page], 8);
	sim_send_bits(slave);
}

static void ds2438_read_scratchpad(struct sim_slave *slave)
{
	const struct ds2438 *s = slave->state;
	uint8_t out[8], busy = s->work == CONVERT_T ? TB : s->work == CONVERT_V ? ADB : NVB;

	memcpy(out, s->scratchpad[page_of(slave)], 8);
	if (page_of(slave) == 0)
		out[0] = (uint8_t)((out[0] & 15) | (s->work ? busy : 0));
	sim_send_crc8(slave, out, 8);
}

static void ds2438_write_scratchpad(struct sim_slave *slave, uint8_t byte)
{
	unsigned page = page_of(slave), at = slave->address++ - slave->taken[0];

	/* Of page 0 the configuration and the threshold can be written. */
	if (page != 0 || at == 0 || at == 7)
		sim_state(slave, ds2438)->scratchpad[page][at] = byte;
	if (at == 7)
		sim_end(slave);
}

static const struct sim_function functions[] = {
	{.code = CONVERT_T, .start = ds2438_work},
	{.code = CONVERT_V, .start = ds2438_work},
	/* Write, Read, Copy Scratchpad; Recall Memory */
	{.code = 0x4E, .takes = 1, .byte = ds2438_write_scratchpad},
	{.code = 0xBE, .takes = 1, .start = ds2438_read_scratchpad},
	{.code = COPY, .takes = 1, .start = ds2438_work},
	{.code = 0xB8, .takes = 1, .start = ds2438_recall},
	{0},
};

/*
 * A program that plays one, as OneWireHub: the scratchpads are all the memory, what is measured
 * stands there at once, and neither a conversion nor a copy shows that it works.
 */
static void play_convert(struct sim_slave *slave)
{
	struct ds2438 *s = slave->state;
	unsigned source = s->scratchpad[0][0] & AD ? VDD : VAD;

	if (slave->function->code == CONVERT_V)
		sim_put(s->scratchpad[0] + 3, 2,
		        sim_within(sim_input_now(slave, source) * 100, 0, 1023));
	slave->conversions++;
	sim_end(slave);
}

static void play_read(struct sim_slave *slave)
{
	struct ds2438 *s = slave->state;

	if (slave->taken[0] > 7) {
		sim_end(slave);
		return;
	}
	sim_put(s->scratchpad[0] + 1, 2,
	        sim_within(sim_input_now(slave, TEMPERATURE) * 32, -128 * 32, 128 * 32 - 1) * 8);
	sim_put(s->scratchpad[0] + 5, 2,
	        sim_within(sim_input_now(slave, VSENS) / CURRENT_MV, -1023, 1023));
	sim_send_crc8(slave, s->scratchpad[page_of(slave)], 8);
}

static void play_write(struct sim_slave *slave, uint8_t byte)
{
	if (slave->taken[0] > 7)
		sim_end(slave);
	else
		ds2438_write_scratchpad(slave, byte);
}

static const struct sim_function played[] = {
	{.code = CONVERT_T, .start = play_convert},
	{.code = CONVERT_V, .start = play_convert},
	{.code = 0x4E, .takes = 1, .byte = play_write},
	{.code = 0xBE, .takes = 1, .start = play_read},
	{.code = COPY, .takes = 1, .start = sim_end},
	{.code = 0xB8, .takes = 1, .start = sim_end},
	{0},
};

static const struct sim_input inputs[] = {
	/* all that the register holds, also what no chip measures */
	[TEMPERATURE] = {.name = "temperature", .start = 20, .least = -128, .most = 127.96875},
	[VDD] = {.name = "vdd", .start = 5, .least = 0, .most = 10},
	[VAD] = {.name = "vad"},
	[VSENS] = {.name = "vsens"},
	{0},
};

#define MONITOR(part, family) \
	.name = (part), .code = (family), .state_size = sizeof(struct ds2438), \
	.functions = functions, .inputs = inputs, .create = ds2438_create, \
	.power_on = ds2438_power_on, .worked = ds2438_worked, .advance = ds2438_advance, \
	SIM_MEMORY(ds2438, memory, 64)

const struct sim_family sim_ds2437 = {MONITOR("DS2437", 0x1E)};
const struct sim_family sim_ds2438 = {MONITOR("DS2438", 0x26)};
const struct sim_family sim_ds2438_emulated = {
	.name = "DS2438-EMULATED",
	.code = 0x26,
	.state_size = sizeof(struct ds2438),
	.functions = played,
	.inputs = inputs,
	.create = ds2438_create,
	.power_on = ds2438_power_on,
	SIM_MEMORY(ds2438, memory, 64),
};
const struct sim_family sim_ds2438_a6 = {MONITOR("DS2438-A6", 0xA6)};
