/* SPDX-License-Identifier: MIT */
/*
 * The native bus: the OWFS namespace over the links of one master. The parts, from the top down:
 *
 *   native.c   the bus contract: create, submit, step, suspend
 *   job.c      one request on its way: what it waits for, its next step
 *   resolve.c  what a path means
 *   hunt.c     searches: background, directories, alarms
 *   locate.c   devices that requests name and no search has found
 *   first.c    first values, before the first search has ended
 *   first_asked.c  ... for which requests, and of devices that are found meanwhile
 *   guess.c    ... on which of several wires
 *   touch.c    keys that touch a wire
 *   exchange.c properties read and written
 *   convert/   when thermometers convert, and what a result is worth
 *     convert.c    one Convert T for all thermometers due on a channel, or each in turn
 *     broadcast.c  Convert T for all of a channel; writes to /simultaneous
 *     schedule.c   which of these is faster
 *     together.c   thermometers on several chips of the master at the same time
 *     ending.c     when a conversion ends
 *     supply.c     which thermometers are fed by the wire
 *   outcome.c  what follows from how a transaction ended
 *   master.c   open, lost, opened again; the recovery ladder
 *   answer.c   answers, and what the cache keeps of them
 *   job_txn.c  the transactions of a request
 *   listing.c  directories
 *   tables.c   the directories that belong to no device: settings, statistics, /structure and so on
 *   branches.c the branches of couplers as channels
 *   presence.c devices found, lost, restarted
 *   sensors.c  the file that names the sensors behind bridges
 *   cache.c    what was read lately
 *   state.c    the state on which all work, and what the work has cost
 *
 * All of it runs on the bus's thread; but the counters, which any thread may read.
 *
 * Room hal/native: the native bus: requests, conversions, searches, listings.
 */
#pragma once

#include "hal/bus/bus.h"
#include "hal/native/limits.h"
#include "hal/wire/link.h"

/*
 * For a scheme's bus_ops.create: a native bus over this kind of master. All errors as
 * bus_ops.create. The other slots are NATIVE_BUS_SLOTS.
 */
int native_create(const struct bus_ops *ops, const struct link_master_ops *master,
                  const char *where, const struct bus_env *env, struct bus **bus, char *why,
                  size_t why_size);
void native_destroy(struct bus *bus);
/* bus_ops.option: Sensors, and what the link master has. */
int native_option(struct bus *bus, const char *key, const char *text, char *why, size_t why_size);
int native_submit(struct bus *bus, struct bus_req *req);
int64_t native_step(struct bus *bus, int64_t now);
void native_suspend(struct bus *bus, bool yes);
int native_visible(struct bus *bus);
const struct bus_counter *native_counters(struct bus *bus, size_t *n);
/* Of a scheme with a step of its own, which calls native_step(). */
#define NATIVE_BUS_SLOTS_BUT_STEP \
	.depth = NATIVE_DEPTH, .searches = true, .destroy = native_destroy, \
	.option = native_option, .submit = native_submit, .suspend = native_suspend, \
	.visible = native_visible, .counters = native_counters
#define NATIVE_BUS_SLOTS NATIVE_BUS_SLOTS_BUT_STEP, .step = native_step, .brief = true
/* For such a step. The master while the bus is up, else NULL. */
struct link_master *native_master(struct bus *bus);
/* Of a bus that is up: search all channels now, and let the master grow. */
void native_look(struct bus *bus, int64_t now);
