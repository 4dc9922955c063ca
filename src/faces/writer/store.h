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
 * Put text in place of the file if that is still the one of the request's base. If the file has
 * this text already, both files stay as they are, and the answer is that of a replace.
 */
void store_replace(const char *file, const struct order *order, const char *text,
                   struct answer *answer);
/* Put the file of before in place likewise; the present one is then the file of before. */
void store_restore(const char *file, const struct order *order, struct answer *answer);
/* Give an item of the file another name; names: that of now, a line end, the other. */
void store_rename(const char *file, const char *names, struct answer *answer);
