/* SPDX-License-Identifier: MIT */
#ifndef TARGET_H
#define TARGET_H

#include <stddef.h>

/*
 * Can owsd make the bus of this target? Nothing is opened but what says what the target is (the
 * file of a simulation). 0, or a negative errno with the reason in why.
 */
int target_check(const char *target, char *why, size_t why_size);

#endif
