/* SPDX-License-Identifier: MIT */
/*
 * How the thermometers of a channel convert: all at once, or in turn.
 *
 *   all at once  Convert T with Skip ROM when all results are read; then each is read
 *   in turn      a chip that was read and is asked for again converts at once, by Match ROM, while
 *                others convert or wait to be read
 *
 * The facts: how many thermometers are asked for (one thread serves all channels of the bus, so
 * those of all count); how long the slowest converts; what a reading and a verified start took
 * lately; the share of the time that requests of other kinds took lately; how long it will be until
 * the results that are under way on the channel are read. The rule stands at schedule_in_turn().
 * All times are ns.
 *
 * Nothing here waits, allocates or uses the wire. The thread of the bus calls it.
 */
#pragma once

#include "hal/native/state.h"

/* Of a channel: its thermometers that are asked for. */
struct schedule_plan {
	unsigned due;     /* wait for Convert T */
	unsigned reading; /* convert, or are not read yet */
	/* Of all channels: how often the thread reads until all that are due or under way are. */
	unsigned rounds;
	bool preparing; /* others will be due soon */
	bool locked;    /* a chip on the channel is at work */
	bool silent;    /* one of those cannot show that it converts */
	bool driven;    /* a driver has the wire, and waits for the end of each conversion */
	bool parasitic_due, parasitic;
	const struct job *fed;  /* due, and of the only chip of the channel that the wire feeds */
	bool others_due;        /* ... and others are due, too */
	int64_t due_ns, all_ns; /* how long those that are due convert, and all */
	int64_t longest_ns;     /* ... and those that are due, convert, or are not read yet */
	int64_t ready_ns;       /* when the last of those that convert is ready */
};

struct schedule_plan schedule_look(const struct native *native, unsigned channel);
/*
 * Is a new request of a thermometer due before those that came earlier are done? Not where others
 * take much of the time: they would wait longer for that.
 */
bool schedule_early(const struct native *native);
/* Do those that are due convert now, in turn, though others are not read yet? */
bool schedule_in_turn(const struct native *native, const struct schedule_plan *plan, int64_t now);
/* Is this job one of a thermometer that is to convert? */
bool schedule_asks(const struct job *job);
/* Does this job, of a thermometer, read a result? */
bool schedule_reads(const struct job *job);
/* Owe this; not less than what is owed already: a group makes several starts in one step. */
static inline void schedule_owe(struct schedule *schedule, enum schedule_debt debt)
{
	if (schedule->owes < debt)
		schedule->owes = (uint8_t)debt;
}
/* A step of the bus took from began to now, and did schedule.doing. */
void schedule_took(struct schedule *schedule, int64_t began, int64_t now);
