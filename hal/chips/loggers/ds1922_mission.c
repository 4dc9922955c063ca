/* SPDX-License-Identifier: MIT */
/* DS1922, DS1923, DS2422: converts, writes registers, sets the clock, starts and stops missions. */

#include <errno.h>
#include <string.h>

#include "hal/chips/family.h"
#include "hal/chips/loggers/ds1922.h"

enum { CLEAR_MEMORY = 0x96, START_MISSION = 0xcc, STOP_MISSION = 0x33 };

#define CONVERT_NS (666 * TXN_MS)

struct visit {
	struct logger_visit common;
	uint8_t before[3], config;
};

/* The page of the registers that has the counters and the configuration. */
static int look_at_samples(struct txn *txn, uint8_t page[DS1922_PAGE])
{
	return ds1922_load(txn, &ds1922_memory, DS1922_SAMPLES, page, DS1922_PAGE);
}

/* arg: of which quantity. */
static int take_latest(struct txn *txn, uint8_t config, const uint8_t *page)
{
	unsigned where = txn->property->arg == DS1922_LOG_DATA ? DS1922_LATEST_DATA : DS1922_LATEST;
	const uint8_t *latest = page + (where - DS1922_CLOCK);

	if (txn->property->arg == DS1922_LOG_DATA)
		txn->number[0] = ds1922_humidity(latest[1], latest[0]);
	else
		txn->number[0] = ds1922_celsius(config, latest[1], latest[0]);
	return 0;
}

/*
 * The result is new when the counter of the device has moved. Without its oscillator the chip does
 * not convert.
 */
int ds1922_read_now(struct txn *txn)
{
	struct visit *visit = txn_own(txn, struct visit);
	uint8_t page[DS1922_PAGE];
	int err;

	switch (txn->phase++) {
	case 0:
		err = logger_look(txn);
		if (!err && !(visit->common.page[DS1922_OSCILLATOR - DS1922_CLOCK] & DS1922_EOSC))
			err = -EIO;
		return err ? err : TXN_MORE;
	case 1:
		err = look_at_samples(txn, page);
		if (err)
			return err;
		memcpy(visit->before, page + (DS1922_DEVICE_SAMPLES - DS1922_SAMPLES), 3);
		visit->config = page[DS1922_CONFIG - DS1922_SAMPLES];
		if (ds1922_zero_of(visit->config) < 0)
			return -EIO;
		if (txn->property->arg == DS1922_LOG_DATA && !ds1922_has_data(visit->config))
			return -ENOENT;
		return TXN_MORE;
	case 2:
		return txn_command_wait(txn, TXN_BYTES(0x55, 0xff), CONVERT_NS);
	case 3:
		err = look_at_samples(txn, page);
		if (!err &&
		    memcmp(visit->before, page + (DS1922_DEVICE_SAMPLES - DS1922_SAMPLES), 3) == 0)
			err = -EBADMSG;
		return err ? err : TXN_MORE;
	default:
		err = ds1922_logger.look(txn, page);
		return err ? err : take_latest(txn, visit->config, page);
	}
}

/* The general pages; the registers have properties. */
int ds1922_write_page(struct txn *txn)
{
	unsigned at = (unsigned)txn->element * DS1922_PAGE + (unsigned)txn->at;

	if (txn->len == 0)
		return 0;
	if (at >= DS1922_GENERAL)
		return -EOPNOTSUPP;
	return logger_write(txn, at, txn->data, (unsigned)txn->len);
}

/* --- Clock and missions --- */

/* Steps of what sets the clock or starts a mission; each is left out where it can be. */
enum step {
	LOOK,
	SET_CLOCK,
	SET_OSCILLATOR,
	SET_RATE,
	SET_MISSION,
	CLEAR,
	IS_CLEAR,
	START,
	IS_STARTED,
	DONE,
};
enum { SETS_CLOCK = 1, RUNS_CLOCK = 2, SETS_RATE = 4, STARTS = 8 };

/* A command, its password, and a byte that starts it. */
static int mission_command(struct txn *txn, uint8_t code)
{
	uint8_t bytes[2 + LOGGER_PASSWORD] = {code};

	memset(bytes + 1, 0xff, sizeof(bytes) - 1);
	txn_void(txn);
	int err = txn_command(txn, bytes, sizeof(bytes));
	if (err)
		return err;
	txn->phase++;
	return txn_wait(txn, TXN_MS);
}

/* Has the status the flag? */
static int has_flag(struct txn *txn, uint8_t flag)
{
	uint8_t page[DS1922_PAGE];
	int err = ds1922_logger.look(txn, page);

	if (err)
		return err;
	txn->phase++;
	return page[DS1922_STATUS - DS1922_CLOCK] & flag ? TXN_MORE : -EIO;
}

static int set_clock(struct txn *txn, unsigned wanted)
{
	const struct logger_visit *visit = txn_own(txn, struct logger_visit);
	bool stands = !(visit->page[DS1922_OSCILLATOR - DS1922_CLOCK] & DS1922_EOSC);

	if (wanted & SETS_CLOCK || (wanted & STARTS && stands))
		return logger_set_clock(txn, !(wanted & SETS_CLOCK));
	txn->phase++;
	return TXN_MORE;
}

