/* SPDX-License-Identifier: MIT */
/* Where clients connect: addresses, the unix socket; and which clients get a place. */
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "src/daemon/serve/client.h"
#include "src/daemon/serve/listener.h"
#include "src/ground/service/listen.h"
#include "src/memory/shm/owner.h"
#include "src/memory/shm/segment.h"

/* Connections that wait for a place; the kernel's net.core.somaxconn may be less. */
#define BACKLOG 4096
/* Connections that the server accepts in a row before it serves clients again. */
#define ACCEPTS 16

union address {
	struct sockaddr any;
	struct sockaddr_in v4;
	struct sockaddr_in6 v6;
	struct sockaddr_un local;
};

static socklen_t listener_fill(const struct listen_address *from, union address *to)
{
	memset(to, 0, sizeof(*to));
	if (from->is_v6) {
		to->v6.sin6_family = AF_INET6;
		to->v6.sin6_port = htons(from->port);
		memcpy(&to->v6.sin6_addr, from->bytes, 16);
		return sizeof(to->v6);
	}
	to->v4.sin_family = AF_INET;
	to->v4.sin_port = htons(from->port);
	memcpy(&to->v4.sin_addr, from->bytes, 4);
	return sizeof(to->v4);
}

static int listener_add(struct serve *s, int fd, struct listener as)
{
	struct epoll_event event = {.events = EPOLLIN | EPOLLET};

	event.data.u32 = SERVER_CLIENTS + 1 + s->listener_count;
	if (listen(fd, BACKLOG) < 0 || epoll_ctl(s->epoll_fd, EPOLL_CTL_ADD, fd, &event) < 0)
		return -errno;
	as.fd = fd;
	s->listeners[s->listener_count++] = as;
	return 0;
}

/* Bind an address that the machine may get later or never: signals do not wait for the network. */
static int bind_later(struct serve *s, int fd, const struct listen_address *address,
                      const union address *to, socklen_t len)
{
	char text[LISTEN_TEXT_MAX];
	int one = 1;

	if (setsockopt(fd, address->is_v6 ? IPPROTO_IPV6 : IPPROTO_IP,
	               address->is_v6 ? IPV6_FREEBIND : IP_FREEBIND, &one, sizeof(one)) < 0 ||
	    bind(fd, &to->any, len) < 0)
		return -errno;
	listen_print(address, text);
	log_warning(s->log,
	            "Listen %s: not an address of this machine now; it is served when it comes",
	            text);
	return 0;
}

/* The socket of [::] serves IPv4 too, unless an IPv4 address of the list has the same port. */
static int is_v6_only(const struct config_serve *config, const struct listen_address *address)
{
	static const uint8_t any[16];

	if (memcmp(address->bytes, any, sizeof(any)))
		return 1;
	for (unsigned i = 0; i < config->address_count; i++)
		if (!config->addresses[i].is_v6 && config->addresses[i].port == address->port)
			return 1;
	return 0;
}

static int open_network(struct serve *s, const struct listen_address *address)
{
	union address to;
	socklen_t len = listener_fill(address, &to);
	int fd = socket(to.any.sa_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0), one = 1;
	int only = is_v6_only(&s->config->serve, address), err;

	if (fd < 0)
		return -errno;
	setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &one, sizeof(one));
	if (address->is_v6)
		setsockopt(fd, IPPROTO_IPV6, IPV6_V6ONLY, &only, sizeof(only));
	/* accepted sockets inherit both options */
	setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &one, sizeof(one));
	setsockopt(fd, SOL_SOCKET, SO_KEEPALIVE, &one, sizeof(one));
	err = bind(fd, &to.any, len) < 0 ? -errno : 0;
	if (err == -EADDRNOTAVAIL && !listen_is_loopback(address))
		err = bind_later(s, fd, address, &to, len);
	if (!err)
		err = listener_add(s, fd, (struct listener){.network = true});
	if (err)
		close(fd);
	return err;
}

/* A socket of that path, which does not exist, for this user and the group. */
static int bind_local(struct serve *s, const union address *to, const char *group, bool own)
{
	gid_t gid;
	bool has = owner_group(group, &gid);
	int fd = listen_local(&to->local, SOCK_STREAM, has ? 0660 : 0600, has ? gid : (gid_t)-1);
	int err;

	if (fd < 0)
		return fd;
	err = listener_add(s, fd, (struct listener){.own = own});
	if (err)
		close(fd);
	return err;
}

