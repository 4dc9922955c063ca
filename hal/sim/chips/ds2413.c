/* SPDX-License-Identifier: MIT */
/* DS2413 (data sheet 19-5709): two pins. */
#include <string.h>

#include "hal/sim/chips/families.h"
#include "hal/sim/pins.h"

enum { ACCESS_READ = 0xF5, ACCESS_WRITE = 0x5A };

struct ds2413 {
	struct sim_pins pins;
	uint8_t command, got, taken[2];
};

static struct ds2413 *state(struct sim_slave *slave)
{
	return sim_state(slave, ds2413);
}

static void power_on(struct sim_slave *slave, int64_t t)
{
	memset(state(slave), 0, sizeof(struct ds2413));
	sim_pins_start(slave, &state(slave)->pins, 2, t);
}

static void advance(struct sim_slave *slave, int64_t t)
{
	sim_pins_follow(slave, &state(slave)->pins, t);
}

static void reset(struct sim_slave *slave, int64_t t)
{
	(void)t;
	state(slave)->command = 0;
}

/* Pin A, latch A, pin B, latch B, and their complement above. */
static void send_status(struct sim_slave *slave)
{
	const struct sim_pins *pins = &state(slave)->pins;
	unsigned low = (pins->level & 1) | (pins->latch & 1) << 1 | (pins->level & 2) << 1 |
	               (pins->latch & 2) << 2;

	sim_send_byte(slave, (uint8_t)(low | (~low & 15) << 4));
}

static void received(struct sim_slave *slave, uint8_t byte, int64_t t)
{
	struct ds2413 *s = state(slave);

	if (s->command != ACCESS_WRITE) {
		s->command = byte;
		s->got = 0;
		if (byte == ACCESS_READ)
			send_status(slave);
		else if (byte != ACCESS_WRITE)
			sim_end(slave);
		return;
	}
	s->taken[s->got++] = byte;
	if (s->got < 2)
		return;
	if ((s->taken[0] ^ s->taken[1]) != 0xFF) {
		sim_end(slave);
		return;
	}
	sim_pins_write(slave, &s->pins, s->taken[0] & 3, t);
	sim_send_byte(slave, 0xAA);
}

static void drained(struct sim_slave *slave, int64_t t)
{
	struct ds2413 *s = state(slave);

	(void)t;
	if (s->command == ACCESS_READ) {
		send_status(slave);
	} else if (s->got == 2) { /* behind AAh */
		s->got = 3;
		send_status(slave);
	} else {
		s->got = 0;
		sim_receive(slave);
	}
}

static const struct sim_input inputs[] = {SIM_PIN("pin.A"), SIM_PIN("pin.B"), {0}};

const struct sim_family sim_ds2413 = {
	.name = "DS2413",
	.code = 0x3A,
	.overdrive = true,
	.resume = true,
	.state_size = sizeof(struct ds2413),
	.inputs = inputs,
	.power_on = power_on,
	.reset = reset,
	.received = received,
	.drained = drained,
	.advance = advance,
};
