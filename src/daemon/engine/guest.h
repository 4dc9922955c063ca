/* SPDX-License-Identifier: MIT */
/*
 * Guests: requests that do not come from the table but from clients of the served owserver
 * protocol. They go out behind alarms, outputs and inputs, a bounded number at a time for each
 * lane, and are never starved by them.
 */
#pragma once

#include "hal/bus/bus.h"

/*
 * Any lane: the lane that serves the device of the path, or each in turn if the table has no such
 * device.
 */
#define GUEST_ANY_LANE (-1)

/*
 * A request of a guest. The engine has it from take() until answered(), and where that says lent,
 * until released(); the guest does not touch it or what it points to meanwhile.
 */
struct engine_guest {
	uint8_t op; /* enum bus_op */
	bool fresh;
	int lane; /* or GUEST_ANY_LANE */
	/* Of the image that numbers the lanes as lane does; when it is answered, as served does. */
	uint32_t generation;
	const char *path;
	uint8_t *data; /* as in struct bus_req */
	uint32_t len, offset;
	uint16_t parts; /* so many times the time, on a bus that takes several requests; 0: once */
	const uint8_t *tokens; /* as in struct bus_req; NULL: the guest is no server */
	uint32_t token_count;
	/* As bus_req.unwanted: the guest may set it, atomically, until it has the request again. */
	uint32_t unwanted;

	struct bus_answer answer; /* its id says nothing */
	unsigned served;          /* index of the lane that answered */
	bool lent;                /* given up, the bus still has path and data */

	/* the engine's */
	struct engine_guest *next;
	int64_t until_ns;
	unsigned at;
	int32_t best_err; /* of the lanes asked so far */
};

/* The engine's way to its guests. The functions never block; they are called on its thread. */
struct engine_guests {
	struct engine_guest *(*take)(void *ctx); /* NULL: none waits */
	void (*answered)(void *ctx, struct engine_guest *guest);
	void (*released)(void *ctx, struct engine_guest *guest);
	void *ctx;
	const uint8_t *token; /* of this server, BUS_TOKEN bytes: goes with the table's requests */
};
