/* SPDX-License-Identifier: MIT */
/* The connection to owsd's control socket: connects, says hello, receives welcomes. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/timerfd.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/memory/libows/join.h"
#include "src/public/ows.h"

#define FIRST 3 /* descriptors of the first welcome: memory, bell, news; later the memory alone */
#define ERRNO_MAX 4095
/* Nothing wakes a program when owsd dies in a frozen state, or is back: so often it looks */
#define TIMER_NS (500 * NS_PER_MS)

void join_none(struct join *join)
{
	*join = (struct join){
		.connection = -1,
		.bell = -1,
		.news = -1,
		.epoll = -1,
		.timer = -1,
	};
}

static void close_fd(int *fd)
{
	if (*fd >= 0)
		close(*fd);
	*fd = -1;
}

static int watch(struct join *join, int fd)
{
	struct epoll_event event = {.events = EPOLLIN};

	return epoll_ctl(join->epoll, EPOLL_CTL_ADD, fd, &event) < 0 ? -errno : 0;
}

int join_watch(struct join *join)
{
	const struct timespec each = {.tv_nsec = TIMER_NS};
	int err;

	if (join->epoll >= 0)
		return 0;
	join->epoll = epoll_create1(EPOLL_CLOEXEC);
	join->timer = timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK);
	if (join->epoll < 0 || join->timer < 0 ||
	    timerfd_settime(join->timer, 0, &(struct itimerspec){each, each}, NULL) < 0)
		err = -errno;
	else
		err = watch(join, join->timer);
	if (!err && join->news >= 0)
		err = watch(join, join->news);
	if (err) {
		close_fd(&join->epoll);
		close_fd(&join->timer);
	}
	return err;
}

void join_hush(struct join *join)
{
	/* closing it does not take it out while a forked child has it too */
	if (join->epoll >= 0 && join->news >= 0)
		epoll_ctl(join->epoll, EPOLL_CTL_DEL, join->news, NULL);
	close_fd(&join->news);
}

void join_end(struct join *join)
{
	close_fd(&join->connection);
	close_fd(&join->bell);
	join_hush(join);
}

void join_leave(struct join *join)
{
	close_fd(&join->epoll);
	close_fd(&join->timer);
	join_end(join);
}

static int connect_to(int directory, const char *file, int *connection)
{
	/* the queue of the socket may be full of others: the kernel lets this one wait */
	const struct timeval most = {.tv_sec = 1};
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	int fd, err;

	/* The directory's own path may be longer than an address has room */
	snprintf(address.sun_path, sizeof(address.sun_path), "/proc/self/fd/%d/%s", directory,
	         file);
	fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
	if (fd < 0)
		return -errno;
	setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &most, sizeof(most));
	if (connect(fd, (const struct sockaddr *)&address, sizeof(address)) < 0) {
		err = errno == ECONNREFUSED || errno == EPROTOTYPE ? -ENOENT : -errno;
		close(fd);
		return err;
	}
	fcntl(fd, F_SETFL, O_NONBLOCK);
	*connection = fd;
	return 0;
}

int join_begin(struct join *join, int directory, const char *file, const char *program,
               uint32_t flags)
{
	struct ows_hello hello = {
		.magic = OWS_HELLO_MAGIC,
		.major = OWS_LAYOUT_MAJOR,
		.minor = OWS_LAYOUT_MINOR,
		.flags = flags,
	};
	int err;

	join_end(join);
	err = connect_to(directory, file, &join->connection);
	if (err)
		return err;
	memcpy(hello.token, join->token, sizeof(hello.token));
	memcpy(hello.name, program, strnlen(program, sizeof(hello.name) - 1));
	join->new = true;
	/* An owsd that refuses this program answers and hangs up before it reads the hello */
	if (send(join->connection, &hello, sizeof(hello), MSG_NOSIGNAL) != sizeof(hello) &&
	    errno != EPIPE && errno != ECONNRESET) {
		join_end(join);
		return -ENOENT;
	}
	return 0;
}

/* Copy up to FIRST descriptors of a message, and close all others; returns how many there were. */
static unsigned take_descriptors(struct msghdr *message, int fds[FIRST])
{
	unsigned count = 0;

	for (struct cmsghdr *c = CMSG_FIRSTHDR(message); c != NULL; c = CMSG_NXTHDR(message, c)) {
		size_t n;

		if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_RIGHTS)
			continue;
		n = (c->cmsg_len - CMSG_LEN(0)) / sizeof(int);
		for (size_t i = 0; i < n; i++, count++) {
			int fd;

			memcpy(&fd, CMSG_DATA(c) + i * sizeof(fd), sizeof(fd));
			if (count < FIRST)
				fds[count] = fd;
			else
				close(fd);
		}
	}
	return count;
}

static int check_welcome(const struct join *join, const struct ows_welcome *welcome, ssize_t n,
                         unsigned count)
{
	if (n < (ssize_t)sizeof(*welcome) || welcome->magic != OWS_WELCOME_MAGIC ||
	    welcome->err > 0 || welcome->err < -ERRNO_MAX)
		return -EPROTO;
	if (welcome->err)
		return welcome->err;
	if (welcome->major != OWS_LAYOUT_MAJOR || count != (join->new ? FIRST : 1))
		return -EPROTO;
	return 0;
}

static int receive_welcome(struct join *join, struct ows_welcome *welcome, int *memory)
{
	union {
		struct cmsghdr align;
		char room[CMSG_SPACE((FIRST + 1) * sizeof(int))];
	} control = {0};
	struct iovec data = {.iov_base = welcome, .iov_len = sizeof(*welcome)};
	struct msghdr message = {
		.msg_iov = &data,
		.msg_iovlen = 1,
		.msg_control = control.room,
		.msg_controllen = sizeof(control.room),
	};
	int fds[FIRST] = {-1, -1, -1}, err;
	ssize_t n = recvmsg(join->connection, &message, MSG_CMSG_CLOEXEC | MSG_DONTWAIT);

	if (n < 0 && errno == ECONNRESET) /* what owsd has sent lies behind that */
		n = recvmsg(join->connection, &message, MSG_CMSG_CLOEXEC | MSG_DONTWAIT);
	if (n < 0)
		return errno == EAGAIN || errno == EINTR ? -EAGAIN : -ENOTCONN;
	err = n == 0 ? -ENOTCONN : check_welcome(join, welcome, n, take_descriptors(&message, fds));
	if (message.msg_flags & MSG_CTRUNC)
		err = -EMFILE; /* no room in the table of descriptors */
	if (err) {
		for (int i = 0; i < FIRST; i++)
			close_fd(&fds[i]);
		return err;
	}
	*memory = fds[0];
	if (join->new) {
		join->bell = fds[1];
		join->news = fds[2];
		/* without it the timer alone wakes the program */
		if (join->epoll >= 0)
			watch(join, join->news);
	}
	join->new = false;
	memcpy(join->token, welcome->token, sizeof(join->token));
	return 0;
}

bool join_await(int fd, int64_t until_ns)
{
	struct pollfd poll_fd = {.fd = fd, .events = POLLIN};
	int64_t left = until_ns - ows_now();
	struct timespec t = timespec_of(left);

	if (left <= 0)
		return false;
	ppoll(&poll_fd, 1, &t, NULL);
	return true;
}

int join_receive(struct join *join, int64_t until_ns, struct ows_welcome *welcome, int *memory)
{
	int err;

	*memory = -1;
	do
		err = receive_welcome(join, welcome, memory);
	while (err == -EAGAIN && join_await(join->connection, until_ns));
	if (err && err != -EAGAIN)
		join_end(join);
	return err;
}
