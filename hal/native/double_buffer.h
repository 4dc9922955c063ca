/* SPDX-License-Identifier: MIT */
/*
 * Double buffer, an experimental way of the thermometers of a channel (option DoubleBuffer): the
 * next Convert T goes to all while results of the last are still to be read. A chip's scratchpad
 * keeps the old result until its conversion ends.
 *
 *   start    when the longest time is over, and as few results are left as can be read early
 *   early    until four fifths of the shortest time that this chip's trial has seen (trial.h)
 *   late     what is not read by then is lost, and the request gets the next result
 *   audit    each sixteenth cycle all are read late, and once more early: both have to be the same
 *
 * Only for chips that have passed their trial; the others of the channel are read late. Never where
 * two channels of the bus have thermometers. Nobody can see which chips heard a Convert T for all.
 * So a result counts as new if it differs from the one before, or if the chip showed a start of its
 * own (thermometer_proof.c); else its time stays that of the result that it repeats. An audit
 * starts the chips one by one where such a time has become old. Each chip is asked for its supply
 * again, about once in sixteen cycles.
 *
 * A request is served by a conversion that began before it and ends after it: measured_ns, the
 * start and the shortest time of the chip, lies behind the request.
 *
 * Nothing here waits or allocates. The thread of the bus calls it. All times are ns.
 */
#ifndef HAL_NATIVE_DOUBLE_BUFFER_H
#define HAL_NATIVE_DOUBLE_BUFFER_H

#include "hal/native/schedule.h"

/* Is this the way of the channel from now on? plan: what is asked for. */
void double_buffer_choose(struct native *native, unsigned n, const struct schedule_plan *plan,
                          int64_t now);
/* Was it chosen? */
bool double_buffer_runs(const struct native *native, unsigned n);
/* Does the next Convert T for all go out now, though results are left? */
bool double_buffer_begins(struct native *native, unsigned n, int64_t now);
/* It did, or failed with err: then all are read before the next. */
void double_buffer_begun(struct native *native, unsigned n, int err);
/* All results were read before this start: an audit begins with it, if it is time. */
void double_buffer_restarts(struct native *native, unsigned n);
/* Do the chips start one by one now, for an audit? */
bool double_buffer_single(const struct native *native, unsigned n);
void double_buffer_single_over(struct native *native, unsigned n);
/* The chip converts from now on; own: it has shown that itself. Before converted_ns is set anew. */
void double_buffer_converts(const struct native *native, struct device *device, bool own,
                            int64_t now);
/* Will the conversion under way serve this request, though it began before? */
bool double_buffer_serves(const struct native *native, const struct job *job, int64_t now);
/* Those whose result cannot be read early any more wait for the next. Before a step. */
void double_buffer_expire(struct native *native, int64_t now);
/* Can the result of this request be read while its chip converts anew? */
bool double_buffer_may_wait(const struct job *job);
/*
 * The chip of this request of a thermometer converts anew, and still holds the result that the
 * request waits for.
 */
bool double_buffer_holds(const struct job *job, int64_t now);
/* Are results to be read early? Searches wait for the time behind that. */
bool double_buffer_hurries(const struct native *native, int64_t now);
/*
 * Audits, and questions for the supply if nothing else is to be done (idle). True: did a
 * transaction.
 */
bool double_buffer_step(struct native *native, int64_t now, bool idle);

#endif
