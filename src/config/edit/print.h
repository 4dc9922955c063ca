/* SPDX-License-Identifier: MIT */
/* The configuration as owsd understood it, printed as a file. */
#pragma once

#include <stdbool.h>
#include <stdio.h>

struct config;
struct config_item;
struct option_def;

/*
 * Print a row with the value of its member, which is `from` of the struct of its block; all: also
 * that a text is not defined, where that is not the same as empty.
 */
void option_print(const struct option_def *def, const void *from, bool all, FILE *out);
/* Print the configuration as owsd understands it, for `owsd --check`. */
void config_print(const struct config *config, FILE *out);
/* The same of one item; all: also with what its alarm does not define. */
void config_print_item(const struct config_item *item, bool all, FILE *out);
