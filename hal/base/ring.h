/* SPDX-License-Identifier: MIT */
/*
 * The two indices of a bounded queue with one thread that puts and one that takes. They count up
 * for ever; the caller keeps the cells, cell n is at n & (size - 1), and size is a power of two.
 * All is sequentially consistent, so that "put, then look whether the taker sleeps" is sound.
 */
#pragma once

#include <stdint.h>

struct ring {
	uint32_t size;
	uint32_t put, taken;
};

static inline uint32_t ring_size(uint32_t at_least)
{
	uint32_t size = 2;

	while (size < at_least)
		size *= 2;
	return size;
}

static inline uint32_t ring_used(const struct ring *ring)
{
	uint32_t taken = __atomic_load_n(&ring->taken, __ATOMIC_SEQ_CST);

	return __atomic_load_n(&ring->put, __ATOMIC_SEQ_CST) - taken;
}

/*
 * The cell that the putter fills next, and the cell that the taker empties next; each for itself.
 */
static inline uint32_t ring_put_at(const struct ring *ring)
{
	return ring->put & (ring->size - 1);
}

static inline uint32_t ring_take_at(const struct ring *ring)
{
	return ring->taken & (ring->size - 1);
}

static inline void ring_did_put(struct ring *ring)
{
	__atomic_store_n(&ring->put, ring->put + 1, __ATOMIC_SEQ_CST);
}

static inline void ring_did_take(struct ring *ring)
{
	__atomic_store_n(&ring->taken, ring->taken + 1, __ATOMIC_SEQ_CST);
}
