/* SPDX-License-Identifier: MIT */
/*
 * Every DS2482 there is, as one master: `i2c:auto`. It has a master for each adapter; the links are
 * those of all of them, in the order of the adapters' numbers. Where one adapter is lost, all are
 * opened anew.
 */
#ifndef HAL_DS2482_EVERY_H
#define HAL_DS2482_EVERY_H

#include "hal/wire/link.h"

#define EVERY_ADAPTERS 32

/* Where the adapters come from. */
struct every_source {
	/* Their numbers, rising, and how many. */
	unsigned (*list)(void *ctx, unsigned *numbers, unsigned max);
	/* A master for one of them, as link_master_ops.create. */
	int (*make)(void *ctx, unsigned number, const struct bus_env *env,
	            struct link_master **master);
	void *ctx; /* lent */
};

/* 0 or -ENOMEM. */
int every_create(const struct bus_env *env, const struct every_source *source,
                 struct link_master **master);

#endif
