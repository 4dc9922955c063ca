/* SPDX-License-Identifier: MIT */
/* The readers of a recording, and the checks of all that each has to find. */
#pragma once

#include "src/public/ows.h"

/* Check by libows each value, attribute, alarm, target and counter. */
void check_all(struct ows *h);
/* Run a command, which must succeed. Returns what it prints. */
const char *output_of(const char *command);
/* Run the code after "import ows, sys"; sys.argv[1] is the instance. */
const char *python(const char *code);
