/* SPDX-License-Identifier: MIT */
/* Each property of a chip is read while the chip loses its power: the truth or an error. */
#ifndef TESTS_UNIT_AID_VISIT_BROWNOUT_H
#define TESTS_UNIT_AID_VISIT_BROWNOUT_H

#include "tests/unit/aid/visit.h"

void visit_brownout(const char *chip, bool parasite);

#endif
