/* SPDX-License-Identifier: MIT */
/* The exchanges of a connection, and the answers of a bus, recorded and replayed. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "hal/trace/frames.h"

/* --- A recording: what comes until something is sent, or the peer ends, is one answer --- */

static void end_exchange(struct trace *trace, const struct bus_env *env, int result)
{
	if (trace->asked)
		trace_told(trace, env, &trace->net, result, trace->in, &trace->in_n);
	trace->asked = false;
	trace->ended_ns = 0;
	trace->in_n = 0;
}

void trace_received(struct tap *tap, const struct bus_env *env, const uint8_t *bytes, size_t n)
{
	struct trace *trace = (struct trace *)tap;
	uint8_t *in;

	if (!trace->file)
		return;
	trace->ended_ns = bus_now(env);
	if (!n) {
		end_exchange(trace, env, -ECONNRESET);
		return;
	}
	in = realloc(trace->in, trace->in_n + n);
	if (!in)
		return;
	memcpy(in + trace->in_n, bytes, n);
	trace->in = in;
	trace->in_n += n;
}

void trace_frames_end(struct trace *trace)
{
	/* The connection is gone, and its clock */
	if (!trace->ended_ns)
		trace->ended_ns = trace->begun_ns;
	if (trace->file)
		end_exchange(trace, NULL, 0);
	free(trace->in);
	if (trace->peer >= 0)
		close(trace->peer);
}

/* --- A replay: the peer is the other end of a pair of sockets --- */

int trace_connect(struct tap *tap)
{
	struct trace *trace = (struct trace *)tap;
	int pair[2];

	if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair))
		return -errno;
	if (trace->peer >= 0)
		close(trace->peer);
	trace->peer = pair[1];
	return pair[0];
}

static void answer_exchange(struct trace *trace, const struct bus_env *env)
{
	static uint8_t in[TRACE_MOST / 4];
	size_t n = sizeof(in);
	int result = trace_told(trace, env, &trace->net, 0, in, &n);

	if (trace->peer < 0)
		return;
	if (n && send(trace->peer, in, n, MSG_NOSIGNAL | MSG_DONTWAIT) != (ssize_t)n)
		result = -ECONNRESET;
	if (result < 0) {
		close(trace->peer);
		trace->peer = -1;
	}
}

void trace_sent(struct tap *tap, const struct bus_env *env, const uint8_t *bytes, size_t n)
{
	struct trace *trace = (struct trace *)tap;

	if (trace->file)
		end_exchange(trace, env, 0);
	trace_ask(trace, env, "sent ");
	trace_bytes(&trace->question, bytes, n, true);
	if (!trace->file)
		answer_exchange(trace, env);
	trace->asked = true;
}

/* --- Answers of the bus --- */

static const char *const words[] = {
	[BUS_DIR] = "dir ", [BUS_READ] = "read ", [BUS_WRITE] = "write ", [BUS_PROBE] = "probe "};

/* A replay looks at the text of the answer, which it makes as a recording does. */
void trace_answered(struct tap *tap, const struct bus_env *env, const struct bus_req *req,
                    const struct bus_answer *answer)
{
	struct trace *trace = (struct trace *)tap;
	bool gives = !answer->err && (req->op == BUS_READ || req->op == BUS_DIR);
	size_t n = gives ? answer->len : 0;
	const struct trace_line *line;

	if (trace->file)
		end_exchange(trace, env, 0);
	trace_ask(trace, env, "%s", words[req->op]);
	trace_bytes(&trace->question, (const uint8_t *)req->path, strlen(req->path), true);
	if (req->op == BUS_WRITE) {
		trace_add(&trace->question, " ");
		trace_bytes(&trace->question, req->data, req->len, true);
	}
	if (trace->file) {
		trace_told(trace, env, &trace->bus, answer->err, req->data, &n);
		return;
	}
	line = trace_find(trace, env, &trace->bus);
	trace_result_text(&trace->answer, answer->err, req->data, n, true);
	if (line && strcmp(line->answer, trace->answer.text))
		trace_note(trace, env, "%s:%zu: %.60s was %.40s, is %.40s", trace->name,
		           line->number, line->question, line->answer, trace->answer.text);
}
