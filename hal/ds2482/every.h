/* SPDX-License-Identifier: MIT */
/*
 * Every DS2482 of the machine as one master: `i2c:auto`. It has a master for each adapter, and the
 * links of all of them in the order of the adapters' numbers. When one adapter is lost, all are
 * opened again.
 */
#pragma once

#include "hal/wire/link.h"

#define EVERY_ADAPTERS 32

/* Where the adapters come from. */
struct every_source {
	/* Write the adapters' numbers, rising; returns how many. */
	unsigned (*list)(void *ctx, unsigned *numbers, unsigned max);
	/* Make a master for one adapter, as link_master_ops.create. */
	int (*make)(void *ctx, unsigned number, const struct bus_env *env,
	            struct link_master **master);
	void *ctx; /* the caller owns it */
};

/* 0 or -ENOMEM. */
int every_create(const struct bus_env *env, const struct every_source *source,
                 struct link_master **master);
