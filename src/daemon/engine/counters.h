/* SPDX-License-Identifier: MIT */
/*
 * Counters: the engine's own first, then LANE_COUNTERS for each port. The image is planned with
 * these names.
 */
#pragma once

#include <stdint.h>

struct engine;
struct image_counter;

/* How many there are, the engine's own and those of its ports. */
unsigned engine_counter_count(unsigned port_count);
void engine_counter_plan(unsigned port_count, struct image_counter *counters);
uint64_t engine_counter(const struct engine *engine, unsigned index);
/* Put all of them into the image. */
void engine_publish_counters(struct engine *e);
