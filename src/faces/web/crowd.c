/* SPDX-License-Identifier: MIT */
/* Counts connections by user and by address. */
#include <errno.h>
#include <string.h>

#include "src/config/read/listen.h"
#include "src/faces/web/crowd.h"

struct crowd_key crowd_user(uid_t uid)
{
	struct crowd_key key = {.kind = AF_UNIX};

	memcpy(key.bytes, &uid, sizeof(uid));
	return key;
}

struct crowd_key crowd_address(const struct sockaddr_storage *address)
{
	struct listen_address from;
	struct crowd_key key = {0};

	if (listen_of((const struct sockaddr *)address, &from)) {
		key.kind = from.is_v6 ? AF_INET6 : AF_INET;
		memcpy(key.bytes, from.bytes, sizeof(key.bytes));
	}
	return key;
}

int crowd_enter(struct crowd *crowd, const struct crowd_key *key, unsigned most)
{
	int place = -ENOSPC;
	unsigned count = 0;

	for (int i = 0; i < CROWD; i++) {
		if (crowd->places[i].kind == 0 && place < 0)
			place = i;
		count += memcmp(&crowd->places[i], key, sizeof(*key)) == 0;
	}
	if (count >= most || place < 0)
		return -ENOSPC;
	crowd->places[place] = *key;
	return place;
}

void crowd_leave(struct crowd *crowd, int place)
{
	if (place >= 0)
		crowd->places[place].kind = 0;
}
