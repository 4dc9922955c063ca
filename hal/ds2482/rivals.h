/* SPDX-License-Identifier: MIT */
/*
 * Other programs on the adapter. An owserver takes no lock (chip_lock.h): it and owsd break each
 * other's transactions, and devices look absent. So owsd looks in /proc who else has the device
 * file open, and names it in the log.
 */
#pragma once

#include <stddef.h>

#define RIVALS_PROC "/proc"
#define RIVALS_TOLD 8
#define RIVALS_TEXT 96

/* What was said already; zero: nothing. */
struct rivals {
	int told[RIVALS_TOLD]; /* process ids */
	unsigned count;        /* how many were told; the oldest is overwritten */
};

/* Write "owsd (process 4711)". proc: RIVALS_PROC. pid 0: not known. */
void rivals_name(const char *proc, int pid, char *text, size_t size);
/*
 * Write which other processes have the device file open, those that were not told before:
 * "owserver, process 109". Returns how many have it open, told or not; 0 also where this process
 * may not look. Programs that take the lock do not count. Opens and stats files of proc alone.
 */
unsigned rivals_find(const char *proc, const char *device, struct rivals *rivals, char *text,
                     size_t size);
