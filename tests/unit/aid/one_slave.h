/* SPDX-License-Identifier: MIT */
/* One slave on a wire of the native bus (one_bus.h, virtual clock), and requests to it. */
#pragma once

#include "tests/unit/aid/one_bus.h"
#include "tests/unit/aid/wire_link.h"

/* The test sets it, and opens the bus. */
extern struct sim_slave *slave;
/* The bytes of the last read. */
extern uint8_t slave_data[4096];

/* setUp() and tearDown() */
void one_slave_begin(void);
void one_slave_end(void);

/* Do a request, and wait for its one answer. text: what a write writes. */
const struct bus_answer *exchange(enum bus_op op, enum bus_prio prio, const char *path,
                                  const char *text);
/* Do a request to a property of the slave, with the priority of an output. */
const struct bus_answer *go(enum bus_op op, const char *property, const char *text);
/* Write a text at an offset. */
const struct bus_answer *put_at(uint32_t at, const char *property, const char *text);
/* Check that a property is read as text, is written, or gives this error. */
void reads(const char *property, const char *text);
void writes(const char *property, const char *text);
void refuses(int err, enum bus_op op, const char *property, const char *text);
/* "/29.01005DDF0300/PIO.0"; valid until the next call. */
const char *slave_path(const char *property);
