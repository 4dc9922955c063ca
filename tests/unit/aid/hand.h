/* SPDX-License-Identifier: MIT */
/* Works a wire with slaves by hand: no chip and no driver stand between the test and the slave. */
#pragma once

#include "hal/sim/families.h"
#include "hal/sim/wire.h"

#define HAND_MS INT64_C(1000000)

struct hand {
	struct sim_wire wire;
	int64_t now;
	bool overdrive;
};

void hand_clear(struct hand *hand);
/* Add a slave with the id last, 0, 0, 0, 0, 0, and power it on. */
struct sim_slave *hand_plug(struct hand *hand, const struct sim_family *family, uint8_t last);
bool hand_reset(struct hand *hand);
bool hand_bit(struct hand *hand, bool out);
void hand_write(struct hand *hand, const uint8_t *bytes, unsigned n);
void hand_read(struct hand *hand, uint8_t *bytes, unsigned n);
uint8_t hand_byte(struct hand *hand);
/* Send reset, Skip ROM, and the n bytes that follow. */
void hand_skip(struct hand *hand, unsigned n, ...);
/* Send reset and Match ROM. */
void hand_match(struct hand *hand, const struct sim_slave *slave);
/* Does the slave answer a conditional search? */
bool hand_in_alarm(struct hand *hand, const struct sim_slave *slave);
/* All ids that a search (0xF0, 0xEC) finds, at most room. */
unsigned hand_search(struct hand *hand, uint8_t command, uint8_t (*rom)[8], unsigned room);
