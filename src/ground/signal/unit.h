/* SPDX-License-Identifier: MIT */
/* Units: their spellings, their quantities, and how a value in one is converted to another. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/*
 * value * *factor + *offset is in the unit `to` what value is in the unit `from`. False: one of the
 * two is not known, or they are of different quantities; the results are unchanged then. The unit
 * that a chip's table says is `from`: of kelvins they are those of a difference.
 */
bool unit_convert(const char *from, const char *to, double *factor, double *offset);
/* "°F" of "degF", which is how other programs know it; NULL: not known. */
const char *unit_symbol(const char *text);
/* The class that Home Assistant has for the unit, such as "temperature"; NULL: none. */
const char *unit_class(const char *text);
/* Writes the units of the same quantity: "°C, K, °F"; empty where that is not known. */
void unit_list(const char *text, char *out, size_t size);
