/* SPDX-License-Identifier: MIT */
/* The key ControlAllow of the driver block: who may command which signals. */
#ifndef CONFIG_ALLOW_H
#define CONFIG_ALLOW_H

struct build;
struct rio_node;

void allow_build(struct build *build, const struct rio_node *driver);

#endif
