/* SPDX-License-Identifier: MIT */
/*
 * An owserver on a unix socket that answers on the world's clock, and what can be wrong with one:
 * it is slow, silent, gone, tells errors, power-fault readings and garbage, sends half a frame, one
 * twice, one with more behind it. The protocol has no request numbers, so an answer that comes
 * behind the next question would be taken for its answer by any client; that one lie is left out.
 */
#include "part.h"

#include "hal/owserver/frame.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#define CLIENTS 8
#define ROOM    8192
#define NOBODY  (-1)

enum lie {
	HONEST, SLOW, ALIVE, VERY_LATE, SILENT, REFUSES, CLOSES, HALF, HALF_AND_SILENT, GARBAGE,
	HUGE, NEGATIVE, VERSION, SHORTER, TWICE, MORE, BY_BYTES, ERRORS, NO_DEVICE, FAULT_85,
	FAULT_127, NO_NUMBER, EMPTY, LIES,
};
static const char *const lies[LIES] = {
	[SLOW] = "slow", [ALIVE] = "only alive", [VERY_LATE] = "very late", [SILENT] = "silent",
	[REFUSES] = "keeps no connection", [CLOSES] = "closes", [HALF] = "half an answer",
	[HALF_AND_SILENT] = "half an answer and silence", [GARBAGE] = "garbage", [HUGE] = "huge",
	[NEGATIVE] = "negative length", [VERSION] = "other version",
	[SHORTER] = "shorter than told",
	[TWICE] = "twice", [MORE] = "more than asked", [BY_BYTES] = "byte by byte",
	[ERRORS] = "errors", [NO_DEVICE] = "no device", [FAULT_85] = "85", [FAULT_127] = "127.938",
	[NO_NUMBER] = "no number", [EMPTY] = "empty",
};

struct server_client {
	int fd;
	uint8_t in[ROOM], out[ROOM];
	unsigned got, len, sent;
	int64_t due_ns, alive_ns; /* INT64_MAX: nothing is to be sent */
	bool close, hangs;
};

struct server {
	char path[60];
	int listen_fd;
	bool dead;  /* no socket */
	bool hangs; /* one, and nobody behind it */
	enum lie lie;
	unsigned chance; /* of a lie, percent */
	struct server_client client[CLIENTS];
	/* the switch */
	unsigned relays, latch, set_alarm;
	bool por;
};

static struct server *of(struct part *part)
{
	return part->own;
}

/* --- Sockets --------------------------------------------------------------------------------- */

static void drop(struct server_client *c)
{
	if (c->fd >= 0)
		close(c->fd);
	*c = (struct server_client){ .fd = NOBODY, .due_ns = INT64_MAX, .alive_ns = INT64_MAX };
}

static void stop(struct server *s)
{
	for (unsigned i = 0; i < CLIENTS; i++)
		drop(&s->client[i]);
	if (s->listen_fd >= 0)
		close(s->listen_fd);
	s->listen_fd = -1;
	unlink(s->path);
}

static void listen_again(struct server *s)
{
	struct sockaddr_un here = { .sun_family = AF_UNIX };

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
	for (unsigned i = 0; i < CLIENTS; i++)
		s->client[i].fd = NOBODY;
	stop(s);
	snprintf(s->path, sizeof(s->path), "%s/s", directory);
	listen_again(s);
	snprintf(target, size, "owserver:%s", s->path);
}

static void end(struct part *part)
{
	struct server *s = of(part);

	stop(s);
	s->path[strlen(s->path) - 2] = '\0';
	rmdir(s->path);
	free(s);
}

/* --- What it knows --------------------------------------------------------------------------- */

static bool has(const struct part *part, int device)
{
	return device >= 0 && !field.device[device].away && field.device[device].wire == part->wire;
}

static int number(char *text, size_t size, unsigned value)
{
	return snprintf(text, size, "%12u", value);
}

static int switch_property(struct server *s, const char *property, char *text, size_t size)
{
	if (strcmp(property, "sensed.BYTE") == 0)
		return number(text, size, field_pins() << 4 | (~s->relays & 0xf));
	if (strcmp(property, "PIO.BYTE") == 0)
		return number(text, size, s->relays);
	if (strcmp(property, "latch.BYTE") == 0)
		return number(text, size, s->latch);
	if (strcmp(property, "por") == 0)
		return number(text, size, s->por);
	if (strcmp(property, "set_alarm") == 0)
		return number(text, size, s->set_alarm);
	return -1;
}

