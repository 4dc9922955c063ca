/* SPDX-License-Identifier: MIT */
/* What the loggers have in common: registers, the clock, a mission and where its samples stand. */
#include "hal/chips/loggers/logger.h"

#include <errno.h>
#include <string.h>
#include <time.h>

#include "hal/chips/field.h"
#include "hal/chips/loggers/host_clock.h"

#define PAGE LOGGER_PAGE
#define COPIED 0x80 /* E/S: the scratchpad was copied */
#define ENDING 0x1f
/* 2 us for each byte. */
#define COPY_NS TXN_MS

enum { WRITE_SCRATCHPAD = 0x0f, READ_SCRATCHPAD = 0xaa };
enum step { WRITE, LOOK, COPY, CONFIRM };

static const struct logger *logger_of(const struct txn *txn)
{
	return txn->device->family->facts;
}

static struct logger_visit *logger_visit_of(struct txn *txn)
{
	return txn_own(txn, struct logger_visit);
}

static int to_scratchpad(struct txn *txn, unsigned at, const uint8_t *bytes, unsigned n)
{
	uint8_t command[3 + PAGE] = {WRITE_SCRATCHPAD, (uint8_t)at, (uint8_t)(at >> 8)};

	memcpy(command + 3, bytes, n);
	return txn_command(txn, command, 3 + n);
}

/* Address, E/S and the bytes to the end of the page, with their CRC16: are they those? */
static int look_at_scratchpad(struct txn *txn, struct logger_write *write, unsigned at,
                              const uint8_t *bytes, unsigned n)
{
	uint8_t in[3 + PAGE];
	int err = txn_ask_crc16(txn, TXN_BYTES(READ_SCRATCHPAD), in, 3 + PAGE - at % PAGE);

	if (err)
		return err;
	write->ending = in[2];
	if (in[0] != (at & 0xff) || in[1] != at >> 8 || (in[2] & ENDING) != (at + n - 1) % PAGE ||
	    memcmp(in + 3, bytes, n) != 0)
		return -EBADMSG;
	return 0;
}

static int copy_scratchpad(struct txn *txn, const struct logger_write *write, unsigned at)
{
	const struct logger *chip = logger_of(txn);
	uint8_t command[4 + LOGGER_PASSWORD] = {chip->copy, (uint8_t)at, (uint8_t)(at >> 8),
	                                        write->ending};

	memset(command + 4, 0xff, LOGGER_PASSWORD);
	txn_void(txn);
	return txn_command_wait(txn, command, chip->password ? sizeof(command) : 4, COPY_NS);
}

/* TXN_MORE until the copy is confirmed. */
static int write_step(struct txn *txn, unsigned at, const uint8_t *bytes, unsigned n)
{
	struct logger_write *write = &logger_visit_of(txn)->write;
	enum step step = write->step;
	int err = 0;

	switch (step) {
	case WRITE:
		err = to_scratchpad(txn, at, bytes, n);
		break;
	case LOOK:
	case CONFIRM:
		err = look_at_scratchpad(txn, write, at, bytes, n);
		if (!err && (write->ending & ~ENDING) != (step == LOOK ? 0 : COPIED))
			err = -EBADMSG;
		break;
	case COPY:
		err = copy_scratchpad(txn, write, at);
		break;
	}
	if (err < 0)
		return err;
	write->step++;
	return step == CONFIRM ? 0 : TXN_MORE;
}

int logger_write(struct txn *txn, unsigned at, const uint8_t *bytes, unsigned n)
{
	int err = write_step(txn, at, bytes, n);

	if (!err)
		logger_visit_of(txn)->write = (struct logger_write){0};
	return err;
}

int logger_write_only(struct txn *txn, unsigned at, const uint8_t *bytes, unsigned n)
{
	if (logger_visit_of(txn)->write.step < CONFIRM)
		return write_step(txn, at, bytes, n);
	logger_visit_of(txn)->write = (struct logger_write){0};
	return 0;
}

int logger_look(struct txn *txn)
{
	const struct logger *chip = logger_of(txn);
	uint8_t *page = logger_visit_of(txn)->page;
	int err = chip->look(txn, page);

	if (err)
		return err;
	return page[chip->status] & chip->running ? -EBUSY : 0;
}

int logger_put(struct txn *txn, unsigned at, unsigned n)
{
	int err = logger_write(txn, LOGGER_REGISTERS + at, logger_visit_of(txn)->bytes, n);

	if (err)
		return err;
	txn->phase++;
	return TXN_MORE;
}

int logger_change(struct txn *txn, unsigned at, unsigned n, uint32_t mask, uint32_t value)
{
	struct logger_visit *visit = logger_visit_of(txn);
	int err;

	if (txn->phase)
		return logger_write(txn, LOGGER_REGISTERS + at, visit->bytes, n);
	err = logger_look(txn);
	if (err && err != -EBUSY)
		return err;
	for (unsigned i = 0; i < n; i++, mask >>= 8, value >>= 8)
		visit->bytes[i] = (uint8_t)((visit->page[at + i] & ~mask) | (value & mask));
	if (memcmp(visit->bytes, visit->page + at, n) == 0)
		return 0;
	txn->phase = 1;
	return err ? err : TXN_MORE;
}

int logger_write_field(struct txn *txn)
{
	const struct field *field = &txn->property->field;
	unsigned n = field->bytes ? field->bytes : 1, bits = field->bits ? field->bits : 8 * n;
	unsigned at = family_area(txn)->at + field->at - LOGGER_REGISTERS;
	uint32_t mask = (UINT32_C(1) << bits) - 1;
	double number = txn->number[0];

	if (number < 0 || number > mask)
		return -EINVAL;
	uint32_t value = field->inverted ? ~(uint32_t)number & mask : (uint32_t)number;
	return logger_change(txn, at, n, mask << field->shift, value << field->shift);
}

