/* SPDX-License-Identifier: MIT */
/* DS1921: converts, writes its registers, sets the clock, starts and stops missions. */

#include <errno.h>
#include <string.h>

#include "hal/chips/family.h"
#include "hal/chips/loggers/ds1921.h"
#include "hal/chips/loggers/ds1921_mission.h"
#include "hal/chips/loggers/host_clock.h"
#include "hal/chips/loggers/logger.h"

static const struct logger_chip chip = {.copy = 0x55};

struct visit {
	struct logger_write write;
	uint8_t page[DS1921_PAGE]; /* the registers as they were */
	uint8_t bytes[8];          /* what is written */
	uint8_t want;              /* the rate of the mission that is to run */
};

/* The first page of the registers as it is now. */
static int ds1921_mission_look(struct txn *txn, uint8_t page[DS1921_PAGE])
{
	return area_fetch(txn, &ds1921_registers, 0, page, DS1921_PAGE);
}

static int refuse_mission(const struct visit *visit)
{
	return visit->page[DS1921_STATUS] & DS1921_MIP ? -EBUSY : 0;
}

/* The result of a conversion is new when the counter of the device has moved. */
int ds1921_read_temperature(struct txn *txn)
{
	static const uint8_t convert = DS1921_CONVERT;
	const struct ds1921_version *version = ds1921_version_of(txn->device);
	struct visit *visit = txn_own(txn, struct visit);
	uint8_t page[DS1921_PAGE];
	int err;

	if (!version)
		return -EIO;
	if (txn->phase == 0) {
		err = ds1921_mission_look(txn, visit->page);
		if (!err)
			err = refuse_mission(visit);
		txn->phase = 1;
		return err ? err : TXN_MORE;
	}
	if (txn->phase == 1) {
		err = txn_command(txn, &convert, 1);
		txn->phase = 2;
		return err ? err : txn_wait(txn, version->convert_ms * TXN_MS);
	}
	err = ds1921_mission_look(txn, page);
	if (err)
		return err;
	if (memcmp(page + DS1921_DEVICE_SAMPLES, visit->page + DS1921_DEVICE_SAMPLES, 3) == 0 ||
	    !(page[DS1921_STATUS] & DS1921_TCB))
		return -EBADMSG;
	txn->number[0] = ds1921_celsius(version, page[DS1921_READOUT]);
	return 0;
}

/*
 * Bits of n bytes of the registers from `at` on become those of value. What they are already may be
 * written during a mission too.
 */
static int change(struct txn *txn, unsigned at, unsigned n, uint32_t mask, uint32_t value)
{
	struct visit *visit = txn_own(txn, struct visit);
	int err;

	if (txn->phase)
		return logger_write(txn, &chip, &visit->write, DS1921_REGISTERS + at, visit->bytes,
		                    n);
	err = ds1921_mission_look(txn, visit->page);
	if (err)
		return err;
	for (unsigned i = 0; i < n; i++, mask >>= 8, value >>= 8)
		visit->bytes[i] = (uint8_t)((visit->page[at + i] & ~mask) | (value & mask));
	if (memcmp(visit->bytes, visit->page + at, n) == 0)
		return 0;
	txn->phase = 1;
	err = refuse_mission(visit);
	return err ? err : TXN_MORE;
}

/* A field of the registers. */
int ds1921_write_field(struct txn *txn)
{
	const struct field *field = &txn->property->field;
	unsigned n = field->bytes ? field->bytes : 1, bits = field->bits ? field->bits : 8 * n;
	uint32_t mask = (UINT32_C(1) << bits) - 1;
	double number = txn->number[0];

	if (number < 0 || number > mask)
		return -EINVAL;
	uint32_t value = field->inverted ? ~(uint32_t)number & mask : (uint32_t)number;
	return change(txn, field->at, n, mask << field->shift, value << field->shift);
}

int ds1921_write_limit(struct txn *txn)
{
	const struct ds1921_version *version = ds1921_version_of(txn->device);

	if (!version)
		return -EIO;
	double code = (txn->number[0] - version->zero) / version->step + 0.5;
	if (!(code >= 0 && code < 256))
		return -EINVAL;
	return change(txn, (unsigned)txn->property->arg, 1, 0xff, (uint32_t)code);
}

/* As owserver: 1 is the bit of the seconds and those behind it, 2 from the minutes on. */
int ds1921_write_trigger(struct txn *txn)
{
	unsigned number = (unsigned)txn->number[0];
	uint32_t value = 0;

	if (txn->number[0] > 4)
		return -EINVAL;
	for (unsigned i = number; number && i <= 4; i++)
		value |= UINT32_C(0x80) << 8 * (i - 1);
	return change(txn, DS1921_CLOCK_ALARM, 4, 0x80808080, value);
}