/* Length of the text, or a code of the protocol. */
static int read_property(struct part *part, const char *path, char *text, size_t size)
{
	struct server *s = of(part);
	int device;
	const char *property;

	if (strncmp(path, "/bus.0/interface/settings/name", 30) == 0)
		return snprintf(text, size, "DS9490R");
	if (strncmp(path, "/alarm/", 7) == 0)
		path += 6;
	device = field_find(path + 1);
	property = device < 0 ? NULL : strchr(path + 1, '/');
	if (!property)
		return -1;
	if (!has(part, device))
		return -1;
	property++;
	if (strcmp(property, "type") == 0)
		return snprintf(text, size, field.device[device].is_switch ? "DS2408" : "DS18B20");
	if (field.device[device].is_switch)
		return switch_property(s, property, text, size);
	if (strcmp(property, "temperature12") != 0)
		return -1;
	if (s->lie == FAULT_85 && device != 1) /* near 85 it could be true */
		return snprintf(text, size, "          85");
	if (s->lie == FAULT_127)
		return snprintf(text, size, "     127.938");
	return snprintf(text, size, "%12g", field_temperature((unsigned)device, world_now()));
}

static int write_property(struct part *part, const char *path, const char *data)
{
	struct server *s = of(part);
	int device;
	const char *property;

	if (strncmp(path, "/alarm/", 7) == 0)
		path += 6;
	device = field_find(path + 1);
	property = device < 0 ? NULL : strchr(path + 1, '/');
	if (!property || !has(part, device) || !field.device[device].is_switch)
		return -1;
	property++;
	if (strcmp(property, "PIO.BYTE") == 0)
		s->relays = (unsigned)strtoul(data, NULL, 10) & 0xf;
	else if (strcmp(property, "latch.BYTE") == 0)
		s->latch = 0;
	else if (strcmp(property, "por") == 0)
		s->por = false;
	else if (strcmp(property, "set_alarm") == 0)
		s->set_alarm = (unsigned)strtoul(data, NULL, 10);
	else
		return -1;
	return 0;
}

static int list(struct part *part, const char *path, char *text, size_t size)
{
	struct server *s = of(part);
	bool alarm = strncmp(path, "/alarm", 6) == 0;
	size_t n = 0;

	text[0] = '\0';
	for (unsigned i = 0; i < field.devices; i++) {
		bool in = field.device[i].is_switch && (s->por || (s->latch && s->set_alarm));

		if (has(part, (int)i) && (!alarm || in))
			n += (size_t)snprintf(text + n, size - n, "%s%s/%s", n ? "," : "",
			                      alarm ? "/alarm" : "", field.device[i].id);
	}
	return (int)n;
}

/* --- Frames ---------------------------------------------------------------------------------- */

static void change(uint8_t *frame, unsigned word, uint32_t value)
{
	for (int i = 0; i < 4; i++)
		frame[word * 4 + (unsigned)i] = (uint8_t)(value >> (24 - 8 * i));
}

static void lie_about(struct server_client *c, enum lie lie)
{
	uint8_t junk[] = "HTTP/1.1 400 Bad Request";

	switch (lie) {
	case SLOW:
		c->due_ns += (int64_t)world_random(18000) * FIELD_MS;
		break;
	case ALIVE:
		c->alive_ns = c->due_ns;
		c->due_ns = INT64_MAX;
		break;
	case VERY_LATE:
		c->alive_ns = c->due_ns;
		c->due_ns += 40 * FIELD_S;
		break;
	case SILENT:
		c->due_ns = INT64_MAX;
		break;
	case REFUSES:
		c->out[15] &= (uint8_t)~FRAME_PERSIST;
		c->close = true;
		break;
	case CLOSES:
		c->len = 0;
		c->close = true;
		break;
	case HALF:
		c->len /= 2;
		c->close = true;
		break;
	case HALF_AND_SILENT:
		c->len /= 2;
		c->hangs = true;
		break;
	case GARBAGE:
		memcpy(c->out, junk, FRAME_HEADER);
		break;
	case HUGE:
		change(c->out, 1, 0x7fffffff);
		break;
	case NEGATIVE:
		change(c->out, 1, (uint32_t)-5);
		break;
	case VERSION:
		change(c->out, 0, 0x20000);
		break;
	case SHORTER:
		change(c->out, 2, 100000);
		break;
	case TWICE:
		if (c->len * 2 <= ROOM)
			memcpy(c->out + c->len, c->out, c->len);
		c->len *= 2;
		break;
	case MORE:
		c->len += 3;
		break;
	case HONEST:
	case BY_BYTES:
	case ERRORS:
	case NO_DEVICE:
	case FAULT_85:
	case FAULT_127:
	case NO_NUMBER:
	case EMPTY:
	case LIES:
		break;
	}
}

