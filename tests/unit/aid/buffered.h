/* SPDX-License-Identifier: MIT */
/*
 * A fleet of thermometers (fleet.h) on one wire with the experimental option DoubleBuffer. The
 * conversions of the chips take the time of genuine ones.
 */
#ifndef TESTS_UNIT_AID_BUFFERED_H
#define TESTS_UNIT_AID_BUFFERED_H

#include "hal/chips/thermometer_state.h"

#include "tests/unit/aid/fleet.h"

/* An empty scene in place of the present one. */
void buffered_again(void);
/* The wire, with so many of the named chip. */
void buffered_set_out(unsigned count, const char *chip);
/* Open the bus with the option "on" or "off", and wait until it is up. */
void buffered_start(const char *what);
/* What the bus knows of the chip. */
struct thermometer *buffered_chip(unsigned i);
/* As if the trials of all were over: they take six seconds of each chip. */
void buffered_trust(uint32_t shortest_us);
void buffered_run(int64_t ns);
/* ... for seconds in which more is reported than a host keeps. */
void buffered_run_trials(unsigned seconds);

#endif
