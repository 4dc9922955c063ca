/* SPDX-License-Identifier: MIT */
/*
 * The visits of the writer, each in a process: how many there are, of whom, and their end. A user
 * whose requests take long keeps no other user waiting.
 */
#pragma once

#include <stdbool.h>
#include <sys/types.h>

#define VISITORS 16
#define VISITORS_PER_USER 4

struct visitors {
	struct {
		pid_t pid; /* 0: a free place */
		uid_t uid;
	} places[VISITORS];
};

/* May that user have one more? Root always may. */
bool visitors_may(const struct visitors *visitors, uid_t uid);
/* There is a free place: visitors_look() has returned less than VISITORS. */
void visitors_add(struct visitors *visitors, pid_t pid, uid_t uid);
/* Free the places of those that have ended. How many are left. */
unsigned visitors_look(struct visitors *visitors);
/*
 * End those that wait for their peer, and wait for those that change the configuration: at most as
 * long as that may take.
 */
void visitors_end(struct visitors *visitors);
