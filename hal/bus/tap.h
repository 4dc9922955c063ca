/* SPDX-License-Identifier: MIT */
/*
 * What a host may put between a bus and its wire (bus_env.tap): it sees what is asked and answered
 * there, to record it, or answers in place of the wire (hal/trace). All of it runs on the bus's
 * thread. None of it is called where there is no tap.
 */
#pragma once

#include "hal/bus/bus.h"

struct link;
struct i2c_adapter;

struct tap {
	/* The adapter that a DS2482 is reached by in place of this one; NULL: that one is. */
	struct i2c_adapter *(*adapter)(struct tap *tap, const struct bus_env *env,
	                               struct i2c_adapter *adapter);
	/* The link that is used in place of channel n's; it may be that one. NULL: that one is. */
	struct link *(*link)(struct tap *tap, unsigned n, struct link *link);
	/* A descriptor in place of a connection, or an error. NULL: the connection is made. */
	int (*connect)(struct tap *tap);
	/* Of a connection: what went out. */
	void (*sent)(struct tap *tap, const struct bus_env *env, const uint8_t *bytes, size_t n);
	/* ... and what came in; 0: the peer has closed it. */
	void (*received)(struct tap *tap, const struct bus_env *env, const uint8_t *bytes,
	                 size_t n);
	/* Called by the host, when it has the answer. */
	void (*answered)(struct tap *tap, const struct bus_env *env, const struct bus_req *req,
	                 const struct bus_answer *answer);
};
