/* SPDX-License-Identifier: MIT */
/*
 * What the loggers have in common (DS1921, DS1922, DS1923, DS2422): registers that are written by
 * way of the scratchpad, the clock, a mission and its log. The registers begin at 200h, and those
 * that steer a mission stand in their first page.
 */
#pragma once

#include "hal/chips/area.h"
#include "hal/chips/property.h"

#define LOGGER_REGISTERS 0x200u
#define LOGGER_PAGE 32
#define LOGGER_PASSWORD 8
#define LOGGER_TIME 6

/* What the log holds, and how it came about. */
struct logger_mission {
	uint32_t samples, room; /* of the mission, and what there is room for in the log */
	bool rollover;
	uint8_t stamp[LOGGER_TIME]; /* when it began */
	double interval;            /* seconds between two samples */
};

/* What tells one of these chips from the others (family.facts). */
struct logger {
	uint8_t copy;             /* the code of Copy Scratchpad */
	bool password;            /* ... a password of ones follows */
	bool weekday;             /* of the clock, between hours and date */
	uint8_t status, running;  /* the register, in the first page, and its bit of a mission */
	const struct area *clock; /* has the clock at LOGGER_REGISTERS */
	/* The first page of the registers as it is now; one transaction. */
	int (*look)(struct txn *txn, uint8_t page[LOGGER_PAGE]);
	/* Reads what belongs to a mission; several calls. */
	int (*mission)(struct txn *txn, struct logger_mission *mission);
};

/* Where a write of registers is, from call to call; zero: at the beginning. */
struct logger_write {
	uint8_t step, ending;
};

/* The first member of what a family keeps from call to call while it writes. */
struct logger_visit {
	struct logger_write write;
	uint8_t page[LOGGER_PAGE]; /* the first of the registers, as logger_look() saw it */
	uint8_t bytes[8];          /* what is written */
};

/*
 * Write n bytes, which do not cross a page of 32: to the scratchpad, which is read back, and from
 * there to the address, which the chip confirms. Several calls.
 */
int logger_write(struct txn *txn, unsigned at, const uint8_t *bytes, unsigned n);
/* The same, but the last call leaves the chip as the copy has left it: unconfirmed. */
int logger_write_only(struct txn *txn, unsigned at, const uint8_t *bytes, unsigned n);

/* The first page of the registers to visit.page. -EBUSY: it is there, and a mission runs. */
int logger_look(struct txn *txn);
/* Write n of visit.bytes to the registers from `at` on; then the next phase comes: TXN_MORE. */
int logger_put(struct txn *txn, unsigned at, unsigned n);
/*
 * Bits of n bytes of the registers from `at` on become those of value. -EBUSY while a mission runs,
 * but for what they are already.
 */
int logger_change(struct txn *txn, unsigned at, unsigned n, uint32_t mask, uint32_t value);
/* A step: sets the clock to the number that is written, or (by_host) to the host's time. */
int logger_set_clock(struct txn *txn, bool by_host);

/*
 * For properties: the clock; the number of samples in the log; the time of the mission's first
 * sample, or (arg 1) of an element of the log; a field of the registers.
 */
property_function logger_read_clock, logger_read_elements, logger_read_date, logger_write_field;

/*
 * Seconds, minutes, hours, date, month, year in BCD, as the registers have them; the month counts
 * from 1 on, and its bit 7 is the century. They are UTC. -EIO: no date.
 */
enum { LOGGER_SECONDS, LOGGER_MINUTES, LOGGER_HOURS, LOGGER_DATE, LOGGER_MONTH, LOGGER_YEAR };
int logger_date(const uint8_t bcd[LOGGER_TIME], double *seconds);

/* How many samples of the mission the log holds. */
uint32_t logger_elements(const struct logger_mission *mission);
/* Where the n-th sample that the log holds stands in it, the oldest first. */
uint32_t logger_index(const struct logger_mission *mission, uint32_t n);

/* A counter of n bytes, the low one first. */
uint32_t logger_count(const uint8_t *bytes, unsigned n);
