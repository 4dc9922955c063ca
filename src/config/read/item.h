/* SPDX-License-Identifier: MIT */
/* Items of the file: makes a signal of an item's keys, and reports what is wrong or odd. */
#pragma once

struct build;
struct config_item;
struct rio_node;

/* One Item block. */
void item_build(struct build *build, const struct rio_node *block, struct config_item *item);
