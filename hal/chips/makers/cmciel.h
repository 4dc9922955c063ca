/* SPDX-License-Identifier: MIT */
/* Sensors of CMC Industrial Electronics: each has measured a word of 16 bits. */
#pragma once

#include "hal/chips/family.h"

extern const struct area cmciel_reading;

/* The one area of a family, and the property that shows its word. */
enum { READING = 1 };
/* NOLINTNEXTLINE(bugprone-macro-parentheses): a row of a list */
#define CMCIEL_AREAS [READING] = &cmciel_reading
#define CMCIEL_READING \
	PROPERTY("reading", UNSIGNED, VOLATILE, READ, .hidden = true, FIELD(READING, .bytes = 2))
