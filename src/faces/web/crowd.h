/* SPDX-License-Identifier: MIT */
/* Who has how many of the connections: counted by user at a socket, and by address elsewhere. */
#pragma once

#include <stdint.h>
#include <sys/socket.h>
#include <sys/types.h>

#define CROWD 1200
#define CROWD_NOBODY (-1) /* the place of one that is not counted */

struct crowd_key {
	uint16_t kind; /* address family; 0: nobody */
	uint8_t bytes[16];
};

struct crowd {
	struct crowd_key places[CROWD];
};

struct crowd_key crowd_user(uid_t uid);
/* An IPv4 address is the same whether it comes mapped or not. Kind 0 of another family. */
struct crowd_key crowd_address(const struct sockaddr_storage *address);
/* The place of one more of these; -ENOSPC: there are `most` already, or no place is left. */
int crowd_enter(struct crowd *crowd, const struct crowd_key *key, unsigned most);
/* CROWD_NOBODY: does nothing. */
void crowd_leave(struct crowd *crowd, int place);
