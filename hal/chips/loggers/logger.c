/* SPDX-License-Identifier: MIT */
/* What the loggers have in common: writing by way of the scratchpad, dates, places in a log. */
#include "hal/chips/loggers/logger.h"

#include <errno.h>
#include <string.h>
#include <time.h>

#define PAGE 32
#define COPIED 0x80 /* E/S: the scratchpad was copied */
#define ENDING 0x1f
/* 2 us for each byte. */
#define COPY_NS TXN_MS

enum { WRITE_SCRATCHPAD = 0x0f, READ_SCRATCHPAD = 0xaa };
enum step { WRITE, LOOK, COPY, CONFIRM };

static int to_scratchpad(struct txn *txn, unsigned at, const uint8_t *bytes, unsigned n)
{
	uint8_t command[3 + PAGE] = {WRITE_SCRATCHPAD, (uint8_t)at, (uint8_t)(at >> 8)};

	memcpy(command + 3, bytes, n);
	return txn_command(txn, command, 3 + n);
}

/* Address, E/S and the bytes to the end of the page, with their CRC16: are they those? */
static int logger_look(struct txn *txn, struct logger_write *write, unsigned at,
                       const uint8_t *bytes, unsigned n)
{
	static const uint8_t command = READ_SCRATCHPAD;
	uint8_t in[3 + PAGE];
	int err = txn_command(txn, &command, 1);

	if (!err)
		err = txn_read_crc16(txn, &command, 1, in, 3 + PAGE - at % PAGE);
	if (err)
		return err;
	write->ending = in[2];
	if (in[0] != (at & 0xff) || in[1] != at >> 8 || (in[2] & ENDING) != (at + n - 1) % PAGE ||
	    memcmp(in + 3, bytes, n) != 0)
		return -EBADMSG;
	return 0;
}

static int logger_copy(struct txn *txn, const struct logger_chip *chip,
                       const struct logger_write *write, unsigned at)
{
	uint8_t command[4 + LOGGER_PASSWORD] = {chip->copy, (uint8_t)at, (uint8_t)(at >> 8),
	                                        write->ending};

	memset(command + 4, 0xff, LOGGER_PASSWORD);
	txn_void(txn);
	int err = txn_command(txn, command, chip->password ? sizeof(command) : 4);
	return err ? err : txn_wait(txn, COPY_NS);
}

/* TXN_MORE until the copy is confirmed. */
static int next(struct txn *txn, const struct logger_chip *chip, struct logger_write *write,
                unsigned at, const uint8_t *bytes, unsigned n)
{
	enum step step = write->step;
	int err = 0;

	switch (step) {
	case WRITE:
		err = to_scratchpad(txn, at, bytes, n);
		break;
	case LOOK:
	case CONFIRM:
		err = logger_look(txn, write, at, bytes, n);
		if (!err && (write->ending & ~ENDING) != (step == LOOK ? 0 : COPIED))
			err = -EBADMSG;
		break;
	case COPY:
		err = logger_copy(txn, chip, write, at);
		break;
	}
	if (err < 0)
		return err;
	write->step++;
	return step == CONFIRM ? 0 : TXN_MORE;
}

int logger_write(struct txn *txn, const struct logger_chip *chip, struct logger_write *write,
                 unsigned at, const uint8_t *bytes, unsigned n)
{
	int err = next(txn, chip, write, at, bytes, n);

	if (!err)
		*write = (struct logger_write){0};
	return err;
}

int logger_write_only(struct txn *txn, const struct logger_chip *chip, struct logger_write *write,
                      unsigned at, const uint8_t *bytes, unsigned n)
{
	if (write->step < CONFIRM)
		return next(txn, chip, write, at, bytes, n);
	*write = (struct logger_write){0};
	return 0;
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

void logger_bcd(double seconds, uint8_t bcd[LOGGER_TIME], uint8_t *weekday)
{
	time_t when = (time_t)seconds;
	struct tm tm;

	gmtime_r(&when, &tm);
	bcd[LOGGER_SECONDS] = to_bcd(tm.tm_sec);
	bcd[LOGGER_MINUTES] = to_bcd(tm.tm_min);
	bcd[LOGGER_HOURS] = to_bcd(tm.tm_hour);
	bcd[LOGGER_DATE] = to_bcd(tm.tm_mday);
	bcd[LOGGER_MONTH] = (uint8_t)(to_bcd(tm.tm_mon + 1) | (tm.tm_year >= 100 ? 0x80 : 0));
	bcd[LOGGER_YEAR] = to_bcd(tm.tm_year % 100);
	*weekday = (uint8_t)(tm.tm_wday + 1);
}

static bool is_full(const struct logger_log *log)
{
	return log->samples > log->room;
}

uint32_t logger_elements(const struct logger_log *log)
{
	return is_full(log) ? log->room : log->samples;
}

uint32_t logger_place(const struct logger_log *log, uint32_t n)
{
	return is_full(log) && log->rollover ? (log->samples + n) % log->room : n;
}

uint32_t logger_sample(const struct logger_log *log, uint32_t n)
{
	return is_full(log) && log->rollover ? log->samples - log->room + n : n;
}

uint32_t logger_count(const uint8_t *bytes, unsigned n)
{
	uint32_t value = 0;

	while (n--)
		value = value << 8 | bytes[n];
	return value;
}
