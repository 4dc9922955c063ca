/* SPDX-License-Identifier: MIT */
/*
 * DS1922L, DS1922T, DS1923 (their data sheets) and the bare chip DS2422: loggers of a temperature
 * and a second quantity with 8 KB, passwords, and a battery of their own. Not simulated: the
 * calibration pages, and the DS1925, whose data sheet could not be had.
 */
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/chips/logger.h"
#include "hal/sim/families.h"

/* Addresses. */
enum {
	CLOCK = 0x200,
	RATE = 0x206,
	LOW = 0x208,
	HIGH = 0x209,
	DATA_LOW = 0x20A,
	DATA_HIGH = 0x20B,
	LATEST = 0x20C,
	LATEST_DATA = 0x20E,
	ALARMS = 0x210,
	DATA_ALARMS = 0x211,
	OSCILLATOR = 0x212,
	MISSION = 0x213,
	FLAGS = 0x214,
	STATUS = 0x215,
	DELAY = 0x216,
	STAMP = 0x219,
	SAMPLES = 0x220,
	DEVICE_SAMPLES = 0x223,
	CONFIG = 0x226,
	PASSWORDS = 0x227,
	READ_PASSWORD = 0x228,
	FULL_PASSWORD = 0x230,
	REGISTERS_END = 0x240,
	CALIBRATION_END = 0x280,
	LOG = 0x1000,
	LOG_END = 0x3000,
};
/* Mission control, the enables and flags of alarms, general status, oscillator. */
enum { SUTA = 0x20, RO = 0x10, DATA_WIDE = 0x08, WIDE = 0x04, LOG_DATA = 0x02, LOG_TEMP = 0x01 };
enum { LOW_ALARM = 0x01, HIGH_ALARM = 0x02, FLAGS_USED = 0x0F, BOR = 0x80, FLAGS_ONES = 0x70 };
enum { MIP = 0x02, MEMCLR = 0x08, WFTA = 0x10, STATUS_ONES = 0xC0 };
enum { EOSC = 0x01, SECONDS = 0x02 };

#define PASSWORDS_ON 0xAA
#define CONVERSION_NS (600 * NS_PER_MS)

struct ds1922 {
	struct sim_scratchpad pad; /* first; its memory up to the calibration */
	struct sim_clock clock;
	uint8_t log[LOG_END - LOG];
	int64_t next; /* the next sample of the mission */
	bool converting;
};

static const struct sim_scratchpad_kind kind = {
	.size = LOG_END, .writable = LOG_END, .page = 32, .copy_ns = 64000, .to_end = true};

static bool has_data(const struct sim_slave *slave)
{
	return slave->family == &sim_ds1923 || slave->family == &sim_ds2422;
}

static void ds1922_create(struct sim_slave *slave)
{
	const struct sim_family *family = slave->family;
	struct ds1922 *s = slave->state;

	sim_clock_init(&s->clock);
	s->pad.memory[OSCILLATOR] = EOSC;
	s->pad.memory[CONFIG] = family == &sim_ds1923    ? 0x20
	                        : family == &sim_ds1922l ? 0x40
	                        : family == &sim_ds1922t ? 0x60
	                                                 : 0x00;
}

/* --- Samples --------------------------------------------------------------------------------- */

/* 11 bits above five zeros: T/2 - 41, of the DS1922T T/2 - 1, with the high byte as T. */
static uint16_t raw_temperature(struct sim_slave *slave, int64_t t)
{
	double zero = slave->family == &sim_ds1922t ? 1 : 41;

	return (uint16_t)(sim_within((sim_input_at(slave, 0, t) + zero) * 16, 0, 0x7FF) << 5);
}

/* 12 bits above four zeros: 5.02 V in 4096 parts; the humidity sensor gives 0.958 + 0.0307 %. */
static uint16_t raw_data(struct sim_slave *slave, int64_t t)
{
	double volts = has_data(slave) ? sim_input_at(slave, 1, t) : 0;

	if (slave->family == &sim_ds1923)
		volts = 0.958 + 0.0307 * volts;
	return has_data(slave) ? (uint16_t)(sim_within(volts / 5.02 * 4096, 0, 4095) << 4) : 0;
}

