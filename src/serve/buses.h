/* SPDX-License-Identifier: MIT */
/*
 * /bus.N over several targets: each bus of each target has one number for the life of owsd. Numbers
 * are given in the order of the targets that are up when clients first ask. When all numbers are
 * given, the numbers of targets that a reload removed are given again, the lowest first.
 */
#ifndef SERVE_BUSES_H
#define SERVE_BUSES_H

#include <stdbool.h>
#include <stdint.h>

#define BUSES_MAX 256
#define BUSES_NO_TARGET 255 /* a reload removed the target; no target has this index */

struct buses {
	unsigned count;
	struct {
		uint8_t target;
		uint16_t number; /* the number that the target itself has for the bus */
	} bus[BUSES_MAX];
};

/* The number of a target's bus; gives it one if it has none. -1: all numbers are in use. */
int buses_number(struct buses *buses, unsigned target, unsigned number);
/*
 * After a reload: target i was target ports[i] before, or is new where that is -1. All numbers
 * stay, also those of removed targets.
 */
void buses_renumber(struct buses *buses, const int *ports, unsigned count);
/* The N of a name "bus.N", -1: the name has another form. */
int buses_parse(const char *name, unsigned len);

#endif
