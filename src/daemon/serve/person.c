/* SPDX-License-Identifier: MIT */
/* The user of a client, by the kernel's word, and what ControlAllow lets that user write. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "src/config/read/allow.h"
#include "src/config/read/config.h"
#include "src/config/read/listen.h"
#include "src/daemon/serve/person.h"
#include "src/memory/shm/peer.h"

#define GROUPS_MAX 1024 /* of one process, that owsd looks at */

void person_address(const struct sockaddr *from, char name[OWS_NAME])
{
	struct listen_address address;
	char text[LISTEN_TEXT_MAX] = "unknown";
	size_t len;

	if (listen_of(from, &address))
		listen_print_host(&address, text);
	len = strlen(text);
	/* the end says which machine it is */
	if (len < OWS_NAME) {
		memcpy(name, text, len + 1);
	} else {
		memset(name, '.', 3);
		memcpy(name + 3, text + len - (OWS_NAME - 4), OWS_NAME - 3);
	}
}

void person_name(int fd, bool network, const struct sockaddr_in6 *peer, char name[OWS_NAME])
{
	struct peer user;

	if (network)
		person_address((const void *)peer, name);
	else if (peer_look_into(fd, &user, NULL, 0) == 0)
		snprintf(name, OWS_NAME, "user %lu", (unsigned long)user.uid);
	else
		snprintf(name, OWS_NAME, "unknown");
}

static bool all_name(const struct config *config, const struct peer *peer)
{
	for (unsigned i = 0; i < config->allow_count; i++)
		if (!peer || !allow_names(&config->allows[i], peer))
			return false;
	return true;
}

bool person_may(const struct config *config, int fd, bool network, const char *signal)
{
	gid_t groups[GROUPS_MAX];
	struct peer peer, *known;

	if (config->allow_count == 0)
		return true;
	known = !network && peer_look_into(fd, &peer, groups, GROUPS_MAX) == 0 ? &peer : NULL;
	if (known && (known->uid == 0 || known->uid == geteuid()))
		return true;
	return signal ? allow_ask(config, known, signal) != ALLOW_NO : all_name(config, known);
}
