/* SPDX-License-Identifier: MIT */
/* The boot that this machine is in. */
#ifndef HISTORY_BOOT_H
#define HISTORY_BOOT_H

#include <stdint.h>

/* A hash of the kernel's boot id, never 0; of "" where it cannot be read. A system call. */
int64_t history_boot_present(void);

#endif
