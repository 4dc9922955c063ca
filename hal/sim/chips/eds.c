/* SPDX-License-Identifier: MIT */
/*
 * The sensors of Embedded Data Systems, family 7E: what all kinds have in common. The first page
 * says which kind it is; the registers are live memory; limits and enables are written through a
 * scratchpad.
 *
 * The memory maps of EDS's manuals could not be had. Commands, addresses, units and flags are
 * those of OWFS's driver and manual page, features and rates those of the manuals' first pages.
 * Nothing says what the following does, so it is the simulation's own: command registers of the
 * EDS0090 read 0 after they acted; flags are set by enabled limits alone; limits, enables and the
 * relay's function outlast a power failure, the relay's state and outputs do not.
 */
#include <math.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/chips/eds.h"

/* Tag of 30 characters, and the kind; the same in all. */
enum { TAG = 0x00, TAG_SIZE = 30, ID = 0x1E };
/* EDS0090. */
enum { INPUT = 0x22, LATCH, OUTPUT, PULLDOWN, PULSES = 0x30, COUNTERS = 2, PINS = 8 };
enum { PULSE_RESET = 0x54, LATCH_RESET, PULLDOWN_VALUE = 0x5B, OUTPUT_VALUE };
/* Bits of the relay's state, each with two bits of function. */
enum { RELAY = 0, LED = 1 };
enum control { WHILE_ALARM = 0, UNTIL_CLEARED, AS_WRITTEN, OFF };

/* Light is measured four times a second, all else more seldom: here all alike. */
#define TICK_NS (250 * NS_PER_MS)
/* The peak of a vibration decays. */
#define DECAY_PER_S 10.0

static const struct eds_kind *eds_kind_of(const struct sim_slave *slave)
{
	return slave->family->kind;
}

static uint8_t *bytes_at(struct sim_slave *slave, unsigned at)
{
	return sim_state(slave, eds)->memory.memory + at;
}

static uint16_t flags_at(struct sim_slave *slave, unsigned at)
{
	unsigned bytes = eds_kind_of(slave)->alarm_bytes;

	return (uint16_t)sim_get(bytes_at(slave, at), bytes);
}

static double quantity_now(struct sim_slave *slave, const struct eds_quantity *q)
{
	return q->derived ? q->derived(slave)
	                  : sim_input_now(slave, (unsigned)sim_slave_input(slave, q->input));
}

/* The limit of a quantity at an address; a limit of two bytes has no sign. */
static double limit_at(struct sim_slave *slave, const struct eds_quantity *q, unsigned at)
{
	int64_t limit = (int64_t)sim_get(bytes_at(slave, at), q->limit_bytes);

	if (q->limit_bytes != 2 && limit >> (8 * q->limit_bytes - 1))
		limit -= INT64_C(1) << (8 * q->limit_bytes);
	return (double)limit * (q->coarse ? 1 : q->unit);
}

/* Which of the pair of flags does the value deserve? */
static unsigned flags_beyond(struct sim_slave *slave, const struct eds_quantity *q, double value)
{
	if (!q->limit_bytes)
		return 0;
	return (value > limit_at(slave, q, q->high)) | (value < limit_at(slave, q, q->low)) << 1;
}

static bool has_quantity(const struct eds_kind *kind, unsigned i)
{
	return kind->measures >> i & 1;
}

/* Measure all; returns the flags of what is beyond its limits now. */
static uint16_t eds_measure(struct sim_slave *slave)
{
	struct eds *s = slave->state;
	uint16_t flags = 0;

	for (unsigned i = 0; i < eds_kind_of(slave)->quantity_count; i++) {
		const struct eds_quantity *q = &eds_kind_of(slave)->quantities[i];
		double value;

		if (!has_quantity(eds_kind_of(slave), i))
			continue;
		value = quantity_now(slave, q);
		s->least[i] = fmin(s->least[i], value);
		s->most[i] = fmax(s->most[i], value);
		sim_put(bytes_at(slave, q->at), q->bytes, sim_round(value / q->unit));
		if (q->min)
			sim_put(bytes_at(slave, q->min), q->bytes,
			        sim_round(s->least[i] / q->unit));
		if (q->max)
			sim_put(bytes_at(slave, q->max), q->bytes, sim_round(s->most[i] / q->unit));
		flags |= (uint16_t)(flags_beyond(slave, q, value) << q->flag);
	}
	return flags;
}

