/* SPDX-License-Identifier: MIT */
/* Searches over netlink, as the slots of link_ops. */
#pragma once

#include "hal/wire/link.h"

int w1_netlink_verify(struct link *link, const uint8_t rom[8], bool alarm);
int w1_netlink_search(struct link *link, bool alarm, uint8_t family, link_found *found, void *ctx);
