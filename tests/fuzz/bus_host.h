/* SPDX-License-Identifier: MIT */
/*
 * The host of a bus under fuzzing, on a virtual clock: it checks what hal/bus/bus.h promises. Each
 * request is answered once, by one of the errors that are listed there, within its room; a bus that
 * lost its target tells BUS_DOWN.
 */
#pragma once

#include "hal/bus/bus.h"
#include "tests/fuzz/fuzz.h"

#define BUS_HOST_MS INT64_C(1000000)
#define BUS_HOST_S INT64_C(1000000000)
#define BUS_HOST_REQS 8

struct bus_host {
	struct bus_env env;
	struct bus *bus;
	int64_t now;
	bool shutdown;
	/* When fd becomes ready; NULL: never. */
	int64_t (*ready)(void *ctx, int fd, short events);
	void *ctx;
	struct {
		bool lent;
		struct bus_req req;
		char path[300];
	} slot[BUS_HOST_REQS];
	unsigned lent, answered, good;
	uint32_t next_id;
	bool down_owed; /* an answer said that the target is lost */
	unsigned steps; /* that may still be done; none left: time stands still */
};

void bus_host_begin(struct bus_host *host);
/* The bus of target; NULL: there is none. */
struct bus *bus_host_open(struct bus_host *host, const char *target);
void bus_host_end(struct bus_host *host);
/* Lend a request whose data lie on the heap, exactly len bytes. Nothing if too many are lent. */
void bus_host_ask(struct bus_host *host, enum bus_op op, const char *path, bool fresh,
                  const void *data, uint32_t len, int64_t timeout_ns);
/* Let time pass; with until_answered only until nothing is lent. */
void bus_host_run(struct bus_host *host, int64_t ns, bool until_answered);
