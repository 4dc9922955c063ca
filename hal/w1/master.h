/* SPDX-License-Identifier: MIT */
/* The kernel's masters. */
#pragma once

#include "hal/wire/link.h"

extern const struct link_master_ops w1_master;

/* For hal/netlink. N of the w1_bus_masterN that the target names; 0: all. */
unsigned w1_master_only(const struct link_master *master);
/* Has the kernel w1_bus_masterN now? */
bool w1_master_has(const struct link_master *master, unsigned number);
/* Does not hear from the kernel of slaves and masters any more, until it is opened again. */
void w1_master_deafen(struct link_master *master);