/* Flags are cleared by writing 0, and set by nothing. */
static int clear_flags(struct txn *txn, uint8_t keep, uint8_t wanted)
{
	struct visit *visit = txn_own(txn, struct visit);
	uint8_t page[DS1921_PAGE];
	int err;

	switch (txn->phase) {
	case 0:
		err = ds1921_mission_look(txn, visit->page);
		if (err || (visit->page[DS1921_STATUS] & DS1921_CLEARED & ~keep) == 0)
			return err ? err : wanted & ~visit->page[DS1921_STATUS] ? -EIO : 0;
		visit->bytes[0] = keep;
		txn->phase = 1;
		return TXN_MORE;
	case 1:
		err = logger_write(txn, &chip, &visit->write, DS1921_REGISTERS + DS1921_STATUS,
		                   visit->bytes, 1);
		if (err)
			return err;
		txn->phase = 2;
		return TXN_MORE;
	default:
		err = ds1921_mission_look(txn, page);
		if (err)
			return err;
		return page[DS1921_STATUS] & DS1921_CLEARED & ~keep || wanted & ~page[DS1921_STATUS]
		               ? -EIO
		               : 0;
	}
}

int ds1921_write_status(struct txn *txn)
{
	uint8_t byte = (uint8_t)txn->number[0];

	if (txn->number[0] > 0xff)
		return -EINVAL;
	return clear_flags(txn, byte, byte & DS1921_CLEARED);
}

int ds1921_write_flag(struct txn *txn)
{
	uint8_t flag = (uint8_t)(1 << txn->property->field.shift);

	return clear_flags(txn, txn->number[0] != 0 ? 0xff : (uint8_t)~flag,
	                   txn->number[0] != 0 ? flag : 0);
}

/* --- Clock and missions --- */

/* Steps of what ends in a running mission or a set clock; each is left out where it can be. */
enum step {
	LOOK,
	STOP,
	ALLOW_CLEAR,
	CLEAR,
	IS_CLEAR,
	SET_CLOCK,
	RUN_CLOCK,
	SET_DELAY,
	START,
	RUNS
};
/* What is wanted of them. */
enum {
	STOPS = 1,
	CLEARS = 2,
	SETS_CLOCK = 4,
	RUNS_CLOCK = 8,
	EASY = 16,
	STARTS = 32,
	MUST_RUN = 64
};

static int ds1921_mission_put(struct txn *txn, unsigned at, unsigned n)
{
	struct visit *visit = txn_own(txn, struct visit);
	int err = logger_write(txn, &chip, &visit->write, DS1921_REGISTERS + at, visit->bytes, n);

	if (err)
		return err;
	txn->phase++;
	return TXN_MORE;
}

static void put_clock(struct visit *visit, double seconds)
{
	uint8_t bcd[LOGGER_TIME];

	logger_bcd(seconds, bcd, &visit->bytes[DS1921_WEEKDAY]);
	memcpy(visit->bytes, bcd, 3);
	memcpy(visit->bytes + DS1921_WEEKDAY + 1, bcd + LOGGER_DATE, 3);
}

/* The command has to follow the copy at once, before any other one. */
static int clear(struct txn *txn)
{
	static const uint8_t command = DS1921_CLEAR_MEMORY;
	struct visit *visit = txn_own(txn, struct visit);
	int err;

	if (txn->phase == ALLOW_CLEAR) {
		visit->bytes[0] = visit->page[DS1921_CONTROL] | DS1921_EMCLR;
		err = logger_write_only(txn, &chip, &visit->write,
		                        DS1921_REGISTERS + DS1921_CONTROL, visit->bytes, 1);
		if (err)
			return err;
		txn->phase = CLEAR;
	}
	if (txn->phase == CLEAR) {
		err = txn_command(txn, &command, 1);
		txn->phase = IS_CLEAR;
		return err ? err : txn_wait(txn, TXN_MS);
	}
	err = ds1921_mission_look(txn, visit->page);
	txn->phase = SET_CLOCK;
	if (err)
		return err;
	return (visit->page[DS1921_STATUS] & DS1921_MEMCLR) &&
	                       !(visit->page[DS1921_CONTROL] & DS1921_EMCLR)
	               ? TXN_MORE
	               : -EBADMSG;
}

static int ds1921_mission_begin(struct txn *txn, unsigned wanted)
{
	struct visit *visit = txn_own(txn, struct visit);
	int err = ds1921_mission_look(txn, visit->page);

	if (err)
		return err;
	if (visit->page[DS1921_STATUS] & DS1921_MIP && !(wanted & STOPS))
		return -EBUSY;
	txn->phase = visit->page[DS1921_STATUS] & DS1921_MIP ? STOP
	             : wanted & CLEARS                       ? ALLOW_CLEAR
	                                                     : SET_CLOCK;
	visit->bytes[0] = (uint8_t)~DS1921_MIP;
	return TXN_MORE;
}

/* Control of a mission that runs: clock on, memory not to be cleared. */
static uint8_t control_for(uint8_t control, unsigned wanted)
{
	control &= (uint8_t) ~(DS1921_EOSC | DS1921_EMCLR);
	return wanted & EASY ? DS1921_TLS | DS1921_THS : control;
}

