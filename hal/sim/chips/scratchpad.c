/* SPDX-License-Identifier: MIT */
/* The commands of the memories with a scratchpad. */
#include <string.h>

#include "hal/sim/chips/scratchpad.h"

/* E/S register: the ending offset in the lower bits, above them a flag, and these. */
enum { OVERFLOW = 0x40, AUTHORIZED = 0x80 };

static const struct sim_scratchpad_kind *pad_kind(const struct sim_slave *slave)
{
	return slave->family->kind;
}

/* The flag of a byte that came in part. */
static uint8_t partial(const struct sim_slave *slave)
{
	return pad_kind(slave)->page > 32 ? 0x40 : 0x20;
}

void sim_scratchpad_power_on(struct sim_slave *slave)
{
	struct sim_scratchpad *s = slave->state;

	memset(s->pad, 0xFF, sizeof(s->pad));
	s->target = 0;
	s->status = (uint8_t)(partial(slave) | (pad_kind(slave)->page - 1));
}

void sim_scratchpad_worked(struct sim_slave *slave)
{
	struct sim_scratchpad *s = slave->state;
	unsigned page = pad_kind(slave)->page, first = s->target % page, last = s->status % page;

	if (pad_kind(slave)->whole) {
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
	if (slave->busy || pad_kind(slave)->plain)
		return slave->busy;
	slave->got ^= 1;
	return slave->got & 1;
}

void sim_scratchpad_target(struct sim_slave *slave)
{
	struct sim_scratchpad *s = slave->state;

	s->target = slave->address;
	s->status = (uint8_t)(partial(slave) | s->target % pad_kind(slave)->page);
	s->bad_sequence = false;
	if (s->target >= pad_kind(slave)->writable)
		sim_end(slave);
}

void sim_scratchpad_write(struct sim_slave *slave, uint8_t byte)
{
	struct sim_scratchpad *s = slave->state;
	unsigned at = slave->address++ % pad_kind(slave)->page;

	if (at < (s->status & (pad_kind(slave)->page - 1u))) {
		s->status |= OVERFLOW;
		sim_end(slave);
		return;
	}
	s->pad[at] = byte;
	s->status = (uint8_t)at;
	if (at == pad_kind(slave)->page - 1u && !pad_kind(slave)->plain)
		sim_send_checked(slave, NULL, 0);
}

/* Send target, E/S, the bytes from the target's offset to the ending one, and a checksum. */
void sim_scratchpad_read(struct sim_slave *slave)
{
	struct sim_scratchpad *s = slave->state;
	unsigned page = pad_kind(slave)->page, first = s->target % page, n = 3;
	unsigned last = pad_kind(slave)->to_end ? page - 1 : s->status % page;
	uint8_t out[3 + 64] = {(uint8_t)s->target, (uint8_t)(s->target >> 8), s->status};

	for (unsigned i = first; i <= last; i++)
		out[n++] = s->pad[i];
	if (pad_kind(slave)->plain)
		sim_send(slave, out, n);
	else
		sim_send_checked(slave, out, n);
}

void sim_scratchpad_copy(struct sim_slave *slave)
{
	struct sim_scratchpad *s = slave->state;

	if (slave->address != s->target || slave->taken[2] != s->status ||
	    (s->status & partial(slave)) || (pad_kind(slave)->sequence && s->bad_sequence)) {
		sim_end(slave);
		return;
	}
	slave->got = 1;
	sim_work(slave, pad_kind(slave)->copy_ns);
}

void sim_scratchpad_dump(struct sim_slave *slave)
{
	struct sim_scratchpad *s = slave->state;
	bool checked = slave->function->code == SIM_DUMP_PAGES;

	s->bad_sequence = true;
	sim_send_memory(slave, s->memory, pad_kind(slave)->size,
	                checked ? pad_kind(slave)->page : 0);
}

void sim_scratchpad_send_counted(struct sim_slave *slave, uint32_t count, const uint8_t more[4])
{
	const struct sim_scratchpad *s = slave->state;
	uint8_t out[32 + 4 + 4];
	unsigned n = 0;

	if (slave->address >= pad_kind(slave)->writable) {
		sim_end(slave);
		return;
	}
	do
		out[n++] = s->memory[slave->address++];
	while (slave->address % 32);
	sim_put(out + n, 4, count);
	memcpy(out + n + 4, more, 4);
	sim_send_checked(slave, out, n + 8);
}
