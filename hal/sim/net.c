/* SPDX-License-Identifier: MIT */
/* The simulated network: its chips, wires and slaves, run up to a time with their events. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/net.h"

#define PAUSE_NS (10 * NS_PER_MS) /* a pause is at least so long */

void sim_net_init(struct sim_net *net)
{
	*net = (struct sim_net){
		.hz = 100000, .combine = SIM_ANY_MESSAGES, .max_messages = 42, .plugged = true};
}

void sim_net_clear(struct sim_net *net)
{
	for (unsigned i = 0; i < net->chips; i++)
		sim_chip_clear(&net->chip[i]);
	free(net->event);
	sim_net_init(net);
}

int sim_net_add_chip(struct sim_net *net, enum sim_part part, uint8_t address)
{
	if (net->chips == SIM_MAX_CHIPS)
		return -ENOSPC;
	for (unsigned i = 0; i < net->chips; i++) {
		if (net->chip[i].address == address)
			return -EEXIST;
	}
	sim_chip_init(&net->chip[net->chips++], part, address);
	return 0;
}

int sim_net_add_slave(struct sim_net *net, unsigned chip, unsigned channel, struct sim_slave *slave)
{
	slave->chip = chip;
	slave->channel = channel;
	return sim_wire_add(&net->chip[chip].wire[channel], slave);
}

int sim_net_add_event(struct sim_net *net, const struct sim_event *event)
{
	struct sim_event *events;

	/* take the place of an event that is over: a simulation of weeks has many */
	for (size_t i = 0; i < net->events; i++) {
		if (net->event[i].done) {
			net->event[i] = *event;
			return 0;
		}
	}
	events = realloc(net->event, (net->events + 1) * sizeof(*events));
	if (!events)
		return -ENOMEM;
	net->event = events;
	net->event[net->events++] = *event;
	return 0;
}

/* The i-th slave of all; NULL after the last. */
static struct sim_slave *slave_at(const struct sim_net *net, size_t i)
{
	for (unsigned chip = 0; chip < net->chips; chip++) {
		for (unsigned channel = 0; channel < net->chip[chip].channels; channel++) {
			const struct sim_wire *wire = &net->chip[chip].wire[channel];

			if (i < wire->count)
				return wire->slaves[i];
			i -= wire->count;
		}
	}
	return NULL;
}

struct sim_slave *sim_net_slave(const struct sim_net *net, const char *name)
{
	struct sim_slave *slave;

	for (size_t i = 0; (slave = slave_at(net, i)); i++) {
		if (strcmp(slave->name, name) == 0)
			return slave;
	}
	return NULL;
}

void sim_net_start(struct sim_net *net, int64_t now)
{
	struct sim_slave *slave;

	if (net->started)
		return;
	net->started = true;
	net->epoch = now;
	for (size_t i = 0; (slave = slave_at(net, i)); i++)
		sim_slave_power_on(slave, 0);
}

static void set_input(struct sim_slave *slave, unsigned input, struct sim_curve curve, int64_t t)
{
	sim_slave_advance(slave, t);
	curve.start_ns += t;
	slave->input[input] = curve;
	sim_slave_advance(slave, t);
}

static void apply_event(struct sim_net *net, const struct sim_event *event, int64_t t)
{
	struct sim_chip *chip = &net->chip[event->chip];
	struct sim_wire *wire = &chip->wire[event->channel];
	struct sim_slave *slave = event->slave;

	switch (event->what) {
	case SIM_SET:
		set_input(slave, event->input, event->curve, t);
		break;
	case SIM_PLUG:
		sim_wire_plug(wire, slave, event->on, t);
		break;
	case SIM_BROWNOUT:
		sim_slave_brownout(slave, t);
		break;
	case SIM_CORRUPT:
		slave->corrupt_every = event->on ? event->each : 0;
		slave->corrupt_probability = event->on ? event->probability : 0;
		slave->corrupt_random = event->seed;
		slave->calls = 0;
		break;
	case SIM_SHORT:
		wire->shorted = event->on;
		break;
	case SIM_STICK:
		chip->stuck = event->on ? SIM_STUCK : SIM_FREE;
		break;
	case SIM_JAM:
		chip->stuck = event->on ? SIM_STUCK_FAST : SIM_FREE;
		break;
	case SIM_CHIP_RESET:
		sim_chip_power_on(chip, t);
		break;
	case SIM_CHIP_SLEEP:
		chip->asleep = event->on;
		break;
	case SIM_REFUSE:
		net->refuse_address[event->chip].each = event->on ? event->each : 0;
		break;
	case SIM_REFUSE_DATA:
		net->refuse_data[event->chip].each = event->on ? event->each : 0;
		break;
	case SIM_ADAPTER:
		net->plugged = event->on;
		break;
	}
}

