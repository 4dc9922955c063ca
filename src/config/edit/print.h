/* SPDX-License-Identifier: MIT */
/* The configuration as owsd understood it, printed as a file. */
#pragma once

#include <stdbool.h>
#include <stdio.h>

struct config;

/* Print the configuration as owsd understands it, for `owsd --check`. */
void config_print(const struct config *config, FILE *out);
/* The same of one item; all: also with what its alarm does not define. */
struct config_item;
void config_print_item(const struct config_item *item, bool all, FILE *out);
