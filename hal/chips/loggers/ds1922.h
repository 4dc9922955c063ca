/* SPDX-License-Identifier: MIT */
/*
 * DS1922L, DS1922T, DS1923 (their data sheets) and their bare chip DS2422: areas, registers, and
 * what is read of them. Nearly each command has a password; that of a chip without one is ignored,
 * and owsd sends ones.
 *
 * Forced Conversion is proved by the counter of all samples, before and behind it; a copy by the
 * flag AA in E/S, after the scratchpad was read back with its CRC16; Clear Memory, Start and Stop
 * Mission by MEMCLR and MIP of the status.
 */
#pragma once

#include "hal/chips/loggers/logger.h"

enum {
	DS1922_CLOCK = 0x200,
	DS1922_RATE = 0x206,
	DS1922_LATEST = 0x20c,
	DS1922_LATEST_DATA = 0x20e,
	DS1922_OSCILLATOR = 0x212,
	DS1922_MISSION = 0x213,
	DS1922_STATUS = 0x215,
	DS1922_DELAY = 0x216,
	DS1922_STAMP = 0x219,
	DS1922_SAMPLES = 0x220,
	DS1922_DEVICE_SAMPLES = 0x223,
	DS1922_CONFIG = 0x226,
	DS1922_GENERAL = 0x200, /* bytes of memory before the registers */
};
/* Bits of the registers of oscillator, mission and status. */
enum { DS1922_EOSC = 0x01, DS1922_FAST = 0x02 };
enum {
	DS1922_RO = 0x10,
	DS1922_DATA_WIDE = 0x08,
	DS1922_WIDE = 0x04,
	DS1922_LOG_DATA = 0x02,
	DS1922_LOG_TEMP = 0x01,
};
enum { DS1922_MEMCLR = 0x08, DS1922_MIP = 0x02 };
enum {
	DS1922_PAGE = 32,
	DS1922_PAGES = 18,
	DS1922_LOG = 0x1000,
	DS1922_LOG_SIZE = 8192,
	DS1922_RATE_MOST = 0x3fff,
};

extern const struct logger ds1922_logger;
extern const struct area ds1922_memory;

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

/*
 * Conversions, settings, clock and missions (ds1922_mission.c). While a mission runs its settings
 * cannot be written (-EBUSY).
 */
property_function ds1922_read_now, ds1922_write_page, ds1922_write_clock;
property_function ds1922_write_interval, ds1922_write_running;
