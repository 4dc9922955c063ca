/* SPDX-License-Identifier: MIT */
/* Asks the kernel for the peer of a connection, and receives without descriptors. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "src/memory/shm/peer.h"

/* Younger than the headers of some machines that build owsd. */
#ifndef SO_PEERGROUPS
#define SO_PEERGROUPS 59
#endif
#ifndef SO_PASSRIGHTS
#define SO_PASSRIGHTS 83
#endif
#ifndef SO_PEERPIDFD
#define SO_PEERPIDFD 77
#endif
#ifndef SYS_pidfd_open
#define SYS_pidfd_open 434
#endif

static int look_at_peer(int connection, struct peer *peer)
{
	struct ucred ucred;
	socklen_t len = sizeof(ucred);

	*peer = (struct peer){0};
	if (getsockopt(connection, SOL_SOCKET, SO_PEERCRED, &ucred, &len) < 0)
		return -errno;
	peer->uid = ucred.uid;
	peer->gid = ucred.gid;
	peer->pid = ucred.pid > 0 ? ucred.pid : 0;
	return 0;
}

int peer_look_into(int connection, struct peer *peer, gid_t *room, unsigned most)
{
	socklen_t len = (socklen_t)(most * sizeof(*room));
	int err = look_at_peer(connection, peer);

	if (!err && getsockopt(connection, SOL_SOCKET, SO_PEERGROUPS, room, &len) == 0) {
		peer->groups = room;
		peer->group_count = (unsigned)(len / sizeof(gid_t));
	}
	return err;
}

int peer_look(int connection, struct peer *peer)
{
	socklen_t len = 0;
	int err = look_at_peer(connection, peer);

	if (err)
		return err;
	/* a kernel that does not know it leaves the group of the process itself */
	if (getsockopt(connection, SOL_SOCKET, SO_PEERGROUPS, NULL, &len) == 0 || errno != ERANGE)
		return 0;
	peer->groups = malloc(len);
	if (!peer->groups)
		return -ENOMEM;
	if (getsockopt(connection, SOL_SOCKET, SO_PEERGROUPS, peer->groups, &len) < 0)
		return 0;
	peer->group_count = (unsigned)(len / sizeof(gid_t));
	return 0;
}

void peer_forget(struct peer *peer)
{
	free(peer->groups);
	peer->groups = NULL;
	peer->group_count = 0;
}

bool peer_in_group(const struct peer *peer, gid_t group)
{
	if (peer->gid == group)
		return true;
	for (unsigned i = 0; i < peer->group_count; i++)
		if (peer->groups[i] == group)
			return true;
	return false;
}

int peer_death(int connection, const struct peer *peer)
{
	struct pollfd ended = {.events = POLLIN};
	int fd = -1;
	socklen_t len = sizeof(fd);

	if (!peer->pid)
		return -ENOENT;
	if (getsockopt(connection, SOL_SOCKET, SO_PEERPIDFD, &fd, &len) < 0 || fd < 0)
		fd = errno == ESRCH ? -1 : (int)syscall(SYS_pidfd_open, peer->pid, 0);
	if (fd < 0)
		return -errno;
	fcntl(fd, F_SETFD, FD_CLOEXEC);
	ended.fd = fd; /* later kernels give one of a process that has ended, too */
	if (poll(&ended, 1, 0) == 0)
		return fd;
	close(fd);
	return -ESRCH;
}

void peer_refuse_descriptors(int listener)
{
	int none = 0;

	setsockopt(listener, SOL_SOCKET, SO_PASSRIGHTS, &none, sizeof(none));
}

ptrdiff_t peer_receive(int connection, void *bytes, size_t room, bool take)
{
	struct iovec part = {bytes, room};
	struct msghdr message = {.msg_iov = &part, .msg_iovlen = 1};
	/* a look closes no descriptor, since the message stays; without room for them it says so */
	ssize_t n = recvmsg(connection, &message, MSG_PEEK | MSG_DONTWAIT | MSG_TRUNC);

	if (n < 0)
		return -errno;
	if (message.msg_flags & MSG_CTRUNC)
		return -EBADMSG;
	if (take && n > 0 &&
	    recv(connection, bytes, (size_t)n < room ? (size_t)n : room, MSG_DONTWAIT) < 0)
		return -errno;
	return n;
}
