/* SPDX-License-Identifier: MIT */
/* DS1922, DS1923, DS2422: converts, writes registers, sets the clock, starts and stops missions. */

#include <errno.h>
#include <string.h>

#include "hal/chips/family.h"
#include "hal/chips/loggers/ds1922.h"
#include "hal/chips/loggers/ds1922_mission.h"
#include "hal/chips/loggers/host_clock.h"
#include "hal/chips/loggers/logger.h"

enum { CLEAR_MEMORY = 0x96, START_MISSION = 0xcc, STOP_MISSION = 0x33 };

#define CONVERT_NS (666 * TXN_MS)

static const struct logger_chip chip = {.copy = 0x99, .password = true};

struct visit {
	struct logger_write write;
	uint8_t page[DS1922_PAGE]; /* the first of the registers as it was */
	uint8_t bytes[8];          /* what is written */
	uint8_t before[3], config;
};

static int ds1922_mission_look(struct txn *txn, unsigned where, uint8_t page[DS1922_PAGE])
{
	return ds1922_load(txn, &ds1922_memory, where, page, DS1922_PAGE);
}

/* The first page of the registers; -EBUSY: a mission runs. */
static int look_for_mission(struct txn *txn)
{
	struct visit *visit = txn_own(txn, struct visit);
	int err = ds1922_mission_look(txn, DS1922_CLOCK, visit->page);

	if (err)
		return err;
	return visit->page[DS1922_STATUS - DS1922_CLOCK] & DS1922_MIP ? -EBUSY : 0;
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
	static const uint8_t convert[] = {0x55, 0xff};
	struct visit *visit = txn_own(txn, struct visit);
	uint8_t page[DS1922_PAGE];
	int err;

	switch (txn->phase++) {
	case 0:
		err = look_for_mission(txn);
		if (!err && !(visit->page[DS1922_OSCILLATOR - DS1922_CLOCK] & DS1922_EOSC))
			err = -EIO;
		return err ? err : TXN_MORE;
	case 1:
		err = ds1922_mission_look(txn, DS1922_SAMPLES, page);
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
		err = txn_command(txn, convert, sizeof(convert));
		return err ? err : txn_wait(txn, CONVERT_NS);
	case 3:
		err = ds1922_mission_look(txn, DS1922_SAMPLES, page);
		if (!err &&
		    memcmp(visit->before, page + (DS1922_DEVICE_SAMPLES - DS1922_SAMPLES), 3) == 0)
			err = -EBADMSG;
		return err ? err : TXN_MORE;
	default:
		err = ds1922_mission_look(txn, DS1922_CLOCK, page);
		return err ? err : take_latest(txn, visit->config, page);
	}
}

/* The general pages; the registers have properties. */
int ds1922_write_page(struct txn *txn)
{
	struct visit *visit = txn_own(txn, struct visit);
	unsigned at = (unsigned)txn->element * DS1922_PAGE + (unsigned)txn->at;

	if (txn->len == 0)
		return 0;
	if (at >= DS1922_GENERAL)
		return -EOPNOTSUPP;
	return logger_write(txn, &chip, &visit->write, at, txn->data, (unsigned)txn->len);
}

/* A field of the registers. What it is already may be written during a mission too. */
int ds1922_write_field(struct txn *txn)
{
	const struct field *field = &txn->property->field;
	struct visit *visit = txn_own(txn, struct visit);
	unsigned n = field->bytes ? field->bytes : 1, bits = field->bits ? field->bits : 8 * n;
	uint32_t mask = (UINT32_C(1) << bits) - 1, value = (uint32_t)txn->number[0];
	const uint8_t *now = visit->page + (field->at - DS1922_CLOCK);
	int err;

	if (txn->number[0] > mask)
		return -EINVAL;
	if (txn->phase)
		return logger_write(txn, &chip, &visit->write, field->at, visit->bytes, n);
	err = look_for_mission(txn);
	if (err && err != -EBUSY)
		return err;
	mask <<= field->shift;
	value <<= field->shift;
	for (unsigned i = 0; i < n; i++, mask >>= 8, value >>= 8)
		visit->bytes[i] = (uint8_t)((now[i] & ~mask) | (value & mask));
	if (memcmp(visit->bytes, now, n) == 0)
		return 0;
	txn->phase = 1;
	return err ? err : TXN_MORE;
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

static int ds1922_mission_put(struct txn *txn, unsigned at, unsigned n)
{
	struct visit *visit = txn_own(txn, struct visit);
	int err = logger_write(txn, &chip, &visit->write, at, visit->bytes, n);

	if (err)
		return err;
	txn->phase++;
	return TXN_MORE;
}

/* A command, its password, and a byte that starts it. */
static int ds1922_mission_command(struct txn *txn, uint8_t code)
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
	int err = ds1922_mission_look(txn, DS1922_CLOCK, page);

	if (err)
		return err;
	txn->phase++;
	return page[DS1922_STATUS - DS1922_CLOCK] & flag ? TXN_MORE : -EIO;
}

