/* SPDX-License-Identifier: MIT */
/* Accepts, receives and sends for all clients, by one epoll descriptor. */
#include <errno.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <string.h>
#include <sys/epoll.h>
#include <unistd.h>

#include "src/faces/kit/loop.h"
#include "src/faces/modbus/clients.h"
#include "src/ground/service/listen.h"

#define BATCH 64
/* A connection whose other end has gone without a word is closed after half a minute */
#define KEEP_IDLE_S 15
#define KEEP_EVERY_S 5
#define KEEP_TIMES 3
#define KEEP_MS 20000

static int clients_watch(struct clients *c, int how, int fd, unsigned number, uint32_t events)
{
	struct epoll_event event = {.events = events, .data.u32 = number};

	return epoll_ctl(c->epoll, how, fd, &event) ? -errno : 0;
}

/* Numbers of epoll: a listener, or after these a client. */
static unsigned number_of(const struct clients *c, const struct client *client)
{
	return LISTENERS + (unsigned)(client - c->places);
}

static void drop(struct clients *c, struct client *client, const char *why)
{
	char text[LISTEN_TEXT_MAX];

	listen_print(&client->from, text);
	log_info(c->face->log, "%s: %s", text, why);
	close(client->fd);
	client->used = false;
	c->count--;
}

/* --- Requests and answers -------------------------------------------------------------------- */

/* False: the connection is closed. */
static bool clients_send(struct clients *c, struct client *client)
{
	struct budget_call call;
	ssize_t sent;

	budget_begin(&client->budget, &call);
	sent = send(client->fd, client->out + client->out_at, client->out_len - client->out_at,
	            MSG_NOSIGNAL | MSG_DONTWAIT);
	if (!budget_end(&client->budget, &call, FRAME_MOST)) {
		drop(c, client, "closed: sending to it takes too long");
		return false;
	}
	if (sent < 0 && errno != EAGAIN && errno != EINTR) {
		drop(c, client, strerror(errno));
		return false;
	}
	if (sent > 0)
		client->out_at += (size_t)sent;
	if (client->out_at == client->out_len)
		client->out_at = client->out_len = 0;
	return true;
}

/*
 * Answer what is whole, until an answer does not go out. What then owes the rest of a request, or
 * takes no answer, has a time for it. False: the connection is closed.
 */
static bool answer_all(struct clients *c, struct client *client, int64_t now_ns)
{
	bool owes = client->out_len, owed = owes;
	size_t at = 0;
	int n = 0;

	while (!client->out_len && (n = frame_length(client->in + at, client->in_len - at)) > 0) {
		client->out_len = c->answer(c->ctx, client, client->in + at, client->out);
		client->came_ns = client->next_ns;
		at += (size_t)n;
		client->heard_ns = now_ns;
		client->late_ns = 0;
		c->requests++;
		if (!clients_send(c, client))
			return false;
		owes = client->out_len;
	}
	if (n < 0) {
		c->refused++;
		drop(c, client, "closed: it speaks no Modbus TCP");
		return false;
	}
	client->in_len -= at;
	memmove(client->in, client->in + at, client->in_len);
	if (!owes && !client->in_len)
		client->late_ns = 0;
	else if (!client->late_ns)
		client->late_ns = now_ns + CLIENTS_LATE_NS;
	/* nothing more is received before it has taken its answer */
	if (owes != owed)
		clients_watch(c, EPOLL_CTL_MOD, client->fd, number_of(c, client),
		              owes ? EPOLLOUT : EPOLLIN);
	return true;
}

static void receive(struct clients *c, struct client *client, int64_t now_ns)
{
	size_t room = sizeof(client->in) - client->in_len;
	int64_t before_ns = ows_now();
	ssize_t got = recv(client->fd, client->in + client->in_len, room, MSG_DONTWAIT);

	if (got < 0 && (errno == EAGAIN || errno == EINTR))
		return;
	if (got <= 0) {
		drop(c, client, got ? strerror(errno) : "has left");
		return;
	}
	client->next_ns = client->empty_ns;
	if (!client->in_len)
		client->came_ns = client->next_ns;
	if ((size_t)got < room)
		client->empty_ns = before_ns;
	client->in_len += (size_t)got;
	answer_all(c, client, now_ns);
}

/*
 * When was nothing left to receive? As long as its answers alone were watched for, nobody knows.
 */
