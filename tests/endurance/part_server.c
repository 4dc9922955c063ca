/* SPDX-License-Identifier: MIT */
/* The sockets of an owserver, when it answers on them, and what goes wrong with it. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "tests/endurance/server.h"

#define NOBODY (-1)

static void drop(struct server_client *c)
{
	if (c->fd >= 0)
		close(c->fd);
	*c = (struct server_client){.fd = NOBODY, .due_ns = INT64_MAX, .alive_ns = INT64_MAX};
}

static void stop(struct server *s)
{
	for (unsigned i = 0; i < SERVER_CLIENTS; i++)
		drop(&s->client[i]);
	if (s->listen_fd >= 0)
		close(s->listen_fd);
	s->listen_fd = -1;
	unlink(s->path);
}

static void listen_again(struct server *s)
{
	struct sockaddr_un here = {.sun_family = AF_UNIX};

	snprintf(here.sun_path, sizeof(here.sun_path), "%s", s->path);
	s->listen_fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (s->listen_fd < 0 || bind(s->listen_fd, (struct sockaddr *)&here, sizeof(here)) ||
	    listen(s->listen_fd, 8))
		abort();
}

static void begin(struct part *part, char *target, unsigned size)
{
	struct server *s = calloc(1, sizeof(*s));
	char directory[] = "/tmp/owsd-endurance-XXXXXX";

	if (!s || !mkdtemp(directory))
		abort();
	part->own = s;
	s->set_alarm = 0;
	s->por = true;
	for (unsigned i = 0; i < SERVER_CLIENTS; i++)
		s->client[i].fd = NOBODY;
	s->listen_fd = -1; /* 0 is of somebody else */
	stop(s);
	snprintf(s->path, sizeof(s->path), "%s/s", directory);
	listen_again(s);
	snprintf(target, size, "owserver:%s", s->path);
}

static void end(struct part *part)
{
	struct server *s = server_of(part);

	stop(s);
	s->path[strlen(s->path) - 2] = '\0';
	rmdir(s->path);
	free(s);
}

static void answer(struct part *part, struct server_client *c, const struct frame_header *request)
{
	struct server *s = server_of(part);
	char *path = (char *)c->in + FRAME_HEADER, *data, text[1024] = "", written[64] = "";
	struct frame_header reply = {.flags = request->flags};
	enum lie before = s->lie;
	int n;

	if (world_random(100) >= s->chance)
		s->lie = HONEST;
	data = path + strlen(path) + 1;
	if (request->type == FRAME_WRITE && request->size > 0 &&
	    request->size < (int32_t)sizeof(written))
		memcpy(written, data, (size_t)request->size);
	n = server_answer(part, request, path, written, text, sizeof(text));
	reply.type = n;
	if (request->type != FRAME_NOP && n >= 0) {
		reply.payload = (int32_t)strlen(text);
		reply.size = request->type == FRAME_WRITE ? request->size : reply.payload;
		if (request->type == FRAME_DIRALL) {
			reply.payload++;
			reply.type = 0;
		}
	}
	memset(c->out, 0, sizeof(c->out));
	frame_put_header(c->out, &reply);
	memcpy(c->out + FRAME_HEADER, text, (size_t)reply.payload);
	c->len = FRAME_HEADER + (unsigned)reply.payload;
	c->sent = 0;
	c->close = c->hangs = c->by_bytes = false;
	c->due_ns = world_now() + (1 + (int64_t)world_random(20)) * FIELD_MS;
	if (request->type == FRAME_READ && strstr(path, "temperature"))
		c->due_ns += 750 * FIELD_MS;
	server_lie(c, s->lie);
	s->lie = before;
}

/* A whole request is here: answer it. */
static void take(struct part *part, struct server_client *c)
{
	struct frame_header request;
	unsigned size;

	if (c->got < FRAME_HEADER || c->due_ns != INT64_MAX || c->hangs)
		return;
	frame_get_header(c->in, &request);
	size = FRAME_HEADER + (unsigned)request.payload;
	if (request.payload < 0 || size > SERVER_ROOM - 1) {
		drop(c);
		return;
	}
	if (c->got < size)
		return;
	c->in[size] = '\0';
	answer(part, c, &request);
	memmove(c->in, c->in + size, c->got - size);
	c->got -= size;
}

