/* SPDX-License-Identifier: MIT */
/* Runs verbs of owsctl and catches their stdout and stderr. */
#pragma once

#include "src/tool/owsctl/ctl.h"

extern struct ctl caught_ctl;
extern char *out, *err; /* of the last run */

void caught_begin(const char *instance);
void caught_end(void);
/* Run a verb with these words, its own name first. Returns its status. */
int run(int (*function)(struct ctl *, int, char **), const char *words);
void holds(const char *text, const char *part);