void sim_net_apply(struct sim_net *net, const struct sim_event *event)
{
	apply_event(net, event, net->time);
}

bool sim_net_lasts(const struct sim_net *net, const struct sim_event *event)
{
	const struct sim_slave *slave = event->slave;

	if (event->what == SIM_PLUG)
		return !slave->plugged;
	if (event->what == SIM_CORRUPT)
		return slave->corrupt_every || slave->corrupt_probability > 0;
	return event->what == SIM_SHORT && net->chip[event->chip].wire[event->channel].shorted;
}

static struct sim_event *next_event(const struct sim_net *net)
{
	struct sim_event *next = NULL;

	for (size_t i = 0; i < net->events; i++) {
		struct sim_event *event = &net->event[i];

		if (!event->done && (!next || event->at_ns < next->at_ns))
			next = event;
	}
	return next;
}

static void run_chips(struct sim_net *net, int64_t t)
{
	for (unsigned i = 0; i < net->chips; i++)
		sim_chip_run(&net->chip[i], t);
}

/*
 * After a pause, skip all but the last times of repeating events: those of a day in which the
 * machine slept would block the caller for too long.
 */
static void skip_repeats(struct sim_net *net, int64_t t)
{
	int64_t repeats = 0, keep;

	for (size_t i = 0; i < net->events; i++)
		repeats += !net->event[i].done && net->event[i].every_ns > 0;
	keep = repeats < SIM_CATCH_UP ? SIM_CATCH_UP / (repeats ? repeats : 1) : 1;
	for (size_t i = 0; i < net->events; i++) {
		struct sim_event *event = &net->event[i];
		int64_t due;

		if (event->done || event->every_ns <= 0 || event->at_ns > t)
			continue;
		due = (t - event->at_ns) / event->every_ns + 1;
		if (due > keep)
			event->at_ns += (due - keep) * event->every_ns;
	}
}

/* Each chip is run up to an event before it is applied: a slot sees the network as it was then. */
void sim_net_run(struct sim_net *net, int64_t now)
{
	struct sim_event *event;
	int64_t t;

	sim_net_start(net, now);
	t = now - net->epoch;
	if (t < net->time)
		t = net->time;
	if (t - net->time > PAUSE_NS)
		skip_repeats(net, t);
	while ((event = next_event(net)) && event->at_ns <= t) {
		run_chips(net, event->at_ns);
		apply_event(net, event, event->at_ns);
		if (event->every_ns > 0)
			event->at_ns += event->every_ns;
		else
			event->done = true;
	}
	net->time = t;
	run_chips(net, t);
}

int64_t sim_net_next(const struct sim_net *net)
{
	const struct sim_event *event = next_event(net);

	return event ? net->epoch + event->at_ns : INT64_MAX;
}

static bool is_refused(struct refusal *refusal)
{
	return refusal->each && ++refusal->count % refusal->each == 0;
}

bool sim_i2c_start(struct sim_net *net, uint8_t address, bool read, int64_t now)
{
	sim_net_run(net, now);
	net->selected = NULL;
	if (!net->plugged)
		return false;
	for (unsigned i = 0; i < net->chips; i++) {
		if (net->chip[i].address != address)
			continue;
		if (is_refused(&net->refuse_address[i]))
			return false;
		if (!sim_chip_start(&net->chip[i], read, net->time))
			return false;
		net->selected = &net->chip[i];
		return true;
	}
	return false;
}

bool sim_i2c_write(struct sim_net *net, uint8_t byte, int64_t now)
{
	sim_net_run(net, now);
	if (!net->selected || !net->plugged ||
	    is_refused(&net->refuse_data[net->selected - net->chip]))
		return false;
	return sim_chip_write(net->selected, byte, net->time);
}

uint8_t sim_i2c_read(struct sim_net *net, int64_t now)
{
	sim_net_run(net, now);
	if (!net->selected || !net->plugged)
		return 0xFF;
	return sim_chip_read(net->selected, net->time);
}
