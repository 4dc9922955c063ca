/* SPDX-License-Identifier: MIT */
/*
 * The owserver bus: requests go to an owserver over one kept connection, one at a time. Target:
 * `host`, `host:port`, `[v6]:port`, or the same after `owserver:`; `owserver:/path` is a unix
 * socket, as that of an owsd.
 *
 * Down, it connects again with back-off for ever; a connection counts as up when a NOP was
 * answered and the server has reported whether its devices are simulated. Silence and loss take it
 * down; a server that only was too slow (it sent keep-alives) stays up, on a new connection.
 */
#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "hal/base/time.h"
#include "hal/owfs/path.h"
#include "hal/owserver/judge.h"
#include "hal/owserver/listing.h"
#include "hal/owserver/server.h"
#include "hal/owserver/status.h"
#include "hal/owserver/talk.h"

#define BACKOFF_MIN (200 * NS_PER_MS)
#define BACKOFF_MAX (5000 * NS_PER_MS)
/*
 * For connecting and greeting together. A step waits for a slice of it, so that requests that come
 * meanwhile are answered at once: the target is down.
 */
#define GREETING_NS (5000 * NS_PER_MS)
#define SLICE_NS (50 * NS_PER_MS)
#define NAMES_NS (5000 * NS_PER_MS) /* owserver answers requests on a busy wire one after another */
/* For the next connection and its greeting when the server closed an idle one. */
#define REOPEN_NS (2000 * NS_PER_MS)
#define READ_MAX 65536

static_assert(BUS_TOKEN == FRAME_TOKEN_SIZE && BUS_TOKENS_MAX == FRAME_TOKENS_SENT,
              "the tokens of a request are those of its frame");

enum state { DOWN, CONNECTING, GREETING, UP };

enum own_counter {
	RECONNECTS = TALK_COUNTERS, /* returns of the server */
	COUNTERS,
};

struct owserver {
	struct bus bus;
	enum state state;
	int64_t retry_ns, backoff_ns, give_up_ns;
	bool was_up, simulated;
	struct bus_loss told;
	struct bus_event loss; /* the event for the next step to report, if text is set */
	struct bus_counter counter[COUNTERS];
	struct talk talk;
	struct listing listing;
	struct judge judge;
};

static const char *const counter_names[COUNTERS] = {
	[TALK_REQUESTS] = "requests",       [TALK_KEEPALIVES] = "keepalives",
	[TALK_CONNECTIONS] = "connections", [TALK_REFUSED] = "refused_persistence",
	[TALK_STALE] = "stale_connection",  [TALK_GARBAGE] = "garbage",
	[TALK_FLOODS] = "keepalive_floods", [TALK_TIMEOUTS] = "timeouts",
	[TALK_BYTES_IN] = "bytes_in",       [TALK_BYTES_OUT] = "bytes_out",
	[RECONNECTS] = "reconnects",
};

static int owserver_create(const char *where, const struct bus_env *env, struct bus **bus,
                           char *why, size_t why_size)
{
	struct owserver *server = calloc(1, sizeof(*server));
	int err = server ? bus_init(&server->bus, &owserver_bus, env) : -ENOMEM;

	if (err) {
		free(server);
		return err;
	}
	err = connection_init(&server->talk.connection, env, where, why, why_size);
	if (err) {
		bus_destroy(&server->bus);
		return err;
	}
	for (unsigned i = 0; i < COUNTERS; i++)
		server->counter[i].name = counter_names[i];
	server->talk.counter = server->counter;
	server->backoff_ns = BACKOFF_MIN;
	*bus = &server->bus;
	return 0;
}

static void owserver_destroy(struct bus *bus)
{
	struct owserver *server = (struct owserver *)bus;

	connection_close(&server->talk.connection);
	free(server);
}

static int64_t server_now(const struct owserver *server)
{
	return server->bus.env->now(server->bus.env->ctx);
}

/* Take the target down. The next step reports the event, so that it follows the answer. */
static void go_down(struct owserver *server, int err, const char *text)
{
	connection_close(&server->talk.connection);
	server->state = DOWN;
	server->retry_ns = server_now(server) + server->backoff_ns;
	server->backoff_ns *= 2;
	if (server->backoff_ns > BACKOFF_MAX)
		server->backoff_ns = BACKOFF_MAX;
	if (server->bus.suspended ||
	    !bus_loss_news(&server->told, err != -EACCES && err != -EPROTO))
		return;
	server->loss = (struct bus_event){.news = BUS_DOWN, .err = err};
	snprintf(server->loss.text, sizeof(server->loss.text), "%s", text);
}

