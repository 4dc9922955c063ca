/* SPDX-License-Identifier: MIT */
/*
 * MAX31888 and MAX30207: thermometers with a FIFO of 32 results. From the maker's summary of the
 * MAX30207, published drivers of both, and the register map of the MAX31889, which is the same chip
 * with I2C; no whole data sheet was at hand. A conversion begins when the two bytes of the CRC16
 * after Convert T have been read. What an empty FIFO gives is not stated: here the last result.
 * The conditional search and the GPIO pins are not simulated.
 */

#include "hal/base/time.h"
#include "hal/sim/families.h"

/* Registers. */
enum {
	STATUS = 0x00,
	WRITE_POINTER = 0x04,
	READ_POINTER = 0x05,
	OVERFLOWS = 0x06,
	RESULTS = 0x07,
	FIFO = 0x08,
	FIFO_CONFIGURATION = 0x0A,
	SYSTEM = 0x0C,
	ALARM_HIGH = 0x10,
	ALARM_LOW = 0x12,
	SETUP = 0x14,
	PART = 0xFF,
};
enum { READY = 0x01, TOO_HIGH = 0x02, TOO_LOW = 0x04 }; /* STATUS, until it is read */
enum { FLUSH = 0x10, RESET = 0x01 };
enum { DEPTH = 32 };

/* The longest of 16 bits: 17.85 ms. */
#define CONVERT_NS (17850 * INT64_C(1000))
/* "T = value x 0.005" */
#define PER_DEGREE 200

struct max31888 {
	uint8_t reg[256];
	uint16_t fifo[DEPTH];
	uint8_t count; /* the register of the count of results; 0: RESULTS */
	bool second;   /* the low byte of the result is the next to be read */
};

static void max31888_power_on(struct sim_slave *slave)
{
	struct max31888 *s = slave->state;

	*s = (struct max31888){.count = s->count};
	s->reg[ALARM_HIGH] = 0x7F;
	s->reg[ALARM_HIGH + 1] = 0xFF;
	s->reg[ALARM_LOW] = 0x80;
	s->reg[SETUP] = 0xC0;
	s->reg[PART] = slave->family == &sim_max30207 ? 0x30 : 0x31;
}

static void max31888_worked(struct sim_slave *slave)
{
	struct max31888 *s = slave->state;
	int16_t result = (int16_t)sim_round(sim_input_now(slave, 0) * PER_DEGREE);

	slave->conversions++;
	s->reg[STATUS] |= READY;
	if (result > (int16_t)sim_get_high(s->reg + ALARM_HIGH, 2))
		s->reg[STATUS] |= TOO_HIGH;
	if (result < (int16_t)sim_get_high(s->reg + ALARM_LOW, 2))
		s->reg[STATUS] |= TOO_LOW;
	if (s->reg[RESULTS] == DEPTH) { /* it is full: the new one is lost */
		s->reg[OVERFLOWS] += s->reg[OVERFLOWS] < DEPTH - 1;
		return;
	}
	s->fifo[s->reg[WRITE_POINTER]] = (uint16_t)result;
	s->reg[WRITE_POINTER] = (uint8_t)((s->reg[WRITE_POINTER] + 1) % DEPTH);
	s->reg[RESULTS]++;
}

/* The next byte of the FIFO; its register does not move on. */
static uint8_t max31888_take(struct max31888 *s)
{
	unsigned at = s->reg[READ_POINTER];

	if (!s->reg[RESULTS])
		at = (at + DEPTH - 1) % DEPTH;
	s->second = !s->second;
	if (s->second)
		return (uint8_t)(s->fifo[at] >> 8);
	if (s->reg[RESULTS]) {
		s->reg[RESULTS]--;
		s->reg[OVERFLOWS] = 0;
		s->reg[READ_POINTER] = (uint8_t)((at + 1) % DEPTH);
	}
	return (uint8_t)s->fifo[at];
}

static uint8_t read_register(struct max31888 *s, unsigned at)
{
	uint8_t byte = s->reg[at & 0xFF];

	if (at == FIFO)
		return max31888_take(s);
	if (at == STATUS)
		s->reg[STATUS] = 0;
	if (s->count == WRITE_POINTER && at == WRITE_POINTER)
		return s->reg[RESULTS];
	return s->count == WRITE_POINTER && at == RESULTS ? 0 : byte;
}

/* Command, register, and the count of bytes less one. */
static void max31888_read(struct sim_slave *slave)
{
	struct max31888 *s = slave->state;
	unsigned at = slave->taken[0], n = slave->taken[1] + 1u;
	uint8_t out[SIM_MAX_SEND - 2];

	if (n > sizeof(out))
		n = sizeof(out);
	s->second = false;
	for (unsigned i = 0; i < n; i++) {
		out[i] = read_register(s, at);
		at += at != FIFO;
	}
	sim_send_checked(slave, out, n);
}

static void max31888_begin_write(struct sim_slave *slave)
{
	slave->address = slave->taken[0];
}

static void flush_fifo(struct max31888 *s)
{
	s->reg[WRITE_POINTER] = s->reg[READ_POINTER] = 0;
	s->reg[OVERFLOWS] = s->reg[RESULTS] = s->reg[STATUS] = 0;
}

static void write_registers(struct sim_slave *slave, uint8_t byte)
{
	struct max31888 *s = slave->state;
	unsigned at = slave->address++;

	if (at == FIFO_CONFIGURATION && (byte & FLUSH))
		flush_fifo(s);
	if (at == SYSTEM && (byte & RESET))
		max31888_power_on(slave);
	if (at == SETUP && (byte & 1)) /* CONVERT_T clears itself */
		sim_work(slave, CONVERT_NS);
	if (at == FIFO_CONFIGURATION)
		s->reg[at] = byte & (uint8_t)~FLUSH;
	else if (at == SETUP)
		s->reg[at] = byte & 0xFE;
	else if (at != STATUS && at != SYSTEM && at < PART && (at < WRITE_POINTER || at > FIFO))
		s->reg[at] = byte;
	if (slave->address == slave->taken[0] + slave->taken[1] + 1u)
		sim_send_checksum(slave);
}

static void checksum_was_read(struct sim_slave *slave)
{
	sim_work(slave, CONVERT_NS);
}

static void reset_was_confirmed(struct sim_slave *slave)
{
	max31888_power_on(slave);
	sim_end(slave);
}

static const struct sim_option options[] = {
	SIM_OPTION(max31888, "count", WRITE_POINTER, RESULTS, count), {0}};

static const struct sim_function functions[] = {
	{.code = 0x44, .start = sim_send_checksum, .next = checksum_was_read},
	{.code = 0x82, .start = sim_send_checksum, .next = reset_was_confirmed}, /* Soft Reset */
	{.code = 0x33, .takes = 2, .start = max31888_read},
	{.code = 0xCC, .takes = 2, .start = max31888_begin_write, .byte = write_registers},
	{0},
};

static const struct sim_input max31888_inputs[] = {
	{.name = "temperature", .start = 20, .least = -40, .most = 125}, {0}};
static const struct sim_input max30207_inputs[] = {
	{.name = "temperature", .start = 20, .least = -40, .most = 85}, {0}};

#define THERMOMETER(part, input) \
	.name = (part), .code = 0x54, .starves = true, .state_size = sizeof(struct max31888), \
	.functions = functions, .inputs = (input), .power_on = max31888_power_on, \
	.worked = max31888_worked, .bit = sim_ones, .options = options

const struct sim_family sim_max31888 = {THERMOMETER("MAX31888", max31888_inputs)};
const struct sim_family sim_max30207 = {THERMOMETER("MAX30207", max30207_inputs)};
