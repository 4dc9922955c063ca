/* SPDX-License-Identifier: MIT */
/* One chip of OneWireHub, driven slot by slot. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct hub;

/* The chip of that name of the simulator; NULL: OneWireHub is not asked to play it. */
struct hub *hub_new(const char *chip, const uint8_t rom[8]);
void hub_free(struct hub *hub);

/* A reset; a slot in which the line is so; what the chip does to it now: false pulls it low. */
void hub_reset(struct hub *hub, int64_t now_ns);
void hub_slot(struct hub *hub, bool line, int64_t now_ns);
bool hub_output(struct hub *hub, int64_t now_ns);

/* What the sketch of a user would set: the inputs of the simulator's chip, in its order. */
void hub_set(struct hub *hub, const double *inputs);
/* The memory of a DS2438. */
const uint8_t *hub_memory(const struct hub *hub);

/* Of test programs: the chip of a slave on the simulator's wire (wrap.c). */
struct sim_slave;
struct hub *hub_of(const struct sim_slave *slave);
/* How many slots went through OneWireHub. */
extern unsigned hub_slots;

#ifdef __cplusplus
}
#endif
