/* SPDX-License-Identifier: MIT */
/* The client of another owsd-web. What that sends is believed in nothing but checked fields. */
#include <errno.h>
#include <netdb.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/faces/web/ask.h"
#include "src/public/ows.h"

/* What the number of an answer means, where it is not 200. */
static const struct {
	int status;
	const char *words;
} statuses[] = {
	{301, "it leads elsewhere: give the address that it leads to"},
	{302, "it leads elsewhere: give the address that it leads to"},
	{307, "it leads elsewhere: give the address that it leads to"},
	{308, "it leads elsewhere: give the address that it leads to"},
	{401, "it wants a password: give an address that wants none, or a socket"},
	{403, "it serves its proxy alone"},
	{404, "there is no owsd-web that has a summary: look at the path and the version"},
	{421, "that machine has no such name: add it to Hosts of its block Web"},
};

static bool __attribute__((format(printf, 2, 3))) fail(char why[ASK_WORDS], const char *format, ...)
{
	va_list args;

	va_start(args, format);
	vsnprintf(why, ASK_WORDS, format, args);
	va_end(args);
	return false;
}

static bool fail_with(char why[ASK_WORDS], int err)
{
	return err == ETIMEDOUT ? fail(why, "it does not answer in time")
	                        : fail(why, "%s", strerror(err));
}

/* --- The answer ------------------------------------------------------------------------------ */

/* "HTTP/1.1 200 OK"; negative: it is no such line. */
static int status_of(const char *bytes, size_t len)
{
	int status = 0;

	if (len < 13 || memcmp(bytes, "HTTP/1.", 7) || bytes[8] != ' ')
		return -1;
	for (int i = 9; i < 12; i++) {
		if (bytes[i] < '0' || bytes[i] > '9')
			return -1;
		status = status * 10 + bytes[i] - '0';
	}
	return status;
}

bool ask_parse(char *bytes, size_t len, struct summary *summary, char why[ASK_WORDS])
{
	static const char end[] = "\r\n\r\n";
	char *body = memmem(bytes, len, end, strlen(end));
	int status = status_of(bytes, len);

	if (status < 0 || !body)
		return fail(why, "what answers there does not speak HTTP");
	for (size_t i = 0; i < sizeof(statuses) / sizeof(statuses[0]); i++)
		if (status == statuses[i].status)
			return fail(why, "%s", statuses[i].words);
	if (status != 200)
		return fail(why, "it answers with status %d", status);
	body += strlen(end);
	if (summary_parse(body, len - (size_t)(body - bytes), summary))
		return fail(why, "its answer is no summary of an owsd-web");
	return true;
}

/* --- The connection -------------------------------------------------------------------------- */

/* 0, or a negative errno. */
static int wait_for(int fd, short events, int64_t until_ns)
{
	struct pollfd ready = {.fd = fd, .events = events};
	int64_t left_ms = (until_ns - ows_now()) / NS_PER_MS;
	int n = left_ms > 0 ? poll(&ready, 1, (int)left_ms) : 0;

	if (n < 0)
		return errno == EINTR ? 0 : -errno;
	return n ? 0 : -ETIMEDOUT;
}

static int connect_at(const struct sockaddr *address, socklen_t len, int64_t until_ns)
{
	int fd = socket(address->sa_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0), err = 0;
	socklen_t size = sizeof(err);

	if (fd < 0)
		return -errno;
	if (connect(fd, address, len))
		err = errno == EINPROGRESS ? wait_for(fd, POLLOUT, until_ns) : -errno;
	if (!err && !getsockopt(fd, SOL_SOCKET, SO_ERROR, &err, &size))
		err = -err;
	if (!err)
		return fd;
	close(fd);
	return err;
}

/* Each address of a name has its share of the time that is left. */
static int connect_name(const struct other_place *place, int64_t until_ns, char why[ASK_WORDS])
{
	struct addrinfo hints = {.ai_socktype = SOCK_STREAM}, *found;
	int fd = -EHOSTUNREACH, err = getaddrinfo(place->host, place->port, &hints, &found), n = 0;

	if (err) {
		fail(why, "no address of that name was found: %s", gai_strerror(err));
		return -1;
	}
	for (struct addrinfo *at = found; at; at = at->ai_next)
		n++;
	for (struct addrinfo *at = found; at && fd < 0; at = at->ai_next, n--)
		fd = connect_at(at->ai_addr, at->ai_addrlen,
		                ows_now() + (until_ns - ows_now()) / n);
	freeaddrinfo(found);
	if (fd < 0)
		fail_with(why, -fd);
	return fd;
}

static int connect_socket(const struct other_place *place, int64_t until_ns, char why[ASK_WORDS])
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	int fd;

	snprintf(address.sun_path, sizeof(address.sun_path), "%.107s", place->host);
	fd = connect_at((struct sockaddr *)&address, sizeof(address), until_ns);
	if (fd < 0)
		fail_with(why, -fd);
	return fd;
}

static int send_all(int fd, const char *text, int64_t until_ns)
{
	size_t left = strlen(text);

	while (left) {
		ssize_t n = send(fd, text, left, MSG_NOSIGNAL | MSG_DONTWAIT);
		int err = n >= 0 ? 0 : errno == EAGAIN ? wait_for(fd, POLLOUT, until_ns) : -errno;

		if (err)
			return err;
		text += n > 0 ? n : 0;
		left -= n > 0 ? (size_t)n : 0;
	}
	return 0;
}

/* Up to the end: how many bytes, or a negative errno; -EFBIG: there were more. */
static int receive_all(int fd, char *bytes, size_t size, int64_t until_ns)
{
	size_t len = 0;

	for (;;) {
		ssize_t n;
		int err = wait_for(fd, POLLIN, until_ns);

		if (err)
			return err;
		n = recv(fd, bytes + len, size - len, MSG_DONTWAIT);
		if (n < 0 && errno != EAGAIN && errno != EINTR)
			return -errno;
		if (n == 0)
			return (int)len;
		len += n > 0 ? (size_t)n : 0;
		if (len == size)
			return -EFBIG;
	}
}

bool ask_summary(const struct other_place *place, int64_t until_ns, struct summary *summary,
                 char why[ASK_WORDS])
{
	bool named = *place->port, v6 = named && strchr(place->host, ':');
	char request[800], bytes[ASK_MAX + 1] = "";
	int len, fd = named ? connect_name(place, until_ns, why)
	                    : connect_socket(place, until_ns, why);

	if (fd < 0)
		return false;
	snprintf(request, sizeof(request),
	         "GET %sapi/summary HTTP/1.0\r\nHost: %s%s%s%s%s\r\nConnection: close\r\n\r\n",
	         place->path, v6 ? "[" : "", named ? place->host : "localhost", v6 ? "]" : "",
	         named ? ":" : "", place->port);
	len = send_all(fd, request, until_ns);
	if (!len)
		len = receive_all(fd, bytes, sizeof(bytes), until_ns);
	close(fd);
	if (len == -EFBIG)
		return fail(why, "its answer is longer than 16 KiB");
	return len < 0 ? fail_with(why, -len) : ask_parse(bytes, (size_t)len, summary, why);
}
