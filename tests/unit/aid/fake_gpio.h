/* SPDX-License-Identifier: MIT */
/*
 * One GPIO chip, "/dev/gpiochip0" labelled "fake", in place of libgpiod. As with the kernel: a
 * line is one holder's, an input keeps GPIO_EDGES_KEPT edges and loses what comes then.
 */
#ifndef TESTS_UNIT_AID_FAKE_GPIO_H
#define TESTS_UNIT_AID_FAKE_GPIO_H

#include "hal/gpio/line.h"

#define FAKE_LINES 8

struct fake_line {
	char name[GPIO_NAME_MAX];
	char consumer[GPIO_NAME_MAX]; /* "": free */
	bool high;                    /* the wire's level */
	struct gpio_setup setup;      /* of the last request */
	bool held;                    /* by the code under test */
	unsigned requests, sets;
	struct gpio_edge kept[GPIO_EDGES_KEPT];
	unsigned edges;
};

struct fake_gpio {
	struct fake_line line[FAKE_LINES];
	int open_err;  /* of the chip */
	bool gone;     /* unplugged: everything gives -ENODEV */
	unsigned open; /* chips open now */
	/* Called after a line was driven, by set or by request. */
	void (*driven)(unsigned line, bool high);
};
extern struct fake_gpio fake_gpio;

/* All lines low, free, without a name; libgpiod's place is taken. */
void fake_gpio_begin(void);
/* Everything was given back? Then libgpiod has its place again. */
void fake_gpio_end(void);
/* The wire of a line changes at that time. */
void fake_gpio_level(unsigned line, bool high, int64_t at_ns);

#endif