static void send_due(struct server_client *c)
{
	uint8_t alive[FRAME_HEADER] = {0};

	if (c->alive_ns <= world_now()) {
		server_change(alive, 1, UINT32_MAX);
		if (send(c->fd, alive, sizeof(alive), MSG_NOSIGNAL | MSG_DONTWAIT) < 0)
			drop(c);
		else
			c->alive_ns = world_now() + 5 * FIELD_S;
	}
	while (c->fd >= 0 && c->due_ns <= world_now()) {
		unsigned part = c->by_bytes ? 1 : c->len - c->sent;

		if (part > c->len - c->sent)
			part = c->len - c->sent;
		if (part && send(c->fd, c->out + c->sent, part, MSG_NOSIGNAL | MSG_DONTWAIT) < 0) {
			drop(c);
			return;
		}
		c->sent += part;
		if (c->sent < c->len) {
			c->due_ns = world_now() + FIELD_MS;
			return;
		}
		c->due_ns = c->alive_ns = INT64_MAX;
		if (c->close)
			drop(c);
	}
}

static void receive(struct part *part, struct server_client *c)
{
	ssize_t n = recv(c->fd, c->in + c->got, SERVER_ROOM - 1 - c->got, MSG_DONTWAIT);

	if (n == 0 || (n < 0 && errno != EAGAIN)) {
		drop(c);
		return;
	}
	if (n > 0)
		c->got += (unsigned)n;
	take(part, c);
}

static void look(struct part *part)
{
	struct server *s = server_of(part);
	int fd;

	if (s->dead || s->hangs)
		return;
	while ((fd = accept4(s->listen_fd, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK)) >= 0) {
		struct server_client *c = s->client;

		while (c < s->client + SERVER_CLIENTS && c->fd >= 0)
			c++;
		if (c == s->client + SERVER_CLIENTS) {
			close(fd);
			continue;
		}
		drop(c);
		c->fd = fd;
	}
	for (unsigned i = 0; i < SERVER_CLIENTS; i++)
		if (s->client[i].fd >= 0)
			receive(part, &s->client[i]);
}

static int64_t next(struct part *part)
{
	const struct server *s = server_of(part);
	int64_t at = INT64_MAX;

	for (unsigned i = 0; i < SERVER_CLIENTS && !s->hangs; i++) {
		const struct server_client *c = &s->client[i];
		int64_t due = c->alive_ns < c->due_ns ? c->alive_ns : c->due_ns;

		if (c->fd >= 0 && due < at)
			at = due;
	}
	return at;
}

static void run(struct part *part)
{
	struct server *s = server_of(part);

	look(part);
	for (unsigned i = 0; i < SERVER_CLIENTS; i++)
		if (s->client[i].fd >= 0)
			send_due(&s->client[i]);
}

static int64_t ready(struct part *part, int fd, short events)
{
	struct pollfd poll_fd = {.fd = fd, .events = events};

	look(part);
	if (poll(&poll_fd, 1, 0) > 0)
		return world_now();
	return next(part);
}

/* --- What goes wrong ------------------------------------------------------------------------- */

static void honest(void *ctx)
{
	((struct server *)ctx)->lie = HONEST;
	((struct server *)ctx)->chance = 0;
}

static void revive(void *ctx)
{
	struct server *s = ctx;

	if (!s->dead)
		return;
	s->dead = false;
	listen_again(s);
}

static void unhang(void *ctx)
{
	struct part *part = ctx;

	server_of(part)->hangs = false;
	look(part); /* who waited is gone by now, and makes room */
}

static const char *fault(struct part *part, int64_t ns)
{
	struct server *s = server_of(part);
	unsigned what = world_random(10);

	if (what == 0 && !s->dead) {
		stop(s);
		s->dead = true;
		world_after(ns, revive, s);
		return "the server dies";
	}
	if (what == 1 && !s->hangs) {
		s->hangs = true;
		world_after(ns, unhang, part);
		return "the server hangs";
	}
	if (what == 2 && !s->dead) {
		stop(s);
		listen_again(s);
		return "the server restarts";
	}
	s->lie = 1 + world_random(LIES - 1);
	s->chance = world_random(2) ? 100 : 1 + world_random(60);
	world_after(ns, honest, s);
	return server_lies[s->lie];
}

static void restart(struct part *part, unsigned device)
{
	struct server *s = server_of(part);

	if (!field.device[device].is_switch)
		return;
	s->relays = 0;
	s->latch = s->set_alarm = 0;
	s->por = true;
}

static void plug(struct part *part, unsigned device, bool in)
{
	if (in)
		restart(part, device);
}

static void pins(struct part *part)
{
	server_of(part)->latch |= 0xf0;
}

static unsigned relays(struct part *part)
{
	return server_of(part)->relays;
}

const struct part_ops part_server = {
	.name = "server",
	.age_ns = 21 * FIELD_S,
	.begin = begin,
	.end = end,
	.fault = fault,
	.plug = plug,
	.restart = restart,
	.pins = pins,
	.relays = relays,
	.next = next,
	.run = run,
	.ready = ready,
};
