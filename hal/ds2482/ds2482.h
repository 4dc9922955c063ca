/* SPDX-License-Identifier: MIT */
/*
 * The DS2482 driver: link masters over struct i2c_adapter. One master has all chips of an adapter
 * that the target names, one link for each channel of each.
 *
 * Room hal/ds2482: DS2482 and its kin as links.
 */
#pragma once

#include "hal/base/rivals.h"
#include "hal/base/time.h"
#include "hal/ds2482/codes.h"
#include "hal/ds2482/ends.h"
#include "hal/ds2482/i2c.h"
#include "hal/gpio/line.h"
#include "hal/wire/link.h"

#define DS2482_FIRST_ADDRESS 0x18
#define DS2482_ADDRESSES 8

#define DS2482_NO_PARAMETER (-1)

/* How long a wire is without supply, so that all slaves forget their state. */
#define DS2482_POWER_OFF_NS (500 * NS_PER_MS)
#define DS2482_POWER_ON_NS (10 * NS_PER_MS)

/* A chip that is busy for so much longer than it may be stays so; and how often to look. */
#define DS2482_STUCK_NS (10 * NS_PER_MS)
#define DS2482_POLL_NS INT64_C(200000)

enum ds2482_part {
	DS2482_100, /* or a -101, which the bus cannot tell apart */
	DS2482_800,
	DS2482_ADJUSTABLE, /* DS2483, DS2484 */
};

struct ds2482_chip;
struct ds2482_link {
	struct link link; /* first */
	struct ds2482_chip *chip;
	uint8_t number;
	struct link_cost cost;
};

static inline struct ds2482_link *ds2482_link_of(struct link *link)
{
	return (struct ds2482_link *)link;
}

struct ds2482_master;
struct ds2482_chip {
	struct ds2482_master *master;
	uint8_t address;
	enum ds2482_part part;
	unsigned channels;
	bool answered;           /* when it was looked for last, as a DS2482 after a reset */
	bool lost;               /* reset or changed by another program: it needs a chip reset */
	uint8_t channel;         /* the selected channel */
	uint8_t config;          /* the configuration in the chip */
	int64_t claim_ns;        /* env time of the next look whether the chip is still ours */
	int64_t free_at;         /* env time by which the last operation has ended at the latest */
	struct ds2482_ends ends; /* when its operations really end */
	struct ds2482_link link[8];
};

/* Where a master's adapter comes from. */
struct ds2482_source {
	/* As link_master_ops.open. */
	int (*open)(void *ctx, const struct bus_env *env, struct i2c_adapter **adapter, char *why,
	            size_t why_size);
	/*
	 * As link_master_ops.visible, of the chips whose bits are set (bit 0: 0x18); 0: which ones
	 * are meant is not known. NULL: that cannot be seen.
	 */
	int (*visible)(void *ctx, const struct bus_env *env, uint8_t chips, uint64_t *mark);
	/*
	 * Write into why what to do about a chip that a kernel driver has. NULL: there are no such
	 * drivers.
	 */
	void (*explain)(void *ctx, uint8_t address, char *why, size_t why_size);
	void (*destroy)(void *ctx);
	const char *name; /* "/dev/i2c-1", for messages */
	/* RIVALS_PROC, and name is a device file: see rivals.h. NULL: nobody else can have it. */
	const char *proc;
	void *ctx;
};

struct ds2482_master {
	struct link_master master; /* first */
	struct ds2482_source source;
	struct i2c_adapter *adapter; /* NULL while closed */
	int address, channel;        /* only this one; -1: all */
	bool active_pullup;
	int64_t byte_ns; /* shortest time of one I2C byte, measured; 0: bytes tell no time */
	/*
	 * Shortest time of one more message of two bytes in a transfer, measured; 0: not known. It
	 * is longer than its bytes where the adapter takes time for each message, as over USB.
	 */
	int64_t message_ns;
	int64_t measured_ns;     /* env time of the measurement */
	unsigned measured_again; /* since the adapter was opened */
	/*
	 * What a transaction takes of the I2C bus when others have theirs meanwhile, mean; 0: not
	 * known.
	 */
	int64_t visit_ns;
	unsigned count;
	struct ds2482_chip chip[DS2482_ADDRESSES];
	/*
	 * The addresses of all chips so far, in the order in which they were taken; and which are
	 * missing.
	 */
	unsigned known;
	uint8_t order[DS2482_ADDRESSES];
	bool missing[DS2482_ADDRESSES];
	/*
	 * The supply of the wire, and the SLPZ pins; their chip's name is "" where there is none.
	 */
	struct gpio_output power, sleep;
	int64_t power_off_ns;
	/*
	 * i2c_master.c; link.c says which chip had been reset or changed when it was set up again.
	 * 0: none. Errors since the last look. Env times of the next look, of the next after such a
	 * change. What disturbs, whether it names programs, and when its cause was seen last.
	 */
	uint8_t changed;
	unsigned failures;
	int64_t look_ns, changed_look_ns;
	char trouble[BUS_EVENT_TEXT];
	bool named;
	int64_t trouble_ns;
	/* The cost before the adapter was opened again. */
	struct link_master_cost cost;
};
