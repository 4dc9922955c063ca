/* SPDX-License-Identifier: MIT */
/*
 * What the loggers have in common (DS1921, DS1922, DS1923, DS2422): registers that are written by
 * way of the scratchpad, dates, the places of samples in a log.
 */
#pragma once

#include "hal/wire/txn.h"

/* Copy Scratchpad of this chip: its code, and whether a password of ones follows. */
struct logger_chip {
	uint8_t copy;
	bool password;
};
#define LOGGER_PASSWORD 8

/* Where a write of registers is, from call to call; zero: at the beginning. */
struct logger_write {
	uint8_t step, ending;
};

/*
 * Write n bytes, which do not cross a page of 32: to the scratchpad, which is read back, and from
 * there to the address, which the chip confirms. Several calls.
 */
int logger_write(struct txn *txn, const struct logger_chip *chip, struct logger_write *write,
                 unsigned at, const uint8_t *bytes, unsigned n);
/* The same, but the last call leaves the chip as the copy has left it: unconfirmed. */
int logger_write_only(struct txn *txn, const struct logger_chip *chip, struct logger_write *write,
                      unsigned at, const uint8_t *bytes, unsigned n);

/*
 * Seconds, minutes, hours, date, month, year in BCD, as the registers have them; the month counts
 * from 1 on, and its bit 7 is the century. They are UTC. -EIO: no date.
 */
enum { LOGGER_SECONDS, LOGGER_MINUTES, LOGGER_HOURS, LOGGER_DATE, LOGGER_MONTH, LOGGER_YEAR };
#define LOGGER_TIME 6
int logger_date(const uint8_t bcd[LOGGER_TIME], double *seconds);
/* The other way; *weekday: 1 to 7, Sunday first. */
void logger_bcd(double seconds, uint8_t bcd[LOGGER_TIME], uint8_t *weekday);

/* A log of `room` samples after `samples` of a mission that rolls over or does not. */
struct logger_log {
	uint32_t samples, room;
	bool rollover;
};
/* How many samples of the mission the log holds. */
uint32_t logger_elements(const struct logger_log *log);
/* The place in the log of the n-th that it holds, the oldest first. */
uint32_t logger_place(const struct logger_log *log, uint32_t n);
/* Which sample of the mission that is. */
uint32_t logger_sample(const struct logger_log *log, uint32_t n);

/* A counter of n bytes, the low one first. */
uint32_t logger_count(const uint8_t *bytes, unsigned n);
