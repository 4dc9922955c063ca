/* SPDX-License-Identifier: MIT */
/*
 * A recording, or a replay, as the functions of a tap. Here are the exchanges of a connection and
 * the answers of a bus.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <unistd.h>

#include "hal/base/file.h"
#include "hal/trace/anonymous.h"
#include "hal/trace/i2c.h"
#include "hal/trace/links.h"
#include "hal/trace/trace.h"

/* --- A recording: what comes until something is sent, or the peer ends, is one answer --- */

static void end_exchange(struct lines *lines, int result)
{
	if (lines->asked)
		trace_write(lines, result, lines->ended_ns);
	lines->asked = false;
}

static void note_received(struct tap *tap, const struct bus_env *env, const uint8_t *bytes,
                          size_t n)
{
	struct lines *lines = (struct lines *)tap;

	if (!lines->asked)
		return;
	lines->ended_ns = bus_now(env);
	if (!n)
		end_exchange(lines, -ECONNRESET);
	else if (ftell(lines->now) <= (long)TRACE_MOST)
		trace_more(lines, bytes, n);
}

/* --- A replay: the peer is the other end of a pair of sockets --- */

static void close_peer(struct lines *lines)
{
	if (lines->peer >= 0)
		close(lines->peer);
	lines->peer = -1;
}

static int connect_peer(struct tap *tap)
{
	struct lines *lines = (struct lines *)tap;
	int pair[2];

	if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair))
		return -errno;
	close_peer(lines);
	lines->peer = pair[1];
	return pair[0];
}

static void answer_exchange(struct lines *lines)
{
	const char *answer = trace_find(lines);
	size_t n = answer ? strcspn(answer, "\n") : 0;
	uint8_t *bytes = n ? malloc(n) : NULL;
	bool ends = !answer || trace_pass(lines, answer, 0);

	n = bytes ? trace_parse(answer, bytes, n) : 0;
	if (lines->peer >= 0 && n)
		ends |= send(lines->peer, bytes, n, MSG_NOSIGNAL | MSG_DONTWAIT) != (ssize_t)n;
	free(bytes);
	if (ends)
		close_peer(lines);
}

static void note_sent(struct tap *tap, const struct bus_env *env, const uint8_t *bytes, size_t n)
{
	struct lines *lines = (struct lines *)tap;
	FILE *now;

	end_exchange(lines, 0);
	now = trace_ask(lines, env, &lines->net);
	lines->form = TRACE_TEXT;
	fputs("sent ", now);
	trace_bytes(now, bytes, n, TRACE_TEXT);
	lines->asked = lines->trace.file != NULL;
	lines->ended_ns = lines->begun_ns;
	if (lines->trace.file)
		trace_asked(lines);
	else
		answer_exchange(lines);
}

/* --- Answers of the bus --- */

static const char *const words[] = {
	[BUS_DIR] = "dir ", [BUS_READ] = "read ", [BUS_WRITE] = "write ", [BUS_PROBE] = "probe "};

/* A replay has the recorded answer, and makes a text of this one. */
static void compare_answer(struct lines *lines, int result, const uint8_t *bytes, size_t n)
{
	const char *was = trace_find(lines), *is, *question;

	if (!was)
		return;
	trace_more(lines, bytes, n);
	is = trace_result(lines, result);
	question = lines->text + strlen(" bus: ");
	if (strncmp(was, is, strlen(is)) != 0 || !strchr("\n", was[strlen(is)]))
		trace_note(lines, was, "%.*swas%.*s, is%.40s", trace_shown(question, ">"), question,
		           trace_shown(was, "\n"), was, is);
}

