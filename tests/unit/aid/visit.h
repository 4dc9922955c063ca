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
/* "slot 17 turned over" */
const char *visit_says(const struct visit *visit, const struct trouble *what);

#endif
