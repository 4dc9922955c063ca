/* SPDX-License-Identifier: MIT */
/* Keeps the messages of a report, and fails the test on a message that must not come. */
#pragma once

#include "src/config/read/config.h"

extern struct config_report report;
/* All lines since said_begin(), each ended by '\n'. */
extern char said[8192];

void said_begin(void);
/* Begin, and let any message fail the test. */
void said_must_not_begin(void);
