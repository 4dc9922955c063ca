/* SPDX-License-Identifier: MIT */
/* What an item is known by, its name and its identity: each item has others. */
#pragma once

#include "hal/owfs/path.h"
#include "src/config/read/build.h"
#include "src/config/read/report.h"

#define IDENTITY_MAX (PATH_LEN_MAX + 32)

/* The path of a text with NUL as an identity: without the flags /uncached and /alarm. */
void identity_of_path(const struct path *path, char out[IDENTITY_MAX]);
/* That of an item by its place, from 1, among those of one path. */
void identity_number(unsigned number, char identity[IDENTITY_MAX]);

/* Give each item its identity; report names and identities that two have. */
void items_check(struct build *build, const struct rio_position *names);
