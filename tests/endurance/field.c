/* SPDX-License-Identifier: MIT */
/* The devices of the simulated field, and their true values at each time. */
#include <math.h>
#include <string.h>

#include "tests/endurance/field.h"

#define TWO_PI 6.28318530717958647692
#define NEAR 0.15 /* the coarsest resolution here, and half of it */
#define LOOKS 8

struct field_truth field;

void field_begin(int64_t now_ns)
{
	static const struct field_device devices[] = {
		{.id = "28.0000000000B1", .name = "boiler", .mean = 60, .swing = 6, .span_s = 7200},
		/* through 85, the power-on value */
		{.id = "28.0000000000B2", .name = "hot", .mean = 82, .swing = 8, .span_s = 10800},
		{.id = "28.0000000000A3",
	         .name = "outside",
	         .mean = 8,
	         .swing = 12,
	         .span_s = 86400},
		{.id = "29.000000000001", .name = "board", .is_switch = true},
	};

	memset(&field, 0, sizeof(field));
	field.start_ns = now_ns;
	field.devices = sizeof(devices) / sizeof(devices[0]);
	memcpy(field.device, devices, sizeof(devices));
	for (unsigned i = 0; i < FIELD_PINS; i++) {
		field.inputs[i].pins = 0xf;
		field.inputs[i].since_ns = now_ns;
	}
}

double field_temperature(unsigned device, int64_t ns)
{
	const struct field_device *d = &field.device[device];
	int64_t span = d->span_s * FIELD_S;

	if (!span)
		return d->mean;
	return d->mean +
	       d->swing * sin(TWO_PI * (double)((ns - field.start_ns) % span) / (double)span);
}

unsigned field_pins(void)
{
	return field.inputs[0].pins;
}

void field_set_pins(unsigned pins, int64_t now_ns)
{
	memmove(field.inputs + 1, field.inputs, sizeof(field.inputs) - sizeof(field.inputs[0]));
	field.inputs[0].pins = pins;
	field.inputs[0].since_ns = now_ns;
}

/* Slow enough that it passes nothing between two looks. */
bool field_was_temperature(unsigned device, double value, int64_t from, int64_t to)
{
	double low = 1e9, high = -1e9;

	for (int i = 0; i <= LOOKS; i++) {
		double at = field_temperature(device, from + (to - from) / LOOKS * i);

		low = at < low ? at : low;
		high = at > high ? at : high;
	}
	return value > low - NEAR && value < high + NEAR;
}

bool field_was_pins(unsigned pins, int64_t from, int64_t to)
{
	for (unsigned i = 0; i < FIELD_PINS; i++) {
		bool begun = field.inputs[i].since_ns <= to;
		bool over = i > 0 && field.inputs[i - 1].since_ns < from;

		if (over)
			return false;
		if (begun && field.inputs[i].pins == pins)
			return true;
	}
	return false;
}

int field_find(const char *id)
{
	for (unsigned i = 0; i < field.devices; i++)
		if (strncmp(field.device[i].id, id, strlen(field.device[i].id)) == 0)
			return (int)i;
	return -1;
}

int field_switch(void)
{
	for (unsigned i = 0; i < field.devices; i++)
		if (field.device[i].is_switch)
			return (int)i;
	return -1;
}
