/* SPDX-License-Identifier: MIT */
/* DS2890 (data sheet, "1-Wire Digital Potentiometer"): a wiper of 256 positions, a charge pump. */
#include "hal/sim/families.h"

enum { FEATURES = 0xF3, CONTROL = 0x0C, CHARGE_PUMP = 0x40 };
enum { WRITE_POSITION = 0x0F, RELEASE = 0x96, INCREMENT = 0xC3, DECREMENT = 0x99 };

struct ds2890 {
	uint8_t position, control;
	uint8_t fresh; /* was sent back, takes effect with the release code */
};

static void ds2890_power_on(struct sim_slave *slave)
{
	*sim_state(slave, ds2890) = (struct ds2890){.control = CONTROL};
}

/* Send control register and position, */
static void read_position(struct sim_slave *slave)
{
	const struct ds2890 *s = slave->state;
	const uint8_t out[2] = {s->control, s->position};

	sim_send(slave, out, sizeof(out));
}

/* or the features and the control register, */
static void ds2890_read_control(struct sim_slave *slave)
{
	const uint8_t out[2] = {FEATURES, sim_state(slave, ds2890)->control};

	sim_send(slave, out, sizeof(out));
}

/* and zeros after them. */
static void send_zero(struct sim_slave *slave)
{
	sim_send_byte(slave, 0);
}

/* Send the byte back; it takes effect when the release code follows. */
static void ds2890_write(struct sim_slave *slave, uint8_t byte)
{
	struct ds2890 *s = slave->state;
	bool is_position = slave->function->code == WRITE_POSITION;

	if (slave->address++ == 0) {
		s->fresh = byte;
		if (is_position || (byte & ~CHARGE_PUMP) == CONTROL)
			sim_send_byte(slave, byte);
		else
			sim_end(slave);
		return;
	}
	sim_end(slave);
	if (byte == RELEASE)
		*(is_position ? &s->position : &s->control) = s->fresh;
}

/* Move one step, not beyond the end, and send where the wiper is. */
static void ds2890_step(struct sim_slave *slave, uint8_t code)
{
	struct ds2890 *s = slave->state;

	if (code == INCREMENT && s->position < UINT8_MAX)
		s->position++;
	if (code == DECREMENT && s->position > 0)
		s->position--;
	sim_send_byte(slave, s->position);
}

static void first_step(struct sim_slave *slave)
{
	ds2890_step(slave, slave->function->code);
}

/* Another step needs no ROM command. */
static void another_step(struct sim_slave *slave, uint8_t byte)
{
	if (byte == INCREMENT || byte == DECREMENT)
		ds2890_step(slave, byte);
	else
		sim_end(slave);
}

static const struct sim_function functions[] = {
	{.code = 0xF0, .start = read_position, .next = send_zero},
	{.code = WRITE_POSITION, .byte = ds2890_write, .next = sim_receive},
	{.code = 0xAA, .start = ds2890_read_control, .next = send_zero},
	{.code = 0x55, .byte = ds2890_write, .next = sim_receive},
	{.code = INCREMENT, .start = first_step, .byte = another_step, .next = sim_receive},
	{.code = DECREMENT, .start = first_step, .byte = another_step, .next = sim_receive},
	{0},
};

const struct sim_family sim_ds2890 = {
	.name = "DS2890",
	.code = 0x2C,
	.overdrive = true,
	.resume = true,
	.state_size = sizeof(struct ds2890),
	.functions = functions,
	.power_on = ds2890_power_on,
};
