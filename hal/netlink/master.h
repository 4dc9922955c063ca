/* SPDX-License-Identifier: MIT */
/*
 * The kernel's masters over netlink, as a link master.
 *
 * Room hal/netlink: the masters of the kernel, by netlink.
 */
#pragma once

#include "hal/netlink/run.h"

extern const struct link_master_ops w1_netlink_master;

/* Is it "netlink", "netlink/...", of which this bus is? */
bool w1_is_netlink(const char *where);
