/* SPDX-License-Identifier: MIT */
/* Those who read what was recorded, and all that they have to find there. */
#ifndef TESTS_UNIT_AID_RECORDED_READERS_H
#define TESTS_UNIT_AID_RECORDED_READERS_H

#include "src/libows/ows.h"

/* By libows: each value, attribute, alarm, target and counter. */
void check_all(struct ows *h);
/* What a command prints; it must succeed. */
const char *output_of(const char *command);
/* Behind "import ows, sys"; sys.argv[1] is the instance. */
const char *python(const char *code);

#endif
