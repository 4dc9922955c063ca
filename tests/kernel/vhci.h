/* SPDX-License-Identifier: MIT */
/*
 * A simulated USB device plugged into the kernel by vhci_hcd: we hold one end of a socket pair, the
 * kernel the other. Closing our end, or dying, unplugs the device.
 */
#pragma once

#include "tests/kernel/tiny_usb.h"

/* Plug into port (0..7) of the first virtual controller. A descriptor, or negative errno. */
int vhci_plug(unsigned port);

/*
 * Read one request from the descriptor (blocking) and answer it. 0, or negative errno: -ECONNRESET
 * the kernel let go, -EPROTO it sent what no kernel sends.
 */
int vhci_serve(int fd, struct tiny_usb *usb);
