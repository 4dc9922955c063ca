/* SPDX-License-Identifier: MIT */
/* GPIO lines beside the chips: the supply of the wire, and the SLPZ pins. */
#pragma once

#include <stddef.h>

struct ds2482_master;
struct link_master;

/*
 * Switch the supply on and wake the chips, as far as there are lines for it. Errors as
 * gpio_output_take().
 */
int ds2482_power_on(struct ds2482_master *master, char *why, size_t why_size);
/* Let the chips sleep; the supply stays on. */
void ds2482_rest(struct ds2482_master *master);
void ds2482_power_release(struct ds2482_master *master);
/* Switch the supply off and on, then set up all chips. -EOPNOTSUPP: no line for it. */
int ds2482_power_cycle(struct ds2482_master *master);

/* The slots of link_master_ops but create. */
int ds2482_option(struct link_master *master, const char *key, const char *text, char *why,
                  size_t why_size);
