/* SPDX-License-Identifier: MIT */
/* The commands of the memories with a scratchpad. */
#include <string.h>

#include "hal/sim/chips/scratchpad.h"

/* E/S register: the ending offset in the lower bits, above them a flag, and these. */
enum { OVERFLOW = 0x40, AUTHORIZED = 0x80 };

static const struct sim_scratchpad_kind *kind_of(const struct sim_slave *slave)
{
	return slave->family->kind;
}

/* The flag of a byte that came in part. */
static uint8_t partial(const struct sim_slave *slave)
{
	return kind_of(slave)->page > 32 ? 0x40 : 0x20;
}

void sim_scratchpad_power_on(struct sim_slave *slave)
{
	struct sim_scratchpad *s = slave->state;

	memset(s->pad, 0xFF, sizeof(s->pad));
	s->target = 0;
	s->status = (uint8_t)(partial(slave) | (kind_of(slave)->page - 1));
}

void sim_scratchpad_worked(struct sim_slave *slave)
{
	struct sim_scratchpad *s = slave->state;
	unsigned page = kind_of(slave)->page, first = s->target % page, last = s->status % page;

	if (kind_of(slave)->whole) {
		first = 0;
		last = page - 1;
	}
	if (first <= last)
		memcpy(s->memory + s->target / page * page + first, s->pad + first,
		       last - first + 1);
	s->status |= AUTHORIZED;
}

/* During the copy the line stays high; then 0 and 1 follow in turns, as AAh, or only 0. */
bool sim_scratchpad_bit(struct sim_slave *slave)
{
	if (slave->busy || kind_of(slave)->plain)
		return slave->busy;
	slave->got ^= 1;
	return slave->got & 1;
}

void sim_scratchpad_target(struct sim_slave *slave)
{
	struct sim_scratchpad *s = slave->state;

	s->target = slave->address;
	s->status = (uint8_t)(partial(slave) | s->target % kind_of(slave)->page);
	s->bad_sequence = false;
	if (s->target >= kind_of(slave)->writable)
		sim_end(slave);
}

void sim_scratchpad_write(struct sim_slave *slave, uint8_t byte)
{
	struct sim_scratchpad *s = slave->state;
	unsigned at = slave->address++ % kind_of(slave)->page;

	if (at < (s->status & (kind_of(slave)->page - 1u))) {
		s->status |= OVERFLOW;
		sim_end(slave);
		return;
	}
	s->pad[at] = byte;
	s->status = (uint8_t)at;
	if (at == kind_of(slave)->page - 1u && !kind_of(slave)->plain)
		sim_send_checked(slave, NULL, 0);
}

/* Send target, E/S, the bytes from the target's offset to the ending one, and a checksum. */
void sim_scratchpad_read(struct sim_slave *slave)
{
	struct sim_scratchpad *s = slave->state;
	unsigned page = kind_of(slave)->page, first = s->target % page, n = 3;
	unsigned last = kind_of(slave)->to_end ? page - 1 : s->status % page;
	uint8_t out[3 + 64] = {(uint8_t)s->target, (uint8_t)(s->target >> 8), s->status};

	for (unsigned i = first; i <= last; i++)
		out[n++] = s->pad[i];
	if (kind_of(slave)->plain)
		sim_send(slave, out, n);
	else
		sim_send_checked(slave, out, n);
}

void sim_scratchpad_copy(struct sim_slave *slave)
{
	struct sim_scratchpad *s = slave->state;

	if (slave->address != s->target || slave->taken[2] != s->status ||
	    (s->status & partial(slave)) || (kind_of(slave)->sequence && s->bad_sequence)) {
		sim_end(slave);
		return;
	}
	slave->got = 1;
	sim_work(slave, kind_of(slave)->copy_ns);
}

static void dump(struct sim_slave *slave, unsigned page)
{
	struct sim_scratchpad *s = slave->state;

	s->bad_sequence = true;
	sim_send_memory(slave, s->memory, kind_of(slave)->size, page);
}

void sim_scratchpad_dump(struct sim_slave *slave)
{
	dump(slave, 0);
}

void sim_scratchpad_dump_pages(struct sim_slave *slave)
{
	dump(slave, kind_of(slave)->page);
}
