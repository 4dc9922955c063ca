/* SPDX-License-Identifier: MIT */
/* Printing values and changing a document; what is not changed keeps every byte. */
#pragma once

#include "src/config/read/rio.h"

#define RIO_KEY_WIDTH 24 /* REXYGEN puts values in this column behind the key's first letter */
#define RIO_WRAP 50 /* a longer string continues as another string at the start of the next line */

/* text as a quoted string (malloc), wrapped if it is long; NULL: no memory. */
char *rio_quote(const char *text);

/*
 * Changes work on the text: they return a new document in *rio, the old one and all its nodes are
 * gone. 0, -ENOMEM, or -EFBIG (the document is then the old one). Each "\n" of what is put becomes
 * the document's own line end.
 */
/*
 * Set a key, or add it after the other values of the block. The value is written unchanged: quote
 * strings first.
 */
int rio_set(struct rio **rio, struct rio_node *block, const char *key, const char *value);
/* The same with a text, which is quoted here. */
int rio_set_text(struct rio **rio, struct rio_node *block, const char *key, const char *text);
/* Put another value in the place of a key's: the same. */
int rio_replace(struct rio **rio, const struct rio_node *node, const char *value);
/* Add lines after the block's last child: `Key Value`, or a whole block. Indents every line. */
int rio_add(struct rio **rio, struct rio_node *block, const char *lines);
/* Take a node out, with its lines if nothing else stands on them. */
int rio_remove(struct rio **rio, struct rio_node *node);
/*
 * Put a node, with its lines and the comments directly above it, before or after other; both are in
 * one block. -EINVAL: the lines of one of them hold other text.
 */
int rio_move(struct rio **rio, struct rio_node *node, const struct rio_node *other, bool behind);