static int set_clock(struct txn *txn, unsigned wanted)
{
	struct visit *visit = txn_own(txn, struct visit);
	bool stands = !(visit->page[DS1922_OSCILLATOR - DS1922_CLOCK] & DS1922_EOSC);
	uint8_t weekday;

	if (!(wanted & SETS_CLOCK) && !(wanted & STARTS && stands)) {
		txn->phase++;
		return TXN_MORE;
	}
	if (!visit->write.step) {
		double seconds = txn->number[0];
		int err = wanted & SETS_CLOCK ? 0 : host_clock(&seconds);

		if (err)
			return err;
		logger_bcd(seconds, visit->bytes, &weekday);
	}
	return ds1922_mission_put(txn, DS1922_CLOCK, LOGGER_TIME);
}

/* In seconds as far as they can be counted, then in minutes. */
static int set_oscillator(struct txn *txn, unsigned wanted)
{
	struct visit *visit = txn_own(txn, struct visit);
	uint8_t byte = visit->page[DS1922_OSCILLATOR - DS1922_CLOCK] & (DS1922_EOSC | DS1922_FAST);

	if (wanted & (RUNS_CLOCK | STARTS))
		byte |= DS1922_EOSC;
	if (wanted & SETS_RATE)
		byte = (uint8_t)((byte & ~DS1922_FAST) |
		                 (txn->number[0] <= DS1922_RATE_MOST ? DS1922_FAST : 0));
	visit->bytes[0] = byte;
	if (byte != visit->page[DS1922_OSCILLATOR - DS1922_CLOCK])
		return ds1922_mission_put(txn, DS1922_OSCILLATOR, 1);
	txn->phase++;
	return TXN_MORE;
}

static int set_rate(struct txn *txn, unsigned wanted)
{
	struct visit *visit = txn_own(txn, struct visit);
	unsigned rate = (unsigned)(txn->number[0] <= DS1922_RATE_MOST ? txn->number[0]
	                                                              : txn->number[0] / 60);

	if (wanted & SETS_RATE) {
		visit->bytes[0] = (uint8_t)rate;
		visit->bytes[1] = (uint8_t)(rate >> 8);
		return ds1922_mission_put(txn, DS1922_RATE, 2);
	}
	txn->phase = wanted & STARTS ? SET_MISSION : DONE;
	return TXN_MORE;
}

/* All quantities, as finely as they are measured; the rollover stays as it is. */
static int set_mission(struct txn *txn)
{
	struct visit *visit = txn_own(txn, struct visit);

	visit->bytes[0] = (uint8_t)((visit->page[DS1922_MISSION - DS1922_CLOCK] & DS1922_RO) |
	                            DS1922_LOG_TEMP | DS1922_WIDE |
	                            (ds1922_has_data(visit->config)
	                                     ? DS1922_LOG_DATA | DS1922_DATA_WIDE
	                                     : 0));
	return ds1922_mission_put(txn, DS1922_MISSION, 1);
}

static int do_steps(struct txn *txn, unsigned wanted)
{
	int err;

	switch ((enum step)txn->phase) {
	case LOOK:
		err = look_for_mission(txn);
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
		return ds1922_mission_command(txn, CLEAR_MEMORY);
	case IS_CLEAR:
		return has_flag(txn, DS1922_MEMCLR);
	case START:
		return ds1922_mission_command(txn, START_MISSION);
	case IS_STARTED:
		return has_flag(txn, DS1922_MIP);
	case DONE:
		return 0;
	}
	return -EIO;
}

int ds1922_write_date(struct txn *txn)
{
	return do_steps(txn, SETS_CLOCK | RUNS_CLOCK);
}

int ds1922_write_udate(struct txn *txn)
{
	return do_steps(txn, SETS_CLOCK);
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
		return ds1922_mission_command(txn, STOP_MISSION);
	err = look_for_mission(txn);
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
		err = ds1922_mission_look(txn, DS1922_SAMPLES, page);
		if (err)
			return err;
		visit->config = page[DS1922_CONFIG - DS1922_SAMPLES];
		visit->before[0] = 1;
		return TXN_MORE;
	}
	err = do_steps(txn, STARTS);
	return err == TXN_MORE && ds1922_interval_of(visit->page) == 0 ? -EINVAL : err;
}
