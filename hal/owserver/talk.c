/* SPDX-License-Identifier: MIT */
/*
 * Sends a request and receives its reply over a kept connection, within limits for what the peer
 * may send.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/owserver/talk.h"

/*
 * A genuine owserver sends one keep-alive a second, also when it serves another owserver's devices.
 */
#define ALIVE_BURST 32u
#define ALIVE_PER_S 20
/* So many pieces of a reply are read as they come; after that, what came within a pause at once. */
#define PIECES 16u
#define PAUSE_NS NS_PER_MS

static int talk_fail(struct talk *talk, int err, const char *reason)
{
	snprintf(talk->trouble, sizeof(talk->trouble), "%.60s: %.48s", talk->connection.peer,
	         reason);
	connection_close(&talk->connection);
	if (err == -EPROTO)
		bus_count(&talk->counter[TALK_GARBAGE], 1);
	return err;
}

static int fail_socket(struct talk *talk, int err)
{
	if (err == -ECANCELED)
		return talk_fail(talk, -EINPROGRESS, "shutting down");
	return talk_fail(talk, -ECONNRESET, strerror(-err));
}

static int time_is_over(struct talk *talk)
{
	bus_count(&talk->counter[TALK_TIMEOUTS], 1);
	return talk->heard ? talk_fail(talk, -EINPROGRESS, "no whole answer in time")
	                   : talk_fail(talk, -ETIMEDOUT, "no sign of life in time");
}

static int make_request(struct talk *talk, const struct talk_request *request)
{
	uint32_t flags = FRAME_PERSIST | (request->fresh ? FRAME_UNCACHED : 0) |
	                 (request->type == FRAME_DIRALL ? FRAME_BUS_LIST : 0);

	int len = frame_request(talk->out, request->type, flags, request->size, request->path,
	                        request->data, request->data_len);

	if (len < 0)
		return len;
	frame_set_offset(talk->out, (int32_t)request->offset);
	return frame_add_tokens(talk->out, len, talk->tokens, talk->token_count);
}

/* 0, or the error of connection_send(). */
static int send_request(struct talk *talk, const struct talk_request *request, size_t len,
                        int64_t until_ns, size_t *sent)
{
	int err;

	talk->asked_ns = bus_now(talk->connection.env);
	talk->alives = talk->pieces = 0;
	if (request->room)
		frame_begin(&talk->reader, request->room, request->limit);
	else
		frame_begin(&talk->reader, talk->scrap, sizeof(talk->scrap));
	err = connection_send(&talk->connection, talk->out, len, until_ns, sent);
	bus_count(&talk->counter[TALK_BYTES_OUT], *sent);
	return err;
}

int talk_send(struct talk *talk, const struct talk_request *request, int64_t until_ns)
{
	int len = make_request(talk, request), err;
	size_t sent;

	if (len < 0)
		return len;
	err = send_request(talk, request, (size_t)len, until_ns, &sent);
	return err == -ETIMEDOUT ? time_is_over(talk) : err ? fail_socket(talk, err) : 0;
}

static int end_reply(struct talk *talk, size_t left_over)
{
	if (left_over)
		return talk_fail(talk, -EPROTO, "garbage after the answer");
	if (!(talk->reader.header.flags & FRAME_PERSIST)) {
		bus_count(&talk->counter[TALK_REFUSED], 1);
		connection_close(&talk->connection);
	}
	return 0;
}

/* Does the peer send more keep-alives than any owserver does? They cost time and carry nothing. */
static bool is_flood(struct talk *talk)
{
	int64_t waited_ns = bus_now(talk->connection.env) - talk->asked_ns;

	bus_count(&talk->counter[TALK_KEEPALIVES], 1);
	return ++talk->alives > ALIVE_BURST + (uint64_t)(waited_ns * ALIVE_PER_S / NS_PER_S);
}

/*
 * Pause between pieces: a peer that sends byte by byte causes at most a thousand reads a second. 0,
 * or -ECANCELED.
 */
