/* SPDX-License-Identifier: MIT */
/*
 * DS2404 (data sheet 020998) and DS1994: RAM with a battery, clock, interval timer, cycle counter,
 * and an alarm for each. A cycle is a power-on. Neither interrupt pulses nor programmable
 * expiration; the interval timer in automatic mode always runs, as where the wire is always high.
 */
#include <string.h>

#include "hal/sim/chips/scratchpad.h"
#include "hal/sim/families.h"

enum { STATUS = 0x200, CONTROL, CLOCK, INTERVAL = 0x207, CYCLE = 0x20C, ALARMS = 0x210 };
enum { END = 0x21E, COUNTERS = 3 };
/* Status register: three flags; above them, their enables: 0 enables. */
enum { FLAGS = 0x07, ENABLES = 0x38 };
/* Control register. */
enum { WRITE_PROTECTED = 0x07, OSC = 0x10, AUTO = 0x20, STOP = 0x40, DSEL = 0x80 };

struct ds2404 {
	struct sim_scratchpad memory; /* first */
	int64_t seen, part;           /* ns since the last 1/256 s */
};

/* Clock and interval timer count 1/256 s. */
static const struct {
	uint16_t at, alarm;
	uint8_t bytes;
} counters[COUNTERS] = {{CLOCK, ALARMS, 5}, {INTERVAL, 0x215, 5}, {CYCLE, 0x21A, 4}};

static const struct sim_scratchpad_kind kind = {
	.size = END,
	.writable = END,
	.page = 32,
	.copy_ns = 30000,
	.to_end = true,
	.plain = true,
};

/* Count; the flag is set when the counter reaches its alarm. */
static void ds2404_count(struct sim_slave *slave, unsigned which, uint64_t by)
{
	uint8_t *memory = sim_state(slave, ds2404)->memory.memory;
	unsigned at = counters[which].at, n = counters[which].bytes;
	uint64_t old = sim_get(memory + at, n), alarm = sim_get(memory + counters[which].alarm, n);

	sim_put(memory + at, n, (int64_t)(old + by));
	if (alarm > old && alarm - old <= by)
		memory[STATUS] |= (uint8_t)(1 << which);
}

static void ds2404_advance(struct sim_slave *slave)
{
	struct ds2404 *s = slave->state;
	uint8_t control = s->memory.memory[CONTROL];
	int64_t span = s->part + (slave->now - s->seen) * 256;

	s->seen = slave->now;
	if (!(control & OSC))
		return;
	s->part = span % 1000000000;
	ds2404_count(slave, 0, (uint64_t)(span / 1000000000));
	if ((control & AUTO) || !(control & STOP))
		ds2404_count(slave, 1, (uint64_t)(span / 1000000000));
}

/* The battery keeps all but the scratchpad. */
static void ds2404_power_on(struct sim_slave *slave)
{
	sim_scratchpad_power_on(slave);
	sim_state(slave, ds2404)->seen = slave->now;
	ds2404_count(slave, 2, 1);
}

static bool ds2404_alarm(struct sim_slave *slave)
{
	uint8_t status = sim_state(slave, ds2404)->memory.memory[STATUS];

	return status & FLAGS & ~(status >> 3);
}

/* Put back what a write protection keeps from the copy. */
static void keep_protected(uint8_t *memory, const uint8_t *before)
{
	uint8_t old = before[CONTROL - STATUS], *control = &memory[CONTROL];

	if (!(old & WRITE_PROTECTED))
		return;
	for (unsigned i = 0; i < COUNTERS; i++) {
		if (!(old >> i & 1))
			continue;
		memcpy(memory + counters[i].at, before + counters[i].at - STATUS,
		       counters[i].bytes);
		memcpy(memory + counters[i].alarm, before + counters[i].alarm - STATUS,
		       counters[i].bytes);
	}
	*control = (uint8_t)((*control & ~0x0F) | (old & 0x0F));
	*control |= old & OSC;
	if (old & 2)
		*control = (uint8_t)((*control & ~(STOP | AUTO)) | (old & AUTO));
	if (old & 4)
		*control = (uint8_t)((*control & ~DSEL) | (old & DSEL));
}

/* The flags of the status register can only be read. */
static void ds2404_worked(struct sim_slave *slave)
{
	struct ds2404 *s = slave->state;
	uint8_t *memory = s->memory.memory;
	uint8_t before[END - STATUS];

	memcpy(before, memory + STATUS, sizeof(before));
	sim_scratchpad_worked(slave);
	memory[STATUS] = (uint8_t)((memory[STATUS] & ENABLES) | (before[0] & FLAGS));
	keep_protected(memory, before);
	if (memory[CONTROL] != before[CONTROL - STATUS])
		s->part = 0;
}

/* To read the status register clears its flags. */
static void ds2404_dump(struct sim_slave *slave)
{
	unsigned at = slave->address;

	sim_scratchpad_dump(slave);
	if (at == STATUS)
		sim_state(slave, ds2404)->memory.memory[STATUS] &= ENABLES;
}

/* The clock runs then. */
static void set_seconds(struct sim_slave *slave, int64_t seconds)
{
	uint8_t *memory = sim_state(slave, ds2404)->memory.memory;

	sim_put(memory + CLOCK + 1, 4, seconds);
	memory[CONTROL] |= OSC;
}

static const struct sim_option options[] = {{"seconds", 0, UINT32_MAX, .set = set_seconds}, {0}};

static const struct sim_function functions[] = {SIM_SCRATCHPAD_COMMANDS(0x55, ds2404_dump), {0}};

#define TIME_CHIP(part) \
	.name = (part), .code = 0x04, .state_size = sizeof(struct ds2404), .functions = functions, \
	.kind = &kind, .power_on = ds2404_power_on, .alarm = ds2404_alarm, \
	.bit = sim_scratchpad_bit, .worked = ds2404_worked, .advance = ds2404_advance, \
	.options = options, SIM_MEMORY(ds2404, memory.memory, END)

const struct sim_family sim_ds2404 = {TIME_CHIP("DS2404")};
const struct sim_family sim_ds1994 = {TIME_CHIP("DS1994")};