/* Falling edges are counted and any change is latched. */
static void follow_pin(struct sim_slave *slave, unsigned pin)
{
	struct eds *s = slave->state;
	const struct sim_curve *curve = &slave->input[pin];
	uint8_t mask = (uint8_t)(1 << pin), *pulses = bytes_at(slave, PULSES + 4 * pin);
	bool pulled = *bytes_at(slave, OUTPUT) & mask;
	bool was = s->level & mask, is = !pulled && sim_curve_at(curve, slave->now) >= 0.5;
	uint64_t falls = pulled ? 0 : sim_curve_falls(curve, s->followed, slave->now);

	/* The level also falls where an output or a new curve begins. */
	if (was && (pulled || sim_curve_at(curve, s->followed) < 0.5))
		falls++;
	if (falls || was != is)
		*bytes_at(slave, LATCH) |= mask;
	if (pin < COUNTERS)
		sim_put(pulses, 4, (int64_t)(sim_get(pulses, 4) + falls));
	s->level = (uint8_t)(is ? s->level | mask : s->level & ~mask);
}

/* The pins at t; returns the flags of those whose level is asked for. */
static uint16_t eds_follow(struct sim_slave *slave)
{
	struct eds *s = slave->state;
	uint16_t flags = 0;

	for (unsigned i = 0; i < PINS; i++) {
		follow_pin(slave, i);
		flags |= (uint16_t)((s->level >> i & 1 ? 1 : 2) << (2 * i));
	}
	*bytes_at(slave, INPUT) = s->level;
	s->followed = slave->now;
	return flags;
}

/* Relay and LED: by the alarm, or as written. */
static void switch_outputs(struct sim_slave *slave, bool beyond_now, bool flagged)
{
	uint8_t function = *bytes_at(slave, eds_kind_of(slave)->relay);
	uint8_t *out = bytes_at(slave, eds_kind_of(slave)->relay + 1u);

	for (unsigned i = RELAY; i <= LED; i++) {
		enum control control = function >> (2 * i) & 3;
		bool on = control == WHILE_ALARM ? beyond_now : control == UNTIL_CLEARED && flagged;

		if (control != AS_WRITTEN)
			*out = (uint8_t)((*out & ~(1 << i)) | on << i);
	}
}

static void count_time(struct sim_slave *slave)
{
	struct eds *s = slave->state;
	const struct eds_kind *kind = eds_kind_of(slave);

	sim_put(bytes_at(slave, kind->seconds), 4, (slave->now - s->started) / NS_PER_S);
	if (kind->samples) {
		int64_t delay = *bytes_at(slave, kind->delay);
		int64_t each = (delay ? delay : 1) * NS_PER_S, n = (slave->now - s->sampled) / each;
		uint8_t *samples = bytes_at(slave, kind->samples);

		sim_put(samples, 4, (int64_t)sim_get(samples, 4) + n);
		s->sampled += n * each;
	}
	if (kind->peak) {
		double level = sim_input_now(slave, 0);

		s->peak -= (double)(slave->now - s->sampled) / (double)NS_PER_S * DECAY_PER_S;
		s->peak = fmax(s->peak, level);
		sim_put(bytes_at(slave, kind->peak), 2, sim_round(s->peak));
		s->sampled = slave->now;
	}
}

/* One round of the microcontroller. */
static void eds_round(struct sim_slave *slave)
{
	const struct eds_kind *kind = eds_kind_of(slave);
	uint16_t enabled = flags_at(slave, kind->enable), flags = flags_at(slave, kind->alarm);
	uint16_t now = kind->digital ? eds_follow(slave) : eds_measure(slave);

	now &= enabled;
	flags |= now;
	sim_put(bytes_at(slave, kind->alarm), kind->alarm_bytes, flags);
	count_time(slave);
	switch_outputs(slave, now, flags);
}

