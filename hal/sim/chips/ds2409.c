/* SPDX-License-Identifier: MIT */
/*
 * DS2409 (data sheet 102199, "MicroLAN Coupler"): two branches, of which one at most is on. What
 * the data sheet leaves open: an output is switched by the command, by Smart-On after its
 * confirmation; Smart-On of a branch that is short switches it on, and the whole wire is short
 * until the short is gone.
 */
#include "hal/base/time.h"
#include "hal/sim/branch.h"
#include "hal/sim/families.h"

/* Status control byte. */
enum { NO_WRITE = 0x18, MANUAL = 0x20, AUX_OR_ON = 0x40, DATA = 0x80 };
/* Status info byte; those of the auxiliary output are two bits above, its event flag one. */
enum { INACTIVE = 0x01, LEVEL = 0x02, EVENT = 0x10, CONTROL = 0x40, MODE = 0x80 };
enum { ALL_LINES_OFF = 0x66, SMART_ON_MAIN = 0xCC };

/* "The duration of the discharge time should be 100ms minimum". */
#define DISCHARGE_NS (100 * NS_PER_MS)

struct ds2409 {
	struct sim_branch branch[SIM_BRANCHES];
	bool manual, control; /* of the control output: mode, and its value or association */
	bool discharging;
	int64_t since; /* the discharge began */
	int64_t seen;  /* the inputs were followed up to this time */
};

static void ds2409_create(struct sim_slave *slave)
{
	slave->branches = sim_state(slave, ds2409)->branch;
	for (unsigned i = 0; i < SIM_BRANCHES; i++)
		slave->branches[i].coupler = slave;
}

static void branches_off(struct ds2409 *s)
{
	for (unsigned i = 0; i < SIM_BRANCHES; i++)
		s->branch[i].on = s->branch[i].event = false;
}

static void ds2409_power_on(struct sim_slave *slave)
{
	struct ds2409 *s = slave->state;

	branches_off(s);
	s->manual = s->control = s->discharging = false;
	s->seen = slave->now;
	for (unsigned i = 0; i < SIM_BRANCHES; i++) {
		s->branch[i].low = sim_input_now(slave, i) < 0.5;
		sim_branch_restart(&s->branch[i], slave->now);
	}
}

/* A branch that is off is watched for falling edges. */
static void ds2409_advance(struct sim_slave *slave)
{
	struct ds2409 *s = slave->state;

	for (unsigned i = 0; i < SIM_BRANCHES; i++) {
		struct sim_branch *branch = &s->branch[i];
		bool low = sim_input_now(slave, i) < 0.5;
		bool fell = (low && !branch->low) ||
		            sim_curve_falls(&slave->input[i], s->seen, slave->now);

		branch->low = low;
		branch->event |= fell && !branch->on && !s->discharging;
	}
	s->seen = slave->now;
}

static bool ds2409_alarm(struct sim_slave *slave)
{
	struct ds2409 *s = slave->state;

	ds2409_advance(slave);
	return s->branch[SIM_MAIN].event || s->branch[SIM_AUX].event;
}

static uint8_t ds2409_info(const struct ds2409 *s)
{
	uint8_t byte = (uint8_t)((s->manual ? MODE : 0) | (s->control ? CONTROL : 0));

	for (unsigned i = 0; i < SIM_BRANCHES; i++) {
		const struct sim_branch *branch = &s->branch[i];

		byte |= (uint8_t)((branch->on ? 0 : INACTIVE) << 2 * i);
		byte |= (uint8_t)((branch->low || s->discharging ? 0 : LEVEL) << 2 * i);
		byte |= (uint8_t)((branch->event ? EVENT : 0) << i);
	}
	return byte;
}

/* Any other command ends a discharge. */
static void end_discharge(struct ds2409 *s, int64_t t)
{
	for (unsigned i = 0; i < SIM_BRANCHES; i++) {
		if (s->discharging && t - s->since >= DISCHARGE_NS)
			sim_branch_restart(&s->branch[i], t);
	}
	s->discharging = false;
}

static void ds2409_status(struct sim_slave *slave)
{
	struct ds2409 *s = slave->state;
	uint8_t control = slave->taken[0], out[2];

	end_discharge(s, slave->now);
	if (!(control & NO_WRITE)) {
		s->manual = control & MANUAL;
		s->control = control & (s->manual ? DATA : AUX_OR_ON);
	}
	out[0] = out[1] = ds2409_info(s);
	sim_send(slave, out, 2);
}

static void confirm_code(struct sim_slave *slave)
{
	sim_send_byte(slave, slave->function->code);
}

static void all_lines_off(struct sim_slave *slave)
{
	struct ds2409 *s = slave->state;

	end_discharge(s, slave->now);
	branches_off(s);
	confirm_code(slave);
}

static void discharge(struct sim_slave *slave)
{
	struct ds2409 *s = slave->state;

	s->branch[SIM_MAIN].on = s->branch[SIM_AUX].on = false;
	if (!s->discharging)
		s->since = slave->now;
	s->discharging = true;
	confirm_code(slave);
}

static void switch_on(struct ds2409 *s, enum sim_branch_number number)
{
	s->branch[SIM_MAIN].on = number == SIM_MAIN;
	s->branch[SIM_AUX].on = number == SIM_AUX;
}

static void direct_on_main(struct sim_slave *slave)
{
	struct ds2409 *s = slave->state;

	end_discharge(s, slave->now);
	switch_on(s, SIM_MAIN);
	confirm_code(slave);
}

static enum sim_branch_number asked_branch(const struct sim_slave *slave)
{
	return slave->function->code == SMART_ON_MAIN ? SIM_MAIN : SIM_AUX;
}

/* The reset stimulus was sent: a reset on the output alone. A short looks like presence. */
static void smart_on(struct sim_slave *slave)
{
	struct ds2409 *s = slave->state;
	struct sim_branch *branch = &s->branch[asked_branch(slave)];
	uint8_t out[2] = {0x00, slave->function->code};

	end_discharge(s, slave->now);
	s->branch[SIM_MAIN].on = s->branch[SIM_AUX].on = false;
	if (!branch->low && !sim_branch_reset(branch, slave->now))
		out[0] = 0xFF;
	sim_send(slave, out, 2);
}

static void smart_on_confirmed(struct sim_slave *slave)
{
	switch_on(sim_state(slave, ds2409), asked_branch(slave));
}

static const struct sim_function functions[] = {
	{.code = 0x5A, .takes = 1, .start = ds2409_status},
	{.code = ALL_LINES_OFF, .start = all_lines_off},
	{.code = 0x99, .start = discharge},
	{.code = 0xA5, .start = direct_on_main},
	{.code = SMART_ON_MAIN, .takes = 1, .start = smart_on, .next = smart_on_confirmed},
	{.code = 0x33, .takes = 1, .start = smart_on, .next = smart_on_confirmed},
	{0},
};

/* What pulls a branch low from outside. */
static const struct sim_input inputs[] = {
	[SIM_MAIN] = {SIM_PIN("main")}, [SIM_AUX] = {SIM_PIN("aux")}, {0}};

const struct sim_family sim_ds2409 = {
	.name = "DS2409",
	.code = 0x1F,
	.state_size = sizeof(struct ds2409),
	.functions = functions,
	.inputs = inputs,
	.create = ds2409_create,
	.power_on = ds2409_power_on,
	.alarm = ds2409_alarm,
	.advance = ds2409_advance,
};
