/* SPDX-License-Identifier: MIT */
/*
 * DS2437: the forerunner of the DS2438 (data sheet, "Smart Battery Monitor"), with the same memory
 * and the same commands.
 */
#include "hal/chips/batteries/ds2438_measure.h"
#include "hal/chips/family.h"

enum { PAGES = 1 };
static const struct area *const areas[] = {[PAGES] = &ds2438_pages};

enum { WAYS = 1 };
static const struct property_how how[] = {DS2438_WAYS(WAYS)};

#define MEASURED(text, kind, what, range) DS2438_MEASURED(text, kind, what, WAYS, range)
#define FLAG(text, bit) DS2438_FLAG(text, bit, WAYS)
#define TIME(text, kind, life_, where) DS2438_TIME(text, kind, life_, where, WAYS)

static const struct property properties[] = {
	FLAG("CA", 1),
	FLAG("EE", 2),
	FLAG("IAD", 0),
	MEASURED("VAD", FLOAT, DS2438_VAD, DS2438_VAD_VOLTS),
	MEASURED("VDD", FLOAT, DS2438_VDD, DS2438_VDD_VOLTS),
	TIME("date", DATE, VOLATILE, 8),
	PROPERTY_DIR("disconnect"),
	TIME("disconnect/date", DATE, VOLATILE, 16),
	TIME("disconnect/udate", UNSIGNED, VOLATILE, 16),
	PROPERTY_DIR("endcharge"),
	TIME("endcharge/date", DATE, VOLATILE, 20),
	TIME("endcharge/udate", UNSIGNED, VOLATILE, 20),
	DS2438_LATEST(128, WAYS),
	PROPERTY_DIR("pages"),
	DS2438_PAGES(WAYS),
	MEASURED("temperature", TEMPERATURE, DS2438_TEMPERATURE, DS2438_CELSIUS(128)),
	TIME("udate", UNSIGNED, SECOND, 8),
	MEASURED("vis", FLOAT, DS2438_VIS, DS2438_VIS_VOLTS),
};

CHIP_FAMILY(1e, "DS2437", PRESENCE, .flags = FLAG_VOLT | FLAG_TEMPERATURE,
            SCAN({"temperature", "temperature"}, {"VDD", "vdd"}, {"VAD", "vad"}), AREAS(areas),
            HOW(how), PROPERTIES(properties));
