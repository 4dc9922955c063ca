/* SPDX-License-Identifier: MIT */
/* owsctl alarms: the alarms that stand. */
#pragma once

#include "src/tool/owsctl/ctl.h"

/* The words of `owsctl alarms` that are no patterns. NULL ends them. */
extern const struct alarms_word {
	const char *word;
	int (*run)(struct ctl *ctl, int argc, char **argv); /* argv[0] is the word */
} alarms_words[];

/* Does each pattern match a signal? If not, prints the error on stderr. */
bool alarms_known(struct ows *h, char *const *patterns, int count);
int alarms_live(struct ctl *ctl, int argc, char **argv);
