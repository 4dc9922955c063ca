/* SPDX-License-Identifier: MIT */
/* What a DS2438 measures: temperature, two voltages, a current. */
#pragma once

#include "hal/chips/batteries/ds2438.h"
#include "hal/chips/property.h"

/* Measure a set of quantities, or take what has been measured for others: to value[]. */
int ds2438_measure(struct txn *txn, unsigned what);
/* For properties: the quantity that arg says; the temperature that was measured last. */
int ds2438_read_measured(struct txn *txn);
int ds2438_read_latest(struct txn *txn);

/* clang-format off */
/* Ways of a family that measures so, from first on; PAGES is its area. */
#define DS2438_WAYS(first) \
	[first] = {.read = ds2438_read_measured}, \
	[(first) + 1] = {.read = ds2438_read_latest}, \
	[(first) + 2] = {.write = ds2438_write_flag}, \
	[(first) + 3] = {.write = ds2438_write_field}, \
	[(first) + 4] = {.write = ds2438_write_page}
enum { DS2438_WAY_COUNT = 5 };

#define DS2438_MEASURED(text, kind, what, first, ...) \
	PROPERTY(text, kind, VOLATILE, READ, .arg = (what), .how = (first), __VA_ARGS__)
/* -55 to +125 within 2, 0.03125; a TMP1826 up to 150 */
#define DS2438_CELSIUS(most) MEASURES(-58, most, 5, DEGREES_C)
/* 10 bits of 10 mV; on a VDD of 2.4 V at least the chip runs: a 0 is what a restart left */
#define DS2438_VAD_VOLTS MEASURES(0, 10.23, 2, "V")
#define DS2438_VDD_VOLTS MEASURES(2, 10.23, 2, "V")
/* 10 bits and sign of 0.2441 mV */
#define DS2438_VIS_VOLTS MEASURES(-0.25, 0.25, 5, "V")
#define DS2438_LATEST(most, first) \
	PROPERTY("latesttemp", TEMPERATURE, VOLATILE, READ, DS2438_CELSIUS(most), .how = (first) + 1)
#define DS2438_FLAG(text, bit, first) \
	PROPERTY(text, YESNO, STABLE, BOTH, FIELD(PAGES, .shift = (bit), .bits = 1), \
	         .how = (first) + 2)
#define DS2438_TIME(text, kind, life_, where, first) \
	PROPERTY(text, kind, life_, BOTH, FIELD(PAGES, .at = (where), .bytes = 4), \
	         .how = (first) + 3)
#define DS2438_PAGES(first) \
	PROPERTY("pages/page", BINARY, STABLE, BOTH, ELEMENTS(8, NUMBERS), .size = 8, \
	         FIELD(PAGES), .how = (first) + 4)
/* clang-format on */
