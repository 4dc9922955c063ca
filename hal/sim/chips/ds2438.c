/* SPDX-License-Identifier: MIT */
/* DS2438 (data sheet, "Smart Battery Monitor"): temperature, two voltages, current, 64 bytes. */
#include <errno.h>
#include <string.h>

#include "hal/sim/chips/families.h"
#include "hal/sim/crc.h"

enum {
	CONVERT_T = 0x44,
	CONVERT_V = 0xB4,
	WRITE_SCRATCHPAD = 0x4E,
	COPY_SCRATCHPAD = 0x48,
	READ_SCRATCHPAD = 0xBE,
	RECALL = 0xB8,
};

/* Status/configuration, page 0 byte 0. */
enum { IAD = 0x01, CA = 0x02, EE = 0x04, AD = 0x08, TB = 0x10, NVB = 0x20, ADB = 0x40 };

/* tCONV and tWR: 10 ms at most. */
#define WORK_NS INT64_C(10000000)
#define SECOND INT64_C(1000000000)
/* Current register: 0.2441 mV across the sense resistor. */
#define CURRENT_MV 0.2441

enum { TEMPERATURE, VDD, VAD, VSENS };
enum work { IDLE, TEMPERATURE_WORK, VOLTAGE_WORK, COPY_WORK };

struct ds2438 {
	uint8_t memory[8][8];     /* pages 0 to 2 in part registers */
	uint8_t scratchpad[8][8]; /* each page has its own */
	uint8_t command, got, page;
	uint8_t busy_page;
	enum work work;
	int64_t until, started; /* the elapsed time meter was 0 at started */
};

static struct ds2438 *state(struct sim_slave *slave)
{
	return sim_state(slave, ds2438);
}

static void create(struct sim_slave *slave)
{
	state(slave)->memory[0][0] = IAD | CA | EE | AD;
}

static void power_on(struct sim_slave *slave, int64_t t)
{
	struct ds2438 *s = state(slave);

	memset(s->memory[0] + 1, 0, 6);
	memset(s->memory[1], 0, 5);
	s->memory[1][7] = 0xFF;
	memset(s->memory[2], 0, 8);
	memcpy(s->scratchpad, s->memory, sizeof(s->memory));
	s->command = 0;
	s->work = IDLE;
	s->started = t;
}

static void reset(struct sim_slave *slave, int64_t t)
{
	(void)t;
	state(slave)->command = 0;
}

static void put16(uint8_t *at, int value)
{
	at[0] = (uint8_t)value;
	at[1] = (uint8_t)(value >> 8);
}

static int within(double value, int least, int most)
{
	int64_t whole = sim_round(value);

	return whole < least ? least : whole > most ? most : (int)whole;
}

/* With IAD the current is measured 36.41 times a second: always fresh here. */
static void measure_current(struct sim_slave *slave, int64_t t)
{
	struct ds2438 *s = state(slave);

	if (s->scratchpad[0][0] & IAD)
		put16(s->memory[0] + 5,
		      within(sim_input_at(slave, VSENS, t) / CURRENT_MV, -1023, 1023));
}

static void finish(struct sim_slave *slave, int64_t t)
{
	struct ds2438 *s = state(slave);
	unsigned source = s->scratchpad[0][0] & AD ? VDD : VAD;

	switch (s->work) {
	case IDLE:
		break;
	case TEMPERATURE_WORK: /* 13 bits of 0.03125, left-aligned */
		put16(s->memory[0] + 1,
		      within(sim_input_at(slave, TEMPERATURE, t) * 32, -55 * 32, 125 * 32) * 8);
		slave->conversions++;
		break;
	case VOLTAGE_WORK: /* 10 bits of 10 mV */
		put16(s->memory[0] + 3, within(sim_input_at(slave, source, t) * 100, 0, 1023));
		slave->conversions++;
		break;
	case COPY_WORK:
		if (s->busy_page == 0) { /* the measured values are read-only */
			s->memory[0][0] = s->scratchpad[0][0] & 15;
			s->memory[0][7] = s->scratchpad[0][7];
		} else {
			memcpy(s->memory[s->busy_page], s->scratchpad[s->busy_page], 8);
		}
		if (s->busy_page == 1) {
			const uint8_t *b = s->memory[1];
			uint32_t seconds = b[0] | b[1] << 8 | b[2] << 16 | (uint32_t)b[3] << 24;

			s->started = t - (int64_t)seconds * SECOND;
		}
		break;
	}
	s->work = IDLE;
}