static void go_up(struct owserver *server, int64_t cache_ns)
{
	struct bus_event event = {.news = BUS_UP, .cache_ns = cache_ns};

	if (server->was_up)
		bus_count(&server->counter[RECONNECTS], 1);
	server->state = UP;
	server->was_up = true;
	server->told = (struct bus_loss){0};
	snprintf(event.text, sizeof(event.text), "connected to owserver at %s",
	         server->talk.connection.peer);
	server->bus.env->event(server->bus.env->ctx, &event);
}

static void report_loss(struct owserver *server)
{
	if (!server->loss.text[0])
		return;
	server->bus.env->event(server->bus.env->ctx, &server->loss);
	server->loss.text[0] = '\0';
}

/* --- Coming up, slice by slice --------------------------------------------------------------- */

/*
 * Nothing was sent: nobody listens there, the host cannot be reached, or who is there is not
 * believed, or may not be asked.
 */
static int as_absence(int err)
{
	if (err == -EPERM || err == -EACCES)
		return -EACCES;
	return err == -ECONNREFUSED ? err : -ENOTCONN;
}

static void begin_connect(struct owserver *server)
{
	int err = connection_begin(&server->talk.connection);

	server->give_up_ns = server_now(server) + GREETING_NS;
	if (err)
		go_down(server, as_absence(err), server->talk.connection.trouble);
	else
		server->state = CONNECTING;
}

static void out_of_time(struct owserver *server)
{
	char text[sizeof(server->loss.text)];

	snprintf(text, sizeof(text), "%.70s: no answer", server->talk.connection.peer);
	bus_count(&server->counter[TALK_TIMEOUTS], 1);
	go_down(server, -ETIMEDOUT, text);
}

static int64_t slice_end(const struct owserver *server)
{
	int64_t end = server_now(server) + SLICE_NS;

	return end < server->give_up_ns ? end : server->give_up_ns;
}

static void go_on_connecting(struct owserver *server)
{
	const struct talk_request nop = {.type = FRAME_NOP};
	struct talk *talk = &server->talk;
	int err = connection_go_on(&talk->connection, slice_end(server));

	if (err == -EAGAIN || err == -ECANCELED) {
		if (server_now(server) >= server->give_up_ns)
			out_of_time(server);
		return;
	}
	if (err) {
		go_down(server, as_absence(err), talk->connection.trouble);
		return;
	}
	bus_count(&server->counter[TALK_CONNECTIONS], 1);
	server->state = GREETING;
	talk->heard = false;
	err = talk_send(talk, &nop, server->give_up_ns);
	if (err)
		go_down(server, err, talk->trouble);
}

/* The errors of an exchange that take the target down, as the contract names them. */
static int as_loss(int err)
{
	return err == -ETIMEDOUT || err == -EPROTO ? err : -ECONNRESET;
}

static void go_on_greeting(struct owserver *server)
{
	int err = talk_receive(&server->talk, slice_end(server));
	int64_t cache_ns = 0;

	if (err == 0 && server->bus.suspended) {
		server->state = UP;
		return;
	}
	if (err == 0)
		err = server_ask_simulated(&server->talk, server_now(server) + NAMES_NS,
		                           &server->simulated);
	if (err == 0)
		err = server_ask_cache(&server->talk, server_now(server) + NAMES_NS, &cache_ns);
	if (err == 0)
		go_up(server, cache_ns);
	else if (err != -EAGAIN)
		go_down(server, as_loss(err), server->talk.trouble);
	else if (server_now(server) >= server->give_up_ns)
		out_of_time(server);
}

/*
 * If a server closed an idle connection, connect again and ask a NOP, to learn whether the server
 * is there: the kernel may make a connection to a server that goes at that moment, and lose it
 * without a word.
 */
static void look_at_idle(struct owserver *server)
{
	const struct talk_request nop = {.type = FRAME_NOP};
	struct talk *talk = &server->talk;
	int err;

	if (!connection_is_open(&talk->connection) || !connection_is_stale(&talk->connection))
		return;
	talk->heard = false;
	err = talk_exchange(talk, &nop, server_now(server) + REOPEN_NS);
	if (err && err != -EINPROGRESS)
		go_down(server, as_loss(err), talk->trouble);
}

/* The next slice of coming up; nothing if the server is up. */
static void come_up(struct owserver *server)
{
	switch (server->state) {
	case DOWN:
		begin_connect(server);
		break;
	case CONNECTING:
		go_on_connecting(server);
		break;
	case GREETING:
		go_on_greeting(server);
		break;
	case UP:
		break;
	}
}

