/* SPDX-License-Identifier: MIT */
/*
 * Listeners: all unix sockets at which a program listens are made here, or taken over here from the
 * service manager. On their connections the kernel refuses descriptors, where it can (from Linux
 * 6.16 on). Where it cannot, and on those that came before the program ran, peer_receive() takes
 * the bytes, and a porter closes them.
 */
#pragma once

#include <stdbool.h>
#include <sys/socket.h>
#include <sys/types.h>
#include <sys/un.h>

/*
 * A socket of that type at a path that does not exist, not blocking, closed on exec. It is bound,
 * not yet listening. It has that mode, and that group unless this user may not give it that: then
 * it is for this user alone; (gid_t)-1: the user's own. A negative errno; -EPERM: another process
 * put something else in its place.
 */
int listen_local(const struct sockaddr_un *at, int type, mode_t mode, gid_t group);

/*
 * Remove the socket of a process that was killed. -EADDRINUSE: a process listens there, -EEXIST: it
 * is no socket; another negative errno.
 */
int listen_vacate(const struct sockaddr_un *at);

/*
 * The sockets that the service manager has opened for this process, as sd_listen_fds(3) has them:
 * closed on exec, not blocking. Returns their number, at most `most` in fds; 0: none; -EINVAL:
 * there are more; another negative errno. The environment names them no longer.
 */
int listen_inherited(int *fds, int most);

/* What to do when an address of Listen or -l cannot be had, to stand behind the error; or "". */
const char *listen_remedy(int err);

/*
 * Accept a connection, not blocking, closed on exec. On one of a unix socket a byte out of band
 * keeps its place, so that no look passes over its descriptors. As accept4(), with a negative
 * errno.
 */
int listen_accept(int listener, struct sockaddr *from, socklen_t *len);
