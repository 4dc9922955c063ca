/* SPDX-License-Identifier: MIT */
/*
 * A DS9490R as a master with one link: found, taken from the kernel's driver, and found again.
 *
 * Room hal/usb: the USB adapter DS9490R, a DS2490, as a link.
 */
#pragma once

#include "hal/usb/port.h"
#include "hal/wire/link.h"

extern const struct link_master_ops usb_master_ops;
/* A master at these adapters. where: as after "usb:". As link_master_ops.create. */
int usb_create(const struct usb_system *system, const char *where, const struct bus_env *env,
               struct link_master **out, char *why, size_t size);
