/* SPDX-License-Identifier: MIT */
/*
 * USB as the driver of the DS2490 uses it: the adapters that are plugged in, and the transfers to
 * one of them. Each call blocks for USB_TIMEOUT_MS at most. Errors are returned: -ENODEV the
 * adapter is gone, -ETIMEDOUT, -EIO.
 */
#pragma once

#include "hal/bus/bus.h"

#define USB_TIMEOUT_MS 200

/* Of a DS2490: its state, by interrupts; and bytes, by bulk transfers. */
enum { USB_STATE = 0x81, USB_OUT = 0x02, USB_IN = 0x83 };

struct usb_port;
struct usb_port_ops {
	/* A vendor's request without data. */
	int (*control)(struct usb_port *port, uint8_t request, uint16_t value, uint16_t index);
	/* Up to n bytes to or from an endpoint: how many. */
	int (*transfer)(struct usb_port *port, uint8_t endpoint, uint8_t *bytes, size_t n);
	/* The endpoints, after a transfer that failed. */
	int (*clear)(struct usb_port *port);
	/* The hub resets the adapter. */
	int (*reset)(struct usb_port *port);
	void (*close)(struct usb_port *port);
};

struct usb_port {
	const struct usb_port_ops *ops;
};

#define USB_NAME 32
#define USB_CALLED "the adapter at USB %s"
/* An adapter that is plugged in. */
struct usb_place {
	char name[USB_NAME];   /* its bus and ports, as the kernel writes them: "1-1.4" */
	char device[48];       /* its device file, another one after each plugging */
	char driver[USB_NAME]; /* what has its interface; "": nothing */
};

#define USB_PLACES 16
struct usb_system {
	/* Those that are plugged in, in the order of their names: how many. */
	unsigned (*list)(struct usb_place places[USB_PLACES]);
	/* 0 and the port, or an error, and what to do about it. */
	int (*open)(const struct usb_place *place, struct usb_port **port, char *why, size_t size);
	/* The kernel's driver gets back what was opened. */
	void (*give_back)(const struct usb_place *place);
	const char *proc; /* RIVALS_PROC: look who else has it open; NULL: nobody can */
};