static void advance(struct sim_slave *slave, int64_t t)
{
	struct ds2438 *s = state(slave);
	uint32_t seconds;

	if (s->work != IDLE && t >= s->until)
		finish(slave, s->until);
	seconds = (uint32_t)((t - s->started) / SECOND);
	for (unsigned i = 0; i < 4; i++)
		s->memory[1][i] = (uint8_t)(seconds >> (8 * i));
}

static bool bit(struct sim_slave *slave, int64_t t)
{
	(void)t;
	return state(slave)->work == IDLE;
}

static void work(struct sim_slave *slave, enum work what, int64_t t)
{
	struct ds2438 *s = state(slave);

	s->work = what;
	s->until = t + WORK_NS;
	s->busy_page = s->page;
	sim_send_bits(slave);
}

static void recall(struct sim_slave *slave, int64_t t)
{
	struct ds2438 *s = state(slave);

	if (s->page == 0)
		measure_current(slave, t);
	memcpy(s->scratchpad[s->page], s->memory[s->page], 8);
	sim_send_bits(slave);
}

static void send_scratchpad(struct sim_slave *slave)
{
	const struct ds2438 *s = state(slave);
	uint8_t out[9];

	memcpy(out, s->scratchpad[s->page], 8);
	if (s->page == 0) {
		static const uint8_t busy[] = {[IDLE] = 0, TB, ADB, NVB};

		out[0] = (uint8_t)((out[0] & 15) | busy[s->work]);
	}
	out[8] = sim_crc8(0, out, 8);
	sim_send(slave, out, 9);
}

static void command(struct sim_slave *slave, uint8_t byte, int64_t t)
{
	struct ds2438 *s = state(slave);

	s->command = byte;
	s->got = 0;
	switch (byte) {
	case CONVERT_T:
		work(slave, TEMPERATURE_WORK, t);
		break;
	case CONVERT_V:
		work(slave, VOLTAGE_WORK, t);
		break;
	case WRITE_SCRATCHPAD:
	case COPY_SCRATCHPAD:
	case READ_SCRATCHPAD:
	case RECALL:
		break;
	default:
		sim_end(slave);
		break;
	}
}

static void page_chosen(struct sim_slave *slave, int64_t t)
{
	switch (state(slave)->command) {
	case COPY_SCRATCHPAD:
		work(slave, COPY_WORK, t);
		break;
	case READ_SCRATCHPAD:
		send_scratchpad(slave);
		break;
	case RECALL:
		recall(slave, t);
		break;
	}
}

static void received(struct sim_slave *slave, uint8_t byte, int64_t t)
{
	struct ds2438 *s = state(slave);

	if (!s->command) {
		command(slave, byte, t);
	} else if (s->got++ == 0) {
		s->page = byte & 7;
		page_chosen(slave, t);
	} else {
		unsigned at = s->got - 2u;

		/* Of page 0 the configuration and the threshold can be written. */
		if (s->page != 0 || at == 0 || at == 7)
			s->scratchpad[s->page][at] = byte;
		if (at == 7)
			sim_end(slave);
	}
}

static uint8_t *memory(struct sim_slave *slave, size_t *size)
{
	*size = 64;
	return state(slave)->memory[0];
}

static const struct sim_input inputs[] = {
	[TEMPERATURE] = SIM_TEMPERATURE_INPUT,
	[VDD] = {.name = "vdd", .start = 5, .least = 2.4, .most = 10},
	[VAD] = {.name = "vad"},
	[VSENS] = {.name = "vsens"},
	{0},
};

const struct sim_family sim_ds2438 = {
	.name = "DS2438",
	.code = 0x26,
	.state_size = sizeof(struct ds2438),
	.inputs = inputs,
	.create = create,
	.power_on = power_on,
	.reset = reset,
	.received = received,
	.bit = bit,
	.advance = advance,
	.memory = memory,
};
