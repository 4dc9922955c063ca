/* SPDX-License-Identifier: MIT */
/*
 * The native bus over a net of simulated slaves (wire_link.h) on a virtual clock: what the tests of
 * its parts set up alike. wire_init() and wire_add() first, then start().
 */
#ifndef TESTS_UNIT_AID_NATIVE_SCENE_H
#define TESTS_UNIT_AID_NATIVE_SCENE_H

#include "tests/unit/aid/one_bus.h"
#include "tests/unit/aid/wire_link.h"

#define NATIVE_REQUESTS 256

/* Of request id, as ask() returns it. */
extern struct bus_req req[NATIVE_REQUESTS];
extern uint8_t data[NATIVE_REQUESTS][4096];

/* Where writes begin in their value. */
extern uint32_t write_offset;

/* setUp() and tearDown() */
void native_begin(void);
void native_end(void);

/* Open the bus; it comes up. */
void start(void);
/* Submit a request and go on; returns its id. text: what a write writes. */
uint32_t ask(enum bus_op op, enum bus_prio prio, bool fresh, const char *what, const char *text);
/* Run until it is answered, exactly once. */
const struct bus_answer *answer_to(uint32_t id);
/* A read gives this text. */
void expect(bool fresh, const char *what, const char *text);
/* The answers so far are done with: there is room for as many requests again. */
void forget(void);
/* The error of a fresh request; 0: none. */
int result(enum bus_op op, const char *what, const char *text);
/* "/28.01005DDF0300", and the path of a property of it; good for three calls more. */
const char *name_of(const struct sim_slave *slave);
const char *of(const struct sim_slave *slave, const char *property);

#endif
