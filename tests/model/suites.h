/* SPDX-License-Identifier: MIT */
/* What main.c runs, and how it counts. */
#pragma once

#include "tests/model/explore.h"

struct tally {
	unsigned passed, failed;
	uint64_t states, steps;
};
__attribute__((format(printf, 3, 4))) void tally_test(struct tally *tally, bool passed,
                                                      const char *format, ...);

void litmus_run(struct tally *tally);

/* A slot of which only two words are looked at, for every two. */
void record_pairs(struct tally *tally);
/* Scenarios over the code of src/memory/shm and src/memory/libows; a NULL name ends a list. */
extern const struct scenario record_scenarios[], command_scenarios[], change_scenarios[];
/* Code that is wrong or of which too much is asked: each must fail. */
extern const struct scenario wrong_scenarios[], wrong_changes[];
