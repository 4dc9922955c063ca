/* SPDX-License-Identifier: MIT */
/* The socket NAME.control in owsd's directory. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "src/ground/service/listen.h"
#include "src/memory/control/socket.h"

#define BACKLOG 1024 /* the kernel's net.core.somaxconn may be less */

int socket_open_for(int directory, const char *name, bool all)
{
	return fchmodat(directory, name, all ? 0666 : 0600, 0) < 0 ? -errno : 0;
}

void socket_remove(int directory, const char *name, ino_t inode)
{
	struct stat st;

	if (fstatat(directory, name, &st, AT_SYMLINK_NOFOLLOW) == 0 && st.st_ino == inode)
		unlinkat(directory, name, 0);
}

int socket_listen(int directory, const char *name, bool for_all, ino_t *inode)
{
	struct sockaddr_un to = {.sun_family = AF_UNIX};
	struct stat st;
	int fd, err;

	/* the directory's own path may be longer than an address has room */
	snprintf(to.sun_path, sizeof(to.sun_path), "/proc/self/fd/%d/%s", directory, name);
	if (unlinkat(directory, name, 0) < 0 && errno != ENOENT)
		return -errno;
	fd = listen_local(&to, SOCK_SEQPACKET, for_all ? 0666 : 0600, (gid_t)-1);
	if (fd < 0)
		return fd;
	if (fstatat(directory, name, &st, AT_SYMLINK_NOFOLLOW) < 0 || listen(fd, BACKLOG) < 0) {
		err = -errno;
		close(fd);
		return err;
	}
	*inode = st.st_ino;
	return fd;
}
