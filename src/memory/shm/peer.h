/* SPDX-License-Identifier: MIT */
/* The peer of a connection, as the kernel reports it; what it sends, taken with care. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
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

/*
 * Receive what fits of the first message, or of the stream up to the next descriptors, without
 * closing any: a message with descriptors stays where it is. As recv() with MSG_DONTWAIT; -EBADMSG:
 * there are descriptors. take: what was received leaves the socket.
 */
ptrdiff_t peer_receive(int connection, void *bytes, size_t room, bool take);
/* Ask the kernel to refuse descriptors on connections to that socket (from Linux 6.16 on). */
void peer_refuse_descriptors(int listener);
