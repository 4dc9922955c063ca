/* SPDX-License-Identifier: MIT */
/* Numbers as persons read them. */
#pragma once

#include "src/ground/signal/value.h"

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
