/* SPDX-License-Identifier: MIT */
/* The checks of owsctl doctor, in order, and the remedies that it may run by itself. */
#pragma once

#include <stdbool.h>

struct doctor;

/* May --fix run the remedy? */
bool doctor_is_safe(const char *remedy);
/* Look at the machine of d->root and d->instance. Is anything to be done? */
bool doctor_look(struct doctor *d);
