/* SPDX-License-Identifier: MIT */
/* DS1921: converts, writes its registers, sets the clock, starts and stops missions. */

#include <errno.h>
#include <string.h>

#include "hal/chips/family.h"
#include "hal/chips/loggers/ds1921.h"
#include "hal/chips/loggers/host_clock.h"

struct visit {
	struct logger_visit common;
	uint8_t want; /* the rate of the mission that is to run */
};

/* The result of a conversion is new when the counter of the device has moved. */
int ds1921_read_temperature(struct txn *txn)
{
	const struct ds1921_version *version = ds1921_version_of(txn->device);
	struct logger_visit *visit = txn_own(txn, struct logger_visit);
	uint8_t page[DS1921_PAGE];
	int err;

	if (!version)
		return -EMEDIUMTYPE;
	if (txn->phase == 0) {
		err = logger_look(txn);
		txn->phase = 1;
		return err ? err : TXN_MORE;
	}
	if (txn->phase == 1) {
		txn->phase = 2;
		return txn_command_wait(txn, TXN_BYTES(DS1921_CONVERT),
		                        version->convert_ms * TXN_MS);
	}
	err = ds1921_logger.look(txn, page);
	if (err)
		return err;
	if (memcmp(page + DS1921_DEVICE_SAMPLES, visit->page + DS1921_DEVICE_SAMPLES, 3) == 0 ||
	    !(page[DS1921_STATUS] & DS1921_TCB))
		return -EBADMSG;
	txn->number[0] = ds1921_celsius(version, page[DS1921_READOUT]);
	return 0;
}

int ds1921_write_limit(struct txn *txn)
{
	const struct ds1921_version *version = ds1921_version_of(txn->device);

	if (!version)
		return -EMEDIUMTYPE;
	double code = (txn->number[0] - version->zero) / version->step + 0.5;
	if (!(code >= 0 && code < 256))
		return -EINVAL;
	return logger_change(txn, (unsigned)txn->property->arg, 1, 0xff, (uint32_t)code);
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
	return logger_change(txn, DS1921_CLOCK_ALARM, 4, 0x80808080, value);
}

/* Flags are cleared by writing 0, and set by nothing. */
static int clear_flags(struct txn *txn, uint8_t keep, uint8_t wanted)
{
	struct logger_visit *visit = txn_own(txn, struct logger_visit);
	const uint8_t *status = &visit->page[DS1921_STATUS];
	int err;

	if (txn->phase == 1)
		return logger_put(txn, DS1921_STATUS, 1);
	err = logger_look(txn);
	if (err && err != -EBUSY)
		return err;
	bool cleared = (*status & DS1921_CLEARED & ~keep) == 0;
	if (cleared || txn->phase)
		return !cleared || (wanted & ~*status) ? -EIO : 0;
	visit->bytes[0] = keep;
	txn->phase = 1;
	return TXN_MORE;
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
	EASY = 16, /* the clock is set to the host's time, delay and tests are switched off */
	STARTS = 32,
	MUST_RUN = 64,
};

/* The command has to follow the copy at once, before any other one. */
static int clear_log(struct txn *txn)
{
	struct logger_visit *visit = txn_own(txn, struct logger_visit);
	int err;

	if (txn->phase == ALLOW_CLEAR) {
		visit->bytes[0] = visit->page[DS1921_CONTROL] | DS1921_EMCLR;
		err = logger_write_only(txn, LOGGER_REGISTERS + DS1921_CONTROL, visit->bytes, 1);
		if (err)
			return err;
		txn->phase = CLEAR;
	}
	if (txn->phase == CLEAR) {
		txn->phase = IS_CLEAR;
		return txn_command_wait(txn, TXN_BYTES(DS1921_CLEAR_MEMORY), TXN_MS);
	}
	err = ds1921_logger.look(txn, visit->page);
	txn->phase = SET_CLOCK;
	if (err)
		return err;
	return (visit->page[DS1921_STATUS] & DS1921_MEMCLR) &&
	                       !(visit->page[DS1921_CONTROL] & DS1921_EMCLR)
	               ? TXN_MORE
	               : -EBADMSG;
}

