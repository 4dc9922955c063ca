/* SPDX-License-Identifier: MIT */
/*
 * The engine: owns the signal table, drives its lanes and publishes into the image. It does no I/O
 * and knows no clock: time is an argument, answers and events are brought to it, and requests leave
 * through the ports. One thread. So a day of its life is tested in milliseconds.
 */
#ifndef ENGINE_ENGINE_H
#define ENGINE_ENGINE_H

#include "../config/config.h"
#include "../log.h"
#include "../shm/commands.h"
#include "../shm/image.h"
#include "hal/bus.h"

#include "guest.h"

/* One target, as the engine reaches it. */
struct engine_port {
	const char *target; /* for the log; lives as long as the engine */
	unsigned depth;     /* requests it takes before an answer */
	bool searches;      /* its list of /alarm can be kept to families: "/alarm/29,12" */
	/* 0 or -EAGAIN; never blocks. The request is lent until its answer. */
	int (*submit)(void *ctx, struct bus_req *req);
	void *ctx;
	/*
	 * Ways to one wire (a bar) have the same number; groups are numbered in the order in which they
	 * are written, and their ways stand in it too. All but the first way of a group start suspended.
	 */
	unsigned group;
	/* bus_ops.suspend; never blocks. NULL: nothing to let go of. */
	void (*suspend)(void *ctx, bool yes);
};

struct engine_setup {
	const struct config *config;
	const struct engine_port *ports;
	unsigned port_count; /* at least 1 */
	struct image *image;
	struct commands *commands;
	struct log *log;     /* NULL: silent */
	const struct engine_guests *guests; /* NULL: none; lives as long as the engine */
	int64_t start_ns;
};

struct engine;

/* All strings of the configuration must outlive the engine. 0 or -ENOMEM. */
int engine_create(const struct engine_setup *setup, struct engine **engine);
/* The buses must have given back what was lent, or never will. */
void engine_destroy(struct engine *engine);

/* What a bus told. Unknown and repeated ids are counted and ignored. */
void engine_answer(struct engine *engine, unsigned port, const struct bus_answer *answer,
                   int64_t now_ns);
void engine_event(struct engine *engine, unsigned port, const struct bus_event *event,
                  int64_t now_ns);

/*
 * Do what is due at now_ns: take commands in, turn the period, find requests that ran out of time,
 * submit requests, publish. Returns when it wants to be called again at the latest.
 */
int64_t engine_step(struct engine *engine, int64_t now_ns);

/* Was anything published since the last call? The host then wakes those who wait for news. */
bool engine_published(struct engine *engine);

/*
 * The command segment was lost and made again: look into the old one for the last time and go on
 * with this one, which is empty and which no consumer has seen yet. What was commanded goes in.
 */
void engine_take_commands(struct engine *engine, struct commands *commands, int64_t now_ns);

/*
 * Counters: the engine's own first, then LANE_COUNTERS for each port; the image is planned with
 * these names. engine_counter_count() counts both.
 */
unsigned engine_counter_count(unsigned port_count);
void engine_counter_plan(unsigned port_count, struct image_counter *counters);
uint64_t engine_counter(const struct engine *engine, unsigned index);

#endif
