/* SPDX-License-Identifier: MIT */
/* The key ControlAllow of the driver block: which users may command which signals. */
#pragma once

#include <stdbool.h>

struct build;
struct config;
struct config_allow;
struct peer;
struct rio_node;

void allow_build(struct build *build, const struct rio_node *driver);

/* Does the entry name the peer, or a group of his? */
bool allow_names(const struct config_allow *allow, const struct peer *peer);

enum allow_word {
	ALLOW_OPEN, /* no pattern fits the signal */
	ALLOW_YES,
	ALLOW_NO,
};
/*
 * What ControlAllow says about the peer and the signal; the empty name is that of the driver. No
 * peer (NULL): a client of which owsd knows nothing.
 */
enum allow_word allow_ask(const struct config *config, const struct peer *peer, const char *name);
