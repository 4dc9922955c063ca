/* SPDX-License-Identifier: MIT */
/*
 * The memories that are written through a scratchpad: target address, ending offset, a copy that
 * needs both as its key. DS2431, DS2433 and DS2423 differ in sizes, codes and times.
 */
#ifndef HAL_SIM_CHIPS_SCRATCHPAD_H
#define HAL_SIM_CHIPS_SCRATCHPAD_H

#include "hal/sim/slave.h"

struct sim_scratchpad_kind {
	uint16_t size; /* of the memory */
	uint8_t page;  /* bytes of the scratchpad: 8 or 32 */
	uint8_t copy;  /* command code */
	int64_t copy_ns;
	bool whole; /* a copy takes the whole scratchpad */
};

#define SIM_SCRATCHPAD_MEMORY 512
struct sim_scratchpad {
	const struct sim_scratchpad_kind *kind;
	uint8_t memory[SIM_SCRATCHPAD_MEMORY];
	uint8_t pad[32];
	uint8_t command, got, taken[3];
	uint16_t target, address, crc;
	uint8_t status; /* E/S */
	bool copying;
	int64_t until;
};

/* For the slots of struct sim_family; the state begins with a struct sim_scratchpad. */
void sim_scratchpad_power_on(struct sim_slave *slave, int64_t t);
void sim_scratchpad_reset(struct sim_slave *slave, int64_t t);
void sim_scratchpad_received(struct sim_slave *slave, uint8_t byte, int64_t t);
void sim_scratchpad_drained(struct sim_slave *slave, int64_t t);
bool sim_scratchpad_bit(struct sim_slave *slave, int64_t t);
void sim_scratchpad_advance(struct sim_slave *slave, int64_t t);
void sim_scratchpad_strong(struct sim_slave *slave, bool on, int64_t t);
uint8_t *sim_scratchpad_memory(struct sim_slave *slave, size_t *size);

#endif
