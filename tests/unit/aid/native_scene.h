/* SPDX-License-Identifier: MIT */
/*
 * The native bus over a net of simulated slaves (wire_link.h) on a virtual clock: the common set-up
 * of its tests. They call wire_init() and wire_add() first, then start().
 */
#pragma once

#include "tests/unit/aid/one_bus.h"
#include "tests/unit/aid/wire_link.h"

#define NATIVE_REQUESTS 256

/* The request of an id, as ask() returns it. */
extern struct bus_req req[NATIVE_REQUESTS];
extern uint8_t data[NATIVE_REQUESTS][4096];

/* The offset of writes in their value. */
extern uint32_t write_offset;
/* So many NULs stand behind the text of a write. */
extern uint32_t write_nuls;
/* Each id of a list is read whole. */
extern bool list_whole;

/* setUp() and tearDown() */
void native_begin(void);
void native_end(void);

/* Open the bus, and wait until it is up. */
void start(void);
/* Submit a request and return its id at once. text: what a write writes. */
uint32_t ask(enum bus_op op, enum bus_prio prio, bool fresh, const char *what, const char *text);
/* Run until the request has its one answer. */
const struct bus_answer *answer_to(uint32_t id);
/* Read, and compare the text. */
void expect(bool fresh, const char *what, const char *text);
/* Forget the answers so far: there is room for as many requests again. */
void forget(void);
/* Do a fresh request. Returns its error. */
int result(enum bus_op op, const char *what, const char *text);
/* "/28.01005DDF0300", and the path of a property of the device; valid for three more calls. */
const char *name_of(const struct sim_slave *slave);
const char *of(const struct sim_slave *slave, const char *property);
