/* SPDX-License-Identifier: MIT */
/* Who is at the other end of a connection, by the kernel's word. */
#ifndef SHM_PEER_H
#define SHM_PEER_H

#include <stdbool.h>
#include <sys/types.h>

struct peer {
	uid_t uid;
	gid_t gid;
	pid_t pid;     /* 0: unknown, as of a process in another pid namespace */
	gid_t *groups; /* the other groups; allocated */
	unsigned group_count;
};

/* The credentials of the process that connected, of that moment. 0 or a negative errno. */
int peer_look(int connection, struct peer *peer);
/*
 * As peer_look(), with the other groups in this room, so that nothing is allocated. Of a process
 * that has more of them none is known.
 */
int peer_look_into(int connection, struct peer *peer, gid_t *room, unsigned most);
void peer_forget(struct peer *peer);
bool peer_in_group(const struct peer *peer, gid_t group);
/*
 * A descriptor that becomes readable when the process that connected ends. -ESRCH: it has ended;
 * another negative errno: the kernel gives none, or the process is unknown.
 */
int peer_death(int connection, const struct peer *peer);

#endif
