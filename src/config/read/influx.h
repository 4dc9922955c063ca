/* SPDX-License-Identifier: MIT */
/* The Influx block, of which owsd-influx takes its options. owsd checks it, and does not use it. */
#pragma once

struct build;
struct rio_node;

/* The block, or the defaults if it is NULL. */
void influx_build(struct build *build, const struct rio_node *block);
