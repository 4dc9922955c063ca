/* SPDX-License-Identifier: MIT */
/* What an item is known by, its name and its identity: each item has others. */
#pragma once

#include "src/config/read/build.h"
#include "src/config/read/report.h"

/* Give each item its identity; report names and identities that two have. */
void items_check(struct build *build, const struct place *names);
