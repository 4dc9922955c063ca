/* SPDX-License-Identifier: MIT */
/*
 * The visits of the writer, each in a process: how many there are, of whom, and their end. A user
 * whose requests take long keeps no other user waiting.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

#define VISITORS 16
#define VISITORS_PER_USER 4
#define VISITORS_NS 75000000000 /* longer than request, lock, check, reload and answer may take */

struct visitors {
	struct {
		pid_t pid; /* 0: a free place */
		uid_t uid;
		int64_t until_ns; /* it is killed then: there is no watchdog */
	} places[VISITORS];
};

/* May that user have one more? Root always may. */
bool visitors_may(const struct visitors *visitors, uid_t uid);
/* There is a free place: visitors_look() has returned less than VISITORS. */
void visitors_add(struct visitors *visitors, pid_t pid, uid_t uid, int64_t now_ns);
/*
 * Free the places of those that have ended, and kill those that go on beyond all deadlines of a
 * visit. How many are left.
 */
unsigned visitors_look(struct visitors *visitors, int64_t now_ns);
/*
 * End those that wait for their peer, and wait for those that change the configuration: at most as
 * long as that may take.
 */
void visitors_end(struct visitors *visitors);
