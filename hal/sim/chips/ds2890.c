/* SPDX-License-Identifier: MIT */
/* DS2890 (data sheet, "1-Wire Digital Potentiometer"): a wiper of 256 positions, a charge pump. */
#include "hal/sim/families.h"

enum { FEATURES = 0xF3, CONTROL = 0x0C, CHARGE_PUMP = 0x40 };
enum { WRITE_POSITION = 0x0F, RELEASE = 0x96, INCREMENT = 0xC3, DECREMENT = 0x99 };

struct ds2890 {
	uint8_t position, control;
	uint8_t fresh; /* was sent back, takes effect with the release code */
	bool asked;
};

static struct ds2890 *ds2890_state(struct sim_slave *slave)
{
	return sim_state(slave, ds2890);
}

static void ds2890_power_on(struct sim_slave *slave, int64_t t)
{
	(void)t;
	*ds2890_state(slave) = (struct ds2890){.control = CONTROL};
}

/* Send control register and position, */
static void read_position(struct sim_slave *slave, int64_t t)
{
	const struct ds2890 *s = ds2890_state(slave);
	const uint8_t out[2] = {s->control, s->position};

	(void)t;
	sim_send(slave, out, sizeof(out));
}

/* or the features and the control register, */
static void read_control(struct sim_slave *slave, int64_t t)
{
	const uint8_t out[2] = {FEATURES, ds2890_state(slave)->control};

	(void)t;
	sim_send(slave, out, sizeof(out));
}

/* and zeros after them. */
static void send_zero(struct sim_slave *slave, int64_t t)
{
	(void)t;
	sim_send_byte(slave, 0);
}

static void ds2890_begin_write(struct sim_slave *slave, int64_t t)
{
	(void)t;
	ds2890_state(slave)->asked = false;
}

/* Send the byte back; it takes effect when the release code follows. */
static void ds2890_write(struct sim_slave *slave, uint8_t byte, int64_t t)
{
	struct ds2890 *s = ds2890_state(slave);
	bool is_position = slave->function->code == WRITE_POSITION;

	(void)t;
	if (!s->asked) {
		s->fresh = byte;
		s->asked = true;
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

static void ds2890_receive(struct sim_slave *slave, int64_t t)
{
	(void)t;
	sim_receive(slave);
}

/* Move one step, not beyond the end, and send where the wiper is. */
static void ds2890_step(struct sim_slave *slave, uint8_t code)
{
	struct ds2890 *s = ds2890_state(slave);

	if (code == INCREMENT && s->position < UINT8_MAX)
		s->position++;
	if (code == DECREMENT && s->position > 0)
		s->position--;
	sim_send_byte(slave, s->position);
}

static void first_step(struct sim_slave *slave, int64_t t)
{
	(void)t;
	ds2890_step(slave, slave->function->code);
}

/* Another step needs no ROM command. */
static void another_step(struct sim_slave *slave, uint8_t byte, int64_t t)
{
	(void)t;
	if (byte == INCREMENT || byte == DECREMENT)
		ds2890_step(slave, byte);
	else
		sim_end(slave);
}

static const struct sim_function functions[] = {
	{.code = 0xF0, .start = read_position, .next = send_zero},
	{.code = WRITE_POSITION,
         .start = ds2890_begin_write,
         .byte = ds2890_write,
         .next = ds2890_receive},
	{.code = 0xAA, .start = read_control, .next = send_zero},
	{.code = 0x55, .start = ds2890_begin_write, .byte = ds2890_write, .next = ds2890_receive},
	{.code = INCREMENT, .start = first_step, .byte = another_step, .next = ds2890_receive},
	{.code = DECREMENT, .start = first_step, .byte = another_step, .next = ds2890_receive},
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
