/* SPDX-License-Identifier: MIT */
/*
 * /bus.N over several targets: each bus of each target has one number for the life of owsd, in the
 * order of the targets as far as they are up when clients first ask. When all numbers are given,
 * those of targets that a reload took away are given again, the lowest first.
 */
#ifndef SERVE_BUSES_H
#define SERVE_BUSES_H

#include <stdbool.h>
#include <stdint.h>

#define BUSES_MAX 256
#define BUSES_NO_TARGET 255 /* it went; no target has this index */

struct buses {
	unsigned count;
	struct {
		uint8_t target;
		uint16_t number; /* as that target counts */
	} bus[BUSES_MAX];
};

/* The number of a target's bus, given now if need be; -1: all are those of targets that are there. */
int buses_number(struct buses *buses, unsigned target, unsigned number);
/* After a reload: target i is what ports[i] was, -1 a new one. Numbers stay, also of those that went. */
void buses_renumber(struct buses *buses, const int *ports, unsigned count);
/* N of a name "bus.N", -1: it is none. */
int buses_parse(const char *name, unsigned len);

#endif
