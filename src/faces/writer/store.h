/* SPDX-License-Identifier: MIT */
/*
 * The file of the configuration, and the file of before beside it: FILE.before. Each is replaced
 * in one step, so that it is the old or the new one at any moment. A writer that is killed between
 * the two steps leaves the same text in both: of a replace the old one, of a restore the new one.
 * Blocking: waits for other writers, five seconds at most.
 */
#pragma once

#include "src/faces/writer/answer.h"
#include "src/faces/writer/order.h"

/* Check the items of a text against what is known of their chips: the warnings go to answer. */
void store_check_items(const char *text, size_t len, struct answer *answer);
/*
 * What the order asks for, if the file is still the one of its base. The body: a text for the place
 * of the file (if the file has this text already, both files stay as they are, and the answer is
 * that of a replace); of a rename the name that an item has, a line end, its other name. To restore
 * puts the file of before in place; the present one is then the file of before.
 */
void store_change(const char *file, const struct order *order, const char *body,
                  struct answer *answer);