static int from_bcd(uint8_t bcd)
{
	return (bcd >> 4) * 10 + (bcd & 15);
}

static int hour_of(uint8_t bcd)
{
	if (!(bcd & 0x40))
		return from_bcd(bcd & 0x3f);
	return from_bcd(bcd & 0x1f) % 12 + (bcd & 0x20 ? 12 : 0);
}

int logger_date(const uint8_t bcd[LOGGER_TIME], double *seconds)
{
	struct tm tm = {
		.tm_sec = from_bcd(bcd[LOGGER_SECONDS] & 0x7f),
		.tm_min = from_bcd(bcd[LOGGER_MINUTES] & 0x7f),
		.tm_hour = hour_of(bcd[LOGGER_HOURS]),
		.tm_mday = from_bcd(bcd[LOGGER_DATE] & 0x3f),
		.tm_mon = from_bcd(bcd[LOGGER_MONTH] & 0x1f) - 1,
		.tm_year = from_bcd(bcd[LOGGER_YEAR]) + (bcd[LOGGER_MONTH] & 0x80 ? 100 : 0),
	};
	struct tm given = tm;
	time_t when = timegm(&tm);

	/* what is no date is taken as another one */
	if (when < 0 || tm.tm_mday != given.tm_mday || tm.tm_mon != given.tm_mon ||
	    tm.tm_hour != given.tm_hour || tm.tm_min != given.tm_min || tm.tm_sec != given.tm_sec)
		return -EIO;
	*seconds = (double)when;
	return 0;
}

static uint8_t to_bcd(int value)
{
	return (uint8_t)(value / 10 << 4 | value % 10);
}

static void put_clock(const struct logger *chip, double seconds, uint8_t *bytes)
{
	time_t when = (time_t)seconds;
	struct tm tm;

	gmtime_r(&when, &tm);
	const uint8_t bcd[LOGGER_TIME] = {
		[LOGGER_SECONDS] = to_bcd(tm.tm_sec),
		[LOGGER_MINUTES] = to_bcd(tm.tm_min),
		[LOGGER_HOURS] = to_bcd(tm.tm_hour),
		[LOGGER_DATE] = to_bcd(tm.tm_mday),
		[LOGGER_MONTH] = to_bcd(tm.tm_mon + 1) | (tm.tm_year >= 100 ? 0x80 : 0),
		[LOGGER_YEAR] = to_bcd(tm.tm_year % 100),
	};
	memcpy(bytes, bcd, LOGGER_DATE);
	bytes[LOGGER_DATE] = (uint8_t)(tm.tm_wday + 1); /* 1 to 7, Sunday first */
	memcpy(bytes + LOGGER_DATE + chip->weekday, bcd + LOGGER_DATE, LOGGER_TIME - LOGGER_DATE);
}

int logger_set_clock(struct txn *txn, bool by_host)
{
	const struct logger *chip = logger_of(txn);
	struct logger_visit *visit = logger_visit_of(txn);

	if (!visit->write.step) {
		double seconds = txn->number[0];
		int err = by_host ? host_clock(&seconds) : 0;

		if (err)
			return err;
		put_clock(chip, seconds, visit->bytes);
	}
	return logger_put(txn, 0, LOGGER_TIME + chip->weekday);
}

int logger_read_clock(struct txn *txn)
{
	const struct logger *chip = logger_of(txn);
	uint8_t bytes[LOGGER_TIME + 1];
	int err = area_read(txn, chip->clock, LOGGER_REGISTERS - chip->clock->at, bytes,
	                    LOGGER_TIME + chip->weekday);

	if (err)
		return err;
	memmove(bytes + LOGGER_DATE, bytes + LOGGER_DATE + chip->weekday,
	        LOGGER_TIME - LOGGER_DATE);
	return logger_date(bytes, &txn->number[0]);
}

static bool is_full(const struct logger_mission *mission)
{
	return mission->samples > mission->room;
}

uint32_t logger_elements(const struct logger_mission *mission)
{
	return is_full(mission) ? mission->room : mission->samples;
}

uint32_t logger_index(const struct logger_mission *mission, uint32_t n)
{
	return is_full(mission) && mission->rollover ? (mission->samples + n) % mission->room : n;
}

int logger_read_elements(struct txn *txn)
{
	struct logger_mission *mission = txn_own(txn, struct logger_mission);
	int err = logger_of(txn)->mission(txn, mission);

	if (!err)
		txn->number[0] = logger_elements(mission);
	return err;
}

int logger_read_date(struct txn *txn)
{
	struct logger_mission *mission = txn_own(txn, struct logger_mission);
	uint32_t n = (uint32_t)txn->element;
	int err = logger_of(txn)->mission(txn, mission);

	if (!err)
		err = logger_date(mission->stamp, &txn->number[0]);
	if (err || !txn->property->arg)
		return err;
	if (n >= logger_elements(mission))
		return -ENODATA;
	/* a log that rolled over holds the last samples */
	if (is_full(mission) && mission->rollover)
		n += mission->samples - mission->room;
	txn->number[0] += mission->interval * n;
	return 0;
}

uint32_t logger_count(const uint8_t *bytes, unsigned n)
{
	uint32_t value = 0;

	while (n--)
		value = value << 8 | bytes[n];
	return value;
}
