/* SPDX-License-Identifier: MIT */
/*
 * Listeners: all sockets at which a program listens are made here, or taken over here from the
 * service manager. On connections of unix sockets the kernel refuses descriptors, where it can
 * (from Linux 6.16 on). Where it cannot, and on those that came before the program ran,
 * peer_receive() takes the bytes, and a porter closes them.
 */
#pragma once

#include <stdbool.h>
#include <sys/socket.h>
#include <sys/types.h>

#include "hal/base/time.h"

/*
 * Listen at a path, with a socket not blocking and closed on exec, in place of one of a process
 * that was killed. It has that mode, and that group unless this user may not give it that: then it
 * is for this user alone; (gid_t)-1: the user's own. A descriptor or a negative errno;
 * -EADDRINUSE: a process listens there, -EEXIST: something else is there, -EPERM: another process
 * put something else in its place, -ENAMETOOLONG.
 */
int listen_at_path(const char *path, mode_t mode, gid_t group);
/*
 * The same at a name in an open directory, in place of whatever is there: only one process at a
 * time may use that name.
 */
int listen_at_name(int directory, const char *name, int type, mode_t mode, gid_t group);
/*
 * The file that a socket of this process is: its name may lead to that of another process by the
 * time it is removed. One that is not there is none, and equals no other.
 */
struct listen_file {
	dev_t device;
	ino_t inode; /* 0: none */
};
/* What is there now; directory as in openat(2). */
struct listen_file listen_file_at(int directory, const char *name);
/* Remove that file, and no other. The socket is still open: no other file has its number yet. */
void listen_remove(int directory, const char *name, const struct listen_file *file);
/*
 * Listen at a TCP address. only: [::] does not serve IPv4. later: also if the machine does not have
 * that address yet.
 */
int listen_at_address(const struct sockaddr_storage *at, bool only, bool later);
/* Has an interface of this machine that address now? */
bool listen_is_here(const struct sockaddr_storage *at);

/*
 * The sockets that the service manager has opened for this process, as sd_listen_fds(3) has them:
 * closed on exec, not blocking. Returns their number, at most `most` in fds; 0: none; -EINVAL:
 * there are more; another negative errno. The environment names them no longer.
 */
int listen_inherited(int *fds, int most);

/* What to do when an address cannot be had, to stand behind the error; or "". */
const char *listen_remedy(int err);

/*
 * Accept a connection, not blocking, closed on exec. On one of a unix stream a byte out of band
 * keeps its place, so that no look passes over its descriptors. from NULL: of packets, which have
 * none. As accept4(), with a negative errno.
 */
int listen_accept(int listener, struct sockaddr *from, socklen_t *len);
/* Did it say that there is no room for a connection? It waits with the kernel meanwhile. */
bool listen_is_full(int err);
/*
 * Listeners that have no room would be ready without end: epoll, which knows each by its number in
 * fds, reports none of them before listen_resume(). Those below 0 are left out.
 */
#define LISTEN_PAUSE_NS (200 * NS_PER_MS)
void listen_pause(int epoll, const int *fds, unsigned count);
void listen_resume(int epoll, const int *fds, unsigned count);
