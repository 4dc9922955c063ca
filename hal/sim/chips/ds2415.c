/* SPDX-License-Identifier: MIT */
/*
 * DS2415, DS1904 (data sheet, "1-Wire Time Chip") and DS2417: a counter of seconds with its own
 * supply, and a control byte. The DS2417's interrupt pin is not on the wire.
 */
#include <errno.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/families.h"

enum { OSC = 0x0C };

struct ds2415 {
	uint8_t control;
	uint32_t seconds;
	int64_t seen, part; /* ns since the last second */
	unsigned at;        /* of the control byte and the four of the counter */
};

/* Both bits make the oscillator run. */
static void ds2415_advance(struct sim_slave *slave)
{
	struct ds2415 *s = slave->state;

	if ((s->control & OSC) == OSC) {
		s->part += slave->now - s->seen;
		s->seconds += (uint32_t)(s->part / NS_PER_S);
		s->part %= NS_PER_S;
	}
	s->seen = slave->now;
}

/* Send the control byte and the counter as it is now, again and again. */
static void ds2415_send(struct sim_slave *slave)
{
	const struct ds2415 *s = slave->state;
	uint8_t out[5] = {s->control};

	for (unsigned i = 0; i < 4; i++)
		out[1 + i] = (uint8_t)(s->seconds >> (8 * i));
	sim_send(slave, out, sizeof(out));
}

static void ds2415_begin_write(struct sim_slave *slave)
{
	sim_state(slave, ds2415)->at = 0;
}

/*
 * The control byte counts at once. A byte of the counter does too, where the data sheet waits for
 * the reset.
 */
static void ds2415_write(struct sim_slave *slave, uint8_t byte)
{
	struct ds2415 *s = slave->state;
	unsigned at = s->at++;

	if (at == 0) {
		s->control = byte & 0xFC;
	} else if (at <= 4) {
		s->seconds &= ~(0xFFu << (8 * (at - 1)));
		s->seconds |= (uint32_t)byte << (8 * (at - 1));
		s->part = 0;
	} else {
		sim_end(slave);
	}
}

static int ds2415_option(struct sim_slave *slave, const char *name, double value)
{
	struct ds2415 *s = slave->state;

	if (strcmp(name, "seconds") == 0) {
		if (value < 0 || value > UINT32_MAX)
			return -ERANGE;
		s->seconds = (uint32_t)value;
	} else if (strcmp(name, "control") == 0) {
		if (value < 0 || value > 0xFC)
			return -ERANGE;
		s->control = (uint8_t)value & 0xFC;
	} else {
		return -ENOENT;
	}
	return 0;
}

static const struct sim_function functions[] = {
	{.code = 0x66, .start = ds2415_send, .next = ds2415_send}, /* Read Clock, Write Clock */
	{.code = 0x99, .start = ds2415_begin_write, .byte = ds2415_write},
	{0},
};

#define CLOCK(part, family) \
	.name = (part), .code = (family), .state_size = sizeof(struct ds2415), \
	.functions = functions, .advance = ds2415_advance, .option = ds2415_option

const struct sim_family sim_ds2415 = {CLOCK("DS2415", 0x24)};
const struct sim_family sim_ds2417 = {CLOCK("DS2417", 0x27)};
