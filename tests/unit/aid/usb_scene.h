/* SPDX-License-Identifier: MIT */
/* Sets up the driver of the DS9490R over simulated ones, on a virtual clock. */
#pragma once

#include "hal/sim/usb/ds2490.h"
#include "hal/usb/master.h"
#include "tests/unit/aid/host.h"

#define STICKS 3
struct usb_stick {
	struct usb_port port;
	struct usb_place place;
	struct sim_net net;
	struct sim_ds2490 chip;
	bool plugged, open;
	bool kernel; /* the kernel's driver has it */
	bool deaf;   /* a reset by its hub does not help */
	bool mute;   /* the results of its commands are lost */
	int refuses; /* what opening it returns; 0: it opens */
	unsigned opens, resets;
};

struct usb_scene {
	struct host host;
	struct usb_stick stick[STICKS];
	unsigned sticks;
	uint64_t transfers; /* of any kind */
	uint64_t fail_at;   /* this transfer fails; 0: none */
	int fail;
	bool pulls; /* ... and stick 0 is pulled at it */
	struct link_master *master;
	struct link *wire;
	char why[300];
};
extern struct usb_scene sticks;
extern const struct usb_system sticks_system;

void sticks_begin(void);
void sticks_end(void);
/* One more adapter, with the wire of a scenario, plugged into port 1-N. */
struct usb_stick *stick_add(const char *scenario);
/* Out, and into a port, where it has another device file. */
void stick_pull(struct usb_stick *stick);
void stick_plug(struct usb_stick *stick, const char *port);
void stick_event(struct usb_stick *stick, const char *text);
/* A master for the target usb:WHERE; opened: 0 and sticks.wire, or an error and sticks.why. */
void sticks_make(const char *where);
int sticks_try(void);
/* The first adapter with the wire of a scenario, and its master, open. */
void sticks_start(const char *scenario);
/* The same as a native bus, which is up. */
struct bus *sticks_bus(const char *scenario);
/* Read the scratchpad of a thermometer by its name: in one part. 0 or the link's error. */
int sticks_scratchpad(const char *name, uint8_t scratchpad[9]);
/* It is whole, and of 21.5 degrees. */
void sticks_check(const char *name);
