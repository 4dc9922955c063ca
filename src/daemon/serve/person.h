/* SPDX-License-Identifier: MIT */
/* The user at the other end of a client's connection, and what that user may write. */
#pragma once

#include <netinet/in.h>
#include <stdbool.h>
#include <sys/socket.h>

#include "src/public/ows_layout.h"

struct config;

/* The client's name in image and journal: "user 1000" of the unix socket, else its address. */
void person_name(int fd, bool network, const struct sockaddr_in6 *peer, char name[OWS_NAME]);
/* The text of an address; of a long one "..." and its end. */
void person_address(const struct sockaddr *from, char name[OWS_NAME]);
/*
 * Does ControlAllow let the client command the signal? The empty name is that of the driver; NULL:
 * something of a device that is no signal, which may be an output under another path, so that every
 * entry has to name the client. Of a client over the network nothing is known.
 */
bool person_may(const struct config *config, int fd, bool network, const char *signal);