static void judge_silence(const struct clients *c, struct client *client)
{
	int64_t silent_ns = face_came(c->face, c->epoll);

	/* a look at all did not find it ready: nothing was there */
	if (client->pass < c->whole_pass && c->whole_ns > silent_ns)
		silent_ns = c->whole_ns;
	if (!client->out_len && silent_ns > client->blind_ns && silent_ns > client->empty_ns)
		client->empty_ns = silent_ns;
}

/* The client is ready, to send or to take. */
static void turn(struct clients *c, struct client *client, int64_t now_ns)
{
	judge_silence(c, client);
	client->pass = c->pass;
	if (!client->out_len) {
		receive(c, client, now_ns);
		return;
	}
	if (!clients_send(c, client) || client->out_len)
		return;
	client->late_ns = 0;
	client->blind_ns = ows_now();
	clients_watch(c, EPOLL_CTL_MOD, client->fd, number_of(c, client), EPOLLIN);
	answer_all(c, client, now_ns);
}

/* --- Places ---------------------------------------------------------------------------------- */

static bool same_host(const struct listen_address *a, const struct listen_address *b)
{
	return a->is_v6 == b->is_v6 && !memcmp(a->bytes, b->bytes, a->is_v6 ? 16 : 4);
}

/* That of all, or of that address, which has been silent for longest. */
static struct client *most_silent(struct clients *c, const struct listen_address *of,
                                  unsigned *count)
{
	struct client *found = NULL;

	*count = 0;
	for (unsigned i = 0; i < CONFIG_MODBUS_CLIENTS; i++) {
		struct client *client = &c->places[i];

		if (!client->used || (of && !same_host(of, &client->from)))
			continue;
		++*count;
		if (!found || client->heard_ns < found->heard_ns)
			found = client;
	}
	return found;
}

static void make_room(struct clients *c, const struct listen_address *from)
{
	unsigned of_it, all;
	struct client *own = most_silent(c, from, &of_it), *any = most_silent(c, NULL, &all);

	if (own && of_it >= (c->most + 1) / 2)
		drop(c, own, "closed: a new connection of its address takes its place");
	else if (any && all >= c->most)
		drop(c, any, "closed: a new connection takes its place");
}

static void keep_alive(int fd)
{
	static const struct {
		int level, name, value;
	} options[] = {
		{SOL_SOCKET, SO_KEEPALIVE, 1},
		{IPPROTO_TCP, TCP_KEEPIDLE, KEEP_IDLE_S},
		{IPPROTO_TCP, TCP_KEEPINTVL, KEEP_EVERY_S},
		{IPPROTO_TCP, TCP_KEEPCNT, KEEP_TIMES},
		{IPPROTO_TCP, TCP_USER_TIMEOUT, KEEP_MS},
		{IPPROTO_TCP, TCP_NODELAY, 1},
	};

	for (size_t i = 0; i < sizeof(options) / sizeof(options[0]); i++)
		setsockopt(fd, options[i].level, options[i].name, &options[i].value,
		           sizeof(options[i].value));
}

static void welcome(struct clients *c, int fd, const struct listen_address *from, int64_t now_ns)
{
	char text[LISTEN_TEXT_MAX];
	struct client *client = c->places;

	make_room(c, from);
	while (client->used)
		client++;
	if (clients_watch(c, EPOLL_CTL_ADD, fd, number_of(c, client), EPOLLIN)) {
		close(fd);
		return;
	}
	keep_alive(fd);
	*client = (struct client){.used = true,
	                          .fd = fd,
	                          .from = *from,
	                          .heard_ns = now_ns,
	                          .empty_ns = c->nobody_ns,
	                          .blind_ns = c->resumed_ns,
	                          .pass = c->pass};
	c->count++;
	c->full_err = 0;
	listen_print(from, text);
	log_info(c->face->log, "%s: connected", text);
}

/* Connections wait with the kernel for a moment; who is connected is served meanwhile. */
static void pause_listeners(struct clients *c, int err, int64_t now_ns)
{
	if (err != c->full_err)
		log_warning(c->face->log, "no client can connect: %s", strerror(-err));
	c->full_err = err;
	c->pause_ns = now_ns + LISTEN_PAUSE_NS;
	listen_pause(c->epoll, c->listeners.fds, c->listeners.count);
}

