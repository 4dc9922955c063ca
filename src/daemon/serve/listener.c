/* SPDX-License-Identifier: MIT */
/* Where clients connect: addresses, the unix socket; and which clients get a place. */
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/daemon/serve/client.h"
#include "src/daemon/serve/listener.h"
#include "src/ground/service/listen.h"
#include "src/memory/shm/corpse.h"
#include "src/memory/shm/owner.h"
#include "src/memory/shm/segment.h"

/* Connections that the server accepts in a row before it serves clients again. */
#define ACCEPTS 16

union address {
	struct sockaddr any;
	struct sockaddr_in6 v6;
};

/* Accept at listener i. fd: as listen_at_...() has returned it. */
static int listener_watch(struct serve *s, unsigned i, int fd)
{
	struct epoll_event event = {.events = EPOLLIN | EPOLLET};

	event.data.u32 = SERVER_CLIENTS + 1 + i;
	if (fd < 0)
		return fd;
	s->listeners[i].fd = fd; /* first: from then on the thread may accept there */
	if (epoll_ctl(s->epoll_fd, EPOLL_CTL_ADD, fd, &event) < 0) {
		int err = -errno;

		s->listeners[i].fd = -1;
		close(fd);
		return err;
	}
	return 0;
}

static int listener_add(struct serve *s, int fd, struct listener as)
{
	unsigned i = s->listener_count;
	int err;

	s->listeners[i] = as;
	err = listener_watch(s, i, fd);
	if (!err)
		s->listener_count++;
	return err;
}

/* The socket of [::] serves IPv4 too, unless an IPv4 address of the list has the same port. */
static bool is_v6_only(const struct config_serve *config, const struct listen_address *address)
{
	static const uint8_t any[16];

	if (memcmp(address->bytes, any, sizeof(any)))
		return true;
	for (unsigned i = 0; i < config->address_count; i++)
		if (!config->addresses[i].is_v6 && config->addresses[i].port == address->port)
			return true;
	return false;
}

static int open_network(const struct serve *s, const struct listen_address *address)
{
	bool only = is_v6_only(&s->config->serve, address);
	struct sockaddr_storage to;
	const int one = 1;
	int fd;

	listen_sockaddr(address, &to);
	/* the machine may get the address later or never: signals do not wait for the network */
	fd = listen_at_address(&to, only, !listen_is_loopback(address));
	if (fd < 0)
		return fd;
	/* accepted sockets inherit both options */
	setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &one, sizeof(one));
	setsockopt(fd, SOL_SOCKET, SO_KEEPALIVE, &one, sizeof(one));
	return fd;
}

/* The mode of a socket for this user and that group, if there is one. */
static mode_t mode_for(const char *group, gid_t *gid)
{
	bool has = owner_group(group, gid);

	if (!has)
		*gid = (gid_t)-1;
	return has ? 0660 : 0600;
}

static int open_local(struct serve *s, const char *path)
{
	gid_t gid;
	mode_t mode = mode_for("owsd-control", &gid);
	int fd = listen_at_path(path, mode, gid);

	return listener_add(s, fd, (struct listener){.file = listen_file_at(AT_FDCWD, path)});
}

/* Is ListenSocket that socket? Then it is served as the configuration has it. */
static bool is_listen_socket(const struct serve *s, const char *name)
{
	struct stat own, other;

	return s->config->serve.socket && stat(s->config->serve.socket, &other) == 0 &&
	       fstatat(s->directory, name, &own, AT_SYMLINK_NOFOLLOW) == 0 &&
	       own.st_dev == other.st_dev && own.st_ino == other.st_ino;
}

/* NAME.sock in the directory of owsd's files. One that is there is of an owsd that was killed. */
static int open_own(struct serve *s)
{
	char name[SEGMENT_FILE];
	mode_t mode;
	gid_t gid;
	struct listener own = {.own = true};
	int fd;

	segment_file(s->instance, "sock", name);
	if (s->directory < 0 || is_listen_socket(s, name))
		return 0;
	mode = mode_for("owsd-config", &gid);
	fd = listen_at_name(s->directory, name, SOCK_STREAM, mode, gid);
	own.file = listen_file_at(s->directory, name);
	return listener_add(s, fd, own);
}

/* Without IPv6 in the kernel the other loopback address serves. */
static bool may_miss(const struct serve *s, const struct listen_address *address, int err)
{
	return address->is_v6 && listen_is_loopback(address) && s->listener_count &&
	       (err == -EAFNOSUPPORT || err == -EADDRNOTAVAIL);
}

/*
 * A corpse of owsd may have the port, and then the signals wait for nothing: listeners_look() asks
 * for it again. What another program has is an error of the configuration.
 */
static bool may_be_free_later(int err)
{
	return err == -EADDRINUSE && corpse_of_program();
}

static int open_addresses(struct serve *s, char *why, size_t why_size)
{
	const struct config_serve *config = &s->config->serve;
	char text[LISTEN_WHY_MAX];

	for (unsigned i = 0; i < config->address_count; i++) {
		const struct listen_address *at = &config->addresses[i];
		struct listener as = {.fd = -1, .network = true, .at = *at};
		int err = listener_add(s, open_network(s, at), as);

		if (!err || may_miss(s, at, err))
			continue;
		listen_why(at, err, text);
		if (!may_be_free_later(err)) {
			snprintf(why, why_size, "%s%s", text, listen_remedy(err));
			return err;
		}
		s->unserved[s->listener_count] = err;
		s->listeners[s->listener_count++] = as;
		log_warning(s->log,
		            "%s; an owsd that was killed is stuck in the kernel, and may have the "
		            "port: owsd listens there once it is free",
		            text);
	}
	return 0;
}

