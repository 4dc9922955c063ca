/* SPDX-License-Identifier: MIT */
/*
 * DS1921G (its data sheet; that of the DS1921H and Z, whose range is smaller and finer): a
 * thermometer with a clock that logs a mission: 2048 samples, a histogram, and the times beyond its
 * limits. Its battery is in it, so no loss of power on the wire concerns it.
 */
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/chips/logger.h"
#include "hal/sim/families.h"

/* Addresses. */
enum {
	CLOCK = 0x200,
	CLOCK_ALARM = 0x207,
	LOW = 0x20B,
	HIGH = 0x20C,
	RATE = 0x20D,
	CONTROL = 0x20E,
	READOUT = 0x211,
	DELAY = 0x212,
	STATUS = 0x214,
	STAMP = 0x215,
	SAMPLES = 0x21A,
	DEVICE_SAMPLES = 0x21D,
	LOW_TIMES = 0x220,
	HIGH_TIMES = 0x250,
	TIMES_END = 0x280,
	HISTOGRAM = 0x800,
	HISTOGRAM_END = 0x880,
	LOG = 0x1000,
	LOG_END = 0x1800,
	END = 0x2000,
};
/* Control, status. */
enum { EOSC = 0x80, EMCLR = 0x40, EM = 0x10, RO = 0x08, SEARCHES = 0x07 };
enum { TCB = 0x80, MEMCLR = 0x40, MIP = 0x20, SIP = 0x10, TLF = 0x04, THF = 0x02, TAF = 0x01 };

enum { COPY = 0x55, READ_CHECKED = 0xA5, CLEAR = 0x3C }; /* commands */

#define CONVERSION_NS (90 * NS_PER_MS)
#define PER_MINUTE (60 * NS_PER_S)
#define COPY_NS_PER_BYTE 2000

struct ds1921 {
	struct sim_scratchpad pad; /* first; its memory up to the histogram */
	struct sim_clock clock;
	uint8_t log[LOG_END - LOG];
	int64_t next,
		checked; /* the next sample of the mission; the alarm was looked at until then */
	bool converting, was_low, was_high;
};

static const struct sim_scratchpad_kind kind = {
	.size = END, .writable = END, .page = 32, .copy_ns = 32 * COPY_NS_PER_BYTE, .to_end = true};

static void ds1921_create(struct sim_slave *slave)
{
	struct ds1921 *s = slave->state;

	sim_clock_init(&s->clock);
	s->pad.memory[CONTROL] = EM;
	s->pad.memory[STATUS] = TCB;
}

static uint8_t raw_temperature(struct sim_slave *slave, int64_t t)
{
	double celsius = sim_input_at(slave, 0, t);
	const struct sim_family *family = slave->family;
	double raw = family == &sim_ds1921h   ? (celsius - 14.5) * 8
	             : family == &sim_ds1921z ? (celsius + 5.5) * 8
	                                      : (celsius + 40) * 2;

	/* the finer ones use all codes */
	return (uint8_t)sim_within(raw, 0, family == &sim_ds1921g ? 0xFA : 0xFF);
}

/* Beyond a limit: a new entry of sample number and duration, or one more sample for the last. */
static void note_time(struct ds1921 *s, unsigned first, bool beyond, bool *was)
{
	uint8_t *entry = s->pad.memory + first, *end = entry + 48;

	while (entry < end && entry[3])
		entry += 4;
	if (beyond && *was && entry > s->pad.memory + first && entry[-1] < 255) {
		entry[-1]++;
	} else if (beyond && entry < end) {
		memcpy(entry, s->pad.memory + SAMPLES, 3);
		entry[3] = 1;
	}
	*was = beyond;
}

static void ds1921_sample(struct sim_slave *slave, int64_t t)
{
	struct ds1921 *s = slave->state;
	uint8_t *memory = s->pad.memory, raw = raw_temperature(slave, t);
	uint64_t n = sim_get(memory + SAMPLES, 3);

	if (n < sizeof(s->log) || memory[CONTROL] & RO)
		s->log[n % sizeof(s->log)] = raw;
	sim_count_up(memory + SAMPLES, 3);
	sim_count_up(memory + DEVICE_SAMPLES, 3);
	sim_count_up(memory + HISTOGRAM + raw / 4 * 2, 2);
	note_time(s, LOW_TIMES, raw <= memory[LOW], &s->was_low);
	note_time(s, HIGH_TIMES, raw >= memory[HIGH], &s->was_high);
	memory[STATUS] |= (raw <= memory[LOW] ? TLF : 0) | (raw >= memory[HIGH] ? THF : 0);
	slave->conversions++;
}

