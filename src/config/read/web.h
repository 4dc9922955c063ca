/* SPDX-License-Identifier: MIT */
/* The Web block: what owsd-web takes from the file. owsd checks it and uses none of it. */
#pragma once

struct build;
struct rio_node;

/* The block, or the defaults if it is NULL. */
void web_build(struct build *build, const struct rio_node *block);
