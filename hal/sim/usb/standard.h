/* SPDX-License-Identifier: MIT */
/* What every USB device answers alike (USB 1.1, chapter 9): its descriptors and its state. */
#pragma once

#include <stddef.h>
#include <stdint.h>

/* bmRequestType. */
enum { USB_IN = 0x80, USB_KIND = 0x60, USB_KIND_STANDARD = 0x00, USB_KIND_VENDOR = 0x40 };
enum usb_request {
	USB_GET_STATUS = 0,
	USB_CLEAR_FEATURE = 1,
	USB_SET_FEATURE = 3,
	USB_GET_DESCRIPTOR = 6,
	USB_GET_CONFIGURATION = 8,
	USB_SET_CONFIGURATION = 9,
	USB_GET_INTERFACE = 10,
	USB_SET_INTERFACE = 11,
};
enum { USB_DEVICE = 1, USB_CONFIGURATION = 2, USB_STRING = 3, USB_INTERFACE = 4, USB_ENDPOINT = 5 };

struct usb_identity {
	const uint8_t *device, *configuration; /* of one configuration, with all behind it */
	const char *const *strings;            /* from index 1 on; NULL ends them. NULL: none */
};

/* The bytes of an answer that a request has room for. */
int usb_give(uint8_t *data, size_t room, const void *answer, size_t len);
/*
 * Answer a standard request. data gets the answer, room is its size. Returns the bytes of the
 * answer, or -EPIPE for what the device does not know (a stall). The caller keeps interfaces and
 * halts.
 */
int usb_standard(const struct usb_identity *identity, const uint8_t setup[8], uint8_t *data,
                 size_t room);
