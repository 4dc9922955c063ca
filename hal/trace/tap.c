/* SPDX-License-Identifier: MIT */
/*
 * A recording, or a replay, as the functions of a tap. Here are the exchanges of a connection and
 * the answers of a bus.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "hal/trace/i2c.h"
#include "hal/trace/links.h"
#include "hal/trace/tap.h"

/* --- A recording: what comes until something is sent, or the peer ends, is one answer --- */

static void end_exchange(struct trace *trace, int result)
{
	if (trace->asked)
		trace_write(trace, result, trace->ended_ns);
	trace->asked = false;
}

static void note_received(struct tap *tap, const struct bus_env *env, const uint8_t *bytes,
                          size_t n)
{
	struct trace *trace = (struct trace *)tap;

	if (!trace->asked)
		return;
	trace->ended_ns = bus_now(env);
	if (n)
		trace_bytes(&trace->answer, bytes, n, true);
	else
		end_exchange(trace, -ECONNRESET);
}

/* --- A replay: the peer is the other end of a pair of sockets --- */

static void close_peer(struct trace *trace)
{
	if (trace->peer >= 0)
		close(trace->peer);
	trace->peer = -1;
}

static int connect_peer(struct tap *tap)
{
	struct trace *trace = (struct trace *)tap;
	int pair[2];

	if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair))
		return -errno;
	close_peer(trace);
	trace->peer = pair[1];
	return pair[0];
}

static void answer_exchange(struct trace *trace)
{
	uint8_t *in = (uint8_t *)trace->answer.text;
	size_t n = sizeof(trace->answer.text);
	int result = trace_told(trace, 0, 0, in, &n);

	if (trace->peer >= 0 && n &&
	    send(trace->peer, in, n, MSG_NOSIGNAL | MSG_DONTWAIT) != (ssize_t)n)
		result = -ECONNRESET;
	if (result < 0)
		close_peer(trace);
}

static void note_sent(struct tap *tap, const struct bus_env *env, const uint8_t *bytes, size_t n)
{
	struct trace *trace = (struct trace *)tap;

	end_exchange(trace, 0);
	trace_ask(trace, env, TRACE_NET, "sent ");
	trace_bytes(&trace->question, bytes, n, true);
	trace->asked = trace->file != NULL;
	trace->ended_ns = trace->begun_ns;
	if (!trace->file)
		answer_exchange(trace);
}

/* --- Answers of the bus --- */

static const char *const words[] = {
	[BUS_DIR] = "dir ", [BUS_READ] = "read ", [BUS_WRITE] = "write ", [BUS_PROBE] = "probe "};

/* A replay looks at the text of the answer, which it makes as a recording does. */
static void compare_answer(struct trace *trace, int result, const uint8_t *bytes, size_t n)
{
	const struct trace_line *line = trace_find(trace);
	char text[TRACE_RESULT];

	trace_add(&trace->answer, n ? "%s " : "%s", trace_result_text(result, text));
	if (n)
		trace_bytes(&trace->answer, bytes, n, true);
	if (line && strcmp(line->answer, trace->answer.text) != 0)
		trace_note(trace, "%s:%zu: %.60s was %.40s, is %.40s", trace->name, line->number,
		           line->question, line->answer, trace->answer.text);
}

static void note_answer(struct tap *tap, const struct bus_env *env, const struct bus_req *req,
                        const struct bus_answer *answer)
{
	struct trace *trace = (struct trace *)tap;
	bool gives = !answer->err && (req->op == BUS_READ || req->op == BUS_DIR);
	size_t n = gives ? answer->len : 0;

	end_exchange(trace, 0);
	trace_ask(trace, env, TRACE_BUS, "%s", words[req->op]);
	trace_bytes(&trace->question, (const uint8_t *)req->path, strlen(req->path), true);
	if (req->op == BUS_WRITE) {
		trace_add(&trace->question, " ");
		trace_bytes(&trace->question, req->data, req->len, true);
	}
	if (trace->file)
		trace_told(trace, 0, answer->err, req->data, &n);
	else
		compare_answer(trace, answer->err, req->data, n);
}

/* --- Begin and end --- */

static void begin(struct trace *trace)
{
	memset(trace, 0, sizeof(*trace)); /* no literal: it is larger than a stack */
	trace->tap = (struct tap){.adapter = trace_adapter_of,
	                          .link = trace_link_of,
	                          .sent = note_sent,
	                          .received = note_received,
	                          .answered = note_answer};
	trace->left = TRACE_MOST / 2;
	trace->peer = -1;
}

void trace_record(struct trace *trace, FILE *file, bool i2c)
{
	begin(trace);
	trace->file = file;
	if (i2c)
		trace->tap.link = NULL;
	else
		trace->tap.adapter = NULL;
	fputs(TRACE_BEGIN, file);
}

int trace_replay(struct trace *trace, const char *name, char *why, size_t why_size)
{
	begin(trace);
	trace->tap.connect = connect_peer;
	return trace_read(trace, name, why, why_size);
}

void trace_end(struct trace *trace)
{
	end_exchange(trace, 0);
	close_peer(trace);
	trace_links_free(trace);
	free(trace->line);
	free(trace->text);
}