static int open_local(struct serve *s, const char *path)
{
	union address to = {.local = {.sun_family = AF_UNIX}};
	int err;

	snprintf(to.local.sun_path, sizeof(to.local.sun_path), "%s", path);
	err = listen_vacate(&to.local);
	return err ? err : bind_local(s, &to, "owsd-control", false);
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
	union address to = {.local = {.sun_family = AF_UNIX}};
	char name[SEGMENT_FILE];

	segment_file(s->instance, "sock", name);
	if (s->directory < 0 || is_listen_socket(s, name))
		return 0;
	/* the path of the directory may be longer than an address has room */
	snprintf(to.local.sun_path, sizeof(to.local.sun_path), "/proc/self/fd/%d/%s", s->directory,
	         name);
	if (unlinkat(s->directory, name, 0) < 0 && errno != ENOENT)
		return -errno;
	return bind_local(s, &to, "owsd-config", true);
}

/* Without IPv6 in the kernel the other loopback address serves. */
static bool may_miss(const struct serve *s, const struct listen_address *address, int err)
{
	return address->is_v6 && listen_is_loopback(address) && s->listener_count &&
	       (err == -EAFNOSUPPORT || err == -EADDRNOTAVAIL);
}

static int open_configured(struct serve *s, char *why, size_t why_size)
{
	const struct config_serve *config = &s->config->serve;
	char text[LISTEN_TEXT_MAX];
	int err;

	for (unsigned i = 0; i < config->address_count; i++) {
		err = open_network(s, &config->addresses[i]);
		if (!err || may_miss(s, &config->addresses[i], err))
			continue;
		listen_print(&config->addresses[i], text);
		snprintf(why, why_size, "cannot listen at %s: %s%s", text, strerror(-err),
		         listen_remedy(err));
		return err;
	}
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
		snprintf(why, why_size, "cannot listen at %s/%s.sock: %s", s->place, s->instance,
		         strerror(-err));
	return err;
}

void listeners_close(struct serve *s)
{
	char name[SEGMENT_FILE];

	for (unsigned i = 0; i < s->listener_count; i++) {
		client_part(s, s->listeners[i].fd, s->listeners[i].network);
		if (s->listeners[i].own)
			unlinkat(s->directory, segment_file(s->instance, "sock", name), 0);
		else if (!s->listeners[i].network)
			unlink(s->config->serve.socket);
	}
	s->listener_count = 0;
	if (s->held.is)
		client_part(s, s->held.fd, s->held.from.network);
	s->held.is = false;
}

static bool is_allowed(struct serve *s, const union address *from)
{
	const struct config_serve *config = &s->config->serve;
	struct listen_address peer = {.is_v6 = from->any.sa_family == AF_INET6};

	if (!config->peer_count)
		return true;
	if (peer.is_v6 && IN6_IS_ADDR_V4MAPPED(&from->v6.sin6_addr)) {
		peer.is_v6 = false;
		memcpy(peer.bytes, from->v6.sin6_addr.s6_addr + 12, 4);
	} else if (peer.is_v6) {
		memcpy(peer.bytes, &from->v6.sin6_addr, 16);
	} else {
		memcpy(peer.bytes, &from->v4.sin_addr, 4);
	}
	return listen_is_loopback(&peer) ||
	       listen_peers_have(config->peers, config->peer_count, peer.is_v6, peer.bytes);
}

static void refuse_peer(struct serve *s, int fd, const union address *from)
{
	bool is_v6 = from->any.sa_family == AF_INET6;
	char address[INET6_ADDRSTRLEN] = "", reason[INET6_ADDRSTRLEN + 32];

	inet_ntop(from->any.sa_family,
	          is_v6 ? (const void *)&from->v6.sin6_addr : (const void *)&from->v4.sin_addr,
	          address, sizeof(address));
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
	if (at->network && !is_allowed(s, from))
		refuse_peer(s, fd, from);
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
			/* the connection waits until a client leaves, or the next one comes */
			if (fd == -EAGAIN || fd == -EMFILE || fd == -ENFILE || fd == -ENOBUFS ||
			    fd == -ENOMEM)
				break;
			any = true;
			if (fd >= 0)
				admit_client(s, fd, &s->listeners[i], &from);
		}
	}
	return any && s->waiting && !s->held.is;
}
