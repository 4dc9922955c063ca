/* SPDX-License-Identifier: MIT */
/* Listens, accepts, and lets in whoever sends a proper head in time. */
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/faces/web/doors.h"
#include "src/faces/web/head.h"
#include "src/faces/web/wire.h"
#include "src/ground/service/listen.h"
#include "src/memory/shm/peer.h"
#include "src/public/ows.h"

#define BATCH 64
#define SEND_BUFFER (32 * 1024) /* bytes; the kernel takes twice that, with its own data */

struct visitor {
	bool used; /* the place; fd counts then */
	int fd;
	int64_t until_ns;
	int64_t came_ns, watched_ns; /* what it has sent came later; it is watched since then */
	socklen_t len;
	struct sockaddr_storage address;
};

int doors_open(struct doors *doors)
{
	doors->visitors = calloc(DOORS_CONNECTIONS, sizeof(*doors->visitors));
	doors->epoll = epoll_create1(EPOLL_CLOEXEC);
	doors->listeners.epoll = doors->epoll;
	doors->listeners.look_ns = INT64_MAX;
	if (!doors->visitors)
		return -ENOMEM;
	return doors->epoll < 0 ? -errno : 0;
}

/* Numbers of epoll: a door, or after the doors a visitor. */
static int doors_watch(struct doors *doors, int fd, unsigned number, uint32_t how)
{
	struct epoll_event event = {.events = EPOLLIN | how, .data.u32 = number};

	return epoll_ctl(doors->epoll, EPOLL_CTL_ADD, fd, &event) ? -errno : 0;
}

int doors_inherit(struct doors *doors)
{
	int fds[LISTENERS], count = listen_inherited(fds, LISTENERS);

	for (int i = 0; i < count; i++) {
		int err = listeners_add(&doors->listeners, fds[i]);

		if (err)
			return err;
	}
	return count;
}

int doors_socket(struct doors *doors, const char *path)
{
	int fd = listen_at_path(path, 0660, (gid_t)-1), err;

	if (fd < 0)
		return fd;
	err = listeners_add(&doors->listeners, fd);
	if (err)
		return err;
	snprintf(doors->path, sizeof(doors->path), "%s", path);
	doors->file = listen_file_at(AT_FDCWD, path);
	return 0;
}

/* --- Visitors -------------------------------------------------------------------------------- */

static void let_go(struct doors *doors, struct visitor *visitor, bool inside)
{
	epoll_ctl(doors->epoll, EPOLL_CTL_DEL, visitor->fd, NULL);
	if (!inside)
		crowd_leave(&doors->crowd, wire_close(visitor->fd));
	visitor->used = false;
	doors->visitor_count--;
}

/* An answer that needs no reading of the request. A visitor who does not take it goes without. */
static void doors_refuse(int fd, int status, const char *why)
{
	char body[160], text[320];
	int len = snprintf(body, sizeof(body), "{\"error\":\"%s\"}\n", why);

	len = snprintf(text, sizeof(text),
	               "HTTP/1.1 %d Refused\r\nContent-Type: application/json\r\n"
	               "Content-Length: %d\r\nConnection: close\r\n\r\n%s",
	               status, len, body);
	send(fd, text, (size_t)len, MSG_NOSIGNAL | MSG_DONTWAIT);
	shutdown(fd, SHUT_WR);
	/* unread bytes would make the kernel take the answer back */
	wire_drain(fd, text, sizeof(text));
}

/* Its place among those of its user or address; the reverse proxy has as many as it likes. */
static int find_place(struct doors *doors, const struct visitor *new)
{
	bool local = new->address.ss_family == AF_UNIX;
	struct crowd_key key = crowd_address(&new->address);
	struct peer peer;

	if (local && peer_look_into(new->fd, &peer, NULL, 0) == 0)
		key = crowd_user(peer.uid);
	if (!key.kind || (local && (!peer.uid || peer.uid == geteuid())) ||
	    doors->is_proxy(doors->ctx, new->fd))
		return CROWD_NOBODY;
	return crowd_enter(&doors->crowd, &key, DOORS_PER_PEER);
}

static void admit(struct doors *doors, struct visitor *visitor)
{
	int fd = visitor->fd;

	/* has epoll had nothing of it since it is watched? */
	doors->head_ns = doors->came_ns > visitor->watched_ns ? doors->came_ns : visitor->came_ns;
	let_go(doors, visitor, true);
	doors->welcome(doors->ctx, fd, (const struct sockaddr *)&visitor->address, visitor->len);
}

/* gone: it sends no more. What it sent before is read all the same. */
static void look_at(struct doors *doors, struct visitor *visitor, bool gone)
{
	static char head[HEAD_MAX + 1];
	ptrdiff_t got = wire_look(visitor->fd, head, sizeof(head));
	const char *why;
	int status;

	if (got == -EAGAIN || got == -EINTR)
		return;
	if (got <= 0) {
		let_go(doors, visitor, false);
		return;
	}
	status = head_check(head, (size_t)got, &why);
	if (status == 200) {
		admit(doors, visitor);
	} else if (status) {
		doors_refuse(visitor->fd, status, why);
		let_go(doors, visitor, false);
	} else if (gone) {
		let_go(doors, visitor, false);
	}
}

