/* SPDX-License-Identifier: MIT */
/*
 * An instance of many signals without owsd: they are read once a second, in ten parts, and some of
 * them change. Programs that follow them are woken as owsd wakes them. Signal 0 is the probe: its
 * value is the time at which it was published, so a client knows how old what it sees is.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#define MANY_MOST 10000

struct many_pace {
	unsigned changing; /* of 100 signals, each second; 0: nothing but the heart beats */
	bool probe;        /* publish the time, each 50 to 250 ms */
};

/* In bench_dir(). One at a time. False: the reason was noted. */
bool many_open(uint32_t count);
void many_pace(struct many_pace pace);
void many_close(void);
const char *many_instance(void);
/* A configuration that has these signals. */
bool many_write_config(const char *path);
/* Now in the unit of the probe: milliseconds since many_base_ms(), of the wall clock. */
double many_now(void);
int64_t many_base_ms(void);
