/* SPDX-License-Identifier: MIT */
/*
 * A plant: engine, native bus, DS2482 driver and simulator together on one virtual clock, as in
 * production except for the threads. The bus's steps take their time on the clock. The engine runs
 * in the middle of them, when its time has come or answer_delay_ns after a message for it, and its
 * requests reach the bus before the bus's next step. So a bus that goes on before the engine could
 * answer does so here too. For tests and benches; an error of the plant itself aborts.
 */
#pragma once

#include "hal/sim/net.h"
#include "src/config/read/config.h"
#include "src/daemon/engine/engine.h"
#include "tests/unit/aid/giving.h"

#define PLANT_US INT64_C(1000)
#define PLANT_MS INT64_C(1000000)
#define PLANT_S INT64_C(1000000000)
#define PLANT_MESSAGES 1024 /* power of 2 */

struct plant_message {
	int64_t due_ns;
	bool is_event;
	struct bus_answer answer;
	struct bus_event event;
};

struct plant {
	int64_t now, start;      /* ns; the simulation begins at start */
	int64_t answer_delay_ns; /* from the bus's answer to the engine's next request */
	/* Called after each publication; may be NULL. */
	void (*published)(void *ctx);
	void *ctx;

	struct bus_env env;
	struct bus *bus;
	struct sim_net *net;
	struct config *config;
	struct engine *engine;
	struct engine_port port;
	struct image image;
	struct controller_layout layout;
	struct giving controller; /* the program that commands */
	void *image_memory;
	int64_t engine_ns; /* when the engine wants to run */
	uint64_t engine_steps;
	struct plant_message message[PLANT_MESSAGES];
	unsigned message_head, message_count;
	struct bus_req *order[PLANT_MESSAGES];
	unsigned orders, lent;
	unsigned idle_steps;
};

/* The network is a scenario, the configuration a .rio text whose targets are ignored. */
void plant_begin(struct plant *plant, const char *scenario, const char *rio);
/* The same on any other target, without a simulation. */
void plant_begin_on(struct plant *plant, const char *target, const char *rio);
void plant_run(struct plant *plant, int64_t until_ns);
void plant_end(struct plant *plant);

/* record: 1 is the first item. */
struct ows_sample plant_sample(const struct plant *plant, unsigned record);
double plant_number(const struct plant *plant, unsigned record);
void plant_set(struct plant *plant, unsigned record, int64_t value);
/* A total of the bus. */
uint64_t plant_count(struct plant *plant, const char *name);
/* The simulation's time, as its curves take it. */
int64_t plant_time(const struct plant *plant, int64_t ns);

/* In plant_net.c: the simulation below a bus of scheme "sim". */
struct sim_net *plant_net(struct bus *bus);
