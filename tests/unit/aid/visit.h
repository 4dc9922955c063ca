/* SPDX-License-Identifier: MIT */
/*
 * One visit of one chip, again and again with a trouble at each place of it: each begins with the
 * same chip on a new wire, which measured something once and whose inputs and memories then
 * changed. What an untroubled visit says is the truth.
 */
#ifndef TESTS_UNIT_AID_VISIT_H
#define TESTS_UNIT_AID_VISIT_H

#include "hal/chips/family.h"
#include "tests/unit/aid/native_scene.h"

struct visit {
	const char *chip;
	const char *property; /* with its extension, ".BYTE" */
	const char *write;    /* NULL: it is read */
	bool parasite;
	bool turned;     /* the pins are the other way round, a DS2405 conducts */
	double slack;    /* a number that goes on by itself may be so much more than the truth */
	unsigned stride; /* of the places that are tried; 0: each */
};

extern struct trouble trouble;
extern struct sim_slave *visited;

/* The chip, as described above; the bus is up and nothing is troubled. */
void visit_begin(const struct visit *visit);
void visit_end(void);
/* The visit itself, with this trouble; its answer's text is data[the id]. Returns its id. */
uint32_t visit_go(const struct visit *visit, const struct trouble *what);
/* Calls one() with each trouble that can happen to the visit. Returns how many there were. */
unsigned visit_each(const struct visit *visit,
                    void (*one)(const struct visit *visit, const struct trouble *what));
/* "slot 17 turned over" */
const char *visit_says(const struct visit *visit, const struct trouble *what);

#endif
