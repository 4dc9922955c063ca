/* SPDX-License-Identifier: MIT */
/* One master as a link. */
#ifndef HAL_NETLINK_LINK_H
#define HAL_NETLINK_LINK_H

#include "hal/wire/link.h"

extern const struct link_ops w1_netlink_link_ops;

#endif
