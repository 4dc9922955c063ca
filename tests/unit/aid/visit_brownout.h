/* SPDX-License-Identifier: MIT */
/* Each property of a chip is read while the chip loses its power: the truth or an error. */
#pragma once

#include "tests/unit/aid/visit.h"

void visit_brownout(const char *chip, bool parasite);