static int start_mission(struct txn *txn, unsigned wanted)
{
	struct visit *visit = txn_own(txn, struct visit);

	visit->bytes[0] = visit->want;
	if (!(wanted & STARTS))
		return 0;
	return ds1921_mission_put(txn, DS1921_RATE, 1);
}

/* Did it start? Only a cleared memory and an enabled mission let it. */
static int is_started(struct txn *txn, unsigned wanted)
{
	struct visit *visit = txn_own(txn, struct visit);
	uint8_t page[DS1921_PAGE];
	int err = ds1921_mission_look(txn, page);

	if (err)
		return err;
	if (page[DS1921_RATE] != visit->want)
		return -EBADMSG;
	return page[DS1921_STATUS] & DS1921_MIP || !(wanted & MUST_RUN) ? 0 : -EIO;
}

static int set_clock(struct txn *txn, unsigned wanted, double seconds)
{
	struct visit *visit = txn_own(txn, struct visit);

	if (!(wanted & SETS_CLOCK) &&
	    !(wanted & STARTS && visit->page[DS1921_CONTROL] & DS1921_EOSC)) {
		txn->phase = RUN_CLOCK;
		return TXN_MORE;
	}
	if (!visit->write.step) {
		int err = wanted & SETS_CLOCK ? 0 : host_clock(&seconds);

		if (err)
			return err;
		put_clock(visit, seconds);
	}
	return ds1921_mission_put(txn, DS1921_CLOCK, DS1921_CLOCK_ALARM);
}

static int run_clock(struct txn *txn, unsigned wanted)
{
	struct visit *visit = txn_own(txn, struct visit);
	uint8_t control = control_for(visit->page[DS1921_CONTROL], wanted);

	if (!(wanted & (RUNS_CLOCK | STARTS)) || control == visit->page[DS1921_CONTROL]) {
		txn->phase = SET_DELAY;
		return TXN_MORE;
	}
	visit->bytes[0] = control;
	return ds1921_mission_put(txn, DS1921_CONTROL, 1);
}

static int do_steps(struct txn *txn, unsigned wanted, double seconds)
{
	struct visit *visit = txn_own(txn, struct visit);

	switch ((enum step)txn->phase) {
	case LOOK:
		return ds1921_mission_begin(txn, wanted);
	case STOP:
		return ds1921_mission_put(txn, DS1921_STATUS, 1);
	case ALLOW_CLEAR:
	case CLEAR:
	case IS_CLEAR:
		return clear(txn);
	case SET_CLOCK:
		return set_clock(txn, wanted, seconds);
	case RUN_CLOCK:
		return run_clock(txn, wanted);
	case SET_DELAY:
		memset(visit->bytes, 0, 2);
		if (wanted & EASY)
			return ds1921_mission_put(txn, DS1921_DELAY, 2);
		txn->phase = START;
		return TXN_MORE;
	case START:
		return start_mission(txn, wanted);
	case RUNS:
		return is_started(txn, wanted);
	}
	return -EIO;
}

int ds1921_write_date(struct txn *txn)
{
	return do_steps(txn, SETS_CLOCK | RUNS_CLOCK, txn->number[0]);
}

int ds1921_write_udate(struct txn *txn)
{
	return do_steps(txn, SETS_CLOCK, txn->number[0]);
}

int ds1921_clear_memory(struct txn *txn)
{
	if (txn->number[0] == 0)
		return 0;
	return do_steps(txn, CLEARS, 0);
}

/* It ends by a write of its flag. */
static int stop_mission(struct txn *txn)
{
	return clear_flags(txn, (uint8_t)~DS1921_MIP, 0);
}

static int start_with(struct txn *txn, double rate, unsigned wanted)
{
	struct visit *visit = txn_own(txn, struct visit);

	if (!(rate >= 1 && rate <= 255))
		return -EINVAL;
	visit->want = (uint8_t)rate;
	double now = 0;
	int err = wanted & SETS_CLOCK ? host_clock(&now) : 0;
	return err ? err : do_steps(txn, wanted, now);
}

int ds1921_write_frequency(struct txn *txn)
{
	return txn->number[0] == 0 ? stop_mission(txn) : start_with(txn, txn->number[0], STARTS);
}

/* With the rate that stands there. */
int ds1921_write_running(struct txn *txn)
{
	struct visit *visit = txn_own(txn, struct visit);

	if (txn->number[0] == 0)
		return stop_mission(txn);
	if (txn->phase == LOOK) {
		int err = ds1921_mission_begin(txn, STARTS);

		visit->want = visit->page[DS1921_RATE];
		return err == TXN_MORE && !visit->want ? -EINVAL : err;
	}
	return do_steps(txn, STARTS | MUST_RUN, 0);
}

/* All in one: the mission that runs is stopped, its log cleared, the clock set. */
int ds1921_write_easystart(struct txn *txn)
{
	if (txn->number[0] == 0)
		return stop_mission(txn);
	return start_with(txn, txn->number[0],
	                  STOPS | CLEARS | SETS_CLOCK | EASY | STARTS | MUST_RUN);
}
