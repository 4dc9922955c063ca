/* SPDX-License-Identifier: MIT */
/*
 * Thermometers that are asked for without pause: each again as soon as it was answered. Their
 * temperature climbs all the time, so a value tells when the chip took it. Each answer is an error,
 * or the value of the moment that it states.
 */
#pragma once

#include "tests/unit/aid/native_scene.h"

#define FLEET_MAX 100

extern struct fleet {
	struct sim_slave *slave[FLEET_MAX];
	unsigned count;
	int64_t pause_ns[FLEET_MAX];    /* between an answer and the next request */
	int64_t patience_ns[FLEET_MAX]; /* its requests' deadline; 0: 20 s */
	bool stopped;                   /* nothing is asked for any more */
	const char *property;           /* NULL: "temperature" */
	double step;                    /* of its resolution; 0: that of 12 bits */
	int64_t early_ns;      /* the chips may convert by so much faster than the longest time */
	unsigned good, failed; /* answers, since fleet_forget() */
	unsigned each[FLEET_MAX]; /* good answers of each */
	unsigned older;           /* ... of a conversion that began before the request */
	unsigned newer;           /* ... that came after the moment that they state */
	unsigned wrong;           /* ... and values that are not true; a message tells each */
	unsigned halves; /* ... of them those that a conversion at 9 bits could have given */
} fleet;

/* It climbs by so much; 0: by a degree a second. Ahead of fleet_add(). */
extern double fleet_slope;
/* No fleet; after native_begin(). */
void fleet_begin(void);
/* The bus and its wires end, and others may be set out. */
void fleet_again(void);
/*
 * All chips lose power for a moment, step_ms, 2 step_ms ... up to most_ms after `settled`: each
 * time of a fleet that set_out() made anew. No answer may be wrong; returns how many were good.
 */
unsigned fleet_restarts(void (*set_out)(unsigned count, const char *chip), unsigned count,
                        const char *chip, int64_t settled, unsigned most_ms, unsigned step_ms);
/*
 * Each slot and each reset of round_ns is disturbed in turn, in each way: begin() makes the fleet
 * anew each time, go_on() runs it for so many ns. No answer may be wrong; returns how many were
 * good. *slots: how many there were.
 */
unsigned fleet_troubles(struct trouble *trouble, void (*begin)(void), void (*go_on)(int64_t ns),
                        int64_t round_ns, uint32_t *slots);
/* Add the thermometers of this kind to channel 0, before start(); may be called again. */
void fleet_add(const char *chip, unsigned count);
void fleet_add_to(unsigned channel, const char *chip, unsigned count);
/* Run until then. Others' requests may be under way: their ids are FLEET_MAX and above. */
void fleet_run(int64_t until_ns);
/* Counts begin anew. */
void fleet_forget(void);
/* A request besides, to be answered while the fleet runs. */
uint32_t fleet_ask(enum bus_prio prio, enum bus_op op, const char *path);
/* The same, to write this text. */
uint32_t fleet_write(enum bus_prio prio, const char *path, const char *text);
/* Run until it is answered, which takes a second at most. Returns how long it took. */
int64_t fleet_answered(uint32_t id, int *err);
