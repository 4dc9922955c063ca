/* SPDX-License-Identifier: MIT */
/*
 * One GPIO chip, "/dev/gpiochip0" labelled "fake", in place of libgpiod. As with the kernel, a line
 * has one holder, and an input keeps GPIO_EDGES_KEPT edges and loses later ones.
 */
#pragma once

#include "hal/gpio/line.h"

#define FAKE_LINES 8

struct fake_line {
	char name[GPIO_NAME_MAX];
	char consumer[GPIO_NAME_MAX]; /* "": the line is free */
	bool high;                    /* the level on the wire */
	struct gpio_setup setup;      /* of the last request */
	bool held;                    /* the code under test holds the line */
	unsigned requests, sets;
	struct gpio_edge kept[GPIO_EDGES_KEPT];
	unsigned edges;
};

struct fake_gpio {
	struct fake_line line[FAKE_LINES];
	int open_err;  /* the error of opening the chip */
	bool gone;     /* unplugged: every call returns -ENODEV */
	unsigned open; /* how many times the chip is open now */
	/* Called after a line was driven, by set or by request. */
	void (*driven)(unsigned line, bool high);
};
extern struct fake_gpio fake_gpio;

/* All lines are low, free and without a name; the fake takes the place of libgpiod. */
void fake_gpio_begin(void);
/* Check that the code under test gave everything back, and give libgpiod its place back. */
void fake_gpio_end(void);
/* Change the level on the wire of a line at that time. */
void fake_gpio_level(unsigned line, bool high, int64_t at_ns);
