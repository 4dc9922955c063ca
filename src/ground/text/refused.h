/* SPDX-License-Identifier: MIT */
#pragma once

#include <getopt.h>
#include <stddef.h>

/*
 * Write to text why getopt_long() has just returned c, which is '?' or ':'; text names the option
 * as it was typed. The short options begin with ':', opterr is 0, and each long one has the letter
 * of a short one or a value above 255. Words of argv stand in text as they are: printable() makes
 * them fit for a terminal.
 */
void refused_option(int c, const struct option *longs, char *const *argv, char *text, size_t size);
