/* SPDX-License-Identifier: MIT */
/* Streams and sockets that a process gets from the one that starts it. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "src/service/streams.h"

int standard_open(void)
{
	int fd;

	/* open() returns the lowest number that is free */
	do
		fd = open("/dev/null", O_RDONLY);
	while ((fd >= 0 && fd <= STDERR_FILENO) || (fd < 0 && errno == EINTR));
	if (fd < 0)
		return -errno;
	close(fd);
	return 0;
}

bool journal_is_stderr(void)
{
	const char *stream = getenv("JOURNAL_STREAM");
	unsigned long long device, inode;
	struct stat st;

	/* NOLINTNEXTLINE(cert-err34-c): a number out of range is none of ours either */
	return stream && sscanf(stream, "%llu:%llu", &device, &inode) == 2 &&
	       fstat(STDERR_FILENO, &st) == 0 && st.st_dev == device && st.st_ino == inode;
}

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