static int pause_after_pieces(struct talk *talk, int64_t until_ns)
{
	const struct bus_env *env = talk->connection.env;
	int64_t end_ns = bus_now(talk->connection.env) + PAUSE_NS;

	if (++talk->pieces <= PIECES)
		return 0;
	return env->wait(env->ctx, -1, 0, end_ns < until_ns ? end_ns : until_ns);
}

int talk_receive(struct talk *talk, int64_t until_ns)
{
	do {
		int n = pause_after_pieces(talk, until_ns);
		size_t at = 0;

		if (n == 0)
			n = connection_receive(&talk->connection, talk->in, sizeof(talk->in),
			                       until_ns);

		if (n == -ETIMEDOUT)
			return -EAGAIN;
		if (n < 0)
			return fail_socket(talk, n);
		if (n == 0)
			return talk_fail(talk, -ECONNRESET, "closed by the server");
		talk->heard = true;
		bus_count(&talk->counter[TALK_BYTES_IN], (uint64_t)n);
		while (at < (size_t)n) {
			size_t used;
			int state = frame_feed(&talk->reader, talk->in + at, (size_t)n - at, &used);

			at += used;
			if (state == FRAME_WHOLE)
				return end_reply(talk, (size_t)n - at);
			if (state == FRAME_ALIVE && is_flood(talk)) {
				bus_count(&talk->counter[TALK_FLOODS], 1);
				return talk_fail(talk, -EPROTO, "keep-alives without end");
			}
			if (state == -EMSGSIZE)
				return talk_fail(talk, -EPROTO, "an answer longer than asked for");
			else if (state < 0)
				return talk_fail(talk, -EPROTO, "this is not an owserver");
		}
	} while (bus_now(talk->connection.env) < until_ns);
	return -EAGAIN;
}

static int talk_reopen(struct talk *talk, int64_t deadline_ns)
{
	int err = connection_open(&talk->connection, deadline_ns);

	if (!err) {
		bus_count(&talk->counter[TALK_CONNECTIONS], 1);
		return 0;
	}
	if (err == -ECANCELED)
		return fail_socket(talk, err);
	if (err == -ETIMEDOUT)
		bus_count(&talk->counter[TALK_TIMEOUTS], 1);
	snprintf(talk->trouble, sizeof(talk->trouble), "%s", talk->connection.trouble);
	return err == -ETIMEDOUT ? err : -ECONNREFUSED;
}

/* Try once. *again: the peer had closed the kept connection, and repeating does no harm. */
static int talk_once(struct talk *talk, const struct talk_request *request, size_t len,
                     int64_t deadline_ns, bool *again)
{
	bool kept = connection_is_open(&talk->connection);
	uint64_t in_before = talk->counter[TALK_BYTES_IN].value;
	size_t sent;
	int err;

	*again = false;
	/*
	 * The peer closed the connection while it was idle, or sent bytes that must not pass for
	 * the next answer.
	 */
	if (kept && connection_is_stale(&talk->connection)) {
		bus_count(&talk->counter[TALK_STALE], 1);
		kept = false;
		connection_close(&talk->connection);
	}
	if (!connection_is_open(&talk->connection)) {
		err = talk_reopen(talk, deadline_ns);
		if (err)
			return err;
	}
	err = send_request(talk, request, len, deadline_ns, &sent);
	if (err == -ETIMEDOUT)
		return time_is_over(talk);
	if (err) {
		*again = kept && err != -ECANCELED && (sent == 0 || request->type != FRAME_WRITE);
		return fail_socket(talk, err);
	}
	err = talk_receive(talk, deadline_ns);
	*again = err == -ECONNRESET && kept && request->type != FRAME_WRITE &&
	         in_before == talk->counter[TALK_BYTES_IN].value;
	return err == -EAGAIN ? time_is_over(talk) : err;
}

int talk_exchange(struct talk *talk, const struct talk_request *request, int64_t deadline_ns)
{
	int len = make_request(talk, request);
	bool again;
	int err;

	if (len < 0)
		return len;
	bus_count(&talk->counter[TALK_REQUESTS], 1);
	err = talk_once(talk, request, (size_t)len, deadline_ns, &again);
	if (again) {
		bus_count(&talk->counter[TALK_STALE], 1);
		err = talk_once(talk, request, (size_t)len, deadline_ns, &again);
	}
	return err;
}
