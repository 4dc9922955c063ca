/* SPDX-License-Identifier: MIT */
/* One master as a link. */
#pragma once

#include "hal/wire/link.h"

extern const struct link_ops w1_netlink_link_ops;