static int64_t owserver_step(struct bus *bus, int64_t now)
{
	struct owserver *server = (struct owserver *)bus;

	report_loss(server);
	if (server->state == UP && bus->stirred)
		look_at_idle(server);
	else if (server->state != DOWN || now >= server->retry_ns)
		come_up(server);
	bus->stirred = false;
	report_loss(server);
	if (server->state == DOWN)
		return server->retry_ns;
	return server->state == UP ? INT64_MAX : now;
}

/* A server that goes closes the connection. */
static int owserver_watch(struct bus *bus)
{
	const struct owserver *server = (struct owserver *)bus;
	const struct connection *connection = &server->talk.connection;

	return server->state == UP && connection_is_open(connection) ? connection->fd : -1;
}

static void owserver_suspend(struct bus *bus, bool yes)
{
	struct owserver *server = (struct owserver *)bus;

	if (yes)
		report_loss(server);
	connection_close(&server->talk.connection);
	server->state = DOWN;
	server->retry_ns = 0;
	server->backoff_ns = BACKOFF_MIN;
	server->was_up = false;
	server->told = (struct bus_loss){0};
}

/* A NOP is answered without a look at the wire, and not by a server that hangs. */
static int owserver_there(struct bus *bus)
{
	struct owserver *server = (struct owserver *)bus;

	come_up(server);
	if (server->state != UP)
		return server->state == DOWN ? 0 : -EAGAIN;
	connection_close(&server->talk.connection);
	server->state = DOWN;
	return 1;
}

/* --- Requests --------------------------------------------------------------------------------- */

/*
 * The property present is read from the wire. 0, 1: absent, or the error of the exchange. A server
 * that does not have it says nothing.
 */
static int present_on_wire(struct owserver *server, const struct bus_req *req, const char *device)
{
	char path[FRAME_PATH_MAX + 1];
	uint8_t text[16] = "";
	struct talk_request request = {.type = FRAME_READ,
	                               .fresh = true,
	                               .path = path,
	                               .size = sizeof(text),
	                               .room = text,
	                               .limit = sizeof(text)};
	int err;

	if ((size_t)snprintf(path, sizeof(path), "%s/present", device) >= sizeof(path))
		return -EMSGSIZE;
	err = talk_exchange(&server->talk, &request, req->deadline_ns);
	if (err)
		return err;
	return server->talk.reader.header.type == 1 && text[0] == '0';
}

/*
 * Ask PRESENT of the path's device, or of the path without one: the server answers it from a cache
 * of two minutes, past its caches too. 0, 1: absent, or the error of the exchange.
 */
static int present(struct owserver *server, const struct bus_req *req, bool fresh)
{
	char path[FRAME_PATH_MAX + 1];
	struct talk_request request = {.type = FRAME_PRESENT, .fresh = fresh, .path = path};
	size_t len = strlen(req->path);
	struct path split = {0};
	int err;

	if (!path_split(req->path, len, &split) && split.last.len)
		len = (size_t)(split.last.text + split.last.len - req->path);
	if (len >= sizeof(path))
		return -EMSGSIZE;
	memcpy(path, req->path, len);
	path[len] = '\0';
	err = talk_exchange(&server->talk, &request, req->deadline_ns);
	if (err)
		return err;
	if (server->talk.reader.header.type < 0)
		return 1;
	/* owserver's own simulations (--tester, --fake) have no search for one id: they say 0 */
	return fresh && split.last.len && !server->simulated ? present_on_wire(server, req, path)
	                                                     : 0;
}

/* The error for a negative return code; for -1, ask the server whether the device is there. */
static int error_of_refusal(struct owserver *server, const struct bus_req *req)
{
	int err = status_of(server->talk.reader.header.type, (enum bus_op)req->op);
	struct path split;

	if (err != 1)
		return err;
	if (path_split(req->path, strlen(req->path), &split) || !split.last.len)
		return -ENOENT;
	err = present(server, req, true);
	return err == 1 ? -ENODEV : err == 0 ? -ENOENT : err;
}

