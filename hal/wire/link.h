/* SPDX-License-Identifier: MIT */
/*
 * The link contract: a link makes transactions on one 1-Wire wire. A master owns its links, 1 to 8
 * of each chip. What the kernel's drivers do in place of a wire is a contract of its own: driver.h.
 *
 * Blocking: each call is at most one bus operation, or several at the same time, and bounded; all
 * waits go through the environment the master was created with. One thread: the native bus calls
 * it. Errors travel in the return value, never in the data:
 *   -ECOMM      the wire is short
 *   -ETIMEDOUT  the master chip is stuck (busy for longer than any operation takes)
 *   -EIO        the way to the chip failed once (refused byte, refused address)
 *   -ENXIO      the chip was reset or changed under us: recover(LINK_CHIP_RESET)
 *   -ENODEV     the adapter is gone: close the master
 *   -EHOSTDOWN  no chip answered the reset
 *   -EOPNOTSUPP this link has no strong pull-up, no single slots, or no such part
 *   -ECANCELED  the host shuts down
 *
 * Room hal/wire: links, transactions, searches, devices.
 */
#pragma once

#include <errno.h>

#include "hal/bus/bus.h"

enum link_after {
	LINK_IDLE,
	LINK_STRONG, /* strong pull-up from the last bit on, until the next call on this link */
};

/*
 * What a link can do for a wire that fails. The native bus makes the transaction again first, then
 * climbs these rungs, and closes and opens the master last (hal/native/master.c).
 */
enum link_rung {
	LINK_BUS_RESET,
	LINK_CHIP_RESET,  /* device reset and configuration of the master chip */
	LINK_POWER_CYCLE, /* the supply of the wire off and on, for some hundred ms */
	LINK_RUNGS,
};

/* Running totals of one link; the statistics read them. */
struct link_cost {
	uint64_t wire_ns; /* time the 1-Wire slots took by the data sheet */
	uint64_t resets;  /* 1-Wire resets */
};
/* Running totals of what the links of a master share. */
struct link_master_cost {
	uint64_t transfers; /* I2C transactions, START to STOP */
	uint64_t bytes;     /* on the I2C bus, addresses included */
	uint64_t syscalls;
};

struct link;
struct driver_ops;
/* One ROM id found by a search, family first. Return not 0 to end the search. */
typedef int link_found(void *ctx, const uint8_t rom[8]);

/*
 * What one call does on the wire, in this order: a reset, or the transaction before goes on; out_n
 * bytes written; in_n bytes read, each byte from its lowest bit on. Each may be left out. What
 * follows is LINK_IDLE where bytes are read.
 */
struct link_part {
	const uint8_t *out;
	uint8_t *in;
	size_t out_n, in_n;
	bool reset;
	enum link_after after;
};

#define LINK_MANY 8 /* transactions of one group (link_ops.run_many) */

/* A whole transaction: neither out_n nor in_n is 0. */
struct link_run {
	struct link *link;
	struct link_part part;
	int err;
	int64_t ended_ns; /* env time after the last byte */
};

/* What is always so of a link. */
struct link_facts {
	/*
	 * LINK_STRONG is not refused. Without it EEPROMs are written by the wire's resistor,
	 * thermometers fed by the wire do not convert.
	 */
	bool strong;
	/* A transaction may write after it has read: no other user of the wire comes between. */
	bool splits;
};

/*
 * A transaction is a part with a reset and the calls after it. After an error of one of them
 * nothing else is known of the wire: the next call begins with a reset or is recover(). The errors
 * stand above.
 */
struct link_ops {
	const char *name;
	/*
	 * Climb this rung: the wire fails. From LINK_CHIP_RESET on conversions that are under way
	 * on the master's links are void. What it returns, and what the caller does then:
	 *   0            makes the transaction again; if it fails again, the next rung is next
	 *   -ECOMM       the same: the rung is done, and the wire is short
	 *   -EOPNOTSUPP  goes on with the next rung: this link has no such one
	 *   -EBUSY       leaves out the rungs between, closes and opens the master: a driver or
	 *                another process has the chip, and open() says which
	 *   others       goes on with the next rung: it did not help
	 * A link whose master is closed returns -ENODEV. NULL: the link has no rungs.
	 */
	int (*recover)(struct link *link, enum link_rung rung);
	/*
	 * 0, or an error: then how many bytes were written is not known, and what was read means
	 * nothing. Only what a chip answers shows that it took what was written. Where no chip
	 * answers, ones are read, which is no error: the caller looks for a proof.
	 */
	int (*run)(struct link *link, const struct link_part *part);
	/*
	 * One slot: 0 or 1 as read back, or an error; writing 1 is reading. NULL: there are no
	 * single slots.
	 */
	int (*slot)(struct link *link, bool out, enum link_after after);
	/*
	 * Two read slots and one write slot: of the id's bit, its complement, and the direction,
	 * which is the bit where the two differ. Returns bit 0: the id bit read, bit 1: its
	 * complement, bit 2: the direction taken; or an error. NULL: made of slot().
	 */
	int (*triplet)(struct link *link, bool direction);
	/*
	 * A reset, unless the wire had it, the command of a search, and all 64 triplets: the
	 * directions, a bit each, become the id that was taken; conflict has the bits where devices
	 * differ. 0; -EHOSTDOWN: nobody is in this search; -EBADMSG: devices left in the middle; or
	 * an error. NULL: made of run() and triplet().
	 */
	int (*path)(struct link *link, bool reset, uint8_t command, uint8_t rom[8],
	            uint8_t conflict[8]);
	/*
	 * n transactions at the same time, LINK_MANY at most, on links with this function, each of
	 * another chip. None waits for another beyond what it takes of the way to the chips. An
	 * error of one is not judged: the transaction is made again by run(). NULL, together with
	 * many: there is no such thing.
	 */
	void (*run_many)(struct link_run *runs, unsigned n);
	/* How many of them at most do not take much longer than one does; 1: run() is as quick. */
	unsigned (*many)(const struct link *link);
	/*
	 * A whole search, of one family or (0) of all: 0, what found returned, or an error. NULL:
	 * made of run and triplet (hal/wire/search.h).
	 */
	int (*search)(struct link *link, bool alarm, uint8_t family, link_found *found, void *ctx);
	/*
	 * Is rom there (alarm: and in alarm)? 1, 0 or an error, -EBADMSG: the search was disturbed.
	 * Leaves it selected: the next slot() is its next one. NULL: made as search.
	 */
	int (*verify)(struct link *link, const uint8_t rom[8], bool alarm);
	/* Optional; also while the master is closed. Touches nothing. */
	void (*cost)(const struct link *link, struct link_cost *cost);
};

