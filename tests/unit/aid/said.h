/* SPDX-License-Identifier: MIT */
/* A report of a configuration whose lines are kept, and a line that must not come. */
#ifndef TESTS_UNIT_AID_SAID_H
#define TESTS_UNIT_AID_SAID_H

#include "src/config/config.h"

extern struct config_report report;
/* All lines since said_begin(), each ended by '\n'. */
extern char said[8192];

void said_begin(void);
/* The same, but a line fails the test. */
void said_must_not_begin(void);

#endif
