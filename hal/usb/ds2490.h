/* SPDX-License-Identifier: MIT */
/* The DS2490 of an adapter, as a link. */
#pragma once

#include "hal/usb/port.h"
#include "hal/wire/adapter.h"

struct ds2490 {
	struct adapter adapter;
	struct usb_port *port; /* while the adapter is open */
	bool tells;            /* it has said of a reset that all is well */
};

void ds2490_init(struct ds2490 *chip, const struct link_master_ops *ops, const struct bus_env *env);
/* The port was opened: 0, or an error. */
int ds2490_begin(struct ds2490 *chip);
/* End a strong pull-up that may be on. 0, or an error. */
int ds2490_end_strong(struct ds2490 *chip);

/* A packet of the interrupt endpoint (data sheet, tables 16 and 17). */
struct ds2490_state {
	uint8_t speed, pull_up; /* the wire's speed; how long a strong pull-up lasts */
	uint8_t flags;
	uint8_t commands, out, in; /* bytes that wait: of commands, for the wire, and from it */
	uint8_t results;           /* of the commands since the last packet, or-ed */
	bool told;                 /* there was a result */
};
enum { PULLED_UP = 0x01, HALTED = 0x10, IDLE = 0x20, OVERRUN = 0x80 }; /* flags */
enum { NOBODY = 0x01, SHORT = 0x02 };                                  /* results */

/* 0, or -EIO: it is too short. */
int ds2490_parse(const uint8_t *bytes, int n, struct ds2490_state *state);
