/* SPDX-License-Identifier: MIT */
/* Opens and shuts the sockets at which a face listens, and keeps what is wrong with one of them. */
#include "src/faces/kit/listeners.h"

#include <errno.h>
#include <netinet/in.h>
#include <stdio.h>
#include <string.h>
#include <sys/epoll.h>
#include <unistd.h>

#include "src/ground/service/listen.h"

#define LOOK_NS (2 * NS_PER_S)
#define NOT_LOOKED 1 /* no negative errno, and not 0 */

static int add_at(struct listeners *l, unsigned i, int fd)
{
	struct epoll_event event = {.events = EPOLLIN, .data.u32 = i};

	if (epoll_ctl(l->epoll, EPOLL_CTL_ADD, fd, &event)) {
		int err = -errno;

		close(fd);
		return err;
	}
	l->fds[i] = fd;
	return 0;
}

/* A place that is free, or count. */
static unsigned free_place(const struct listeners *l)
{
	unsigned i = 0;

	while (i < l->count && (l->fds[i] >= 0 || l->has_address[i]))
		i++;
	return i;
}

int listeners_add(struct listeners *l, int fd)
{
	unsigned i = free_place(l);
	int err;

	if (i == LISTENERS) {
		close(fd);
		return -ENOSPC;
	}
	err = add_at(l, i, fd);
	if (err)
		return err;
	l->has_address[i] = false;
	l->err[i] = 0;
	l->count += i == l->count;
	return 0;
}

static int open_one(struct listeners *l, unsigned i, const struct sockaddr_storage *at)
{
	int fd = listen_at_address(at, true, !listen_is_loopback(&l->at[i]));

	return fd < 0 ? fd : add_at(l, i, fd);
}

/* Without IPv6 in the kernel the other loopback address serves. */
static bool may_miss(const struct listeners *l, unsigned i, int err)
{
	bool other = false;

	for (unsigned k = 0; k < l->count; k++)
		other |= l->has_address[k] && !l->at[k].is_v6 && listen_is_loopback(&l->at[k]) &&
		         l->at[k].port == l->at[i].port;
	return other && l->at[i].is_v6 && listen_is_loopback(&l->at[i]) &&
	       (err == -EAFNOSUPPORT || err == -EADDRNOTAVAIL);
}

/* With the port that the kernel chose. */
static void tell_served(const struct listeners *l, unsigned i)
{
	struct listen_address at = l->at[i];
	struct sockaddr_in to = {0};
	socklen_t len = sizeof(to);

	/* one of IPv6 is cut off, and has its port at the same place */
	if (getsockname(l->fds[i], (struct sockaddr *)&to, &len) == 0)
		at.port = ntohs(to.sin_port);
	l->tell(l->face, &at, true);
}

/* Open it if it is shut; log what is another since the last look. */
static void look_at(struct listeners *l, unsigned i)
{
	struct sockaddr_storage at;
	char why[LISTEN_WHY_MAX];
	int err;

	listen_sockaddr(&l->at[i], &at);
	err = l->fds[i] < 0 ? open_one(l, i, &at) : 0;
	if (!err && !listen_is_here(&at))
		err = -EADDRNOTAVAIL;
	if (err && may_miss(l, i, err))
		err = 0;
	if (err == l->err[i])
		return;
	l->err[i] = err;
	if (!err && l->fds[i] >= 0)
		tell_served(l, i);
	if (!err)
		return;
	listen_why(&l->at[i], err, why);
	log_err(l->face->log, "%s%s", why, listen_remedy(err));
}

static bool is_among(const struct listen_address *address, const struct listen_address *of,
                     unsigned count)
{
	for (unsigned i = 0; i < count; i++)
		if (listen_same(address, &of[i]))
			return true;
	return false;
}

static void shut(struct listeners *l, unsigned i)
{
	if (l->fds[i] >= 0) {
		epoll_ctl(l->epoll, EPOLL_CTL_DEL, l->fds[i], NULL);
		close(l->fds[i]);
		if (!l->err[i])
			l->tell(l->face, &l->at[i], false);
	}
	l->fds[i] = -1;
	l->has_address[i] = false;
	l->err[i] = 0;
}

static bool has(const struct listeners *l, const struct listen_address *address)
{
	for (unsigned i = 0; i < l->count; i++)
		if (l->has_address[i] && listen_same(&l->at[i], address))
			return true;
	return false;
}

void listeners_follow(struct listeners *l, const struct listen_address *addresses, unsigned count,
                      int64_t now_ns)
{
	/* first: a new one may be another address with the same port */
	for (unsigned i = 0; i < l->count; i++)
		if (l->has_address[i] && !is_among(&l->at[i], addresses, count))
			shut(l, i);
	for (unsigned k = 0; k < count; k++) {
		unsigned i = free_place(l);

		if (has(l, &addresses[k]) || i == LISTENERS)
			continue;
		l->fds[i] = -1;
		l->at[i] = addresses[k];
		l->has_address[i] = true;
		l->count += i == l->count;
		l->err[i] = NOT_LOOKED;
	}
	l->look_ns = now_ns;
	listeners_tick(l, now_ns);
}

int64_t listeners_tick(struct listeners *l, int64_t now_ns)
{
	if (now_ns < l->look_ns)
		return l->look_ns;
	l->look_ns = INT64_MAX;
	l->face->shut[0] = '\0';
	for (unsigned i = 0; i < l->count; i++) {
		if (!l->has_address[i])
			continue;
		look_at(l, i);
		if (l->err[i] || !listen_is_loopback(&l->at[i]))
			l->look_ns = now_ns + LOOK_NS;
		if (!l->err[i] || *l->face->shut)
			continue;
		listen_why(&l->at[i], l->err[i], l->face->shut);
		l->face->shut_remedy = listen_remedy(l->err[i]);
	}
	return l->look_ns;
}

void listeners_tell(const struct listeners *l)
{
	for (unsigned i = 0; i < l->count; i++)
		if (l->has_address[i] && l->fds[i] >= 0 && !l->err[i])
			tell_served(l, i);
}
