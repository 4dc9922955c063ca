/* SPDX-License-Identifier: MIT */
/*
 * The controllers: programs that are connected and command, their heartbeats, and which commands
 * are in force. The control room lets them join and leave, on the engine's thread; or on another
 * before that engine runs.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "src/memory/shm/controller.h"

struct engine;
struct signal;

/*
 * A controller takes a seat (below OWS_CONTROLLERS) that is free. With the token of a controller
 * that has commands in force it comes back as that one. A reload: each controller joins the new
 * engine at its seat with its serial and new memory, before engine_adopt(), which copies what the
 * old memory had.
 */
void engine_controller_join(struct engine *e, unsigned seat,
                            const struct joining_controller *controller, int64_t now_ns);
/*
 * A controller hung up or is dead: the engine looks at its commands for the last time, and touches
 * its memory and rights no more after that.
 */
void engine_controller_left(struct engine *e, unsigned seat, int64_t now_ns);
/*
 * Has some controller marked commands at which engine_step() would look? The engine's thread clears
 * awake in the image, then asks this, and sleeps only if not. Controllers that have used up their
 * budget of looks do not count: what engine_step() returned is early enough for them.
 */
bool engine_controllers_marked(const struct engine *e);

/*
 * Once a period: see which controllers beat, are late, or have used up their time. Time in which
 * owsd did not run does not count.
 */
void engine_look_controllers(struct engine *e);
/*
 * A reload, in this order: the controllers of old can set there no more, and what they have set is
 * taken; those without a memory in e leave. Then e goes on with the others; rows as in struct
 * adoption.
 */
void engine_controllers_retire(struct engine *old, const struct engine *e, int64_t now_ns);
void engine_controllers_adopt(struct engine *e, const struct engine *old, const uint32_t *rows);
