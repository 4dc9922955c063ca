/* SPDX-License-Identifier: MIT */
/*
 * DS1921G, L, H and Z (their data sheets): areas, registers, and what is read of them. All pages
 * have a CRC16.
 *
 * Convert Temperature is proved by the counter of all samples, before and behind it; a copy by the
 * flag AA in E/S, after the scratchpad was read back with its CRC16; Clear Memory by MEMCLR of the
 * status.
 */
#pragma once

#include "hal/chips/loggers/logger.h"

/* Registers, from 200h on. */
enum {
	DS1921_CLOCK = 0x00,
	DS1921_WEEKDAY = 0x03,
	DS1921_CLOCK_ALARM = 0x07,
	DS1921_LOW = 0x0b,
	DS1921_HIGH = 0x0c,
	DS1921_RATE = 0x0d,
	DS1921_CONTROL = 0x0e,
	DS1921_READOUT = 0x11,
	DS1921_DELAY = 0x12,
	DS1921_STATUS = 0x14,
	DS1921_STAMP = 0x15,
	DS1921_SAMPLES = 0x1a,
	DS1921_DEVICE_SAMPLES = 0x1d,
	DS1921_LOW_TIMES = 0x20,
	DS1921_HIGH_TIMES = 0x50,
	DS1921_REGISTERS_END = 0x80,
};
/* Bits of the control register. */
enum {
	DS1921_EOSC = 0x80,
	DS1921_EMCLR = 0x40,
	DS1921_EM = 0x10,
	DS1921_RO = 0x08,
	DS1921_TLS = 0x04,
	DS1921_THS = 0x02,
};
/* Bits of the status register; CLEARED: those that a write of 0 clears. */
enum {
	DS1921_TCB = 0x80,
	DS1921_MEMCLR = 0x40,
	DS1921_MIP = 0x20,
	DS1921_CLEARED = 0x27,
};
enum { DS1921_PAGE = 32, DS1921_LOG_ROOM = 2048, DS1921_BINS = 63, DS1921_TIMES = 12 };
enum { DS1921_CLEAR_MEMORY = 0x3c, DS1921_CONVERT = 0x44 };

extern const struct logger ds1921_logger;

/* Of the upper 12 bits of the serial number; owserver knows these as well. */
struct ds1921_version {
	uint16_t id, convert_ms;
	const char *name;
	double zero, step, least, most;
};

/* NULL: owserver does not know it either. */
const struct ds1921_version *ds1921_version_of(const struct device *device);
double ds1921_celsius(const struct ds1921_version *version, unsigned code);

/*
 * Conversions, settings, clock and missions (ds1921_mission.c). A write to the registers ends a
 * mission, so it is refused (-EBUSY) while one runs.
 */
property_function ds1921_read_temperature, ds1921_write_limit, ds1921_write_trigger;
property_function ds1921_write_status, ds1921_write_flag, ds1921_write_clock;
property_function ds1921_clear_memory, ds1921_write_frequency, ds1921_write_running;
property_function ds1921_write_easystart;
