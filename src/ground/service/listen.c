/* SPDX-License-Identifier: MIT */
/* Makes, takes over and accepts at the sockets of a program. */
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "src/ground/service/listen.h"
#include "src/memory/shm/corpse.h"
#include "src/memory/shm/peer.h"

#define FIRST_FD 3 /* of sd_listen_fds(3) */
/* Connections that wait; the kernel's net.core.somaxconn may be less. */
#define BACKLOG 4096
#define LOCAL_BACKLOG 1024

/*
 * bind() made it for this user alone. In a folder that others may write, another file may have
 * taken its place by now; its rights are not changed.
 */
static int give_rights(const char *path, mode_t mode, gid_t group)
{
	int fd = open(path, O_PATH | O_NOFOLLOW | O_CLOEXEC), err = 0;
	char self[32];
	struct stat st;

	if (fd < 0)
		return -errno;
	snprintf(self, sizeof(self), "/proc/self/fd/%d", fd);
	if (fstat(fd, &st) < 0 || !S_ISSOCK(st.st_mode) || st.st_uid != geteuid())
		err = -EPERM;
	else if ((group == (gid_t)-1 || fchownat(fd, "", (uid_t)-1, group, AT_EMPTY_PATH) == 0) &&
	         chmod(self, mode) < 0)
		err = -errno;
	close(fd);
	return err;
}

static int listen_local(const struct sockaddr_un *at, int type, mode_t mode, gid_t group)
{
	int fd = socket(AF_UNIX, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0), err;
	mode_t mask;

	if (fd < 0)
		return -errno;
	peer_refuse_descriptors(fd);
	mask = umask(0177);
	err = bind(fd, (const struct sockaddr *)at, sizeof(*at)) < 0 ? -errno : 0;
	umask(mask);
	if (!err)
		err = give_rights(at->sun_path, mode, group);
	if (!err && listen(fd, LOCAL_BACKLOG) < 0)
		err = -errno;
	if (!err)
		return fd;
	close(fd);
	return err;
}

/* The process that listens there, where fd is connected, answers nobody. */
static bool is_of_corpse(int fd)
{
	struct peer peer;

	return peer_look_into(fd, &peer, NULL, 0) == 0 && peer.pid > 0 && corpse_is(peer.pid);
}

/* Remove the socket of a process that was killed. */
static int vacate(const struct sockaddr_un *at)
{
	struct stat st;
	bool left;
	int fd, err;

	if (lstat(at->sun_path, &st) < 0)
		return errno == ENOENT ? 0 : -errno;
	if (!S_ISSOCK(st.st_mode))
		return -EEXIST;
	fd = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
	if (fd < 0)
		return -errno;
	err = connect(fd, (const struct sockaddr *)at, sizeof(*at)) < 0 ? errno : 0;
	left = err ? err == ECONNREFUSED : is_of_corpse(fd);
	close(fd);
	if (!left)
		return -EADDRINUSE;
	return unlink(at->sun_path) < 0 ? -errno : 0;
}

int listen_at_path(const char *path, mode_t mode, gid_t group)
{
	struct sockaddr_un at = {.sun_family = AF_UNIX};
	int err;

	if (strlen(path) >= sizeof(at.sun_path))
		return -ENAMETOOLONG;
	memcpy(at.sun_path, path, strlen(path));
	err = vacate(&at);
	return err ? err : listen_local(&at, SOCK_STREAM, mode, group);
}

int listen_at_name(int directory, const char *name, int type, mode_t mode, gid_t group)
{
	struct sockaddr_un at = {.sun_family = AF_UNIX};

	/* the directory's own path may be longer than an address has room */
	snprintf(at.sun_path, sizeof(at.sun_path), "/proc/self/fd/%d/%s", directory, name);
	if (unlinkat(directory, name, 0) < 0 && errno != ENOENT)
		return -errno;
	return listen_local(&at, type, mode, group);
}

