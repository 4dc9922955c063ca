/* SPDX-License-Identifier: MIT */
/*
 * Which target serves a device: pure functions over facts. A group is a wire; its ways (a bar) are
 * targets of which one is open. Groups are different wires (a comma), all of them open, and each
 * device is served by one. The rules stand in docs/semantics.md, "Several targets"; the tests are
 * laid beside them.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "hal/base/time.h"

#define ROUTE_HOLD_NS (10 * NS_PER_S)      /* from the evidence to the return */
#define ROUTE_HOLD_MAX_NS (640 * NS_PER_S) /* of a bar, after returns that failed */
#define ROUTE_DOUBT_NS (600 * NS_PER_S)    /* before a failing device that is claimed is believed */
#define ROUTE_STEADY_NS (60 * NS_PER_S)    /* a way up for so long did not fail on the return */
#define ROUTE_RELEASE_NS (5 * NS_PER_S)    /* for a way to let go of its hardware */
#define ROUTE_DWELL_NS NS_PER_S            /* on each way when all have failed; doubles */
#define ROUTE_DWELL_MAX_NS (30 * NS_PER_S)

/* --- A comma: which group serves a device ---------------------------------------------------- */

enum route_presence {
	ROUTE_UNKNOWN, /* counts as present until the first try */
	ROUTE_PRESENT,
	ROUTE_FAILING, /* a target lists it, and no reading of it was good */
	ROUTE_ABSENT,
};
struct known_presence { /* a device on a group */
	enum route_presence presence;
	int64_t since_ns; /* when it became so */
};

enum route_state {
	ROUTE_OPENING, /* neither up nor down yet: worth waiting for */
	ROUTE_UP,
	ROUTE_DOWN,
};
struct route_group {
	enum route_state state;
	int64_t since_ns;
};

struct route_choice {
	unsigned group;
	int64_t again_ns; /* time alone changes the choice then; INT64_MAX: it does not */
	const char *why;  /* if group is not the present one */
};

/* moved_ns: of the device's last move. */
struct route_choice route_device(const struct known_presence *known,
                                 const struct route_group *groups, unsigned count, unsigned current,
                                 int64_t moved_ns, int64_t now_ns);
/* A path without a device. */
struct route_choice route_path(const struct route_group *groups, unsigned count, unsigned current,
                               int64_t now_ns);
/* The group on which the device is to be looked for next after it was on `last`; -1: on none. */
int route_probe(const struct known_presence *known, const struct route_group *groups,
                unsigned count, unsigned current, unsigned last);

/* --- A bar: which way of a group is open ------------------------------------------------------ */

struct route_way {
	bool released; /* it has no hold of the hardware */
	bool up;       /* the last report since it was opened is BUS_UP */
	bool failed;   /* since it was opened it went down, or is stuck */
	bool back;     /* since it was asked to let go it saw its target */
	int64_t up_ns, failed_ns, back_ns;
};

struct route_bar {
	unsigned count;
	unsigned open; /* the one way that is open, or will be when `leaving` has let go */
	bool letting_go;
	unsigned leaving;
	int from;            /* `open` is a return; this way worked before it. -1: it is none */
	int64_t since_ns;    /* asked to let go, or opened */
	int64_t patience_ns; /* for a way that was opened to say something */
	int64_t hold_ns;     /* before the next return */
	unsigned failures;   /* ways that failed in a row */
};

enum route_act {
	ROUTE_STAY,
	ROUTE_LEAVE, /* ask `open` to let go, then open `way` */
	ROUTE_OPEN,  /* `way`: the other has let go, or its time is over */
};
struct route_step {
	enum route_act act;
	unsigned way;
	int64_t again_ns; /* as in route_choice */
	const char *why;
};

/* The first way is open from the start. */
void route_bar_init(struct route_bar *bar, unsigned count, int64_t patience_ns, int64_t now_ns);
struct route_step route_bar(const struct route_bar *bar, const struct route_way *ways,
                            int64_t now_ns);
/* What the step that was taken makes of the bar. */
void route_bar_took(struct route_bar *bar, const struct route_way *ways,
                    const struct route_step *step, int64_t now_ns);
/* The group as the comma sees it. */
enum route_state route_bar_state(const struct route_bar *bar, const struct route_way *ways,
                                 int64_t now_ns);