/* The text of an answer, or its code. */
static int answer_to(struct part *part, const struct frame_header *request, const char *path,
                     const char *data, char *text, size_t size)
{
	enum lie lie = of(part)->lie;

	switch ((enum frame_type)request->type) {
	case FRAME_READ:
		if (lie == ERRORS && strncmp(path, "/bus.", 5) != 0)
			return -5;
		if (lie == NO_DEVICE && strncmp(path, "/bus.", 5) != 0)
			return -1;
		if (lie == NO_NUMBER && strstr(path, "temperature"))
			return snprintf(text, size, "fifteen");
		if (lie == EMPTY && strstr(path, "temperature"))
			return 0;
		return read_property(part, path, text, size);
	case FRAME_WRITE:
		return lie == ERRORS ? -5 : write_property(part, path, data);
	case FRAME_PRESENT:
		return has(part, field_find(path + 1)) && lie != NO_DEVICE ? 0 : -1;
	case FRAME_DIRALL:
		return list(part, path, text, size);
	case FRAME_NOP:
	case FRAME_DIR:
	case FRAME_GET:
	case FRAME_DIRALLSLASH:
	case FRAME_GETSLASH:
		break;
	}
	return 0;
}

static void answer(struct part *part, struct server_client *c, const struct frame_header *request)
{
	struct server *s = of(part);
	char *path = (char *)c->in + FRAME_HEADER, *data, text[1024] = "", written[64] = "";
	struct frame_header reply = { .flags = request->flags };
	enum lie before = s->lie;
	int n;

	if (world_random(100) >= s->chance)
		s->lie = HONEST;
	data = path + strlen(path) + 1;
	if (request->type == FRAME_WRITE && request->size > 0 &&
	    request->size < (int32_t)sizeof(written))
		memcpy(written, data, (size_t)request->size);
	n = answer_to(part, request, path, written, text, sizeof(text));
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
	c->close = c->hangs = false;
	c->due_ns = world_now() + (1 + (int64_t)world_random(20)) * FIELD_MS;
	if (request->type == FRAME_READ && strstr(path, "temperature"))
		c->due_ns += 750 * FIELD_MS;
	lie_about(c, s->lie);
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
	if (request.payload < 0 || size > ROOM - 1) {
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

static void send_due(struct server *s, struct server_client *c)
{
	uint8_t alive[FRAME_HEADER] = { 0 };

	if (c->alive_ns <= world_now()) {
		change(alive, 1, UINT32_MAX);
		if (send(c->fd, alive, sizeof(alive), MSG_NOSIGNAL | MSG_DONTWAIT) < 0)
			drop(c);
		else
			c->alive_ns = world_now() + 5 * FIELD_S;
	}
	while (c->fd >= 0 && c->due_ns <= world_now()) {
		unsigned part = s->lie == BY_BYTES ? 1 : c->len - c->sent;

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
	ssize_t n = recv(c->fd, c->in + c->got, ROOM - 1 - c->got, MSG_DONTWAIT);

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
	struct server *s = of(part);
	int fd;

	if (s->dead || s->hangs)
		return;
	while ((fd = accept4(s->listen_fd, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK)) >= 0) {
		struct server_client *c = s->client;

		while (c < s->client + CLIENTS && c->fd >= 0)
			c++;
		if (c == s->client + CLIENTS) {
			close(fd);
			continue;
		}
		drop(c);
		c->fd = fd;
	}
	for (unsigned i = 0; i < CLIENTS; i++)
		if (s->client[i].fd >= 0)
			receive(part, &s->client[i]);
}

static int64_t next(struct part *part)
{
	const struct server *s = of(part);
	int64_t at = INT64_MAX;

	for (unsigned i = 0; i < CLIENTS && !s->hangs; i++) {
		const struct server_client *c = &s->client[i];
		int64_t due = c->alive_ns < c->due_ns ? c->alive_ns : c->due_ns;

		if (c->fd >= 0 && due < at)
			at = due;
	}
	return at;
}

static void run(struct part *part)
{
	struct server *s = of(part);

	look(part);
	for (unsigned i = 0; i < CLIENTS; i++)
		if (s->client[i].fd >= 0)
			send_due(s, &s->client[i]);
}

static int64_t ready(struct part *part, int fd, short events)
{
	struct pollfd poll_fd = { .fd = fd, .events = events };

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

	of(part)->hangs = false;
	look(part); /* who waited is gone by now, and makes room */
}

static const char *fault(struct part *part, int64_t ns)
{
	struct server *s = of(part);
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
	return lies[s->lie];
}

static void restart(struct part *part, unsigned device)
{
	struct server *s = of(part);

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
	of(part)->latch |= 0xf0;
}

static unsigned relays(struct part *part)
{
	return of(part)->relays;
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
