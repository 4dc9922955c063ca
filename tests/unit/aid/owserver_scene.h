/* SPDX-License-Identifier: MIT */
/*
 * The owserver bus (one_bus.h, on the real clock) against a peer on loopback: the common set-up of
 * its tests.
 */
#pragma once

#include "tests/unit/aid/one_bus.h"
#include "tests/unit/aid/peer.h"

#define TEMPERATURE "/28.67C6697351FF/temperature"
#define OUTPUT "/29.000029D60100/PIO.BYTE"
#define PATIENCE (60 * HOST_S)
/* The time within which the peer answers, on a busy machine too. */
#define ENOUGH HOST_S

extern struct peer peer;
/* A test sets it when it starts the peer by itself. */
extern bool is_peer_up;
/* The memory of a request's data. */
extern uint8_t room[70000];

/* setUp() and tearDown() */
void owserver_begin(void);
void owserver_end(void);

/* Start the peer with this plan (peer.h) and the bus on it, and wait until the bus is up. */
void serve(const char *plan);
void serve_as(int family, const char *plan);
void stop_peer(void);

/* Submit a request and wait for its one answer. text: what a write writes. */
const struct bus_answer *request(enum bus_op op, const char *path, const char *text, uint32_t len);
const struct bus_answer *request_within(enum bus_op op, const char *path, const char *text,
                                        uint32_t len, int64_t time_ns);
/* Read TEMPERATURE. Returns the error; 0: the value is the peer's. */
int read_temperature(void);

/* Expect as the next event that the target is down for that reason, or up. */
void goes_down_with(int err, const char *word);
void comes_up(void);

/* Wait until the peer counted n: its thread acts only when it has the processor. */
void until_peer_saw(const unsigned *count, unsigned n);

/* How many descriptors this process has open. */
unsigned descriptors(void);
