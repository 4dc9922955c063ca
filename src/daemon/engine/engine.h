/* SPDX-License-Identifier: MIT */
/*
 * The engine: it owns the signal table, drives its lanes and publishes into the image. It does no
 * I/O and knows no clock: time is an argument, answers and events are brought to it, and requests
 * leave through the ports. One thread. So a day of its life is tested in milliseconds.
 *
 * This room may touch src/ground/signal, src/config/read/config.h, src/memory/shm, the log, and of
 * hal the bus contract and the paths. Its files form a stack: a file uses files of its own layer
 * and of those below it, and no two files use each other. state.h has the structures that all of
 * them work on, and says which file changes what; each other header declares what its own .c
 * defines. alarm, limits, routing, command and reload are folders; what stands in none of them is
 * the table and the lanes.
 *
 *   step                 engine (makes it, and takes the calls), adopt (a reload)
 *   events and answers   lane_answer (what happened), ask (chooses what is next)
 *   routing              routing (acts on the facts: opens ways, moves devices)
 *   targets              lane_state (a target goes up and fails, and what its bus reports)
 *   moves                move (of signals to another lane; writes in doubt)
 *   alarm and guests     alarm (the machine), alarm_step, guests
 *   controllers          controllers (they join, beat and leave)
 *   reading and writing  completion, presence, intake, in_force, place
 *   alarm items          read_back, alarm_arm, alarm_effect
 *   schedule, publish    schedule, publish, origin, limits, counters, device_facts
 *   lanes                lane, trace, alarm_item
 *   table                table, scaling, due
 *   pure functions       route, adoption, limit, retry, alarm_fsm, alarm_text
 *
 * Room src/daemon/engine: the table of signals, lanes, alarms; no input or output.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/bus.h"
#include "src/config/read/config.h"
#include "src/daemon/engine/guest.h"
#include "src/daemon/engine/port.h"
#include "src/ground/text/log.h"
#include "src/memory/shm/image.h"

struct engine_last;
struct force;
struct force_left;

struct engine_setup {
	const struct config *config;
	const struct engine_port *ports;
	unsigned port_count; /* at least 1 */
	struct image *image;
	struct force *force;                /* for the owsd after this one; NULL: none */
	const struct force_left *left;      /* of the owsd before; NULL: none, or a reload */
	const struct engine_last *last;     /* Start "last"; NULL: nothing is stored */
	struct log *log;                    /* NULL: silent */
	const struct engine_guests *guests; /* NULL: none; lives as long as the engine */
	int64_t start_ns;
};

struct engine;

/*
 * Record 0 beats at the first step of each period in which there is something to do, and at least
 * so often, or once a period where that is longer. Readers give it 2 s.
 */
#define ENGINE_BEAT_NS INT64_C(500000000)

/* All strings of the configuration must outlive the engine. 0 or -ENOMEM. */
int engine_create(const struct engine_setup *setup, struct engine **engine);
/* Call it when every lent request was answered, or its bus was destroyed. */
void engine_destroy(struct engine *engine);

/* What a bus has answered and reported. Unknown and repeated ids are counted and ignored. */
void engine_answer(struct engine *engine, unsigned port, const struct bus_answer *answer,
                   int64_t now_ns);
void engine_event(struct engine *engine, unsigned port, const struct bus_event *event,
                  int64_t now_ns);

/*
 * Do what is due at now_ns: take commands in, go on to the period, find requests out of time,
 * submit requests, publish. Returns when it wants to be called again at the latest.
 */
int64_t engine_step(struct engine *engine, int64_t now_ns);

/*
 * Was anything published since the last call? The host then wakes the consumers that wait for news.
 */
bool engine_published(struct engine *engine);