static int open_configured(struct serve *s, char *why, size_t why_size)
{
	const struct config_serve *config = &s->config->serve;
	int err = open_addresses(s, why, why_size);

	if (err)
		return err;
	if (!config->socket)
		return 0;
	err = open_local(s, config->socket);
	if (err)
		snprintf(why, why_size, "cannot listen at %s: %s%s", config->socket, strerror(-err),
		         err == -EADDRINUSE ? " (another process serves it)"
		         : err == -EEXIST   ? " and is not a socket"
		         : err == -EPERM    ? " (another process put something else in its place)"
		                            : "");
	return err;
}

int listeners_open(struct serve *s, char *why, size_t why_size)
{
	int err = open_configured(s, why, why_size);

	if (err)
		return err;
	err = open_own(s);
	if (err)
		snprintf(why, why_size, "cannot listen at %s/%s.sock: %s", s->dir, s->instance,
		         strerror(-err));
	return err;
}

int listeners_look(struct serve *s, unsigned i)
{
	const struct listener *l = &s->listeners[i];
	struct sockaddr_storage at;
	int err;

	if (!l->network)
		return 0;
	err = l->fd < 0 ? listener_watch(s, i, open_network(s, &l->at)) : 0;
	if (err)
		return err;
	listen_sockaddr(&l->at, &at);
	return listen_is_here(&at) ? 0 : -EADDRNOTAVAIL;
}

void listeners_close(struct serve *s)
{
	char name[SEGMENT_FILE];

	for (unsigned i = 0; i < s->listener_count; i++) {
		const struct listener *l = &s->listeners[i];

		if (l->own)
			listen_remove(s->directory, segment_file(s->instance, "sock", name),
			              &l->file);
		else if (!l->network)
			listen_remove(AT_FDCWD, s->config->serve.socket, &l->file);
		if (l->fd >= 0)
			client_part(s, l->fd, l->network);
	}
	s->listener_count = 0;
	if (s->held.is)
		client_part(s, s->held.fd, s->held.from.network);
	s->held.is = false;
}

static bool is_allowed(const struct serve *s, const struct listen_address *peer)
{
	const struct config_serve *config = &s->config->serve;

	return !config->peer_count || listen_is_loopback(peer) ||
	       listen_peers_have(config->peers, config->peer_count, peer->is_v6, peer->bytes);
}

static void refuse_peer(struct serve *s, int fd, const struct listen_address *peer)
{
	char address[LISTEN_TEXT_MAX], reason[LISTEN_TEXT_MAX + 32];

	listen_print_host(peer, address);
	snprintf(reason, sizeof(reason), "%s is not in ListenAllow", address);
	close(fd);
	client_refused(s, COUNT_refused_peers, &s->peer_rate, reason);
}

/* All places are taken: hold the connection. owsd logs the first and counts them all. */
static void hold_connection(struct serve *s, int fd, const struct listener *from,
                            const struct sockaddr_in6 *peer)
{
	char others[LOG_OTHERS];
	uint64_t n = log_rate(&s->full_rate, s->now_ns);

	s->held.is = true;
	s->held.fd = fd;
	s->held.from = *from;
	s->held.peer = *peer;
	count(s, COUNT_full, 1);
	if (n)
		log_warning(s->log, "%d clients of the owserver protocol are there, others wait%s",
		            SERVER_CLIENTS, log_others(n, others));
}

static void take_client(struct serve *s, int fd, const struct listener *from,
                        const struct sockaddr_in6 *peer)
{
	client_open(s, fd, from, peer);
	count(s, COUNT_connections, 1);
}

static void admit_client(struct serve *s, int fd, const struct listener *at,
                         const union address *from)
{
	struct listen_address peer;

	listen_of(&from->any, &peer);
	if (at->network && !is_allowed(s, &peer))
		refuse_peer(s, fd, &peer);
	else if (s->free_count || client_evict(s))
		take_client(s, fd, at, &from->v6);
	else
		hold_connection(s, fd, at, &from->v6);
}

/* Give the held connection a place. True: no connection is held any more. */
static bool place_held(struct serve *s)
{
	if (!s->held.is)
		return true;
	if (!s->free_count && !client_evict(s))
		return false;
	s->held.is = false;
	take_client(s, s->held.fd, &s->held.from, &s->held.peer);
	return true;
}

bool listeners_accept(struct serve *s)
{
	bool any = false;

	if (!place_held(s))
		return false;
	/* begin with another listener the next time: places may become free one by one */
	s->listener_at++;
	for (unsigned k = 0; k < s->listener_count; k++) {
		unsigned i = (s->listener_at + k) % s->listener_count;

		for (int n = 0; n < ACCEPTS && !s->held.is && s->waiting >> i & 1; n++) {
			if (!s->listeners[i].network && s->away_count >= SERVER_CLIENTS)
				break;
			union address from = {.any = {.sa_family = AF_UNSPEC}};
			socklen_t len = sizeof(from);
			int fd = listen_accept(s->listeners[i].fd, &from.any, &len);

			if (fd == -EAGAIN)
				s->waiting &= ~((uint32_t)1 << i);
			/* the connection waits until a client leaves, or for a moment */
			if (listen_is_full(fd))
				s->look_ns = earlier_ns(s->look_ns, s->now_ns + LISTEN_PAUSE_NS);
			if (fd == -EAGAIN || listen_is_full(fd))
				break;
			any = true;
			if (fd >= 0)
				admit_client(s, fd, &s->listeners[i], &from);
		}
	}
	return any && s->waiting && !s->held.is;
}