/* True: nobody waits there any more. */
static bool accept_some(struct clients *c, int listener, int64_t now_ns)
{
	for (unsigned i = 0; i < BATCH; i++) {
		struct sockaddr_storage at;
		socklen_t len = sizeof(at);
		struct listen_address from;
		struct client *silent;
		unsigned count;
		int fd = listen_accept(listener, (struct sockaddr *)&at, &len);

		/*
		 * A descriptor of this program is that of the most silent. What the whole machine
		 * lacks, others would take.
		 */
		silent = fd == -EMFILE && i == 0 ? most_silent(c, NULL, &count) : NULL;
		if (silent) {
			drop(c, silent, "closed: too many files are open");
			continue;
		}
		if (listen_is_full(fd))
			pause_listeners(c, fd, now_ns);
		if (fd < 0)
			return fd == -EAGAIN;
		if (listen_of((const struct sockaddr *)&at, &from))
			welcome(c, fd, &from, now_ns);
		else
			close(fd);
	}
	return false;
}

/* --- Of the face ----------------------------------------------------------------------------- */

static void tell(struct face *face, const struct listen_address *at, bool served)
{
	bool local = listen_is_loopback(at);
	char text[LISTEN_TEXT_MAX];

	listen_print(at, text);
	log_at(face->log, local || !served ? LOG_LEVEL_NOTICE : LOG_LEVEL_WARNING,
	       "Modbus is %s at %s%s", served ? "served" : "no longer served", text,
	       local || !served ? "" : ": whoever reaches it may read");
}

int clients_open(struct clients *c)
{
	c->epoll = epoll_create1(EPOLL_CLOEXEC);
	c->listeners = (struct listeners){
		.face = c->face, .epoll = c->epoll, .tell = tell, .look_ns = INT64_MAX};
	return c->epoll < 0 ? -errno : face_watch(c->face, c->epoll, POLLIN);
}

void clients_follow(struct clients *c, const struct config_modbus *options, int64_t now_ns)
{
	unsigned count;

	c->most = options->clients;
	listeners_follow(&c->listeners, options->addresses, options->address_count, now_ns);
	while (c->count > (options->given ? c->most : 0))
		drop(c, most_silent(c, NULL, &count), "closed: the configuration has another");
}

void clients_take(struct clients *c)
{
	struct epoll_event events[BATCH];
	int64_t began_ns = ows_now();
	int n = epoll_wait(c->epoll, events, BATCH, 0);
	bool whole = n < BATCH;

	c->pass++;
	for (int i = 0; i < n; i++) {
		unsigned number = events[i].data.u32;

		if (number < LISTENERS)
			whole &= accept_some(c, c->listeners.fds[number], began_ns);
		else if (c->places[number - LISTENERS].used)
			turn(c, &c->places[number - LISTENERS], began_ns);
	}
	if (whole) {
		c->whole_ns = began_ns;
		c->whole_pass = c->pass;
		if (!c->pause_ns)
			c->nobody_ns = began_ns;
	}
}

int64_t clients_tick(struct clients *c, int64_t now_ns)
{
	int64_t next_ns = listeners_tick(&c->listeners, now_ns);

	if (c->pause_ns && now_ns >= c->pause_ns) {
		c->pause_ns = 0;
		listen_resume(c->epoll, c->listeners.fds, c->listeners.count);
		c->resumed_ns = ows_now();
	}
	if (c->pause_ns && c->pause_ns < next_ns)
		next_ns = c->pause_ns;
	for (unsigned i = 0; c->count && i < CONFIG_MODBUS_CLIENTS; i++) {
		struct client *client = &c->places[i];

		if (!client->used || !client->late_ns)
			continue;
		if (now_ns >= client->late_ns)
			drop(c, client,
			     client->out_len ? "closed: it does not take its answers"
			                     : "closed: its request is not whole in time");
		else if (client->late_ns < next_ns)
			next_ns = client->late_ns;
	}
	return next_ns;
}

void clients_close(struct clients *c)
{
	for (unsigned i = 0; i < CONFIG_MODBUS_CLIENTS; i++)
		if (c->places[i].used)
			drop(c, &c->places[i], "closed: owsd-modbus ends");
	listeners_follow(&c->listeners, NULL, 0, 0);
	close(c->epoll);
}
