/* SPDX-License-Identifier: MIT */
/* What an item is known by, its name and its identity: each item has others. */
#pragma once

#include "hal/owfs/path.h"
#include "src/config/read/build.h"
#include "src/config/read/report.h"

#define IDENTITY_MAX (PATH_LEN_MAX + 32)

/* The path of a text with NUL as an identity: without the flags /uncached and /alarm. */
void identity_of_path(const struct path *path, char out[IDENTITY_MAX]);

struct identity {
	const char *given; /* by Identity; NULL: the item has none */
	const char *path;  /* as identity_of_path() writes it; "": none that can be read */
	unsigned number; /* among those of one path that have no Identity; 0: has one, or no path */
};
/*
 * Number the items: of several with one path the first has it, the second path#2. What is given is
 * passed over. So a rename changes none, nor does an item that is added after them. 0 or -ENOMEM.
 */
int identities_number(struct identity *items, unsigned count);
/* The identity of an item that has its number. */
void identity_text(const struct identity *item, char text[IDENTITY_MAX]);

/* Give each item its identity; report names and identities that two have. */
void items_check(struct build *build, const struct rio_position *names);
