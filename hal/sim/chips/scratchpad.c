/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "hal/sim/chips/scratchpad.h"
#include "hal/sim/crc.h"

enum { WRITE = 0x0F, READ = 0xAA, READ_MEMORY = 0xF0 };
/* E/S register: the ending offset in the lower bits, and these. */
enum { PARTIAL = 0x20, AUTHORIZED = 0x80 };

static struct sim_scratchpad *state(struct sim_slave *slave)
{
	return sim_state(slave, sim_scratchpad);
}

void sim_scratchpad_power_on(struct sim_slave *slave, int64_t t)
{
	struct sim_scratchpad *s = state(slave);

	(void)t;
	memset(s->pad, 0xFF, sizeof(s->pad));
	s->command = 0;
	s->target = 0;
	s->status = PARTIAL | (s->kind->page - 1);
	s->copying = false;
}

void sim_scratchpad_reset(struct sim_slave *slave, int64_t t)
{
	(void)t;
	state(slave)->command = 0;
}

void sim_scratchpad_advance(struct sim_slave *slave, int64_t t)
{
	struct sim_scratchpad *s = state(slave);
	unsigned page = s->kind->page, first = s->target % page, last = s->status % page;

	if (!s->copying || t < s->until)
		return;
	s->copying = false;
	if (s->kind->whole) {
		first = 0;
		last = page - 1;
	}
	if (first <= last)
		memcpy(s->memory + s->target / page * page + first, s->pad + first,
		       last - first + 1);
	s->status |= AUTHORIZED;
}

/* Without current a copy comes to nothing. */
void sim_scratchpad_strong(struct sim_slave *slave, bool on, int64_t t)
{
	if (!on && slave->parasite && state(slave)->copying)
		sim_slave_power_on(slave, t);
}

/* While it is copied the line stays high; then 0 and 1 in turns, AAh. */
bool sim_scratchpad_bit(struct sim_slave *slave, int64_t t)
{
	struct sim_scratchpad *s = state(slave);

	(void)t;
	if (s->copying)
		return true;
	s->got ^= 1;
	return s->got & 1;
}

static void send_crc(struct sim_slave *slave)
{
	struct sim_scratchpad *s = state(slave);
	uint8_t out[2] = {(uint8_t)~s->crc, (uint8_t)(~s->crc >> 8)};

	s->command = 0;
	sim_send(slave, out, 2);
}

static void write(struct sim_slave *slave, uint8_t byte)
{
	struct sim_scratchpad *s = state(slave);
	unsigned at;

	s->crc = sim_crc16(s->crc, &byte, 1);
	if (s->got < 2) {
		s->taken[s->got++] = byte;
		if (s->got < 2)
			return;
		s->target = (uint16_t)(s->taken[0] | s->taken[1] << 8);
		s->address = s->target;
		s->status = PARTIAL | s->target % s->kind->page;
		if (s->target >= s->kind->size)
			sim_end(slave);
		return;
	}
	at = s->address++ % s->kind->page;
	s->pad[at] = byte;
	s->status = (uint8_t)at;
	if (at == s->kind->page - 1u)
		send_crc(slave);
}

/* Target, E/S, the bytes from the target's offset to the ending one, checksum. */
static void read(struct sim_slave *slave)
{
	struct sim_scratchpad *s = state(slave);
	unsigned first = s->target % s->kind->page, last = s->status % s->kind->page, n = 3;
	uint8_t out[3 + 32 + 2] = {(uint8_t)s->target, (uint8_t)(s->target >> 8), s->status};

	for (unsigned i = first; i <= last; i++)
		out[n++] = s->pad[i];
	s->crc = sim_crc16(s->crc, out, n);
	out[n++] = (uint8_t)~s->crc;
	out[n++] = (uint8_t)(~s->crc >> 8);
	s->command = 0;
	sim_send(slave, out, n);
}

static void copy(struct sim_slave *slave, uint8_t byte, int64_t t)
{
	struct sim_scratchpad *s = state(slave);

	s->taken[s->got++] = byte;
	if (s->got < 3)
		return;
	if ((s->taken[0] | s->taken[1] << 8) != s->target || s->taken[2] != s->status ||
	    (s->status & PARTIAL)) {
		sim_end(slave);
		return;
	}
	s->copying = true;
	s->until = t + s->kind->copy_ns;
	s->got = 1;
	sim_send_bits(slave);
}

static void read_memory(struct sim_slave *slave)
{
	struct sim_scratchpad *s = state(slave);

	if (s->address >= s->kind->size)
		sim_end(slave);
	else
		sim_send_byte(slave, s->memory[s->address++]);
}

static void command(struct sim_slave *slave, uint8_t byte)
{
	struct sim_scratchpad *s = state(slave);

	s->command = byte;
	s->got = 0;
	s->crc = sim_crc16(0, &byte, 1);
	if (byte == READ)
		read(slave);
	else if (byte != WRITE && byte != READ_MEMORY && byte != s->kind->copy)
		sim_end(slave);
}

void sim_scratchpad_received(struct sim_slave *slave, uint8_t byte, int64_t t)
{
	struct sim_scratchpad *s = state(slave);

	if (s->command == 0) {
		command(slave, byte);
	} else if (s->command == WRITE) {
		write(slave, byte);
	} else if (s->command == READ_MEMORY) {
		s->taken[s->got++] = byte;
		if (s->got == 2) {
			s->address = (uint16_t)(s->taken[0] | s->taken[1] << 8);
			read_memory(slave);
		}
	} else {
		copy(slave, byte, t);
	}
}

void sim_scratchpad_drained(struct sim_slave *slave, int64_t t)
{
	(void)t;
	if (state(slave)->command == READ_MEMORY)
		read_memory(slave);
}

uint8_t *sim_scratchpad_memory(struct sim_slave *slave, size_t *size)
{
	*size = state(slave)->kind->size;
	return state(slave)->memory;
}