static int begin_steps(struct txn *txn, unsigned wanted)
{
	int err = logger_look(txn);

	if (err && !(err == -EBUSY && wanted & STOPS))
		return err;
	txn->phase = err ? STOP : wanted & CLEARS ? ALLOW_CLEAR : SET_CLOCK;
	txn_own(txn, struct logger_visit)->bytes[0] = (uint8_t)~DS1921_MIP;
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

	visit->common.bytes[0] = visit->want;
	return wanted & STARTS ? logger_put(txn, DS1921_RATE, 1) : 0;
}

/* Did it start? Only a cleared memory and an enabled mission let it. */
static int is_started(struct txn *txn, unsigned wanted)
{
	struct visit *visit = txn_own(txn, struct visit);
	uint8_t page[DS1921_PAGE];
	int err = ds1921_logger.look(txn, page);

	if (err)
		return err;
	if (page[DS1921_RATE] != visit->want)
		return -EBADMSG;
	return page[DS1921_STATUS] & DS1921_MIP || !(wanted & MUST_RUN) ? 0 : -EIO;
}

static int set_clock(struct txn *txn, unsigned wanted)
{
	const struct logger_visit *visit = txn_own(txn, struct logger_visit);
	bool stands = visit->page[DS1921_CONTROL] & DS1921_EOSC;

	if (wanted & (SETS_CLOCK | EASY) || (wanted & STARTS && stands))
		return logger_set_clock(txn, !(wanted & SETS_CLOCK));
	txn->phase = RUN_CLOCK;
	return TXN_MORE;
}

static int run_clock(struct txn *txn, unsigned wanted)
{
	struct logger_visit *visit = txn_own(txn, struct logger_visit);
	uint8_t control = control_for(visit->page[DS1921_CONTROL], wanted);

	if (!(wanted & (RUNS_CLOCK | STARTS)) || control == visit->page[DS1921_CONTROL]) {
		txn->phase = SET_DELAY;
		return TXN_MORE;
	}
	visit->bytes[0] = control;
	return logger_put(txn, DS1921_CONTROL, 1);
}

static int do_steps(struct txn *txn, unsigned wanted)
{
	struct logger_visit *visit = txn_own(txn, struct logger_visit);

	switch ((enum step)txn->phase) {
	case LOOK:
		return begin_steps(txn, wanted);
	case STOP:
		return logger_put(txn, DS1921_STATUS, 1);
	case ALLOW_CLEAR:
	case CLEAR:
	case IS_CLEAR:
		return clear_log(txn);
	case SET_CLOCK:
		return set_clock(txn, wanted);
	case RUN_CLOCK:
		return run_clock(txn, wanted);
	case SET_DELAY:
		memset(visit->bytes, 0, 2);
		if (wanted & EASY)
			return logger_put(txn, DS1921_DELAY, 2);
		txn->phase = START;
		return TXN_MORE;
	case START:
		return start_mission(txn, wanted);
	case RUNS:
		return is_started(txn, wanted);
	}
	return -EIO;
}

/* A date has the clock run from there on. */
int ds1921_write_clock(struct txn *txn)
{
	return do_steps(txn, SETS_CLOCK | (txn->property->type == PROPERTY_DATE ? RUNS_CLOCK : 0));
}

int ds1921_clear_memory(struct txn *txn)
{
	return txn->number[0] != 0 ? do_steps(txn, CLEARS) : 0;
}

/* It ends by a write of its flag. */
static int stop_mission(struct txn *txn)
{
	return clear_flags(txn, (uint8_t)~DS1921_MIP, 0);
}

static int start_with(struct txn *txn, double rate, unsigned wanted)
{
	if (!(rate >= 1 && rate <= 255))
		return -EINVAL;
	txn_own(txn, struct visit)->want = (uint8_t)rate;
	return do_steps(txn, wanted);
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
		int err = begin_steps(txn, STARTS);

		visit->want = visit->common.page[DS1921_RATE];
		return err == TXN_MORE && !visit->want ? -EINVAL : err;
	}
	return do_steps(txn, STARTS | MUST_RUN);
}

/*
 * All in one: the mission that runs is stopped, its log cleared, the clock set to the host's time,
 * which has to be known before any of this.
 */
int ds1921_write_easystart(struct txn *txn)
{
	double now;

	if (txn->number[0] == 0)
		return stop_mission(txn);
	int err = host_clock(&now);
	return err ? err
	           : start_with(txn, txn->number[0], STOPS | CLEARS | EASY | STARTS | MUST_RUN);
}
