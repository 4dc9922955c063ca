/* SPDX-License-Identifier: MIT */
/* Numbers as persons read them. */
#pragma once

#include "src/ground/signal/value.h"
#include "src/public/ows.h"

/*
 * The text of a number, whose value is in integer if type is not float or double: with at most so
 * many decimals, -1: with all. Not of strings.
 */
void digits_print(enum ows_type type, double number, int64_t integer, int decimals,
                  char text[VALUE_TEXT_MAX]);
/*
 * The decimals of a number for a script, which computes with what the chip resolves: six, and those
 * that a person sees. A number below 1 has six digits that count, if these end within twelve
 * decimals; what is smaller is of the arithmetic. -1 (all) stays.
 */
int digits_of_script(double number, int decimals);

/* The values that a signal can have, in words. */

#define RANGE_WORDS 80

/*
 * "0 or 1", "0 to 255", "-32768 or more": those of the type that Min and Max of the configuration
 * leave; NaN: there is none. A number beyond the type limits nothing. Returns words.
 */
const char *range_words(enum ows_type type, double min, double max, char words[RANGE_WORDS]);
