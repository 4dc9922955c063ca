/* SPDX-License-Identifier: MIT */
/*
 * Keeps identities over an edit: an item that stays, and would get another identity by what is
 * edited, gets the key Identity with the one that it had. Its history goes on by that.
 */
#pragma once

#include "src/config/read/identity.h"
#include "src/config/read/rio.h"

struct steady {
	unsigned count;
	/* of each item before the edit; "": it has Identity, or no path */
	char (*identity)[IDENTITY_MAX];
};

/* Before the edit. 0 or -ENOMEM. */
int steady_begin(const struct rio *rio, struct steady *steady);
/* The edit removes this item; or moves it before the item that is at there, or to the end. */
void steady_remove(struct steady *steady, unsigned item);
void steady_move(struct steady *steady, unsigned item, unsigned there);
/* After the edit, which returned err: that, or 0, -ENOMEM or -EFBIG. Frees what begin took. */
int steady_end(struct rio **rio, struct steady *steady, int err);

/* Where the item stands among the items. */
unsigned steady_index(const struct rio *rio, const struct rio_node *item);
