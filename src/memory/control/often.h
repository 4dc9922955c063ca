/* SPDX-License-Identifier: MIT */
/*
 * How often users connect. Each connection that may get a seat costs a memory, a bell and more;
 * users that connect without end cost no more than a small part of a core.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

/* A user may connect so often in a row, then so often in a second. */
#define OFTEN_ROW 256
#define OFTEN_S 64
#define OFTEN_USERS 32

struct often {
	struct {
		uid_t uid;
		int64_t until_ns; /* what the user has used up is there again then */
	} users[OFTEN_USERS];
};

/* The user connects: is it too often? Then it does not count. */
bool often_is_too(struct often *often, uid_t uid, int64_t now_ns);
