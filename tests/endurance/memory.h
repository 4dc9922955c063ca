/* SPDX-License-Identifier: MIT */
/*
 * Who allocates: what is allocated while the engine's thread is watched is counted, and how many
 * blocks live. The linker puts these functions in the place of the allocator's (--wrap).
 */
#pragma once

#include <stdbool.h>

void memory_watch(bool yes);
unsigned long memory_watched(void);
long memory_blocks(void);
unsigned memory_descriptors(void);