/* Does the clock alarm match this second? Bit 7 of a register: whatever it holds. */
static bool alarm_matches(const uint8_t *alarm, const uint8_t *now)
{
	for (unsigned i = 0; i < 4; i++) {
		if (!(alarm[i] & 0x80) && alarm[i] != now[i])
			return false;
	}
	return true;
}

/* Look at each second since the last look, of the last week. */
static void follow_alarm(struct ds1921 *s, int64_t t)
{
	const int64_t week = 7 * 86400 * NS_PER_S;
	uint8_t now[SIM_TIME];

	if (s->checked < t - week)
		s->checked = t - week;
	for (; s->checked <= t && !(s->pad.memory[STATUS] & TAF); s->checked += NS_PER_S) {
		sim_clock_get(&s->clock, s->checked, now);
		if (alarm_matches(s->pad.memory + CLOCK_ALARM, now))
			s->pad.memory[STATUS] |= TAF;
	}
	s->checked = t;
}

static void ds1921_advance(struct sim_slave *slave)
{
	struct ds1921 *s = slave->state;
	uint8_t *memory = s->pad.memory;

	sim_clock_get(&s->clock, slave->now, memory + CLOCK);
	if (!(memory[STATUS] & MIP))
		return;
	follow_alarm(s, slave->now);
	while (s->next <= slave->now) {
		ds1921_sample(slave, s->next);
		s->next += memory[RATE] * PER_MINUTE;
	}
}

/* --- What is written ------------------------------------------------------------------------- */

static void ds1921_start_mission(struct ds1921 *s, int64_t t)
{
	uint8_t *memory = s->pad.memory, now[SIM_TIME];
	int64_t delay = (int64_t)sim_get(memory + DELAY, 2);

	memory[STATUS] = (uint8_t)((memory[STATUS] | MIP) & ~MEMCLR);
	sim_clock_get(&s->clock, t, now);
	memory[STAMP] = now[SIM_MINUTES];
	memory[STAMP + 1] = now[SIM_HOURS];
	memcpy(memory + STAMP + 2, now + SIM_DATE, 3);
	/* samples are on the minute */
	s->next = t - (t - s->clock.zero) % PER_MINUTE + (delay + memory[RATE]) * PER_MINUTE;
	s->checked = t;
	s->was_low = s->was_high = false;
}

static bool is_writable(unsigned at)
{
	return at < CLOCK || (at <= CONTROL && at >= CLOCK) || at == DELAY || at == DELAY + 1;
}

static void write_register(struct sim_slave *slave, unsigned at, uint8_t byte)
{
	static const uint8_t used[CONTROL + 1 - CLOCK] = {0x7F, 0x7F, 0x7F, 0x07, 0x3F,
	                                                  0x9F, 0xFF, 0xFF, 0xFF, 0xFF,
	                                                  0x87, 0xFF, 0xFF, 0xFF, 0xDF};
	struct ds1921 *s = slave->state;
	uint8_t *memory = s->pad.memory;

	if (at == STATUS)
		memory[at] &= (uint8_t)(byte | ~(MIP | TLF | THF | TAF));
	if (at >= CLOCK && at < STATUS)
		memory[STATUS] &= (uint8_t)~MIP; /* a mission ends */
	if (!is_writable(at))
		return;
	memory[at] = at >= CLOCK && at <= CONTROL ? byte & used[at - CLOCK] : byte;
	if (at >= CLOCK && at < CLOCK_ALARM)
		sim_clock_set(&s->clock, slave->now, memory + CLOCK);
	if (at == CONTROL)
		sim_clock_run(&s->clock, slave->now, !(byte & EOSC));
}

static void ds1921_copied(struct sim_slave *slave)
{
	struct ds1921 *s = slave->state;
	unsigned first = s->pad.target, last = (first & ~31u) + (s->pad.status & 31u);
	bool rate = false;

	for (unsigned at = first; at <= last; at++) {
		write_register(slave, at, s->pad.pad[at % 32]);
		rate |= at == RATE;
	}
	if (rate && s->pad.memory[RATE] && s->pad.memory[STATUS] & MEMCLR &&
	    !(s->pad.memory[CONTROL] & (EM | EOSC)))
		ds1921_start_mission(s, slave->now);
	s->pad.status |= 0x80;
}

