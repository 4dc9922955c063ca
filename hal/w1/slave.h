/* SPDX-License-Identifier: MIT */
/* The slaves that the kernel has: what is remembered of each, and its attributes (tree.h). */
#pragma once

#include "hal/w1/name.h"
#include "hal/w1/tree.h"
#include "hal/wire/device.h"

struct w1_slave {
	struct w1_tree *tree;
	uint8_t rom[8];
	char name[W1_NAME_MAX]; /* of its directory */
	uint8_t channel;
	bool told_driver;      /* the log says that no driver has it */
	bool due;              /* thermometer: told to convert, not read since */
	bool known;            /* scratchpad holds what was read last */
	uint8_t scratchpad[9]; /* thermometer */
	int64_t read_ns;       /* when that was; 0: not */
	uint8_t condition[3];  /* DS2408: mask, polarity and control as read last */
	int64_t condition_ns;  /* when mask and polarity were for an alarm; 0: not */
};

struct w1_slaves {
	struct w1_tree *tree;
	struct w1_slave slave[DEVICE_MAX];
	unsigned count;
};

/* Its place, a new one if need be. */
struct w1_slave *w1_slave_of(struct w1_slaves *slaves, const uint8_t rom[8]);

bool w1_slave_has(const struct w1_slave *slave, const char *name);
/* n bytes from byte `at` of the attribute on; 0 or an error: -EIO it has fewer. */
int w1_slave_read(struct w1_slave *slave, const char *name, unsigned at, void *data, size_t n);
int w1_slave_write(struct w1_slave *slave, const char *name, unsigned at, const void *data,
                   size_t n);
/* Text with NUL, in tree->text; -EIO when it is empty: so the kernel tells a failed reading. */
int w1_slave_text(struct w1_slave *slave, const char *name);
int w1_slave_number(struct w1_slave *slave, const char *name, long *number);
