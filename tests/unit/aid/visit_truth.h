/* SPDX-License-Identifier: MIT */
/* Each property of a chip is read with each trouble of the wire: the truth or an error. */
#pragma once

#include "tests/unit/aid/visit.h"

void visit_truth(const char *chip, bool parasite);
