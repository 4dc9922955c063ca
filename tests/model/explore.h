/* SPDX-License-Identifier: MIT */
/*
 * Runs a few threads over the weak memory in every order and with every message that they may read,
 * and remembers the states it has been in. A thread is plain code, compiled with access.h; it stops
 * before each access, and its stack is put aside and back as the search goes to and fro.
 */
#pragma once

#include "tests/model/access.h"
#include "tests/model/weak.h"

struct scenario {
	const char *name;
	void (*setup)(void); /* before the threads: memory, explore_track(), explore_keep() */
	unsigned threads;
	void (*run[THREADS])(void);
	/*
	 * may be killed once, before any access; then this runs in its place, knowing what it knew
	 */
	void (*reborn[THREADS])(void);
	void (*end)(void); /* when nobody can go on */
};

/* What to weaken: an access of a site, in one of the ways that there are for its kind and order. */
struct mutant {
	const struct site *site;
	unsigned way;
};
/* In words, NULL: there is no such way. */
const char *explore_way(const struct site *site, unsigned way);

struct exploration {
	uint64_t states, steps;
	bool failed, too_large;
	char why[200];
};

/* bit: of the scenario in site.scenarios. loud: print the way to a failure. */
void explore(const struct scenario *scenario, const struct mutant *mutant, unsigned bit, bool loud,
             struct exploration *result);
/* All sites that were met, in the order in which they were. */
struct site *explore_sites(void);

/* For setup. Words of 32 or 64 bit that the threads share; all else is not looked at. */
void explore_track(const char *name, volatile void *at, size_t size);
/* What the threads remember besides their stacks: put aside and back too. */
void explore_keep(void *at, size_t size);

/* For the threads. */
__attribute__((format(printf, 1, 2))) void explore_fail(const char *format, ...);
/* What happened so far does not matter for what follows: states that differ in it are one. */
void explore_forget(uint64_t all_that_matters);
/* Loads of this thread since the last explore_forget(). */
unsigned explore_loads(void);

/* For end: what lies there when all is over; is the thread asleep in a futex call? */
uint64_t explore_last(const volatile void *at);
bool explore_asleep(unsigned thread);
