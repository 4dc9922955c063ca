/* SPDX-License-Identifier: MIT */
/*
 * One visit of one chip, repeated with a trouble at each place. Each visit begins with the same
 * chip on a new wire, which measured once and whose inputs and memories then changed. The answer of
 * a visit without trouble is the truth.
 */
#pragma once

#include "hal/chips/family.h"
#include "tests/unit/aid/native_scene.h"

/*
 * Of the places where a trouble can happen one in visit_stride() is tried; the first always is. The
 * variable VISIT_STRIDE of the environment says how many. Without it each place is tried, and one
 * in 7 by builds with a sanitizer and of 32 bits: they look for errors of memory and of sizes, in
 * steps that the plain build tries everywhere, and need several times as long. 7 and the 8 bits of
 * a byte have no common factor: one bit of each byte at least is turned over, each bit of a byte in
 * its turn.
 */
unsigned visit_stride(void);

struct visit {
	const char *chip;
	const char *property; /* with its extension, ".BYTE" */
	const char *write;    /* NULL: the visit reads */
	bool parasite;
	bool turned;     /* the pins are inverted: a DS2405 conducts */
	double slack;    /* a counting number may exceed the truth by this much */
	unsigned stride; /* try each stride-th place (times visit_stride()); 0: each place */
};

/*
 * The chips that are visited, by groups: X(name of its tests, chip, is it fed by the wire?). A new
 * simulated chip is one line here, and all tests of visits have it; each family has one at least. A
 * group is a program (visit_group.h), which also has what is written. VISIT_CHIPS has thermometers
 * and switches.
 */
/* clang-format off */
#define VISIT_CHIPS(X) \
	X(ds18b20, "DS18B20", false) \
	X(ds18b20_fed_by_the_wire, "DS18B20", true) \
	X(ds18s20, "DS18S20", false) \
	X(ds1822, "DS1822", false) \
	X(ds1825, "DS1825", false) \
	X(ds28ea00, "DS28EA00", false) \
	X(ds2405, "DS2405", false) \
	X(ds2409, "DS2409", false) \
	X(ds2406, "DS2406", false) \
	X(ds2408, "DS2408", false) \
	X(ds2413, "DS2413", false) \
	X(ds2450, "DS2450", false)

#define VISIT_MEMORIES(X) \
	X(ds2423, "DS2423", false) \
	X(ds2430a, "DS2430A", false) \
	X(ds2431, "DS2431", false) \
	X(ds2433, "DS2433", false) \
	X(ds2502, "DS2502", false) \
	X(ds28ec20, "DS28EC20", false) \
	X(ds1991, "DS1991", false) \
	X(ds1992, "DS1992", false) \
	X(ds1993, "DS1993", false) \
	X(ds1995, "DS1995", false) \
	X(ds1996, "DS1996", false) \
	X(ds2505, "DS2505", false) \
	X(ds2506, "DS2506", false) \
	X(ds1982u, "DS1982U", false) \
	X(ds1963l, "DS1963L", false) \
	X(ds1963s, "DS1963S", false) \
	X(ds1977, "DS1977", false) \
	X(ds28e04, "DS28E04", false) \
	X(ds2404, "DS2404", false) \
	X(ds2415, "DS2415", false) \
	X(ds2417, "DS2417", false) \
	X(ds2890, "DS2890", false)

#define VISIT_BATTERIES(X) \
	X(ds2436, "DS2436", false) \
	X(ds2437, "DS2437", false) \
	X(ds2438, "DS2438", false) \
	X(ds2720, "DS2720", false) \
	X(ds2740, "DS2740", false)

#define VISIT_GAUGES(X) \
	X(ds2751, "DS2751", false) \
	X(ds2755, "DS2755", false) \
	X(ds2760, "DS2760", false) \
	X(ds2770, "DS2770", false) \
	X(ds2780, "DS2780", false) \
	X(ds2781, "DS2781", false)

#define VISIT_EDS(X) \
	X(eds0064, "EDS0064", false) \
	X(eds0068, "EDS0068", false) \
	X(eds0070, "EDS0070", false) \
	X(eds0071, "EDS0071", false) \
	X(eds0080, "EDS0080", false) \
	X(eds0090, "EDS0090", false)

#define VISIT_HOBBY(X) \
	X(mrs001, "mRS001", false) \
	X(mcm001, "mCM001", false) \
	X(mdi001, "mDI001", false) \
	X(mam001, "mAM001", false) \
	X(iblss, "IBLSS", false) \
	X(rgbw, "IE_RGBW", false) \
	X(switch_master, "IE_SWITCH_MASTER", false) \
	X(updater, "IE_UPDATER", false) \
	X(lcd, "LCD", false) \
	X(bae0910, "BAE0910", false) \
	X(bae0911, "BAE0911", false) \
	X(uvi_meter, "HB_UVI_METER", false) \
	X(moisture_meter, "HB_MOISTURE_METER", false) \
	X(hub, "HB_HUB", false) \
	X(barometer, "HB_BAROMETER", false) \
	X(hygrometer, "HB_HUMIDITY", false) \
	X(multitemp, "HB_MULTITEMP", false)

#define VISIT_LOGGERS(X) \
	X(ds1921g, "DS1921G", false) \
	X(ds1922l, "DS1922L", false) \
	X(ds1922t, "DS1922T", false) \
	X(ds1923, "DS1923", false)

#define VISIT_BRIDGES(X) \
	X(max31888, "MAX31888", false) \
	X(max31888_fed_by_the_wire, "MAX31888", true)

/* Family codes that several chips have. */
#define VISIT_IDENTITY(X) \
	X(max31850, "MAX31850", false) \
	X(tmp1826, "TMP1826", false) \
	X(tmp1826_fed_by_the_wire, "TMP1826", true) \
	X(max31825, "MAX31825", false)

#define VISIT_ALL(X) \
	VISIT_CHIPS(X) VISIT_MEMORIES(X) VISIT_BATTERIES(X) VISIT_GAUGES(X) VISIT_EDS(X) \
	VISIT_HOBBY(X) VISIT_LOGGERS(X) VISIT_BRIDGES(X) VISIT_IDENTITY(X)
/* clang-format on */

extern struct trouble trouble;
extern struct sim_slave *visited;
/* The visited chip is behind two couplers, and another of its kind on another branch. */
extern bool visit_behind;

/* Set up the chip as described above; the bus is up, and nothing goes wrong. */
void visit_begin(const struct visit *visit);
void visit_end(void);
/* Give all inputs and memories of the chip values that all differ; again: others than before. */
void visit_change(struct sim_slave *slave, bool again, bool turned);
/* Do the visit with this trouble; data[id] is the text of its answer. Returns the id. */
uint32_t visit_go(const struct visit *visit, const struct trouble *what);
/* Call one() with each trouble that can happen to the visit. Returns how many there were. */
unsigned visit_each(const struct visit *visit,
                    void (*one)(const struct visit *visit, const struct trouble *what));
/* Call one() so many times with noise, in which this share of the slots is turned over. */
void visit_in_noise(const struct visit *visit, unsigned times, double probability,
                    void (*one)(const struct visit *visit, const struct trouble *what));
/*
 * Call one() with a visit that reads each property of the chip in turn; of properties that are read
 * in the same way only the first. ONLY=text in the environment picks those with the text in their
 * name.
 */
void visit_properties(const char *chip, bool parasite, bool turned,
                      void (*one)(struct visit *visit, const struct property *property));
/* "slot 17 turned over" */
const char *visit_says(const struct visit *visit, const struct trouble *what);
