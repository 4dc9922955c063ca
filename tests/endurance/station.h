/* SPDX-License-Identifier: MIT */
/*
 * A station: an engine and its buses, each a fiber as in production a thread, on one virtual clock.
 * Buses are the real backends; what is below them is a part (part.h). A reload makes another
 * generation as the supervisor does: new buses and memory beside what runs, adoption in one step,
 * and the end of what did not stay while the engine goes on.
 */
#pragma once

#include "src/config/read/config.h"
#include "src/daemon/engine/engine.h"
#include "src/daemon/engine/reload/adopt.h"
#include "src/memory/shm/controller.h"
#include "tests/endurance/fiber.h"
#include "tests/endurance/part.h"

#define STATION_PARTS 5
#define STATION_BUSES 16 /* those that are still ending included */
#define STATION_LENT BUS_MAX_DEPTH
#define STATION_GONE UINT32_MAX
#define STATION_MESSAGES 4096 /* power of 2 */
#define STATION_TIMERS 128
#define STATION_LEAVING 32
#define STATION_SEEN 64

struct station_bus {
	struct part *part; /* NULL: a free place */
	struct bus *bus;
	struct bus_env env;
	struct fiber fiber;
	unsigned port; /* STATION_GONE: no engine has it any more */
	/* what its thread waits for */
	bool sleeps; /* for orders, between two steps */
	bool in_kernel, ready, stopping;
	int64_t wake_ns;
	int fd;
	short events;
	/* its queue, and what it has */
	struct bus_req *order[STATION_LENT];
	unsigned orders, turns_asked, turns_done;
	struct bus_req *lent[STATION_LENT];
	unsigned lent_count;
	uint64_t submitted, answered;
	/* the counters as they were seen last: of its lane, its own */
	uint64_t seen[STATION_SEEN], own_seen[STATION_SEEN];
};

/* What belongs to one configuration. */
struct generation {
	struct config *config;
	struct engine *engine;
	struct engine_port ports[STATION_PARTS];
	struct station_bus *bus[STATION_PARTS];
	unsigned port_count;
	struct image image;
	struct controller_layout layout;
	void *image_memory;
	struct station_bus *ending[STATION_PARTS]; /* when it is over: buses that did not stay */
	unsigned ending_count;
};

struct station_message {
	int64_t due_ns;
	struct station_bus *bus;
	bool is_event;
	struct bus_answer answer;
	struct bus_event event;
};

struct station_timer {
	int64_t at_ns;
	void (*end)(void *ctx);
	void *ctx;
};

struct station {
	int64_t now, start;
	uint32_t random;
	struct part part[STATION_PARTS];
	unsigned part_count;
	struct station_bus bus[STATION_BUSES];
	struct station_bus *running; /* whose fiber is entered */
	struct generation *now_serving;
	struct generation *leaving[STATION_LEAVING];
	unsigned leaving_count;
	int64_t engine_ns;
	uint64_t engine_steps, reloads;
	struct station_message message[STATION_MESSAGES];
	unsigned message_head, message_count;
	struct station_timer timer[STATION_TIMERS];
	unsigned timer_count;
	unsigned idle;
	/* After each step of the engine. */
	void (*stepped)(void);
	const char *broken; /* said inside a fiber */
	struct log *log;    /* NULL: none */
	int64_t log_from_ns;
};

extern struct station station;

/* The parts are in place; rio: the configuration with their targets. */
void station_begin(const char *rio);
void station_run(int64_t until_ns);
void station_end(void);
/* Another configuration in place of the one that is served. */
void station_reload(const char *rio);
/* Nobody runs for so long, as when the machine was suspended. */
void station_gap(int64_t ns);
/* No bus that a reload ended is still ending. */
bool station_settled(void);
/* A program rings. */
void station_ring(void);
/* test_endurance.c: the world is broken. Does not return. */
_Noreturn void world_fails(const char *what, const char *signal);
