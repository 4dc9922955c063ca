/* SPDX-License-Identifier: MIT */
/*
 * One visit of one chip, repeated with a trouble at each place. Each visit begins with the same
 * chip on a new wire, which measured once and whose inputs and memories then changed. The answer of
 * a visit without trouble is the truth.
 */
#ifndef TESTS_UNIT_AID_VISIT_H
#define TESTS_UNIT_AID_VISIT_H

#include "hal/chips/family.h"
#include "tests/unit/aid/native_scene.h"

struct visit {
	const char *chip;
	const char *property; /* with its extension, ".BYTE" */
	const char *write;    /* NULL: the visit reads */
	bool parasite;
	bool turned;     /* the pins are inverted: a DS2405 conducts */
	double slack;    /* a counting number may exceed the truth by this much */
	unsigned stride; /* try each stride-th place; 0: each place */
};

/*
 * The chips that are visited, each once: X(name of its tests, chip, is it fed by the wire?). A new
 * simulated chip is one line here, and all tests of visits have it.
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
	X(ds2406, "DS2406", false) \
	X(ds2408, "DS2408", false) \
	X(ds2413, "DS2413", false) \
	X(ds2423, "DS2423", false) \
	X(ds2430a, "DS2430A", false) \
	X(ds2431, "DS2431", false) \
	X(ds2433, "DS2433", false) \
	X(ds2438, "DS2438", false) \
	X(ds2450, "DS2450", false) \
	X(ds2502, "DS2502", false) \
	X(ds2720, "DS2720", false) \
	X(ds28ec20, "DS28EC20", false)
/* clang-format on */

extern struct trouble trouble;
extern struct sim_slave *visited;

/* Set up the chip as described above; the bus is up, and nothing goes wrong. */
void visit_begin(const struct visit *visit);
void visit_end(void);
/* Do the visit with this trouble; data[id] is the text of its answer. Returns the id. */
uint32_t visit_go(const struct visit *visit, const struct trouble *what);
/* Call one() with each trouble that can happen to the visit. Returns how many there were. */
unsigned visit_each(const struct visit *visit,
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

#endif
