/* SPDX-License-Identifier: MIT */
/* Streams and sockets that a process gets from the one that starts it. */
#pragma once

#include <stdbool.h>

/*
 * Open /dev/null on each of standard input, output and error that the caller has closed, so that no
 * file opened later gets its number and with it the messages meant for the user. Writes there still
 * fail. Called first in main(). Returns 0 or a negative errno.
 */
int standard_open(void);

/* Does stderr go to the journal of systemd, which reads levels from "<4>" prefixes? */
bool journal_is_stderr(void);

struct sockaddr_un;

/* Sockets of a service: inherited from the service manager, or left by another process. */

/*
 * The sockets that the service manager has opened for this process, as sd_listen_fds(3) has them:
 * closed on exec, not blocking. Returns their number, at most `most` in fds; 0: none; -EINVAL:
 * there are more; another negative errno. The environment names them no longer.
 */
int inherited_sockets(int *fds, int most);

/* Does a process listen at that path? False also where that cannot be tried. Does not block. */
bool socket_answers(const struct sockaddr_un *address);
