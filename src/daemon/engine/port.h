/* SPDX-License-Identifier: MIT */
/* A port: one target, as the engine reaches it. The host fills it in. */
#pragma once

#include <stdbool.h>

struct bus_req;

struct engine_port {
	const char *target; /* for the log; lives as long as the engine */
	unsigned depth;     /* requests it takes before an answer */
	bool searches;      /* its list of /alarm can be kept to families: "/alarm/29,12" */
	bool brief;         /* bus_ops.brief: what fails can be asked again soon */
	/* 0 or -EAGAIN; never blocks. The request is lent until its answer. */
	int (*submit)(void *ctx, struct bus_req *req);
	void *ctx;
	/*
	 * Ways to one wire (a bar) have the same number; groups are numbered in the order in which
	 * they are written, and so are the ways of a group. Every way but the first starts
	 * suspended.
	 */
	unsigned group;
	/* bus_ops.suspend; never blocks. NULL: nothing to let go of. */
	void (*suspend)(void *ctx, bool yes);
};
