/* SPDX-License-Identifier: MIT */
/* Sets up a driver of a serial adapter over a simulated one, on a virtual clock. */
#pragma once

#include "hal/serial/master.h"
#include "hal/sim/serial/line.h"
#include "tests/unit/aid/host.h"

struct serial_scene {
	struct host host;
	struct sim_net net;
	struct sim_serial sim;
	struct serial_port port;
	uint32_t baud;    /* that the driver has set */
	uint64_t pull_at; /* the adapter is pulled after so many bytes; 0: never */
	bool pulled, deaf_to_break;
	bool babbles, full;            /* something comes all the time; nothing is taken */
	int64_t late_ns;               /* the machine is busy: each write begins so late */
	unsigned no_speed;             /* the port cannot have this one; 0: it can have all */
	int64_t written_ns, closed_ns; /* by the machine's clock */
	const char *proc;              /* where other programs are looked for: at /dev/null */
	unsigned opens, writes, reads, breaks; /* writes, reads: calls */
	struct link_master *master;
	struct link *wire;
	char why[256];
};
extern struct serial_scene serial;

void serial_begin(void);
void serial_end(void);
/* The adapter of a kind, on the wire of a scenario, and a driver of a kind at it. */
void serial_make(enum sim_serial_kind kind, const struct serial_kind *driver, const char *scenario);
/* The same as a native bus, which is up. */
struct bus *serial_bus_of(enum sim_serial_kind kind, const struct serial_kind *driver,
                          const char *scenario);
/* Open it: 0 and serial.wire, or an error and serial.why. */
int serial_try(void);
void serial_start(enum sim_serial_kind kind, const struct serial_kind *driver,
                  const char *scenario);
/* An event of a scenario, now. */
void serial_event(const char *text);
/* Read the scratchpad of a thermometer by its name: in one part. 0 or the link's error. */
int serial_scratchpad(const char *name, uint8_t scratchpad[9]);
/* It is whole, and of 21.5 degrees. */
void serial_check(const char *name);
