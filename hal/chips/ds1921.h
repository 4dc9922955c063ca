/* SPDX-License-Identifier: MIT */
/*
 * DS1921G, L, H and Z (their data sheets): areas, registers, and what is read of them. All pages
 * have a CRC16.
 */
#ifndef HAL_CHIPS_DS1921_H
#define HAL_CHIPS_DS1921_H

#include "hal/chips/area.h"

#define DS1921_REGISTERS 0x200

/* Registers, from 200h on. */
enum {
	CLOCK = 0x00,
	WEEKDAY = 0x03,
	CLOCK_ALARM = 0x07,
	LOW = 0x0b,
	HIGH = 0x0c,
	RATE = 0x0d,
	CONTROL = 0x0e,
	READOUT = 0x11,
	DELAY = 0x12,
	STATUS = 0x14,
	STAMP = 0x15,
	SAMPLES = 0x1a,
	DEVICE_SAMPLES = 0x1d,
	LOW_TIMES = 0x20,
	HIGH_TIMES = 0x50,
	REGISTERS_END = 0x80,
};
enum { EOSC = 0x80, EMCLR = 0x40, EM = 0x10, RO = 0x08, TLS = 0x04, THS = 0x02 }; /* control */
enum { TCB = 0x80, MEMCLR = 0x40, MIP = 0x20, CLEARED = 0x27 }; /* status; CLEARED by writing 0 */
enum { PAGE = 32, LOG_ROOM = 2048, BINS = 63, TIMES = 12 };
enum { CLEAR_MEMORY = 0x3c, CONVERT = 0x44 };

extern const struct area ds1921_memory, ds1921_registers, ds1921_histogram, ds1921_log;

/* Of the upper 12 bits of the serial number; owserver knows these as well. */
struct ds1921_version {
	uint16_t id, convert_ms;
	const char *name;
	double zero, step, least, most;
};

/* NULL: owserver does not know it either. */
const struct ds1921_version *ds1921_version_of(const struct device *device);
double ds1921_celsius(const struct ds1921_version *version, unsigned code);

/* arg of what is read of the version. */
enum { RESOLUTION, LEAST, MOST, GAP, BIN, NAME };

/* arg of the times beyond a limit: where they begin, and what of them. */
enum { TIMES_COUNT, TIMES_BEGIN, TIMES_END, TIMES_HOW_MANY };
#define TIMES_ARG(first, what) ((first) << 8 | (what))

/* property.arg of the limits: their register. */
int ds1921_read_version(struct txn *txn);
int ds1921_read_bins(struct txn *txn);
int ds1921_read_clock(struct txn *txn);
int ds1921_read_start(struct txn *txn);
int ds1921_read_elements(struct txn *txn);
int ds1921_read_log_date(struct txn *txn);
int ds1921_read_log(struct txn *txn);
int ds1921_read_times(struct txn *txn);
int ds1921_read_limit(struct txn *txn);
int ds1921_read_trigger(struct txn *txn);

#endif
