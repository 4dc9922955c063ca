/* SPDX-License-Identifier: MIT */
/* Sockets of a service: inherited from the service manager, or left by another process. */
#ifndef SERVICE_INHERITED_H
#define SERVICE_INHERITED_H

#include <stdbool.h>

struct sockaddr_un;

/*
 * The sockets that the service manager has opened for this process, as sd_listen_fds(3) has them:
 * closed on exec, not blocking. Returns their number, at most `most` in fds; 0: none; -EINVAL:
 * there are more; another negative errno. The environment names them no longer.
 */
int inherited_sockets(int *fds, int most);

/* Does somebody listen at that path? False also where that cannot be tried. Does not block. */
bool socket_answers(const struct sockaddr_un *address);

#endif
