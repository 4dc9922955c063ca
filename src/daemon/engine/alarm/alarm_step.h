/* SPDX-License-Identifier: MIT */
/* The steps of a visit, as rows: what a state asks of the bus, and what the answer means. */
#pragma once

#include "src/daemon/engine/state.h"

/* An answer to the machine, of the item that it visits. */
struct alarm_answer {
	struct alarm_machine *m;
	struct lane *lane;
	struct alarm_item *item;
	const struct slot *slot;
	const struct bus_answer *answer;
};

struct alarm_step {
	enum alarm_state asks, waits;
	enum bus_op op;
	const char *under;      /* stands before the path */
	size_t property, value; /* as of alarm_string(); value 0: "0" is written */
	enum alarm_deed deed;
	uint8_t unarmed; /* enum ows_unarmed: what is shown while it fails; 0: nothing */
	/* Applies the answer to item, table and journal. Returns the facts; 0: stay. */
	uint32_t (*take)(const struct alarm_answer *a);
};

/* The step that asks or waits in the state, NULL: none. */
const struct alarm_step *alarm_step(enum alarm_state state);
/*
 * The item of the device, this one or another with the same strings, for which the step was done in
 * this cycle; NULL: none.
 */
const struct alarm_item *alarm_done(const struct alarm_machine *m, const struct alarm_item *item,
                                    const struct alarm_step *step);
/* Is the flag that was read set? 1, 0, or the negative errno of the answer. */
int alarm_flag(const struct alarm_answer *a);
/* Keep the latch that was read for the item of the answer; 0 or a negative errno. */
int alarm_keep_latch(const struct alarm_answer *a);
/* The item has the latch that was read: the alarm is raised, or over. Returns the facts. */
uint32_t alarm_show_latch(struct lane *lane, struct alarm_item *item);
/* The next item of the device with a latch that was not read in this cycle; NULL: none. */
struct alarm_item *alarm_to_collect(const struct alarm_machine *m, const struct alarm_item *item);
/* The next output below the device that gets its InitValue, a row of the table, -1: none. */
int64_t alarm_next_init(struct engine *e, struct alarm_machine *m);

/* True: the slot has what the present state asks; false: it asks nothing now. */
bool alarm_ask(struct alarm_machine *m, const struct lane *lane, struct slot *slot);
