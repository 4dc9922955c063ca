/* SPDX-License-Identifier: MIT */
/* Numbers as bytes in the registers of simulated chips, and values within a register's range. */
#pragma once

#include <stdint.h>

/* n bytes, the low one first; of a negative value its two's complement. */
void sim_put(uint8_t *at, unsigned n, int64_t value);
uint64_t sim_get(const uint8_t *at, unsigned n);
/* The high byte first. */
void sim_put_high(uint8_t *at, unsigned n, int64_t value);
uint64_t sim_get_high(const uint8_t *at, unsigned n);

/* Count one more in n bytes, the low one first; a counter that is full stays so. */
void sim_count_up(uint8_t *counter, unsigned n);

/* The value as a whole number (sim_round) from least to most. */
int sim_within(double value, int least, int most);