/* First member of a backend's own struct; the master fills it, with the rest zero. */
struct link {
	const struct link_ops *ops;
	const struct link_facts *facts;
	const struct bus_env *env;
	/* Links with one number share a chip: a call on one ends the strong pull-up of another. */
	unsigned chip;
	const struct driver_ops *driver; /* of the kernel's drivers (driver.h); NULL: a wire */
	bool whole; /* of the next search() of alarms, set by its caller: as bus_req.whole */
	/*
	 * Of a link that stands in front of another (coupler.h), which does all but run(): its
	 * ops are those of that one. NULL: there is none.
	 */
	struct link *wire;
};

/* What the functions of ops get, but for run(). */
static inline struct link *link_wire(struct link *link)
{
	return link->wire ? link->wire : link;
}

static inline int link_slot(struct link *link, bool out, enum link_after after)
{
	return link->ops->slot ? link->ops->slot(link_wire(link), out, after) : -EOPNOTSUPP;
}

/* Zero where the link does not count. */
static inline struct link_cost link_cost_of(struct link *link)
{
	struct link_cost cost = {0};

	if (link->ops->cost)
		link->ops->cost(link_wire(link), &cost);
	return cost;
}

struct link_master;
struct link_master_ops {
	/*
	 * where: the target without its scheme. Allocates all, fills ops and env, touches nothing.
	 * As bus_ops.create.
	 */
	int (*create)(const char *where, const struct bus_env *env, struct link_master **master,
	              char *why, size_t why_size);
	/* Optional, as bus_ops.option. */
	int (*option)(struct link_master *master, const char *key, const char *text, char *why,
	              size_t why_size);
	/*
	 * Take the hardware. -EBUSY a kernel driver owns the chip, -EACCES, -ENODEV, -ENXIO no chip
	 * answers; why gets what to do about it. May be called again after close().
	 */
	int (*open)(struct link_master *master, char *why, size_t why_size);
	/* At the first lasting error, or the kernel cannot finish an unplugging. */
	void (*close)(struct link_master *master);
	/*
	 * Closed: does it look as if open() could work? 1 or 0, never touching the hardware. *mark
	 * differs where something else is seen than before (a device file made anew, a driver bound
	 * or unbound). NULL: that cannot be seen.
	 */
	int (*visible)(struct link_master *master, uint64_t *mark);
	/*
	 * Optional. Take what belongs here and could not be taken at open(), or came later: its
	 * channels come behind those that are there, each when it is whole. 1: some are still
	 * missing, or may yet come, and why names one that is; 0: none is. -ENODEV, -ECANCELED.
	 */
	int (*grow)(struct link_master *master, char *why, size_t why_size);
	/*
	 * Optional. Open: what disturbs the use of the hardware now, as another program; "":
	 * nothing. failed: a link had an error since the last call. May take some ms.
	 */
	void (*trouble)(struct link_master *master, bool failed, char *text, size_t size);
	unsigned (*channels)(struct link_master *master); /* known after open() and grow() */
	struct link *(*channel)(struct link_master *master, unsigned n);
	/* Optional; also while closed. */
	void (*cost)(const struct link_master *master, struct link_master_cost *cost);
	/*
	 * Optional. The answer to a request for what the master has beside its wires: err, len,
	 * kind and number; the rest of *answer is filled. False: the master has no such path. Uses
	 * no wire, never blocks.
	 */
	bool (*own)(struct link_master *master, struct bus_req *req, struct bus_answer *answer);
	void (*destroy)(struct link_master *master);
	bool simulated; /* its devices are not real: answers say BUS_DETAIL_SIMULATED */
	bool slow;      /* searches and converts too slowly to look for buttons (Touch) */
};
struct link_master {
	const struct link_master_ops *ops;
	const struct bus_env *env;
	bool one_supply; /* the power cycle of one link is one of all */
};