static void ds1921_worked(struct sim_slave *slave)
{
	struct ds1921 *s = slave->state;

	if (!s->converting) {
		ds1921_copied(slave);
		return;
	}
	s->converting = false;
	s->pad.memory[READOUT] = raw_temperature(slave, slave->now);
	sim_count_up(s->pad.memory + DEVICE_SAMPLES, 3);
	s->pad.memory[STATUS] |= TCB;
	slave->conversions++;
}

/* --- Commands -------------------------------------------------------------------------------- */

/* Any other command than Clear Memory takes its permission away. */
static void ds1921_begun(struct sim_slave *slave)
{
	if (slave->function->code != CLEAR)
		sim_state(slave, ds1921)->pad.memory[CONTROL] &= (uint8_t)~EMCLR;
	if (slave->function->code == COPY && slave->busy)
		sim_end(slave);
}

static uint8_t ds1921_byte(struct sim_slave *slave, unsigned at)
{
	struct ds1921 *s = slave->state;

	if (at >= LOG && at < LOG_END)
		return s->log[at - LOG];
	return at < TIMES_END || (at >= HISTOGRAM && at < HISTOGRAM_END) ? s->pad.memory[at] : 0;
}

static void ds1921_next(struct sim_slave *slave)
{
	bool checked = slave->function->code == READ_CHECKED;

	sim_send_next(slave, ds1921_byte(slave, slave->address), checked ? kind.page : 0);
}

static void ds1921_clear(struct sim_slave *slave)
{
	uint8_t *memory = sim_state(slave, ds1921)->pad.memory;

	if (memory[CONTROL] & EMCLR && !(memory[STATUS] & MIP)) {
		memory[RATE] = 0;
		memset(memory + DELAY, 0, 2);
		memset(memory + STAMP, 0, DEVICE_SAMPLES - STAMP);
		memset(memory + LOW_TIMES, 0, TIMES_END - LOW_TIMES);
		memset(memory + HISTOGRAM, 0, HISTOGRAM_END - HISTOGRAM);
		memory[STATUS] |= MEMCLR;
	}
	memory[CONTROL] &= (uint8_t)~EMCLR;
	sim_end(slave);
}

static void ds1921_convert(struct sim_slave *slave)
{
	struct ds1921 *s = slave->state;

	if (!(s->pad.memory[STATUS] & MIP) && !slave->busy) {
		s->converting = true;
		s->pad.memory[STATUS] &= (uint8_t)~TCB;
		sim_work(slave, CONVERSION_NS);
	}
	sim_end(slave);
}

static const struct sim_function functions[] = {
	SIM_SCRATCHPAD_COMMANDS(COPY, ds1921_next),
	{.code = READ_CHECKED, .takes = 2, .start = ds1921_next, .next = ds1921_next},
	{.code = CLEAR, .start = ds1921_clear},
	{.code = 0x44, .start = ds1921_convert},
	{0},
};

/* Of the flags those whose search is enabled; a search bit stands one lower than its flag's. */
static bool ds1921_alarm(struct sim_slave *slave)
{
	const uint8_t *memory = sim_state(slave, ds1921)->pad.memory;

	return (memory[STATUS] & memory[CONTROL] & SEARCHES) != 0;
}

#define PART(part, low, high) \
	.name = (part), .code = 0x21, .overdrive = true, .state_size = sizeof(struct ds1921), \
	.kind = &kind, .functions = functions, .create = ds1921_create, .alarm = ds1921_alarm, \
	.begun = ds1921_begun, .bit = sim_scratchpad_bit, .worked = ds1921_worked, \
	.advance = ds1921_advance, SIM_MEMORY(ds1921, pad.memory, CLOCK), \
	.inputs = (const struct sim_input[]) \
	{ \
		{.name = "temperature", .start = 20, .least = (low), .most = (high)}, \
		{ \
			0 \
		} \
	}

const struct sim_family sim_ds1921g = {PART("DS1921G", -40, 85)};
const struct sim_family sim_ds1921h = {PART("DS1921H", 14.5, 46.375)};
const struct sim_family sim_ds1921z = {PART("DS1921Z", -5.5, 26.375)};