struct listen_file listen_file_at(int directory, const char *name)
{
	struct stat st;

	if (fstatat(directory, name, &st, AT_SYMLINK_NOFOLLOW) < 0)
		return (struct listen_file){0};
	return (struct listen_file){.device = st.st_dev, .inode = st.st_ino};
}

void listen_remove(int directory, const char *name, const struct listen_file *file)
{
	struct listen_file there = listen_file_at(directory, name);

	if (there.inode && there.inode == file->inode && there.device == file->device)
		unlinkat(directory, name, 0);
}

static int listen_bind(const struct sockaddr_storage *at, bool only, bool later)
{
	bool is_v6 = at->ss_family == AF_INET6;
	socklen_t len = is_v6 ? sizeof(struct sockaddr_in6) : sizeof(struct sockaddr_in);
	int fd = socket(at->ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0), err;
	const int one = 1, v6_only = only;

	if (fd < 0)
		return -errno;
	setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &one, sizeof(one));
	if (is_v6)
		setsockopt(fd, IPPROTO_IPV6, IPV6_V6ONLY, &v6_only, sizeof(v6_only));
	if (later)
		setsockopt(fd, is_v6 ? IPPROTO_IPV6 : IPPROTO_IP,
		           is_v6 ? IPV6_FREEBIND : IP_FREEBIND, &one, sizeof(one));
	if (bind(fd, (const struct sockaddr *)at, len) == 0)
		return fd;
	err = -errno;
	close(fd);
	return err;
}

int listen_at_address(const struct sockaddr_storage *at, bool only, bool later)
{
	int fd = listen_bind(at, only, later), err;

	if (fd < 0 || listen(fd, BACKLOG) == 0)
		return fd;
	err = -errno;
	close(fd);
	return err;
}

bool listen_is_here(const struct sockaddr_storage *at)
{
	struct sockaddr_storage any_port = *at;
	int fd;

	/* the port stands at the same place in both */
	((struct sockaddr_in *)&any_port)->sin_port = 0;
	fd = listen_bind(&any_port, true, false);
	if (fd >= 0)
		close(fd);
	return fd != -EADDRNOTAVAIL;
}

int listen_inherited(int *fds, int most)
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
		peer_refuse_descriptors(fds[i]);
	}
	return (int)count;
}

const char *listen_remedy(int err)
{
	switch (-err) {
	case EADDRINUSE:
		return "; sudo ss -ltnp names the program that has the port: end it, or choose "
		       "another port";
	case EACCES:
		return "; ports below 1024 are root's: choose another";
	case EADDRNOTAVAIL:
		return "; ip addr lists the addresses that this machine has: choose one of them, "
		       "or give it this one";
	default:
		return "";
	}
}

int listen_accept(int listener, struct sockaddr *from, socklen_t *len)
{
	int fd = accept4(listener, from, len, SOCK_NONBLOCK | SOCK_CLOEXEC);
	const int one = 1;

	if (fd < 0)
		return -errno;
	if (from && from->sa_family == AF_UNIX)
		setsockopt(fd, SOL_SOCKET, SO_OOBINLINE, &one, sizeof(one));
	return fd;
}

bool listen_is_full(int err)
{
	return err == -EMFILE || err == -ENFILE || err == -ENOBUFS || err == -ENOMEM;
}

static void report(int epoll, const int *fds, unsigned count, uint32_t events)
{
	for (unsigned i = 0; i < count; i++) {
		struct epoll_event event = {.events = events, .data.u32 = i};

		if (fds[i] >= 0)
			epoll_ctl(epoll, EPOLL_CTL_MOD, fds[i], &event);
	}
}

void listen_pause(int epoll, const int *fds, unsigned count)
{
	report(epoll, fds, count, 0);
}

void listen_resume(int epoll, const int *fds, unsigned count)
{
	report(epoll, fds, count, EPOLLIN);
}
