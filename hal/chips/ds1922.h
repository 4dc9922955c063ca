/* SPDX-License-Identifier: MIT */
/*
 * DS1922L, DS1922T, DS1923 (their data sheets) and their bare chip DS2422: areas, registers, and
 * what is read of them. Nearly each command has a password; that of a chip without one is ignored,
 * and owsd sends ones.
 */
#ifndef HAL_CHIPS_DS1922_H
#define HAL_CHIPS_DS1922_H

#include "hal/chips/area.h"

enum {
	CLOCK = 0x200,
	RATE = 0x206,
	LATEST = 0x20c,
	LATEST_DATA = 0x20e,
	OSCILLATOR = 0x212,
	MISSION = 0x213,
	STATUS = 0x215,
	DELAY = 0x216,
	STAMP = 0x219,
	SAMPLES = 0x220,
	DEVICE_SAMPLES = 0x223,
	CONFIG = 0x226,
	GENERAL = 0x200, /* bytes of memory before the registers */
};
enum { EOSC = 0x01, FAST = 0x02 }; /* oscillator */
enum { RO = 0x10, DATA_WIDE = 0x08, WIDE = 0x04, LOG_DATA = 0x02, LOG_TEMP = 0x01 }; /* mission */
enum { MEMCLR = 0x08, MIP = 0x02 };                                                  /* status */
enum { PAGE = 32, PAGES = 18, LOG = 0x1000, LOG_SIZE = 8192, RATE_MOST = 0x3fff };

extern const struct area ds1922_memory, ds1922_log;

/* One transaction: n bytes from byte `at` of the area to the end of a page, their CRC16 checked. */
int ds1922_load(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes, unsigned n);

/* What 0 is in degrees below zero, by the configuration; -1: it is not known. */
double ds1922_zero_of(uint8_t config);
/* Has it a second quantity? */
bool ds1922_has_data(uint8_t config);
double ds1922_celsius(uint8_t config, uint8_t high, uint8_t low);
double ds1922_humidity(uint8_t high, uint8_t low);
/* Seconds between two samples, by the first page of the registers. */
double ds1922_interval_of(const uint8_t *page);

int ds1922_read_elements(struct txn *txn);
int ds1922_read_date(struct txn *txn);
int ds1922_read_log(struct txn *txn);
int ds1922_read_clock(struct txn *txn);
int ds1922_read_interval(struct txn *txn);

#endif