static void ds1922_measure(struct sim_slave *slave, int64_t t)
{
	uint8_t *memory = sim_state(slave, ds1922)->pad.memory;

	sim_put(memory + LATEST, 2, raw_temperature(slave, t));
	sim_put(memory + LATEST_DATA, 2, raw_data(slave, t));
	sim_count_up(memory + DEVICE_SAMPLES, 3);
	slave->conversions++;
}

/* Put sample n of a quantity into its part of the log, the high byte first. */
static void ds1922_put(struct ds1922 *s, unsigned part, uint32_t n, const uint8_t *latest,
                       bool wide)
{
	uint8_t *at = s->log + part + n * (wide ? 2 : 1);

	*at++ = latest[1];
	if (wide)
		*at = latest[0];
}

/* How many samples the log holds, and where those of the second quantity begin. */
static uint32_t log_parts(uint8_t mission, unsigned *data)
{
	bool wide = mission & WIDE, data_wide = mission & DATA_WIDE;

	*data = 0;
	if ((mission & (LOG_TEMP | LOG_DATA)) == LOG_TEMP)
		return wide ? 4096 : 8192;
	if ((mission & (LOG_TEMP | LOG_DATA)) == LOG_DATA)
		return data_wide ? 4096 : 8192;
	*data = wide == data_wide ? 4096 : wide ? 0x1400 : 0xA00;
	return wide != data_wide ? 2560 : wide ? 2048 : 4096;
}

static void check_alarms(uint8_t *memory)
{
	static const struct {
		uint16_t enables, latest, low;
		uint8_t shift;
	} both[] = {{ALARMS, LATEST, LOW, 0}, {DATA_ALARMS, LATEST_DATA, DATA_LOW, 2}};

	for (unsigned i = 0; i < 2; i++) {
		uint8_t value = memory[both[i].latest + 1], flags = 0;

		flags |= value <= memory[both[i].low] ? LOW_ALARM : 0;
		flags |= value >= memory[both[i].low + 1] ? HIGH_ALARM : 0;
		memory[FLAGS] |= (uint8_t)((flags & memory[both[i].enables]) << both[i].shift);
	}
}

/* The registers of a date have no day of the week. */
static void put_date(struct ds1922 *s, unsigned at, int64_t t)
{
	uint8_t now[SIM_TIME];

	sim_clock_get(&s->clock, t, now);
	memcpy(s->pad.memory + at, now, 3);
	memcpy(s->pad.memory + at + 3, now + SIM_DATE, 3);
}

static void ds1922_sample(struct sim_slave *slave, int64_t t)
{
	struct ds1922 *s = slave->state;
	uint8_t *memory = s->pad.memory, mission = memory[MISSION];
	uint32_t n = (uint32_t)sim_get(memory + SAMPLES, 3), room;
	unsigned data;

	ds1922_measure(slave, t);
	check_alarms(memory);
	if (memory[STATUS] & WFTA) {
		if (!(memory[FLAGS] & (LOW_ALARM | HIGH_ALARM)))
			return;
		memory[STATUS] &= (uint8_t)~WFTA;
	}
	if (n == 0)
		put_date(s, STAMP, t);
	room = log_parts(mission, &data);
	if (room && (n < room || mission & RO)) {
		if (mission & LOG_TEMP)
			ds1922_put(s, 0, n % room, memory + LATEST, mission & WIDE);
		if (mission & LOG_DATA)
			ds1922_put(s, data, n % room, memory + LATEST_DATA, mission & DATA_WIDE);
	}
	sim_count_up(memory + SAMPLES, 3);
}

static void ds1922_advance(struct sim_slave *slave)
{
	struct ds1922 *s = slave->state;
	uint8_t *memory = s->pad.memory;
	int64_t unit = memory[OSCILLATOR] & SECONDS ? NS_PER_S : 60 * NS_PER_S;

	put_date(s, CLOCK, slave->now);
	while (memory[STATUS] & MIP && s->next <= slave->now) {
		ds1922_sample(slave, s->next);
		s->next += unit * (memory[RATE] | (memory[RATE + 1] & 0x3F) << 8);
	}
}

/* --- What is written ------------------------------------------------------------------------- */

