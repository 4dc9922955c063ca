/* SPDX-License-Identifier: MIT */
/* Sockets that the service manager has opened (socket activation), or another process. */
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "src/service/inherited.h"

#define FIRST_FD 3 /* of sd_listen_fds(3) */

int inherited_sockets(int *fds, int most)
{
	const char *pid = getenv("LISTEN_PID"), *names = getenv("LISTEN_FDS");
	long count = pid && names && strtol(pid, NULL, 10) == getpid() ? strtol(names, NULL, 10)
	                                                               : 0;

	unsetenv("LISTEN_PID");
	unsetenv("LISTEN_FDS");
	if (count < 0 || count > most)
		return -EINVAL;
	for (int i = 0; i < (int)count; i++) {
		fds[i] = FIRST_FD + i;
		if (fcntl(fds[i], F_SETFD, FD_CLOEXEC) || fcntl(fds[i], F_SETFL, O_NONBLOCK))
			return -errno;
	}
	return (int)count;
}

bool socket_answers(const struct sockaddr_un *address)
{
	int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	bool is;

	if (fd < 0)
		return false;
	is = connect(fd, (const struct sockaddr *)address, sizeof(*address)) == 0 ||
	     errno == EAGAIN;
	close(fd);
	return is;
}
