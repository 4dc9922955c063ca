/* SPDX-License-Identifier: MIT */
/*
 * doors ATTACK SOCKET [NUMBER or TEXT]: what a user may do to owsd by a socket of its, at its
 * worst. Prints "ready" when it holds, "refused" when the kernel let none of it through, and waits
 * to be killed.
 *   linger FLAGS   a hello with these flags that has a descriptor with it whose close() sleeps for
 *                  an hour, if it is the last: in the hello itself, and behind it
 *   stranger 0     the same by a user who is refused: it is sent before owsd has looked
 *   served 0       the same in a request to the served protocol
 *   stream TEXT    the same in a request of that text to the socket of another program
 *   watches TEXT   a request of that text, or the reading of such a path by the served protocol
 *                  over and over, to a socket or a port of this machine. The connection's own end
 *                  is watched very often. Prints "closed" when the other end has closed it
 *   places TEXT    as many connections as there may be, each with a request of that text; prints
 *                  how many had no end of their own within two seconds
 */
#include <errno.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "src/public/ows.h"
#include "src/public/ows_layout.h"

#define HOUR 3600
#define HITS 4
#define TRIES 20000
#define COPIES 500
#define WATCHES 100000
#define PLACES 1300
#define REFUSED 3 /* the kernel lets no descriptor through */

static struct sockaddr_un door = {.sun_family = AF_UNIX};
static int door_type = SOCK_SEQPACKET;

static void fail(const char *what)
{
	printf("%s: %s\n", what, strerror(errno));
	fflush(stdout);
	exit(1);
}

/* Ready, or all was refused: either way the connections stay until the end. */
static void stay(unsigned done)
{
	puts(done ? "ready" : "refused");
	fflush(stdout);
	pause();
}

static int dial(int flags)
{
	int fd = socket(AF_UNIX, door_type | SOCK_CLOEXEC | flags, 0);

	if (fd >= 0 && connect(fd, (const struct sockaddr *)&door, sizeof(door)) == 0)
		return fd;
	if (fd >= 0)
		close(fd);
	return -1;
}

/* Its connections wait there for ever, and nobody reads from them. */
static struct sockaddr_in listen_deaf(void)
{
	static struct sockaddr_in at;
	socklen_t len = sizeof(at);
	int fd;

