/* SPDX-License-Identifier: MIT */
/* Numbers as bytes in the registers of simulated chips, and values within a register's range. */
#include "hal/sim/bytes.h"
#include "hal/sim/curve.h"

void sim_put(uint8_t *at, unsigned n, int64_t value)
{
	for (unsigned i = 0; i < n; i++)
		at[i] = (uint8_t)((uint64_t)value >> (8 * i));
}

uint64_t sim_get(const uint8_t *at, unsigned n)
{
	uint64_t value = 0;

	while (n--)
		value = value << 8 | at[n];
	return value;
}

void sim_put_high(uint8_t *at, unsigned n, int64_t value)
{
	for (unsigned i = 0; i < n; i++)
		at[n - 1 - i] = (uint8_t)((uint64_t)value >> (8 * i));
}

uint64_t sim_get_high(const uint8_t *at, unsigned n)
{
	uint64_t value = 0;

	for (unsigned i = 0; i < n; i++)
		value = value << 8 | at[i];
	return value;
}

void sim_count_up(uint8_t *counter, unsigned n)
{
	uint64_t value = sim_get(counter, n);

	if (value + 1 < UINT64_C(1) << (8 * n))
		sim_put(counter, n, (int64_t)(value + 1));
}

int sim_within(double value, int least, int most)
{
	int64_t whole = sim_round(value);

	return whole < least ? least : whole > most ? most : (int)whole;
}
