/* SPDX-License-Identifier: MIT */
/* A property is written with each trouble of the wire: it is in the chip, or there is an error. */
#pragma once

#include "tests/unit/aid/visit.h"

/* Those of the visits, which end with one without a chip, that are of this one so fed. */
void visit_writes(const char *chip, bool parasite, const struct visit *visits);