static bool is_writable(const struct ds1922 *s, unsigned at)
{
	bool password = at >= PASSWORDS && at < FULL_PASSWORD + 8;

	if (at < CLOCK)
		return true;
	if (s->pad.memory[STATUS] & MIP)
		return false;
	return at < LATEST || (at >= ALARMS && at <= MISSION) || (at >= DELAY && at < STAMP) ||
	       password;
}

static void ds1922_set_clock(struct ds1922 *s, int64_t t)
{
	uint8_t bcd[SIM_TIME];

	memcpy(bcd, s->pad.memory + CLOCK, 3);
	bcd[SIM_DAY] = 1;
	memcpy(bcd + SIM_DATE, s->pad.memory + CLOCK + 3, 3);
	sim_clock_set(&s->clock, t, bcd);
}

static void ds1922_copied(struct sim_slave *slave)
{
	struct ds1922 *s = slave->state;
	unsigned first = s->pad.target, last = (first & ~31u) + (s->pad.status & 31u);
	bool clock = false;

	for (unsigned at = first; at <= last && at < CALIBRATION_END; at++) {
		if (!is_writable(s, at))
			continue;
		s->pad.memory[at] = s->pad.pad[at % 32];
		clock |= at >= CLOCK && at < RATE;
	}
	s->pad.memory[OSCILLATOR] &= EOSC | SECONDS;
	s->pad.memory[MISSION] &= 0x3F;
	if (clock)
		ds1922_set_clock(s, slave->now);
	sim_clock_run(&s->clock, slave->now, s->pad.memory[OSCILLATOR] & EOSC);
	s->pad.status |= 0x80;
}

static void ds1922_worked(struct sim_slave *slave)
{
	struct ds1922 *s = slave->state;

	if (s->converting)
		ds1922_measure(slave, slave->now);
	else
		ds1922_copied(slave);
	s->converting = false;
}

/* --- Commands -------------------------------------------------------------------------------- */

/* While the chip is busy its memory cannot be reached. */
static void ds1922_begun(struct sim_slave *slave)
{
	if (slave->busy && slave->function->unchecked)
		sim_end(slave);
}

/* Does the password that came after n bytes of the command open what it should? Else be deaf. */
static bool opens(struct sim_slave *slave, unsigned n, bool reads)
{
	const uint8_t *memory = sim_state(slave, ds1922)->pad.memory, *password = slave->taken + n;

	if (memory[PASSWORDS] != PASSWORDS_ON || memcmp(password, memory + FULL_PASSWORD, 8) == 0 ||
	    (reads && memcmp(password, memory + READ_PASSWORD, 8) == 0))
		return true;
	sim_end(slave);
	return false;
}

static void ds1922_copy(struct sim_slave *slave)
{
	if (opens(slave, 3, false))
		sim_scratchpad_copy(slave);
}

static uint8_t ds1922_byte(struct sim_slave *slave, unsigned at)
{
	const struct ds1922 *s = slave->state;

	if (at >= LOG && at < LOG_END)
		return s->log[at - LOG];
	if (at == ALARMS || at == DATA_ALARMS)
		return s->pad.memory[at] | 0xFC;
	if (at == MISSION)
		return s->pad.memory[at] | 0xC0;
	if (at == FLAGS)
		return s->pad.memory[at] | FLAGS_ONES;
	if (at == STATUS)
		return s->pad.memory[at] | STATUS_ONES;
	if (at >= READ_PASSWORD && at < REGISTERS_END)
		return 0;
	return at < CALIBRATION_END ? s->pad.memory[at] : 0xFF;
}

static void ds1922_next(struct sim_slave *slave)
{
	if (slave->address >= LOG_END)
		sim_end(slave);
	else
		sim_send_next(slave, ds1922_byte(slave, slave->address), kind.page);
}

static void ds1922_read_memory(struct sim_slave *slave)
{
	if (opens(slave, 2, true))
		ds1922_next(slave);
}

static void ds1922_clear(struct sim_slave *slave)
{
	uint8_t *memory = sim_state(slave, ds1922)->pad.memory;

	if (!opens(slave, 0, false))
		return;
	if (!(memory[STATUS] & MIP)) {
		memset(memory + STAMP, 0, 6);
		memset(memory + SAMPLES, 0, 3);
		memory[FLAGS] = 0;
		memory[STATUS] |= MEMCLR;
		if (slave->family == &sim_ds2422)
			memset(memory + RATE, 0, 2);
	}
	sim_end(slave);
}

