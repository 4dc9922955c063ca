/* SPDX-License-Identifier: MIT */
/* DS2430A (data sheet, "256-bit 1-Wire EEPROM"): 32 bytes, and an application register. */
#include <string.h>

#include "hal/sim/chips/families.h"

enum {
	WRITE_SCRATCHPAD = 0x0F,
	READ_SCRATCHPAD = 0xAA,
	COPY_SCRATCHPAD = 0x55,
	READ_MEMORY = 0xF0,
	WRITE_APPLICATION = 0x99,
	READ_APPLICATION = 0xC3,
	READ_STATUS = 0x66,
	LOCK_APPLICATION = 0x5A,
	KEY = 0xA5,
};

/* tPROG: 10 ms. */
#define COPY_NS INT64_C(10000000)

struct ds2430a {
	uint8_t memory[32], application[8];
	uint8_t scratchpad[32], register_pad[8];
	bool locked, addressed;
	uint8_t command, address;
	bool copying, locking;
	int64_t until;
};

static struct ds2430a *state(struct sim_slave *slave)
{
	return sim_state(slave, ds2430a);
}

static void create(struct sim_slave *slave)
{
	memset(state(slave)->memory, 0xFF, 32);
	memset(state(slave)->application, 0xFF, 8);
}

static void power_on(struct sim_slave *slave, int64_t t)
{
	struct ds2430a *s = state(slave);

	(void)t;
	memcpy(s->scratchpad, s->memory, 32);
	memcpy(s->register_pad, s->application, 8);
	s->copying = false;
	s->command = 0;
}

static void reset(struct sim_slave *slave, int64_t t)
{
	(void)t;
	state(slave)->command = 0;
}

static void advance(struct sim_slave *slave, int64_t t)
{
	struct ds2430a *s = state(slave);

	if (!s->copying || t < s->until)
		return;
	s->copying = false;
	if (s->locking) {
		memcpy(s->application, s->register_pad, 8);
		s->locked = true;
	} else {
		memcpy(s->memory, s->scratchpad, 32);
	}
}

static void strong(struct sim_slave *slave, bool on, int64_t t)
{
	if (!on && slave->parasite && state(slave)->copying)
		sim_slave_power_on(slave, t);
}

static void send(struct sim_slave *slave)
{
	struct ds2430a *s = state(slave);

	switch (s->command) {
	case READ_MEMORY:
	case READ_SCRATCHPAD:
		sim_send_byte(slave, s->scratchpad[s->address++ % 32]);
		break;
	case READ_APPLICATION:
		sim_send_byte(slave, s->locked ? s->application[s->address++ % 8]
		                               : s->register_pad[s->address++ % 8]);
		break;
	case READ_STATUS:
		sim_send_byte(slave, s->locked ? 0xFC : 0xFF);
		break;
	}
}

static void copy(struct sim_slave *slave, uint8_t byte, int64_t t)
{
	struct ds2430a *s = state(slave);

	if (byte == KEY && !(s->command == LOCK_APPLICATION && s->locked)) {
		s->copying = true;
		s->locking = s->command == LOCK_APPLICATION;
		s->until = t + COPY_NS;
	}
	sim_end(slave);
}

static void received(struct sim_slave *slave, uint8_t byte, int64_t t)
{
	struct ds2430a *s = state(slave);

	if (s->command == 0) {
		s->command = byte;
		s->addressed = false;
		return;
	}
	switch (s->command) {
	case COPY_SCRATCHPAD:
	case LOCK_APPLICATION:
		copy(slave, byte, t);
		return;
	case READ_MEMORY:
		memcpy(s->scratchpad, s->memory, 32);
		break;
	case READ_SCRATCHPAD:
	case READ_APPLICATION:
	case READ_STATUS:
		break;
	case WRITE_SCRATCHPAD:
		if (!s->addressed)
			s->address = byte;
		else
			s->scratchpad[s->address++ % 32] = byte;
		s->addressed = true;
		return;
	case WRITE_APPLICATION:
		if (!s->addressed)
			s->address = byte;
		else if (!s->locked)
			s->register_pad[s->address++ % 8] = byte;
		s->addressed = true;
		return;
	default:
		sim_end(slave);
		return;
	}
	s->address = byte;
	send(slave);
}

static void drained(struct sim_slave *slave, int64_t t)
{
	(void)t;
	send(slave);
}

static uint8_t *memory(struct sim_slave *slave, size_t *size)
{
	*size = 32;
	return state(slave)->memory;
}

const struct sim_family sim_ds2430a = {
	.name = "DS2430A",
	.code = 0x14,
	.state_size = sizeof(struct ds2430a),
	.create = create,
	.power_on = power_on,
	.reset = reset,
	.received = received,
	.drained = drained,
	.advance = advance,
	.strong = strong,
	.memory = memory,
};
