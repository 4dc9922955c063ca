/* SPDX-License-Identifier: MIT */
/* Who may command which signal: ControlAllow of the configuration, and the rule without it. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "src/memory/shm/peer.h"

struct config;

/* Who has rights without ControlAllow. */
struct rights {
	const struct config *config;
	uid_t own; /* owsd's user; root and this one have all rights */
	/* The groups exist and count: of a user's owsd they do not. */
	bool has_controllers, has_readers, has_configurers;
	gid_t controllers, readers, configurers;
};

/* Looks the groups up; the configuration has to outlive the rights. Blocking. */
void rights_find(struct rights *rights, const struct config *config);
/* May the peer command the signal? The empty name is that of the driver. */
bool rights_set(const struct rights *rights, const struct peer *peer, const char *name);
/* Does any rule let the peer command something? */
bool rights_set_any(const struct rights *rights, const struct peer *peer);
/* May the peer read the image, and so hear of its news? */
bool rights_read(const struct rights *rights, const struct peer *peer);
/* May the peer ask owsd to load its configuration again? */
bool rights_reload(const struct rights *rights, const struct peer *peer);
/* Set a bit for each record that the peer may command; returns how many of them are signals. */
uint32_t rights_fill(const struct rights *rights, const struct peer *peer, uint32_t *bits);
