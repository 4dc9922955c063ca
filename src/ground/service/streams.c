/* SPDX-License-Identifier: MIT */
/* Streams that a process gets from the one that starts it. */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/ground/service/streams.h"

int standard_open(void)
{
	int fd;

	signal(SIGXFSZ, SIG_IGN);
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
