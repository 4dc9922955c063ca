/* SPDX-License-Identifier: MIT */
/*
 * What there is in truth: devices, what they measure over time, how their pins are. Each part of
 * a world shows it in its way, and what the engine publishes is compared with it.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#define FIELD_DEVICES 6
#define FIELD_PINS 16
#define FIELD_MS INT64_C(1000000)
#define FIELD_S INT64_C(1000000000)

struct field_device {
	const char *id;     /* "28.0000000000B1" */
	const char *name;   /* "boiler" */
	double mean, swing; /* of a sine */
	int64_t span_s;     /* 0: it always measures mean */
	bool is_switch;
	bool away;     /* on no wire */
	unsigned wire; /* on this one */
};

struct field_truth {
	struct field_device device[FIELD_DEVICES];
	unsigned devices;
	int64_t start_ns;
	/* The inputs of the switch, four bits, the latest first, and since when they are so. */
	struct {
		int64_t since_ns;
		unsigned pins;
	} inputs[FIELD_PINS];
};

extern struct field_truth field;

/* The devices of all worlds but one; the time is that of the world's clock. */
void field_begin(int64_t now_ns);
double field_temperature(unsigned device, int64_t ns);
unsigned field_pins(void);
void field_set_pins(unsigned pins, int64_t now_ns);
/* Did the device measure this at any time from `from` to `to`? */
bool field_was_temperature(unsigned device, double value, int64_t from, int64_t to);
bool field_was_pins(unsigned pins, int64_t from, int64_t to);
/* -1: no device of this id. */
int field_find(const char *id);
int field_switch(void);