	if (at.sin_port)
		return at;
	at = (struct sockaddr_in){.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
	fd = socket(AF_INET, SOCK_STREAM, 0);
	if (fd < 0 || bind(fd, (struct sockaddr *)&at, sizeof(at)) || listen(fd, 1000) ||
	    getsockname(fd, (struct sockaddr *)&at, &len))
		fail("a port");
	return at;
}

/* A connection with more to send than its peer takes: its last close() waits. */
static int lingering(const struct sockaddr_in *to)
{
	const struct linger linger = {.l_onoff = 1, .l_linger = HOUR};
	int fd = socket(AF_INET, SOCK_STREAM, 0);
	static char bytes[65536];

	if (fd < 0 || connect(fd, (const struct sockaddr *)to, sizeof(*to)))
		fail("a connection that lingers");
	while (send(fd, bytes, sizeof(bytes), MSG_DONTWAIT) > 0)
		;
	if (setsockopt(fd, SOL_SOCKET, SO_LINGER, &linger, sizeof(linger)))
		fail("SO_LINGER");
	return fd;
}

static bool send_fd(int connection, const void *bytes, size_t len, int fd, int flags)
{
	union {
		struct cmsghdr align;
		char room[CMSG_SPACE(sizeof(int))];
	} control = {0};
	struct iovec part = {(void *)(uintptr_t)bytes, len};
	struct msghdr message = {.msg_iov = &part,
	                         .msg_iovlen = 1,
	                         .msg_control = &control,
	                         .msg_controllen = sizeof(control)};
	struct cmsghdr *c = CMSG_FIRSTHDR(&message);

	c->cmsg_level = SOL_SOCKET;
	c->cmsg_type = SCM_RIGHTS;
	c->cmsg_len = CMSG_LEN(sizeof(int));
	memcpy(CMSG_DATA(c), &fd, sizeof(int));
	return sendmsg(connection, &message, MSG_NOSIGNAL | flags) >= 0;
}

/*
 * Send the bytes with a descriptor of which no copy is left here: a process that ends waits for
 * none. Returns whether they were taken.
 */
static bool send_with(int connection, const void *bytes, size_t len, int flags)
{
	struct sockaddr_in to = listen_deaf();
	int status = -1;
	pid_t pid = fork();

	if (pid == 0)
		_exit(!send_fd(connection, bytes, len, lingering(&to), flags));
	if (pid < 0 || waitpid(pid, &status, 0) != pid)
		fail("a process");
	return status == 0;
}

static struct ows_hello hello_of(uint32_t flags)
{
	return (struct ows_hello){.magic = OWS_HELLO_MAGIC,
	                          .major = OWS_LAYOUT_MAJOR,
	                          .minor = OWS_LAYOUT_MINOR,
	                          .flags = flags,
	                          .name = "hostile"};
}

static void linger(uint32_t flags)
{
	struct ows_hello hello = hello_of(flags);
	unsigned hits = 0;

	for (unsigned i = 0; i < HITS; i++) {
		int in = dial(0), behind = dial(0);

		if (in < 0 || behind < 0)
			fail("connect");
		hits += send_with(in, &hello, sizeof(hello), 0);
		send(behind, &hello, sizeof(hello), MSG_NOSIGNAL);
		hits += send_with(behind, "", 0, 0);
		hits += send_with(behind, "", 1, 0);
		close(in);
		close(behind);
	}
	stay(hits);
}

static void *keep_busy(void *arg)
{
	(void)arg;
	for (;;) {
		int fd = dial(SOCK_NONBLOCK);

		if (fd >= 0)
			close(fd);
	}
	return NULL;
}

/* Connect and send until a message was there before owsd looked; a child, which then ends. */
static void be_first(const struct sockaddr_in *to)
{
	struct ows_hello hello = hello_of(0);
	int fd = lingering(to);

	for (unsigned i = 0; i < TRIES; i++) {
		int connection = dial(SOCK_NONBLOCK);

		if (connection < 0)
			continue;
		if (send_fd(connection, &hello, sizeof(hello), fd, 0))
			_exit(0);
		if (errno == EPERM)
			_exit(REFUSED);
		close(connection);
	}
	_exit(1);
}

/* Its thread keeps owsd busy with refusals meanwhile. */
static void stranger(void)
{
	struct sockaddr_in to = listen_deaf();
	pthread_t thread;
	int status = 0;

	if (pthread_create(&thread, NULL, keep_busy, NULL))
		fail("thread");
	for (unsigned i = 0; i < HITS && status == 0; i++) {
		pid_t pid = fork();

		if (pid == 0)
			be_first(&to);
		if (pid < 0 || waitpid(pid, &status, 0) != pid)
			fail("a process");
	}
	if (status != 0 && WEXITSTATUS(status) != REFUSED)
		fail("owsd was always first");
	stay(status == 0);
}

/* With the request, with its second half, behind it, and out of band, which a look would miss. */
static void attack_stream(const void *request, size_t len)
{
	unsigned hits = 0;

	door_type = SOCK_STREAM;
	for (unsigned i = 0; i < HITS; i++) {
		int in = dial(0), half = dial(0), last = dial(0), urgent = dial(0);

		if (in < 0 || half < 0 || last < 0 || urgent < 0)
			fail("connect");
		hits += send_with(in, request, len, 0);
		send(half, request, 5, MSG_NOSIGNAL);
		hits += send_with(half, (const char *)request + 5, len - 5, 0);
		send(last, request, len, MSG_NOSIGNAL);
		hits += send_with(last, request, 5, 0);
		hits += send_with(urgent, "", 1, MSG_OOB);
		send(urgent, request, len, MSG_NOSIGNAL);
		close(in);
		close(half);
		close(last);
		close(urgent);
	}
	stay(hits);
}

static void served(void)
{
	static const unsigned char nop[24] = {[11] = 1, [14] = 1, [15] = 10};

	attack_stream(nop, sizeof(nop));
}

static int dial_any(const char *where)
{
	struct sockaddr_in to = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
	const int one = 1;
	int fd;

	door_type = SOCK_STREAM;
	if (*where == '/') {
		fd = dial(0);
	} else {
		to.sin_port = htons((uint16_t)strtoul(where, NULL, 10));
		fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
		setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &one, sizeof(one));
		if (fd >= 0 && connect(fd, (struct sockaddr *)&to, sizeof(to)))
			fail("connect");
	}
	if (fd < 0)
		fail("connect");
	return fd;
}

