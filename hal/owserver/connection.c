/* SPDX-License-Identifier: MIT */
/* A connection to an owserver: its addresses, connecting, sending and receiving. */
#include <errno.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "hal/bus/tap.h"
#include "hal/owserver/connection.h"
#include "hal/owserver/listener.h"

#define DEFAULT_HOST "localhost"
#define DEFAULT_PORT "4304"
/* The time for one address of several, so that it does not use up the time of the others. */
#define ADDRESS_NS NS_PER_S

static int set_part(char *out, size_t size, const char *from, size_t len)
{
	if (len == 0 || len >= size)
		return -EINVAL;
	memcpy(out, from, len);
	out[len] = '\0';
	return 0;
}

static int set_port(char *out, size_t size, const char *text)
{
	if (set_part(out, size, text, strlen(text)) || text[strspn(text, "0123456789")] ||
	    strtoul(text, NULL, 10) < 1 || strtoul(text, NULL, 10) > 65535)
		return -EINVAL;
	return 0;
}

static int set_path(struct connection *connection, const char *path, char *why, size_t why_size)
{
	if (strlen(path) >= sizeof(((struct sockaddr_un *)NULL)->sun_path)) {
		snprintf(why, why_size, "the path of a socket has at most %zu bytes",
		         sizeof(((struct sockaddr_un *)NULL)->sun_path) - 1);
		return -EINVAL;
	}
	return set_part(connection->host, sizeof(connection->host), path, strlen(path));
}

int connection_init(struct connection *connection, const struct bus_env *env, const char *where,
                    char *why, size_t why_size)
{
	bool brackets = where[0] == '[';
	const char *host = where + brackets;
	size_t len = strcspn(host, brackets ? "]" : ":");
	const char *rest = host + len + (brackets && host[len]);
	bool bad_port = false;
	int err = 0;

	*connection = (struct connection){
		.env = env, .fd = -1, .host = DEFAULT_HOST, .port = DEFAULT_PORT};
	if (!*where)
		return 0;
	if (*where == '/')
		return set_path(connection, where, why, why_size);
	if (brackets && host[len] != ']')
		err = -EINVAL;
	if (!err)
		err = set_part(connection->host, sizeof(connection->host), host, len);
	if (!err && (!len || strpbrk(connection->host, " \t/") || (*rest && *rest != ':')))
		err = -EINVAL;
	if (!err && *rest) {
		err = set_port(connection->port, sizeof(connection->port), rest + 1);
		bad_port = err != 0;
	}
	if (bad_port)
		snprintf(why, why_size, "the port '%.40s' is not a number from 1 to 65535",
		         rest + 1);
	else if (err)
		snprintf(why, why_size, "HOST, HOST:PORT, [IPv6]:PORT or /SOCKET is expected");
	return err;
}

/* Why the address that was tried last is of no use. Returns the error. */
static int set_trouble(struct connection *connection)
{
	/* what is at the other addresses matters less than who is at one of them */
	if (!connection->stranger)
		snprintf(connection->trouble, sizeof(connection->trouble), "%.60s: %.36s%s",
		         connection->peer, strerror(-connection->last_err),
		         connection->last_err == -ECONNREFUSED ? "; does an owserver run there?"
		                                               : "");
	return connection->last_err;
}

static int resolve(struct connection *connection)
{
	const struct addrinfo hints = {
		.ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM, .ai_flags = AI_NUMERICSERV};
	/* getaddrinfo() finds the loopback addresses without loading a name service */
	bool is_local = strcmp(connection->host, DEFAULT_HOST) == 0;
	int err = getaddrinfo(is_local ? NULL : connection->host, connection->port, &hints,
	                      &connection->list);

	connection->next = NULL;
	connection->stranger = false;
	snprintf(connection->peer, sizeof(connection->peer), "%.60s:%s", connection->host,
	         connection->port);
	if (!err) {
		connection->next = connection->list;
		return 0;
	}
	connection->list = NULL;
	snprintf(connection->trouble, sizeof(connection->trouble), "'%.40s' has no address: %.40s",
	         connection->host, gai_strerror(err));
	return -EHOSTUNREACH;
}

static void forget_addresses(struct connection *connection)
{
	if (connection->list)
		freeaddrinfo(connection->list);
	connection->list = connection->next = NULL;
}

static void close_socket(struct connection *connection)
{
	if (connection->fd >= 0)
		close(connection->fd);
	connection->fd = -1;
}

static void note_peer(struct connection *connection, const struct addrinfo *address)
{
	char host[48], port[8];

	if (getnameinfo(address->ai_addr, address->ai_addrlen, host, sizeof(host), port,
	                sizeof(port), NI_NUMERICHOST | NI_NUMERICSERV))
		return;
	snprintf(connection->peer, sizeof(connection->peer),
	         address->ai_family == AF_INET6 ? "[%s]:%s" : "%s:%s", host, port);
}

/*
 * Who is at the other end? -ECONNREFUSED: the socket itself, which happens with a port of this
 * machine without a listener, or a program that does not listen any more. -EPERM: one that is not
 * trusted. Else 0.
 */
static int check_peer(struct connection *connection)
{
	struct sockaddr_storage here = {0}, there = {0};
	socklen_t here_len = sizeof(here), there_len = sizeof(there);
	uid_t user;
	int err;

	if (getsockname(connection->fd, (struct sockaddr *)&here, &here_len) ||
	    getpeername(connection->fd, (struct sockaddr *)&there, &there_len))
		return -errno;
	if (here.ss_family == AF_UNIX)
		return 0;
	err = listener_user("/proc/self/net", (struct sockaddr *)&there, (struct sockaddr *)&here,
	                    &user);
	if (err == -ENOENT || (!err && listener_is_trusted(user)))
		return 0;
	if (err)
		return err;
	snprintf(connection->trouble, sizeof(connection->trouble),
	         "%.36s: not believed, for the user %u serves it; a system user or root has to",
	         connection->peer, (unsigned)user);
	connection->stranger = true;
	return -EPERM;
}

