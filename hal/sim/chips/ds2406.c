/* SPDX-License-Identifier: MIT */
/* DS2406 (data sheet, "Dual Addressable Switch Plus 1Kb Memory"); its EPROM is not programmed. */
#include <string.h>

#include "hal/sim/families.h"
#include "hal/sim/pins.h"

/* Status byte 7. */
enum { POLARITY = 0x01, LATCH_A = 0x20, LATCH_B = 0x40, SUPPLY = 0x80 };
/* Channel control byte 1. */
enum { TOG = 0x20, IM = 0x40, ALR = 0x80 };

enum { MEMORY = 128, STATUS = 8 };

struct ds2406 {
	struct sim_pins pins;
	uint8_t memory[MEMORY], status[STATUS];
	/* Channel access: the direction of this byte, and the number of bytes so far. */
	bool reading;
	unsigned bytes;
};

static void ds2406_create(struct sim_slave *slave)
{
	struct ds2406 *s = slave->state;

	memset(s->memory, 0xFF, MEMORY);
	memset(s->status, 0xFF, 5);
}

static void ds2406_power_on(struct sim_slave *slave)
{
	sim_state(slave, ds2406)->status[7] = 0x1F;
	sim_pins_start(slave, 0, 2);
}

/* OR the selected source of the selected channels, each against the polarity. */
static bool ds2406_alarm(struct sim_slave *slave)
{
	const struct ds2406 *s = slave->state;
	const uint8_t sources[4] = {0, s->pins.activity, s->pins.latch, s->pins.level};
	uint8_t channels = s->status[7] >> 3 & 3, source = sources[s->status[7] >> 1 & 3];

	return ((source & channels) != 0) == (s->status[7] & POLARITY);
}

static void send_memory(struct sim_slave *slave)
{
	sim_send_memory(slave, sim_state(slave, ds2406)->memory, MEMORY, MEMORY);
}

static void send_status(struct sim_slave *slave)
{
	const struct ds2406 *s = slave->state;
	uint8_t status[STATUS];

	memcpy(status, s->status, sizeof(status));
	status[7] |= (uint8_t)((s->pins.latch & 1 ? LATCH_A : 0) |
	                       (s->pins.latch & 2 ? LATCH_B : 0) | (slave->parasite ? 0 : SUPPLY));
	sim_send_memory(slave, status, STATUS, STATUS);
}

static void write_status(struct sim_slave *slave)
{
	uint8_t byte = slave->taken[2];

	if (slave->address == 7) {
		sim_state(slave, ds2406)->status[7] = byte & 0x1F;
		sim_pins_write(slave, byte >> 5 & 3);
	}
	sim_send_checked(slave, NULL, 0);
}

/* --- Channel access --------------------------------------------------------------------------- */

static unsigned selected_channels(const struct sim_slave *slave)
{
	return slave->taken[0] >> 2 & 3;
}

static uint8_t channel_info(const struct sim_slave *slave)
{
	const struct ds2406 *s = slave->state;

	return (uint8_t)(s->pins.latch | s->pins.level << 2 | s->pins.activity << 4 | 0x40 |
	                 (slave->parasite ? 0 : 0x80));
}

static void begin_access(struct sim_slave *slave)
{
	struct ds2406 *s = slave->state;
	uint8_t out = channel_info(slave);

	s->reading = slave->taken[0] & IM;
	s->bytes = 0;
	if (slave->taken[0] & ALR)
		s->pins.activity = 0;
	if (selected_channels(slave) == 0)
		sim_end(slave);
	else
		sim_send_byte(slave, out);
}

static uint8_t channel_sample(const struct sim_slave *slave)
{
	const struct ds2406 *s = slave->state;
	bool a = s->pins.level & 1, b = s->pins.level & 2;

	switch (selected_channels(slave)) {
	case 1:
		return a ? 0xFF : 0;
	case 2:
		return b ? 0xFF : 0;
	default:
		return (uint8_t)((a ? 0x55 : 0) | (b ? 0xAA : 0));
	}
}

/* Count one more byte of the exchange; does a checksum follow? */
static bool crc_is_due(struct sim_slave *slave)
{
	struct ds2406 *s = slave->state;
	static const unsigned every[4] = {0, 1, 8, 32};
	unsigned n = every[slave->taken[0] & 3];

	return ++s->bytes && n && s->bytes % n == 0;
}

/* Begin the next byte of the exchange, in its direction. */
static void next_exchange(struct sim_slave *slave)
{
	struct ds2406 *s = slave->state;
	uint8_t out = channel_sample(slave);

	if (!s->reading) {
		sim_receive(slave);
		return;
	}
	if (slave->taken[0] & TOG)
		s->reading = false;
	if (crc_is_due(slave))
		sim_send_checked(slave, &out, 1);
	else
		sim_send_byte(slave, out);
}

/* Write bit by bit; the last bit for each channel stays. */
static void write_pins(struct sim_slave *slave, uint8_t byte)
{
	struct ds2406 *s = slave->state;
	uint8_t latch = s->pins.latch;

	if (selected_channels(slave) == 1)
		latch = (uint8_t)((latch & 2) | byte >> 7);
	else if (selected_channels(slave) == 2)
		latch = (uint8_t)((latch & 1) | (byte >> 7) << 1);
	else
		latch = byte >> 6;
	sim_pins_write(slave, latch);
	if (slave->taken[0] & TOG)
		s->reading = true;
	if (crc_is_due(slave))
		sim_send_checked(slave, NULL, 0);
	else
		next_exchange(slave);
}

static const struct sim_function functions[] = {
	{.code = 0xF0, .takes = 2, .start = send_memory, .next = send_memory}, /* Read Memory */
	{.code = 0xAA, .takes = 2, .start = send_status, .next = send_status}, /* Read Status */
	{.code = 0x55, .takes = 3, .start = write_status},
	{.code = 0xF5,
         .takes = 2,
         .start = begin_access,
         .next = next_exchange,
         .byte = write_pins},
	{0},
};

static const struct sim_input inputs[] = {{SIM_PIN("pin.A")}, {SIM_PIN("pin.B")}, {0}};

const struct sim_family sim_ds2406 = {
	.name = "DS2406",
	.code = 0x12,
	.state_size = sizeof(struct ds2406),
	.functions = functions,
	.inputs = inputs,
	.create = ds2406_create,
	.power_on = ds2406_power_on,
	.alarm = ds2406_alarm,
	.advance = sim_pins_follow,
	SIM_MEMORY(ds2406, memory, MEMORY),
};
