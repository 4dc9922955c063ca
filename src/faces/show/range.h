/* SPDX-License-Identifier: MIT */
/* The values that a signal can have, in words. */
#pragma once

#include "src/public/ows.h"

#define RANGE_WORDS 80

/*
 * "0 or 1", "0 to 255", "-32768 or more": those of the type that Min and Max of the configuration
 * leave; NaN: there is none. A number beyond the type limits nothing. Returns words.
 */
const char *range_words(enum ows_type type, double min, double max, char words[RANGE_WORDS]);
