/* SPDX-License-Identifier: MIT */
/* What happens to a world: faults of its parts, devices, programs, reloads, suspends. */
#pragma once

#include "tests/endurance/field.h"

#define ALONE (100 * FIELD_S) /* the longest fault */

void happen_begin(void);
/* One of it, at random. */
void happen(void);
/* An input of the switch changes. */
void happen_pin(void);
/* The configuration is the first again. */
void happen_over(void);
/* How often something did. */
uint64_t happened(void);
