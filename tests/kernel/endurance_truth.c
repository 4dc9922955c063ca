/* SPDX-License-Identifier: MIT */
/* The true values of the simulated devices in the guest, over time. */
#include <stdio.h>
#include <string.h>

#include "tests/kernel/control.h"
#include "tests/kernel/endurance.h"

#define KEPT 64 /* the last changes of each input */
/* Values differ from one another for as long as any reading of them may be about */
#define STEPS 400

const char *const signal_names[SIGNALS] = {
	[WARM] = "warm", [COLD] = "cold", [FAR] = "far",
	[AIR] = "air",   [PINS] = "pins", [RELAYS] = "relays",
};

struct change {
	int64_t before_ns, after_ns; /* it came between these */
	double value;
};

/* The upper four pins are inputs, the lower four outputs. */
static struct change history[INPUTS][KEPT];
static unsigned changes[INPUTS];
static struct change outputs[KEPT];
static unsigned output_changes;

static void note(struct change *list, unsigned *count, double value, int64_t before_ns)
{
	list[*count % KEPT] = (struct change){before_ns, ows_now(), value};
	(*count)++;
}

bool sim_tell(const char *event)
{
	char line[128];
	char *words[1] = {line};

	snprintf(line, sizeof(line), "%s", event);
	return control_tell(1, words) == 0;
}

void truth_change(int input)
{
	unsigned step = changes[input];
	int64_t before = ows_now();
	bool told = true;
	double value;
	char line[128];

	if (input == PINS) {
		value = (step * 7 + 5) % 16; /* of pins 4 to 7 */
		for (unsigned pin = 0; pin < 4; pin++) {
			snprintf(line, sizeof(line), "set board pin.%u %u", pin + 4,
			         (unsigned)value >> pin & 1);
			told &= sim_tell(line);
		}
	} else {
		value = -20 + input * 13.5 + step % STEPS * 0.125;
		snprintf(line, sizeof(line), "set %s temperature %g", signal_names[input], value);
		told = sim_tell(line);
	}
	if (!told)
		violated("the chip cannot be told another value of %s", signal_names[input]);
	note(history[input], &changes[input], value, before);
}

void truth_relays(unsigned pins)
{
	note(outputs, &output_changes, pins, ows_now());
}

/* Was it in force at some time between? The pins change one after another. */
static bool in_force(const struct change *list, unsigned count, double value, int64_t from_ns,
                     int64_t until_ns)
{
	for (unsigned i = count; i-- > 0 && count - i < KEPT;) {
		const struct change *c = &list[i % KEPT];
		int64_t ended = i + 1 < count ? list[(i + 1) % KEPT].after_ns : INT64_MAX;

		if (c->value == value && c->before_ns <= until_ns && ended >= from_ns)
			return true;
	}
	return false;
}

static bool changing(const struct change *list, unsigned count, int64_t from_ns, int64_t until_ns)
{
	for (unsigned i = count; i-- > 0 && count - i < KEPT;)
		if (list[i % KEPT].before_ns <= until_ns && list[i % KEPT].after_ns >= from_ns)
			return true;
	return false;
}

bool truth_between(int input, double value, int64_t from_ns, int64_t until_ns)
{
	unsigned low = ~(unsigned)value & 0xf;

	if (input != PINS)
		return in_force(history[input], changes[input], value, from_ns, until_ns);
	if (!changing(history[PINS], changes[PINS], from_ns, until_ns) &&
	    !in_force(history[PINS], changes[PINS], (unsigned)value >> 4, from_ns, until_ns))
		return false;
	/* After a restart of the board no transistor conducts; a command may take its time */
	return low == 0 || in_force(outputs, output_changes, low, from_ns - 60 * SECOND, until_ns);
}

void truth_explain(int input)
{
	int64_t now = ows_now();

	for (unsigned i = changes[input], n = 0; i-- > 0 && n < 4; n++) {
		const struct change *c = &history[input][i % KEPT];

		remark("%s was set to %g between %.3f s and %.3f s ago", signal_names[input],
		       c->value, (double)(now - c->before_ns) / 1e9,
		       (double)(now - c->after_ns) / 1e9);
	}
}

bool truth_now(int input, double value)
{
	double there = history[input][(changes[input] - 1) % KEPT].value;

	if (input != PINS)
		return value == there;
	return (unsigned)value >> 4 == (unsigned)there &&
	       (~(unsigned)value & 0xf) == (unsigned)outputs[(output_changes - 1) % KEPT].value;
}