static void welcome(struct doors *doors, const struct visitor *new, int64_t now_ns)
{
	unsigned i = 0;
	int place = -ENOSPC;

	if (doors->visitor_count + doors->count_inside(doors->ctx) < DOORS_CONNECTIONS)
		place = find_place(doors, new);
	if (!wire_begin(new->fd, new->address.ss_family == AF_UNIX, place)) {
		crowd_leave(&doors->crowd, place);
		close(new->fd);
		return;
	}
	if (place == -ENOSPC) {
		doors_refuse(new->fd, 503, "too many connections: try again later");
		wire_close(new->fd);
		return;
	}
	while (doors->visitors[i].used)
		i++;
	if (doors_watch(doors, new->fd, LISTENERS + i, EPOLLET | EPOLLRDHUP)) {
		crowd_leave(&doors->crowd, wire_close(new->fd));
		return;
	}
	doors->visitors[i] = *new;
	doors->visitors[i].until_ns = now_ns + DOORS_IDLE_S * NS_PER_S;
	doors->visitors[i].came_ns = doors->came_ns;
	doors->visitors[i].watched_ns = ows_now();
	doors->visitor_count++;
}

/* No descriptor is left, or the porter is late: connections wait with the kernel for a moment. */
static void pause_doors(struct doors *doors, int64_t now_ns)
{
	doors->paused_ns = now_ns + LISTEN_PAUSE_NS;
	doors->watched_ns = INT64_MAX;
	listen_pause(doors->epoll, doors->listeners.fds, doors->listeners.count);
}

/* What the kernel keeps of an answer counts as memory of this program: 1200 of these are 75 MB. */
static void bound(int fd)
{
	int size = SEND_BUFFER;

	setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &size, sizeof(size));
}

/* True: nobody waits there any more. */
static bool accept_some(struct doors *doors, int door, int64_t now_ns)
{
	for (int i = 0; i < BATCH; i++) {
		struct visitor new = {.used = true, .len = sizeof(new.address)};

		if (wire_is_full()) {
			pause_doors(doors, now_ns);
			return false;
		}
		new.fd = listen_accept(door, (struct sockaddr *)&new.address, &new.len);
		if (listen_is_full(new.fd))
			pause_doors(doors, now_ns);
		if (new.fd < 0)
			return new.fd == -EAGAIN;
		bound(new.fd);
		welcome(doors, &new, now_ns);
	}
	return false;
}

static void end_late(struct doors *doors, int64_t now_ns)
{
	for (unsigned i = 0; i < DOORS_CONNECTIONS && doors->visitor_count; i++) {
		struct visitor *visitor = &doors->visitors[i];

		if (!visitor->used || visitor->until_ns > now_ns)
			continue;
		doors_refuse(visitor->fd, 408, "the request took longer than 30 seconds");
		let_go(doors, visitor, false);
	}
}

void doors_leave(struct doors *doors, int fd)
{
	crowd_leave(&doors->crowd, wire_leave(fd));
}

void doors_empty(struct doors *doors, int64_t looked_ns)
{
	/* epoll says nothing of what waits at doors that pause */
	if (looked_ns > doors->came_ns && looked_ns > doors->watched_ns)
		doors->came_ns = looked_ns;
}

void doors_take(struct doors *doors, int64_t now_ns)
{
	struct epoll_event events[BATCH];
	int64_t began_ns = ows_now();
	int n = epoll_wait(doors->epoll, events, BATCH, 0);
	bool all = n < BATCH;

	for (int i = 0; i < n; i++) {
		unsigned number = events[i].data.u32;

		if (number < LISTENERS)
			all &= accept_some(doors, doors->listeners.fds[number], now_ns);
		else if (doors->visitors[number - LISTENERS].used)
			look_at(doors, &doors->visitors[number - LISTENERS],
			        events[i].events & (EPOLLRDHUP | EPOLLHUP | EPOLLERR));
	}
	if (all)
		doors_empty(doors, began_ns);
	listeners_tick(&doors->listeners, now_ns);
	if (now_ns >= doors_next(doors))
		end_late(doors, now_ns);
	if (doors->paused_ns && now_ns >= doors->paused_ns) {
		doors->paused_ns = 0;
		listen_resume(doors->epoll, doors->listeners.fds, doors->listeners.count);
		doors->watched_ns = ows_now();
	}
}

int64_t doors_next(const struct doors *doors)
{
	int64_t next_ns = doors->listeners.look_ns;

	if (doors->paused_ns && doors->paused_ns < next_ns)
		next_ns = doors->paused_ns;
	for (unsigned i = 0; doors->visitor_count && i < DOORS_CONNECTIONS; i++)
		if (doors->visitors[i].used && doors->visitors[i].until_ns < next_ns)
			next_ns = doors->visitors[i].until_ns;
	return next_ns;
}

void doors_close(struct doors *doors)
{
	listen_remove(AT_FDCWD, doors->path, &doors->file);
	for (unsigned i = 0; doors->visitors && i < DOORS_CONNECTIONS; i++)
		if (doors->visitors[i].used)
			wire_close(doors->visitors[i].fd);
	/* nobody has accepted what waits there, and what was sent along */
	for (unsigned i = 0; i < doors->listeners.count; i++)
		if (doors->listeners.fds[i] >= 0)
			wire_close_listener(doors->listeners.fds[i]);
	if (doors->epoll >= 0)
		close(doors->epoll);
	free(doors->visitors);
}
