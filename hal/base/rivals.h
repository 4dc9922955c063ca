/* SPDX-License-Identifier: MIT */
/*
 * Other programs on the adapter. An owserver takes no lock (chip_lock.h): it and owsd break each
 * other's transactions, and devices look absent. So owsd looks in /proc who else has the device
 * file open, and names it.
 */
#pragma once

#include <stddef.h>

#define RIVALS_PROC "/proc"
#define RIVALS_TEXT 112 /* room for two of them, and the number of the others */

/* Write "owsd (process 4711)". proc: RIVALS_PROC. pid 0: not known. */
void rivals_name(const char *proc, int pid, char *text, size_t size);
/*
 * Write which other processes have the device file open: "owserver, process 109". Returns how many
 * they are; 0 also where this process may not look. Programs that take the lock do not count. Opens
 * and stats files of proc alone.
 */
unsigned rivals_find(const char *proc, const char *device, char *text, size_t size);
/*
 * Write "owserver (process 109)" of a program of OWFS whose open files this process may not see.
 * Returns its process id; 0: there is none.
 */
int rivals_hidden(const char *proc, char *text, size_t size);

/* A device file as messages about it have it. */
struct rivals_device {
	const char *name, *path;
	const char *missing; /* what to do where it is not there */
	const char *group;   /* that owns it */
};
/*
 * Write why it cannot be opened, and what to do about it. holder: of chip_lock(). Returns the
 * error, one of each kind: -ENODEV, -EACCES, -EBUSY.
 */
int rivals_refused(int err, const struct rivals_device *device, int holder, char *why, size_t size);
