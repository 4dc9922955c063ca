/* SPDX-License-Identifier: MIT */
/* One slave on a wire of the native bus (one_bus.h, virtual clock), and what is asked of it. */
#ifndef TESTS_UNIT_AID_ONE_SLAVE_H
#define TESTS_UNIT_AID_ONE_SLAVE_H

#include "tests/unit/aid/one_bus.h"
#include "tests/unit/aid/wire_link.h"

/* Set by the test, which opens the bus as well. */
extern struct sim_slave *slave;
/* What was read. */
extern uint8_t slave_data[4096];

/* setUp() and tearDown() */
void one_slave_begin(void);
void one_slave_end(void);

/* A request and its one answer. text: what a write writes. */
const struct bus_answer *exchange(enum bus_op op, enum bus_prio prio, const char *path,
                                  const char *text);
/* The same of a property of the slave, as an output. */
const struct bus_answer *go(enum bus_op op, const char *property, const char *text);
/* A write of text at an offset. */
const struct bus_answer *put_at(uint32_t at, const char *property, const char *text);
/* A property is read as text, is written, gives this error. */
void reads(const char *property, const char *text);
void writes(const char *property, const char *text);
void refuses(int err, enum bus_op op, const char *property, const char *text);
/* "/29.01005DDF0300/PIO.0"; good until the next. */
const char *slave_path(const char *property);

#endif
