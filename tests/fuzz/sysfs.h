/* SPDX-License-Identifier: MIT */
/* Files of w1 in the place of /sys/bus/w1/devices: hal/w1/file.c on a file system in memory. */
#pragma once

#include "tests/fuzz/fuzz.h"

#define SYSFS_ROOT "/fuzz"
#define SYSFS_FILES 40
#define SYSFS_BYTES 600

enum sysfs_fault {
	SYSFS_BROKEN = 1, /* reads fail */
	SYSFS_REFUSED,    /* cannot be opened: no right */
	SYSFS_SHORT,      /* reads give one byte at a time */
	SYSFS_STUBBORN,   /* writes are refused as not valid */
	SYSFS_PARTIAL,    /* writes take one byte */
	SYSFS_DEAF,       /* writes change nothing */
};

void sysfs_clear(void);
/* A directory below the root; n bytes of names, each ended by a NUL, are listed in it. */
void sysfs_directory(const char *directory, const uint8_t *names, size_t n);
void sysfs_file(const char *directory, const char *name, const void *bytes, size_t n,
                uint8_t fault);
/* Name NULL: the directory and all of it. */
void sysfs_remove(const char *directory, const char *name);