static void note_answer(struct tap *tap, const struct bus_env *env, const struct bus_req *req,
                        const struct bus_answer *answer)
{
	struct lines *lines = (struct lines *)tap;
	bool gives = !answer->err && (req->op == BUS_READ || req->op == BUS_DIR);
	size_t n = gives ? answer->len : 0;
	FILE *now;

	end_exchange(lines, 0);
	now = trace_ask(lines, env, &lines->bus);
	fputs(words[req->op], now);
	trace_bytes(now, (const uint8_t *)req->path, strlen(req->path), TRACE_TEXT);
	if (req->op == BUS_WRITE) {
		fputc(' ', now);
		trace_bytes(now, req->data, req->len, TRACE_TEXT);
	}
	lines->form = TRACE_TEXT;
	if (lines->trace.file)
		trace_told(lines, 0, answer->err, req->data, &n);
	else
		compare_answer(lines, answer->err, req->data, n);
}

/* --- Begin and end --- */

static struct lines *begin(void)
{
	struct lines *lines = calloc(1, sizeof(*lines));

	if (!lines)
		return NULL;
	lines->trace.tap = (struct tap){.adapter = trace_adapter_of,
	                                .link = trace_link_of,
	                                .sent = note_sent,
	                                .received = note_received,
	                                .answered = note_answer};
	lines->net = (struct place){"net", NULL};
	lines->i2c = (struct place){"i2c", NULL};
	lines->bus = (struct place){"bus", NULL};
	lines->peer = -1;
	lines->now = open_memstream(&lines->text, &lines->len);
	if (lines->now)
		return lines;
	free(lines);
	return NULL;
}

struct trace *trace_record(FILE *file, bool i2c, bool anonymous)
{
	struct lines *lines = begin();
	struct trace *trace = &lines->trace;

	if (!lines)
		return NULL;
	trace->file = anonymous ? open_memstream(&lines->whole, &lines->whole_len) : file;
	if (!trace->file) {
		trace_end(trace);
		return NULL;
	}
	lines->file = anonymous ? file : NULL;
	trace->left = TRACE_MOST;
	if (i2c)
		trace->tap.link = NULL;
	else
		trace->tap.adapter = NULL;
	fputs(TRACE_BEGIN, trace->file);
	return trace;
}

int trace_replay(struct trace **trace, const char *name, char *why, size_t why_size)
{
	struct lines *lines = begin();
	int err = -ENOMEM;

	if (!lines)
		return err;
	lines->trace.tap.connect = connect_peer;
	lines->name = name;
	lines->whole = file_text(name, 2 * TRACE_MOST, &err, why, why_size);
	if (lines->whole && strncmp(lines->whole, TRACE_BEGIN, strlen(TRACE_BEGIN)) != 0) {
		snprintf(why, why_size, "%.100s is no recording: owsctl record makes one", name);
		err = -EINVAL;
	}
	if (err || !lines->whole) {
		trace_end(&lines->trace);
		return err;
	}
	*trace = &lines->trace;
	if (!trace_links(*trace))
		lines->trace.tap.link = NULL;
	return 0;
}

static int write_anonymous(struct lines *lines)
{
	uint8_t mask[TRACE_MASK];

	if (fclose(lines->trace.file) || getrandom(mask, sizeof(mask), 0) != sizeof(mask))
		return -errno;
	trace_anonymous(lines->whole, mask);
	fputs(lines->whole, lines->file);
	return 0;
}

int trace_end(struct trace *trace)
{
	struct lines *lines = (struct lines *)trace;
	int err, count;

	end_exchange(lines, 0);
	err = lines->file ? write_anonymous(lines) : 0;
	count = (int)trace->lines;
	close_peer(lines);
	fclose(lines->now);
	free(lines->text);
	free(lines->whole);
	free(lines);
	return err ? err : count;
}

bool trace_has(const struct trace *trace, const char *what)
{
	return strstr(((const struct lines *)trace)->whole, what);
}

unsigned trace_links(const struct trace *trace)
{
	char text[20];
	unsigned n = 0;

	do
		snprintf(text, sizeof(text), " %u: link >", n);
	while (trace_has(trace, text) && ++n < TRACE_LINKS);
	return n;
}
