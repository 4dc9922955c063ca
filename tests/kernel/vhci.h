/* SPDX-License-Identifier: MIT */
/*
 * A simulated USB device plugged into the kernel by vhci_hcd: we hold one end of a socket pair, the
 * kernel the other. Closing our end, or dying, unplugs the device.
 */
#pragma once

#include "tests/kernel/usbip.h"

#define VHCI_WAITING 8

struct vhci {
	int fd; /* -1: unplugged */
	/*
	 * One transfer: the bytes moved, or negative errno of it. -EAGAIN is a NAK: it is asked
	 * for again. moved: so many bytes of a transfer out have been taken, and fewer than the
	 * rest may be taken now.
	 */
	int (*transfer)(void *ctx, const struct usbip_request *request, uint8_t *data,
	                uint32_t moved);
	void *ctx;
	/* That the device has not answered, in their order. */
	struct vhci_transfer {
		struct usbip_request request;
		uint32_t moved;
		uint8_t answer[USBIP_HEADER + USBIP_MAX_DATA]; /* the header, and the data */
	} waiting[VHCI_WAITING];
	unsigned count;
};

/* Plug into port (0..7) of the first virtual controller. 0 or negative errno. */
int vhci_plug(struct vhci *vhci, unsigned port);
void vhci_unplug(struct vhci *vhci);
/*
 * Read one request (blocking), and answer it or let it wait. 0, or negative errno: -ECONNRESET the
 * kernel let go, -EPROTO it sent what no kernel sends.
 */
int vhci_serve(struct vhci *vhci);
/* Ask the device again for what waits. 0 or negative errno. */
int vhci_again(struct vhci *vhci);
/* Does a transfer of this endpoint wait? */
bool vhci_waits(const struct vhci *vhci, unsigned endpoint);
