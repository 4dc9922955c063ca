/* SPDX-License-Identifier: MIT */
/* DS2430A (data sheet, "256-bit 1-Wire EEPROM"): 32 bytes, and an application register. */
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/families.h"

enum { KEY = 0xA5, LOCK_APPLICATION = 0x5A };

/* tPROG: 10 ms. */
#define COPY_NS (10 * NS_PER_MS)

struct ds2430a {
	uint8_t memory[32], application[8];
	uint8_t scratchpad[32], register_pad[8];
	bool locked, locking;
};

static void ds2430a_create(struct sim_slave *slave)
{
	struct ds2430a *s = slave->state;

	memset(s->memory, 0xFF, 32);
	memset(s->application, 0xFF, 8);
}

static void ds2430a_power_on(struct sim_slave *slave)
{
	struct ds2430a *s = slave->state;

	memcpy(s->scratchpad, s->memory, 32);
	memcpy(s->register_pad, s->application, 8);
}

static void ds2430a_worked(struct sim_slave *slave)
{
	struct ds2430a *s = slave->state;

	if (s->locking) {
		memcpy(s->application, s->register_pad, 8);
		s->locked = true;
	} else {
		memcpy(s->memory, s->scratchpad, 32);
	}
}

static void send_scratchpad(struct sim_slave *slave)
{
	sim_send_byte(slave, sim_state(slave, ds2430a)->scratchpad[slave->address++ % 32]);
}

static void ds2430a_read_memory(struct sim_slave *slave)
{
	struct ds2430a *s = slave->state;

	memcpy(s->scratchpad, s->memory, 32);
	send_scratchpad(slave);
}

static void send_application(struct sim_slave *slave)
{
	const struct ds2430a *s = slave->state;
	unsigned at = slave->address++ % 8;

	sim_send_byte(slave, s->locked ? s->application[at] : s->register_pad[at]);
}

static void send_status(struct sim_slave *slave)
{
	sim_send_byte(slave, sim_state(slave, ds2430a)->locked ? 0xFC : 0xFF);
}

static void ds2430a_write_scratchpad(struct sim_slave *slave, uint8_t byte)
{
	sim_state(slave, ds2430a)->scratchpad[slave->address++ % 32] = byte;
}

static void write_application(struct sim_slave *slave, uint8_t byte)
{
	struct ds2430a *s = slave->state;

	if (!s->locked)
		s->register_pad[slave->address++ % 8] = byte;
}

static void ds2430a_copy(struct sim_slave *slave)
{
	struct ds2430a *s = slave->state;
	bool locking = slave->function->code == LOCK_APPLICATION;

	if (slave->taken[0] == KEY && !(locking && s->locked)) {
		s->locking = locking;
		sim_work(slave, COPY_NS);
	}
	sim_end(slave);
}

static const struct sim_function functions[] = {
	/* Write, Read, Copy Scratchpad; Read Memory */
	{.code = 0x0F, .takes = 1, .byte = ds2430a_write_scratchpad},
	{.code = 0xAA, .takes = 1, .start = send_scratchpad, .next = send_scratchpad},
	{.code = 0x55, .takes = 1, .start = ds2430a_copy},
	{.code = 0xF0, .takes = 1, .start = ds2430a_read_memory, .next = send_scratchpad},
	/* Write and Read Application Register, Read Status Register */
	{.code = 0x99, .takes = 1, .byte = write_application},
	{.code = 0xC3, .takes = 1, .start = send_application, .next = send_application},
	{.code = 0x66, .takes = 1, .start = send_status, .next = send_status},
	{.code = LOCK_APPLICATION, .takes = 1, .start = ds2430a_copy},
	{0},
};

const struct sim_family sim_ds2430a = {
	.name = "DS2430A",
	.code = 0x14,
	.state_size = sizeof(struct ds2430a),
	.functions = functions,
	.create = ds2430a_create,
	.power_on = ds2430a_power_on,
	.worked = ds2430a_worked,
	SIM_MEMORY(ds2430a, memory, 32),
};