static void ds1922_start_mission(struct sim_slave *slave)
{
	struct ds1922 *s = slave->state;
	uint8_t *memory = s->pad.memory;

	if (!opens(slave, 0, false))
		return;
	if (memory[STATUS] & MEMCLR && !(memory[STATUS] & MIP) && memory[OSCILLATOR] & EOSC &&
	    sim_get(memory + RATE, 2) && memory[MISSION] & (LOG_TEMP | LOG_DATA)) {
		memory[STATUS] = MIP | (memory[MISSION] & SUTA ? WFTA : 0);
		s->next = slave->now + (int64_t)sim_get(memory + DELAY, 3) * 60 * NS_PER_S;
	}
	sim_end(slave);
}

static void ds1922_stop_mission(struct sim_slave *slave)
{
	if (!opens(slave, 0, false))
		return;
	sim_state(slave, ds1922)->pad.memory[STATUS] &= (uint8_t)~MIP;
	sim_end(slave);
}

/* While it converts, the memory cannot be reached. */
static void ds1922_convert(struct sim_slave *slave)
{
	struct ds1922 *s = slave->state;

	if (!(s->pad.memory[STATUS] & MIP) && !slave->busy && s->pad.memory[OSCILLATOR] & EOSC &&
	    slave->taken[0] == 0xFF) {
		s->converting = true;
		sim_work(slave, CONVERSION_NS);
	}
	sim_end(slave);
}

static const struct sim_function functions[] = {
	{.code = 0x0F, .takes = 2, .start = sim_scratchpad_target, .byte = sim_scratchpad_write},
	{.code = 0xAA, .start = sim_scratchpad_read},
	{.code = 0x55, .takes = 1, .start = ds1922_convert},
	/* With a password, and a byte after it that means nothing where none comes before it. */
	{.code = 0x99, .takes = 3 + 8, .unchecked = 8, .start = ds1922_copy},
	{.code = 0x69,
         .takes = 2 + 8,
         .unchecked = 8,
         .start = ds1922_read_memory,
         .next = ds1922_next},
	{.code = 0x96, .takes = 8 + 1, .unchecked = 8, .start = ds1922_clear},
	{.code = 0xCC, .takes = 8 + 1, .unchecked = 8, .start = ds1922_start_mission},
	{.code = 0x33, .takes = 8 + 1, .unchecked = 8, .start = ds1922_stop_mission},
	{0},
};

static bool ds1922_alarm(struct sim_slave *slave)
{
	return (sim_state(slave, ds1922)->pad.memory[FLAGS] & (FLAGS_USED | BOR)) != 0;
}

#define PART(part, list) \
	.name = (part), .code = 0x41, .overdrive = true, .state_size = sizeof(struct ds1922), \
	.kind = &kind, .functions = functions, .create = ds1922_create, .alarm = ds1922_alarm, \
	.begun = ds1922_begun, .bit = sim_scratchpad_bit, .worked = ds1922_worked, \
	.advance = ds1922_advance, SIM_MEMORY(ds1922, pad.memory, CLOCK), .inputs = (list)

static const struct sim_input low_inputs[] = {
	{.name = "temperature", .start = 20, .least = -40, .most = 85},
	{0},
};
static const struct sim_input high_inputs[] = {
	{.name = "temperature", .start = 20, .least = 0, .most = 125},
	{0},
};
static const struct sim_input humid_inputs[] = {
	{.name = "temperature", .start = 20, .least = -40, .most = 85},
	{.name = "humidity", .start = 50, .least = 0, .most = 100},
	{0},
};
static const struct sim_input bare_inputs[] = {
	{.name = "temperature", .start = 20, .least = -40, .most = 85},
	{.name = "volt", .start = 0, .least = 0, .most = 5.02},
	{0},
};

const struct sim_family sim_ds1923 = {PART("DS1923", humid_inputs)};
const struct sim_family sim_ds1922l = {PART("DS1922L", low_inputs)};
const struct sim_family sim_ds1922t = {PART("DS1922T", high_inputs)};
const struct sim_family sim_ds2422 = {PART("DS2422", bare_inputs)};
