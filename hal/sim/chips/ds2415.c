/* SPDX-License-Identifier: MIT */
/*
 * DS2415, DS1904 (data sheet, "1-Wire Time Chip") and DS2417: a counter of seconds with its own
 * supply, and a control byte. The DS2417's interrupt pin is not on the wire.
 */

#include "hal/base/time.h"
#include "hal/sim/families.h"

enum { OSC = 0x0C };

struct ds2415 {
	uint8_t control;
	uint32_t seconds;
	int64_t seen, part; /* ns since the last second */
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

	sim_put(out + 1, 4, s->seconds);
	sim_send(slave, out, sizeof(out));
}

/*
 * The control byte counts at once. A byte of the counter does too, where the data sheet waits for
 * the reset.
 */
static void ds2415_write(struct sim_slave *slave, uint8_t byte)
{
	struct ds2415 *s = slave->state;
	unsigned at = slave->address++;

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

static void set_seconds(struct sim_slave *slave, int64_t seconds)
{
	sim_state(slave, ds2415)->seconds = (uint32_t)seconds;
}

static void set_control(struct sim_slave *slave, int64_t control)
{
	sim_state(slave, ds2415)->control = (uint8_t)control & 0xFC;
}

static const struct sim_option options[] = {{"seconds", 0, UINT32_MAX, .set = set_seconds},
                                            {"control", 0, 0xFC, .set = set_control},
                                            {0}};

static const struct sim_function functions[] = {
	{.code = 0x66, .start = ds2415_send, .next = ds2415_send}, /* Read Clock, Write Clock */
	{.code = 0x99, .byte = ds2415_write},
	{0},
};

#define CLOCK(part, family) \
	.name = (part), .code = (family), .state_size = sizeof(struct ds2415), \
	.functions = functions, .advance = ds2415_advance, .options = options

const struct sim_family sim_ds2415 = {CLOCK("DS2415", 0x24)};
const struct sim_family sim_ds2417 = {CLOCK("DS2417", 0x27)};
