/* SPDX-License-Identifier: MIT */
/*
 * The USB/IP headers that vhci_hcd sends and expects on the socket it was attached to: 48 bytes,
 * big-endian (Documentation/usb/usbip_protocol.rst). Pure: no I/O, no allocation.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#define USBIP_HEADER 48
#define USBIP_MAX_DATA 4096 /* a longer transfer is refused */

enum usbip_command {
	USBIP_CMD_SUBMIT = 1,
	USBIP_CMD_UNLINK = 2,
	USBIP_RET_SUBMIT = 3,
	USBIP_RET_UNLINK = 4,
};

struct usbip_request {
	enum usbip_command command; /* USBIP_CMD_SUBMIT or USBIP_CMD_UNLINK */
	uint32_t seq;
	uint32_t unlinked; /* of USBIP_CMD_UNLINK: the request that is taken back */
	bool in;           /* data goes to the host */
	uint32_t endpoint;
	uint32_t length; /* room for data in, or bytes that follow the header for data out */
	uint8_t setup[8];
};

/* 0; -EPROTO another command, an endpoint above 15 or more than USBIP_MAX_DATA bytes. */
int usbip_decode(const uint8_t header[USBIP_HEADER], struct usbip_request *request);

/*
 * The header of the answer. status: 0 or negative errno; actual: bytes moved, and, for data in,
 * bytes that follow. Of an unlink status 0 says that it came too late, -ECONNRESET that it did not.
 */
void usbip_answer(uint8_t header[USBIP_HEADER], const struct usbip_request *request, int32_t status,
                  uint32_t actual);