void eds_advance(struct sim_slave *slave)
{
	struct eds *s = slave->state;

	if (slave->now / TICK_NS == s->tick)
		return;
	s->tick = slave->now / TICK_NS;
	eds_round(slave);
}

/* Minimum and maximum begin anew. */
static void eds_forget(struct sim_slave *slave)
{
	struct eds *s = slave->state;

	for (unsigned i = 0; i < sizeof(s->least) / sizeof(s->least[0]); i++) {
		s->least[i] = INFINITY;
		s->most[i] = -INFINITY;
	}
	sim_put(bytes_at(slave, eds_kind_of(slave)->alarm), eds_kind_of(slave)->alarm_bytes, 0);
}

static void clear_alarms(struct sim_slave *slave)
{
	eds_forget(slave);
	eds_round(slave);
	sim_end(slave);
}

void eds_create(struct sim_slave *slave)
{
	memset(bytes_at(slave, TAG), ' ', TAG_SIZE);
	memcpy(bytes_at(slave, TAG), eds_kind_of(slave)->tag, strlen(eds_kind_of(slave)->tag));
	sim_put(bytes_at(slave, ID), 2, eds_kind_of(slave)->id);
}

void eds_power_on(struct sim_slave *slave)
{
	struct eds *s = slave->state;

	sim_scratchpad_power_on(slave);
	memset(bytes_at(slave, ID + 2), 0, eds_kind_of(slave)->writable - (ID + 2u));
	*bytes_at(slave, eds_kind_of(slave)->relay + 1u) = 0;
	if (eds_kind_of(slave)->digital) {
		*bytes_at(slave, OUTPUT_VALUE) = 0;
		s->level = 0;
		for (unsigned i = 0; i < PINS; i++)
			s->level |= (uint8_t)((sim_input_now(slave, i) >= 0.5) << i);
	}
	s->started = s->sampled = s->followed = slave->now;
	s->tick = slave->now / TICK_NS;
	s->peak = 0;
	eds_forget(slave);
	eds_round(slave);
}

/* What the host wrote into registers that act. */
static void eds_act(struct sim_slave *slave)
{
	uint8_t *reset = bytes_at(slave, PULSE_RESET);

	for (unsigned i = 0; i < COUNTERS; i++)
		if (*reset >> i & 1)
			sim_put(bytes_at(slave, PULSES + 4 * i), 4, 0);
	*reset = 0;
	*bytes_at(slave, LATCH) &= (uint8_t) ~*bytes_at(slave, LATCH_RESET);
	*bytes_at(slave, LATCH_RESET) = 0;
	*bytes_at(slave, OUTPUT) = *bytes_at(slave, OUTPUT_VALUE);
	*bytes_at(slave, PULLDOWN) = *bytes_at(slave, PULLDOWN_VALUE);
}

void eds_worked(struct sim_slave *slave)
{
	struct eds *s = slave->state;
	uint8_t fixed[0xA0];

	if (eds_kind_of(slave)->digital)
		eds_follow(slave);
	memcpy(fixed, s->memory.memory, eds_kind_of(slave)->writable);
	sim_scratchpad_worked(slave);
	memcpy(s->memory.memory, fixed, eds_kind_of(slave)->writable);
	if (eds_kind_of(slave)->digital)
		eds_act(slave);
	eds_round(slave);
}

bool eds_alarm(struct sim_slave *slave)
{
	return flags_at(slave, eds_kind_of(slave)->alarm) != 0;
}

const struct sim_function eds_functions[] = {
	SIM_SCRATCHPAD_FUNCTIONS(0x55),
	/* Read Memory with CRC */
	{SIM_SCRATCHPAD_PAGES},
	{.code = 0x33, .start = clear_alarms},
	{0},
};