/* In seconds as far as they can be counted, then in minutes. */
static int set_oscillator(struct txn *txn, unsigned wanted)
{
	struct logger_visit *visit = txn_own(txn, struct logger_visit);
	uint8_t byte = visit->page[DS1922_OSCILLATOR - DS1922_CLOCK] & (DS1922_EOSC | DS1922_FAST);

	if (wanted & (RUNS_CLOCK | STARTS))
		byte |= DS1922_EOSC;
	if (wanted & SETS_RATE)
		byte = (uint8_t)((byte & ~DS1922_FAST) |
		                 (txn->number[0] <= DS1922_RATE_MOST ? DS1922_FAST : 0));
	visit->bytes[0] = byte;
	if (byte != visit->page[DS1922_OSCILLATOR - DS1922_CLOCK])
		return logger_put(txn, DS1922_OSCILLATOR - DS1922_CLOCK, 1);
	txn->phase++;
	return TXN_MORE;
}

static int set_rate(struct txn *txn, unsigned wanted)
{
	struct logger_visit *visit = txn_own(txn, struct logger_visit);
	unsigned rate = (unsigned)(txn->number[0] <= DS1922_RATE_MOST ? txn->number[0]
	                                                              : txn->number[0] / 60);

	if (wanted & SETS_RATE) {
		visit->bytes[0] = (uint8_t)rate;
		visit->bytes[1] = (uint8_t)(rate >> 8);
		return logger_put(txn, DS1922_RATE - DS1922_CLOCK, 2);
	}
	txn->phase = wanted & STARTS ? SET_MISSION : DONE;
	return TXN_MORE;
}

/* All quantities, as finely as they are measured; the rollover stays as it is. */
static int set_mission(struct txn *txn)
{
	struct visit *visit = txn_own(txn, struct visit);

	visit->common.bytes[0] =
		(uint8_t)((visit->common.page[DS1922_MISSION - DS1922_CLOCK] & DS1922_RO) |
	                  DS1922_LOG_TEMP | DS1922_WIDE |
	                  (ds1922_has_data(visit->config) ? DS1922_LOG_DATA | DS1922_DATA_WIDE
	                                                  : 0));
	return logger_put(txn, DS1922_MISSION - DS1922_CLOCK, 1);
}

static int do_steps(struct txn *txn, unsigned wanted)
{
	int err;

	switch ((enum step)txn->phase) {
	case LOOK:
		err = logger_look(txn);
		txn->phase++;
		return err ? err : TXN_MORE;
	case SET_CLOCK:
		return set_clock(txn, wanted);
	case SET_OSCILLATOR:
		return set_oscillator(txn, wanted);
	case SET_RATE:
		err = set_rate(txn, wanted);
		txn->phase = txn->phase == SET_MISSION && !(wanted & STARTS) ? DONE : txn->phase;
		return err;
	case SET_MISSION:
		return set_mission(txn);
	case CLEAR:
		return mission_command(txn, CLEAR_MEMORY);
	case IS_CLEAR:
		return has_flag(txn, DS1922_MEMCLR);
	case START:
		return mission_command(txn, START_MISSION);
	case IS_STARTED:
		return has_flag(txn, DS1922_MIP);
	case DONE:
		return 0;
	}
	return -EIO;
}

/* A date has the clock run from there on. */
int ds1922_write_clock(struct txn *txn)
{
	return do_steps(txn, SETS_CLOCK | (txn->property->type == PROPERTY_DATE ? RUNS_CLOCK : 0));
}

int ds1922_write_interval(struct txn *txn)
{
	double minutes = txn->number[0] / 60;

	if (txn->number[0] < 1 || minutes > DS1922_RATE_MOST ||
	    (txn->number[0] > DS1922_RATE_MOST && minutes != (unsigned)minutes))
		return -EINVAL;
	return do_steps(txn, SETS_RATE);
}

static int stop_mission(struct txn *txn)
{
	int err;

	if (txn->phase == 0)
		return mission_command(txn, STOP_MISSION);
	err = logger_look(txn);
	return err == -EBUSY ? -EIO : err;
}

/* What its registers and its configuration say is a mission of an interval. */
int ds1922_write_running(struct txn *txn)
{
	struct visit *visit = txn_own(txn, struct visit);
	uint8_t page[DS1922_PAGE];
	int err;

	if (txn->number[0] == 0)
		return stop_mission(txn);
	if (txn->phase > LOOK)
		return do_steps(txn, STARTS);
	if (!visit->before[0]) {
		err = look_at_samples(txn, page);
		if (err)
			return err;
		visit->config = page[DS1922_CONFIG - DS1922_SAMPLES];
		visit->before[0] = 1;
		return TXN_MORE;
	}
	err = do_steps(txn, STARTS);
	return err == TXN_MORE && ds1922_interval_of(visit->common.page) == 0 ? -EINVAL : err;
}