static int do_read(struct owserver *server, struct bus_req *req, uint32_t *len, double *number)
{
	uint32_t room = req->len < READ_MAX ? req->len : READ_MAX;
	struct talk_request request = {.type = FRAME_READ,
	                               .fresh = req->fresh,
	                               .path = req->path,
	                               .size = (int32_t)room,
	                               .room = req->data,
	                               .limit = room};
	const struct frame_header *reply = &server->talk.reader.header;
	int err;

	if (room == 0)
		return -EMSGSIZE;
	err = talk_exchange(&server->talk, &request, req->deadline_ns);
	if (err)
		return err;
	if (reply->type < 0) {
		err = frame_cause(reply, number);
		return err ? err : error_of_refusal(server, req);
	}
	/* either length could make a false value, as 21 of 21.5 */
	if (reply->type != reply->payload) {
		snprintf(server->talk.trouble, sizeof(server->talk.trouble),
		         "%.60s: an answer whose length differs from its header",
		         server->talk.connection.peer);
		bus_count(&server->counter[TALK_GARBAGE], 1);
		return -EPROTO;
	}
	*len = (uint32_t)reply->payload;
	if (!proof_is_needed(req->path))
		return 0;
	err = present(server, req, true);
	if (err == 1) /* one disturbed search proves nothing */
		err = present(server, req, true);
	return err == 1 ? -ENODEV : err;
}

static int do_write(struct owserver *server, struct bus_req *req, uint32_t *len)
{
	struct talk_request request = {.type = FRAME_WRITE,
	                               .path = req->path,
	                               .data = req->data,
	                               .data_len = bus_write_text(req),
	                               .offset = req->offset};
	const struct frame_header *reply = &server->talk.reader.header;
	bool is_output = req->prio == BUS_OUTPUT || req->prio == BUS_ALARM;
	int err = talk_exchange(&server->talk, &request, req->deadline_ns);

	if (err)
		return err;
	if (reply->type < 0)
		return error_of_refusal(server, req);
	/* a memory that ends earlier takes less, but a part of an output is another value */
	if (reply->size < 0 || (is_output && (uint32_t)reply->size < request.data_len))
		return -EIO;
	*len = (uint32_t)reply->size < request.data_len ? (uint32_t)reply->size : request.data_len;
	return 0;
}

static int owserver_serve(struct owserver *server, struct bus_req *req, uint32_t *len,
                          double *number)
{
	int err;

	switch ((enum bus_op)req->op) {
	case BUS_READ:
		return do_read(server, req, len, number);
	case BUS_WRITE:
		return do_write(server, req, len);
	case BUS_DIR:
		err = listing_read(&server->listing, &server->talk, req, len);
		return err == 1 ? error_of_refusal(server, req) : err;
	case BUS_PROBE:
		err = present(server, req, req->fresh);
		return err == 1 ? -ENODEV : err;
	}
	return -EOPNOTSUPP;
}

static void owserver_exec(struct bus *bus, struct bus_req *req, struct bus_answer *answer)
{
	struct owserver *server = (struct owserver *)bus;
	int err;

	answer->kind = BUS_TEXT;
	answer->detail = server->simulated ? BUS_DETAIL_SIMULATED : 0;
	if (server->state != UP) {
		answer->err = -ENOTCONN;
		return;
	}
	server->talk.heard = false;
	server->talk.tokens = req->tokens;
	server->talk.token_count = req->token_count;
	err = owserver_serve(server, req, &answer->len, &answer->number);
	server->talk.token_count = 0;
	if (err == -ECONNREFUSED)
		err = -ECONNRESET;
	if (err == -ECONNRESET || err == -ETIMEDOUT || err == -EPROTO)
		go_down(server, err, server->talk.trouble);
	else
		server->backoff_ns = BACKOFF_MIN;
	answer->measured_ns = server_now(server);
	if (!err && req->op == BUS_READ)
		err = judge_reading(&server->judge, req->path, (const char *)req->data, answer->len,
		                    server->simulated, answer->measured_ns, &answer->number);
	if (err)
		answer->len = 0;
	answer->err = err;
}

static const struct bus_counter *owserver_counters(struct bus *bus, size_t *n)
{
	*n = COUNTERS;
	return ((struct owserver *)bus)->counter;
}

static const struct bus_look looks[] = {
	{.begin = "/",
         .root = "",
         .type = S_IFSOCK,
         .wrong = "no socket",
         .remedy = "the other owsd makes the socket when it runs"},
	{0},
};

const struct bus_ops owserver_bus = {
	.scheme = "owserver",
	.summary = "an owserver of OWFS, over the network",
	.depth = 1,
	.looks = looks,
	.create = owserver_create,
	.destroy = owserver_destroy,
	.exec = owserver_exec,
	.step = owserver_step,
	.suspend = owserver_suspend,
	.visible = owserver_there,
	.watch = owserver_watch,
	.counters = owserver_counters,
};