static void more_files(void)
{
	struct rlimit files;

	getrlimit(RLIMIT_NOFILE, &files);
	files.rlim_cur = files.rlim_max;
	setrlimit(RLIMIT_NOFILE, &files);
}

static void watch(int fd)
{
	struct epoll_event event = {.events = EPOLLIN};
	int copies[COPIES];

	for (unsigned i = 0; i < COPIES; i++)
		copies[i] = dup(fd);
	for (unsigned done = 0; done < WATCHES; done += COPIES) {
		int epoll = epoll_create1(EPOLL_CLOEXEC);

		if (epoll < 0)
			fail("epoll");
		for (unsigned i = 0; i < COPIES; i++)
			if (epoll_ctl(epoll, EPOLL_CTL_ADD, copies[i], &event))
				fail("watches");
	}
}

/* The page has a stream, the served protocol an answer to each request. */
static void watches(const char *where, const char *request, size_t len)
{
	struct pollfd answer = {.events = POLLIN};
	static char bytes[65536];

	more_files();
	answer.fd = dial_any(where);
	watch(answer.fd);
	puts("ready");
	fflush(stdout);
	send(answer.fd, request, len, MSG_NOSIGNAL);
	while (poll(&answer, 1, -1) == 1 && recv(answer.fd, bytes, sizeof(bytes), 0) > 0)
		if (*request != 'G')
			send(answer.fd, request, len, MSG_NOSIGNAL);
	puts("closed");
	fflush(stdout);
	pause();
}

static void places(const char *where, const char *request)
{
	static struct pollfd fds[PLACES];
	unsigned open = 0;
	char byte;

	more_files();
	for (unsigned i = 0; i < PLACES; i++) {
		fds[i].fd = dial_any(where);
		send(fds[i].fd, request, strlen(request), MSG_NOSIGNAL);
	}
	sleep(2); /* pace: refusals come at once */
	for (unsigned i = 0; i < PLACES; i++)
		open += recv(fds[i].fd, &byte, 1, MSG_DONTWAIT) < 0 && errno == EAGAIN;
	printf("%u\n", open);
	stay(open);
}

/* A reading of the id of a device, persistent. */
static size_t frame(const char *path, unsigned char bytes[64])
{
	size_t len = strlen(path) + 1;

	memset(bytes, 0, 64);
	bytes[7] = (unsigned char)len;
	bytes[11] = 2;
	bytes[14] = 1;
	bytes[15] = 4;
	bytes[18] = 4;
	memcpy(bytes + 24, path, len);
	return 24 + len;
}

int main(int argc, char **argv)
{
	unsigned char bytes[64];
	uint32_t number = argc > 3 ? (uint32_t)strtoul(argv[3], NULL, 10) : 0;

	if (argc < 3)
		return 2;
	snprintf(door.sun_path, sizeof(door.sun_path), "%s", argv[2]);
	if (strcmp(argv[1], "linger") == 0)
		linger(number);
	else if (strcmp(argv[1], "stranger") == 0)
		stranger();
	else if (strcmp(argv[1], "served") == 0)
		served();
	else if (strcmp(argv[1], "stream") == 0 && argc > 3)
		attack_stream(argv[3], strlen(argv[3]));
	else if (strcmp(argv[1], "watches") == 0 && argc > 3 && *argv[3] == '/')
		watches(argv[2], (const char *)bytes, frame(argv[3], bytes));
	else if (strcmp(argv[1], "watches") == 0 && argc > 3)
		watches(argv[2], argv[3], strlen(argv[3]));
	else if (strcmp(argv[1], "places") == 0 && argc > 3)
		places(argv[2], argv[3]);
	return 2;
}
