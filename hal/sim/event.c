/* SPDX-License-Identifier: MIT */
/* Events of a simulated network: parses a line of a scenario, and carries events out. */
#include "hal/sim/event.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static struct sim_slave *parse_device(const struct sim_net *net, struct words *words,
                                      struct sim_event *event)
{
	if (!words_next(words)) {
		words_fail(words, "expected the name of a device");
		return NULL;
	}
	event->slave = sim_net_slave(net, words->word);
	if (!event->slave) {
		words_fail(words, "there is no device \"%s\"", words->word);
		return NULL;
	}
	event->chip = event->slave->chip;
	event->channel = event->slave->channel;
	return event->slave;
}

/* Parse "0x18", or with a channel "0x18.3". */
static void parse_chip(const struct sim_net *net, struct words *words, struct sim_event *event)
{
	char *end;
	unsigned long address;

	words_next(words);
	address = strtoul(words->word, &end, 16);
	for (event->chip = 0; event->chip < net->chips; event->chip++) {
		const struct sim_chip *found = &net->chip[event->chip];

		if (found->address != address)
			continue;
		if (!*end)
			return;
		if (end[0] != '.' || end[1] < '0' || end[1] >= '0' + (int)found->channels || end[2])
			words_fail(words, "\"%s\": the chip has the channels 0 to %u", words->word,
			           found->channels - 1);
		else
			event->channel = (unsigned)(end[1] - '0');
		return;
	}
	words_fail(words, "\"%s\": expected the address of a chip, as 0x18", words->word);
}

static void corruption(struct words *words, struct sim_event *event)
{
	if (words_take(words, "each"))
		event->each = (uint32_t)words_number(words, "the count", 1, 1e9);
	else if (words_take(words, "chance"))
		event->probability = words_number(words, "the chance", 0, 1);
	else if (event->on)
		event->each = 1;
	event->seed = 1;
	if (words_take(words, "seed"))
		event->seed = (uint64_t)words_number(words, "the seed", 1, 4e9);
}

static void parse_input(const struct sim_net *net, struct words *words, struct sim_event *event)
{
	int found;

	if (!parse_device(net, words, event))
		return;
	words_next(words);
	found = sim_slave_input(event->slave, words->word);
	if (found < 0) {
		words_fail(words, "a %s has no input \"%s\"", event->slave->family->name,
		           words->word);
		return;
	}
	event->input = (unsigned)found;
	event->curve = words_curve(words, &event->slave->family->inputs[found]);
}

/* One row serves "unplug", "end unplug" and "unplug ... for": the flag is turned over. */
static const struct {
	const char *name;
	enum sim_what what;
	bool on;   /* the event's flag when it begins */
	bool once; /* the event has no end */
} events[] = {
	{"set", SIM_SET, true, true},          {"unplug", SIM_PLUG, false, false},
	{"plug", SIM_PLUG, true, true},        {"brownout", SIM_BROWNOUT, true, true},
	{"corrupt", SIM_CORRUPT, true, false}, {"short", SIM_SHORT, true, false},
	{"stick", SIM_STICK, true, false},     {"jam", SIM_JAM, true, false},
	{"reset", SIM_CHIP_RESET, true, true}, {"sleep", SIM_CHIP_SLEEP, true, false},
	{"refuse", SIM_REFUSE, true, false},   {"refuse-data", SIM_REFUSE_DATA, true, false},
	{"remove", SIM_ADAPTER, false, false},
};

static void operands(const struct sim_net *net, struct words *words, struct sim_event *event)
{
	switch (event->what) {
	case SIM_SET:
		parse_input(net, words, event);
		break;
	case SIM_PLUG:
	case SIM_BROWNOUT:
		parse_device(net, words, event);
		break;
	case SIM_CORRUPT:
		parse_device(net, words, event);
		corruption(words, event);
		break;
	case SIM_SHORT:
	case SIM_STICK:
	case SIM_JAM:
	case SIM_CHIP_RESET:
	case SIM_CHIP_SLEEP:
		parse_chip(net, words, event);
		break;
	case SIM_REFUSE:
	case SIM_REFUSE_DATA:
		parse_chip(net, words, event);
		event->each = 1;
		if (words_take(words, "each"))
			event->each = (uint32_t)words_number(words, "the count", 1, 1e9);
		break;
	case SIM_ADAPTER:
		if (!words_take(words, "adapter")) {
			words_next(words);
			words_fail(words, "\"%s\": expected adapter", words->word);
		}
		break;
	}
}

unsigned event_parse(const struct sim_net *net, struct words *words, struct sim_event event[2])
{
	bool end = words_take(words, "end");
	size_t i = 0, count = sizeof(events) / sizeof(events[0]);
	unsigned n = 1;

	words_next(words);
	while (i < count && strcmp(words->word, events[i].name) != 0)
		i++;
	if (i == count || (end && events[i].once)) {
		words_fail(words,
		           "\"%s\": expected set, unplug, plug, brownout, corrupt, short, "
		           "stick, jam, reset, sleep, refuse, refuse-data or remove",
		           words->word);
		return 0;
	}
	event[0] = (struct sim_event){.what = events[i].what, .on = events[i].on ^ end};
	operands(net, words, &event[0]);
	if (!end && !events[i].once && words_take(words, "for")) {
		event[1] = event[0];
		event[1].on = !event[0].on;
		event[1].at_ns = words_time(words, "a duration");
		n = 2;
	}
	words_end(words);
	return words->failed ? 0 : n;
}

bool event_is_held(const struct sim_event *event)
{
	if (event->what == SIM_PLUG)
		return !event->on;
	return event->on && (event->what == SIM_CORRUPT || event->what == SIM_SHORT);
}

int sim_scenario_event(struct sim_net *net, const char *line, int64_t now, char *why,
                       size_t why_size)
{
	struct sim_event event[2] = {{0}};
	struct words words;
	unsigned n;

	sim_net_run(net, now);
	words_init(&words, "event", 1, line, why, why_size);
	n = event_parse(net, &words, event);
	if (n == 0)
		return -EINVAL;
	for (unsigned i = 0; i < n; i++) {
		event[i].at_ns += net->time;
		if (sim_net_add_event(net, &event[i]))
			return -ENOMEM;
	}
	sim_net_run(net, now);
	return 0;
}