/*
 * Start to connect to the next address that does not fail at once. 0, or the error of the last one.
 */
static int try_next(struct connection *connection)
{
	const int on = 1;

	close_socket(connection);
	while (connection->next) {
		const struct addrinfo *address = connection->next;

		connection->next = address->ai_next;
		note_peer(connection, address);
		connection->fd = socket(address->ai_family,
		                        SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
		if (connection->fd >= 0) {
			connection->give_up_ns = INT64_MAX;
			if (connection->next)
				connection->give_up_ns = bus_now(connection->env) + ADDRESS_NS;
			setsockopt(connection->fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
			if (connect(connection->fd, address->ai_addr, address->ai_addrlen) == 0 ||
			    errno == EINPROGRESS || errno == EINTR)
				return 0;
		}
		connection->last_err = -errno;
		close_socket(connection);
	}
	return set_trouble(connection);
}

/* Connect to a unix socket, which succeeds or fails at once. */
static int begin_local(struct connection *connection)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};

	memcpy(address.sun_path, connection->host, strlen(connection->host));
	snprintf(connection->peer, sizeof(connection->peer), "%.79s", connection->host);
	connection->give_up_ns = INT64_MAX;
	connection->fd = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
	if (connection->fd >= 0 &&
	    connect(connection->fd, (struct sockaddr *)&address, sizeof(address)) == 0)
		return 0;
	/* the queue is full: report it as no server, because -EAGAIN means to go on */
	connection->last_err = errno == EAGAIN ? -ECONNREFUSED : -errno;
	return set_trouble(connection);
}

static int begin_remote(struct connection *connection)
{
	int err = resolve(connection);

	return err ? err : try_next(connection);
}

/* Does something else stand in place of the server? */
static bool is_replayed(const struct connection *connection)
{
	return connection->env->tap && connection->env->tap->connect;
}

int connection_begin(struct connection *connection)
{
	int err;

	connection_close(connection);
	if (is_replayed(connection)) {
		connection->fd = connection->env->tap->connect(connection->env->tap);
		return connection->fd < 0 ? connection->fd : 0;
	}
	err = connection->host[0] == '/' ? begin_local(connection) : begin_remote(connection);
	if (err)
		connection_close(connection);
	return err;
}

static int connect_result(struct connection *connection)
{
	int err = 0;
	socklen_t len = sizeof(err);

	if (getsockopt(connection->fd, SOL_SOCKET, SO_ERROR, &err, &len))
		return -errno;
	return err ? -err : check_peer(connection);
}

int connection_go_on(struct connection *connection, int64_t until_ns)
{
	const struct bus_env *env = connection->env;

	if (is_replayed(connection))
		return 0;
	for (;;) {
		bool last = until_ns <= connection->give_up_ns;
		int ready = env->wait(env->ctx, connection->fd, POLLOUT,
		                      last ? until_ns : connection->give_up_ns);

		if (ready < 0)
			return ready;
		if (ready == 0 && last)
			return -EAGAIN;
		connection->last_err = ready ? connect_result(connection) : -ETIMEDOUT;
		if (connection->last_err == 0) {
			forget_addresses(connection);
			return 0;
		}
		if (try_next(connection)) {
			int err = connection->last_err;

			connection_close(connection);
			return err;
		}
	}
}

int connection_open(struct connection *connection, int64_t until_ns)
{
	int err = connection_begin(connection);

	if (!err)
		err = connection_go_on(connection, until_ns);
	if (err == -EAGAIN) {
		connection->last_err = -ETIMEDOUT;
		err = set_trouble(connection);
	}
	if (err)
		connection_close(connection);
	return err;
}

void connection_close(struct connection *connection)
{
	close_socket(connection);
	forget_addresses(connection);
}

bool connection_is_open(const struct connection *connection)
{
	return connection->fd >= 0 && !connection->list;
}

bool connection_is_stale(const struct connection *connection)
{
	uint8_t byte;

	return recv(connection->fd, &byte, 1, MSG_PEEK | MSG_DONTWAIT) >= 0 ||
	       (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR);
}

int connection_send(struct connection *connection, const uint8_t *bytes, size_t n, int64_t until_ns,
                    size_t *sent)
{
	const struct bus_env *env = connection->env;

	*sent = 0;
	while (*sent < n) {
		ssize_t part = send(connection->fd, bytes + *sent, n - *sent,
		                    MSG_NOSIGNAL | MSG_DONTWAIT);

		if (part >= 0) {
			*sent += (size_t)part;
		} else if (errno == EAGAIN || errno == EWOULDBLOCK) {
			int ready = env->wait(env->ctx, connection->fd, POLLOUT, until_ns);

			if (ready <= 0)
				return ready ? ready : -ETIMEDOUT;
		} else if (errno != EINTR) {
			return -errno;
		}
	}
	if (env->tap)
		env->tap->sent(env->tap, env, bytes, n);
	return 0;
}

int connection_receive(struct connection *connection, uint8_t *bytes, size_t room, int64_t until_ns)
{
	const struct bus_env *env = connection->env;

	for (;;) {
		int ready = env->wait(env->ctx, connection->fd, POLLIN, until_ns);
		ssize_t n;

		if (ready <= 0)
			return ready ? ready : -ETIMEDOUT;
		n = recv(connection->fd, bytes, room, MSG_DONTWAIT);
		if (n >= 0 && env->tap)
			env->tap->received(env->tap, env, bytes, (size_t)n);
		if (n >= 0)
			return (int)n;
		if (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)
			return -errno;
	}
}
