/* SPDX-License-Identifier: MIT */
/* What a world is made of, and what it is told of while it lives. */
#pragma once

#include "tests/endurance/invariants.h"

struct world {
	const char *name;
	const char *targets; /* %0 is the first part's target; comma and bar as in the file */
	const struct part_ops *parts[STATION_PARTS];
	unsigned wires[STATION_PARTS];
	bool moody; /* a target of it is never quiet for long */
	void (*devices)(void);
	unsigned hours; /* among the unit tests */
};

/* test_endurance.c: the one that lives; something happens to it, which a failure tells. */
extern const struct world *world;
void world_note(const char *what);

/* world_config.c: its .rio, with these differences; good until the next. */
enum { WITHOUT_SECOND = 1, OTHER_PERIOD = 2, SLOWER = 4, WITHOUT_LAST_TARGET = 8, VARIANTS = 16 };
const char *world_configuration(unsigned variant);
