/* SPDX-License-Identifier: MIT */
/* Counts connections by user and by address. */
#include <errno.h>
#include <netinet/in.h>
#include <string.h>

#include "src/faces/web/crowd.h"

struct crowd_key crowd_user(uid_t uid)
{
	struct crowd_key key = {.kind = AF_UNIX};

	memcpy(key.bytes, &uid, sizeof(uid));
	return key;
}

struct crowd_key crowd_address(const struct sockaddr_storage *address)
{
	const struct sockaddr_in *v4 = (const void *)address;
	const struct sockaddr_in6 *v6 = (const void *)address;
	struct crowd_key key = {0};

	if (address->ss_family == AF_INET6 && IN6_IS_ADDR_V4MAPPED(&v6->sin6_addr)) {
		key.kind = AF_INET;
		memcpy(key.bytes, &v6->sin6_addr.s6_addr[12], 4);
	} else if (address->ss_family == AF_INET6) {
		key.kind = AF_INET6;
		memcpy(key.bytes, &v6->sin6_addr, sizeof(key.bytes));
	} else if (address->ss_family == AF_INET) {
		key.kind = AF_INET;
		memcpy(key.bytes, &v4->sin_addr, 4);
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
