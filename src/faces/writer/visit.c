/* SPDX-License-Identifier: MIT */
/* Receives a request within its deadline, has it done, and sends the answer. */
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/faces/writer/answer.h"
#include "src/faces/writer/order.h"
#include "src/faces/writer/store.h"
#include "src/faces/writer/visit.h"
#include "src/ground/text/log.h"
#include "src/memory/shm/peer.h"
#include "src/public/ows.h"

#define PATIENCE_NS (10 * NS_PER_S)
#define DRAIN_NS (1 * NS_PER_S)
#define RELOAD_NS (30 * NS_PER_S)

/* Sleep until the connection is ready for events; false: the time is over. */
static bool visit_await(int fd, short events, int64_t until_ns)
{
	struct pollfd poll_fd = {.fd = fd, .events = events};
	int64_t left_ns = until_ns - ows_now();

	return left_ns > 0 && poll(&poll_fd, 1, (int)(left_ns / NS_PER_MS) + 1) >= 0;
}

/* How many bytes came; 0: the peer sends no more; -ETIMEDOUT or another negative errno. */
static ssize_t visit_receive(int fd, char *to, size_t room, int64_t until_ns)
{
	ssize_t n;

	while ((n = peer_receive(fd, to, room, true)) == -EAGAIN || n == -EINTR)
		if (!visit_await(fd, POLLIN, until_ns))
			return -ETIMEDOUT;
	return n;
}

static void send_answer(int fd, const char *text, size_t len, int64_t until_ns)
{
	while (len) {
		ssize_t n = send(fd, text, len, MSG_NOSIGNAL);

		if (n < 0 && errno != EAGAIN && errno != EINTR)
			return;
		if (n < 0 && !visit_await(fd, POLLOUT, until_ns))
			return;
		if (n > 0) {
			text += n;
			len -= (size_t)n;
		}
	}
}

/* A peer that still sends would not find the answer; one that never stops is left. */
static void drain_peer(int fd)
{
	int64_t until_ns = ows_now() + DRAIN_NS;
	char bytes[4096];

	shutdown(fd, SHUT_WR);
	while (ows_now() < until_ns && visit_receive(fd, bytes, sizeof(bytes), until_ns) > 0)
		;
}

static void say_lost(ssize_t got, struct answer *answer)
{
	answer_say(answer, ANSWER_REFUSED, "%s",
	           got == -ETIMEDOUT ? "the request took longer than ten seconds"
	           : got == 0        ? "the request ends before its end"
	           : got == -EBADMSG ? "a descriptor came with the request: send bytes alone"
	                             : strerror((int)-got));
}

/* The bytes behind the head, of which `had` came with it. NULL: the answer has the reason. */
static char *receive_body(int fd, const struct order *order, const char *begin, size_t had,
                          int64_t until_ns, struct answer *answer)
{
	char *body = malloc(order->length + 1);
	size_t used = had < order->length ? had : order->length;
	char more;

	if (!body) {
		answer_say(answer, ANSWER_ERROR, "%s", strerror(ENOMEM));
		return NULL;
	}
	memcpy(body, begin, used);
	while (used < order->length) {
		ssize_t n = visit_receive(fd, body + used, order->length - used, until_ns);

		if (n <= 0) {
			say_lost(n, answer);
			free(body);
			return NULL;
		}
		used += (size_t)n;
	}
	body[used] = '\0';
	if (had <= order->length && recv(fd, &more, 1, MSG_PEEK | MSG_DONTWAIT) <= 0)
		return body;
	answer_say(answer, ANSWER_REFUSED, "more bytes came than length says");
	free(body);
	return NULL;
}

/* The whole request: the body, or "" of a restore; NULL: the answer has the reason. */
static char *receive_request(int fd, struct order *order, struct answer *answer)
{
	int64_t until_ns = ows_now() + PATIENCE_NS;
	char head[ORDER_HEAD_MAX];
	const char *why;
	size_t used = 0;
	int len = 0;

	while (!len) {
		ssize_t n = visit_receive(fd, head + used, sizeof(head) - used, until_ns);

		if (n <= 0) {
			say_lost(n, answer);
			return NULL;
		}
		used += (size_t)n;
		len = order_parse(head, used, order, &why);
	}
	if (len > 0)
		return receive_body(fd, order, head + len, used - (size_t)len, until_ns, answer);
	answer_say(answer, ANSWER_REFUSED, "%s", why);
	return NULL;
}

static bool may_write(const struct writer *writer, const struct peer *peer)
{
	return !peer->uid || peer->uid == geteuid() ||
	       (writer->has_group && peer->uid != writer->owsd &&
	        peer_in_group(peer, writer->group));
}

static void ask_reload(const struct writer *writer, struct answer *answer)
{
	char why[ANSWER_WHY];
	int err = ows_reload(writer->instance, RELOAD_NS, why, sizeof(why));

	answer->reload = !err                      ? ANSWER_RELOADED
	                 : err == -ENOENT && !*why ? ANSWER_NO_OWSD
	                                           : ANSWER_RELOAD_REFUSED;
	if (!err || answer->reload == ANSWER_NO_OWSD)
		return;
	if (*why)
		answer_say(answer, ANSWER_DONE, "%s", why);
	else if (err == -EACCES)
		answer_say(
			answer, ANSWER_DONE,
			"owsd does not let this writer ask for a reload: is its user in the group "
			"owsd-config?");
	else
		answer_say(answer, ANSWER_DONE, "owsd did not reload: %s", strerror(-err));
}

/* kind: "request", where it was not understood. */
static void log_visit(const struct writer *writer, const struct peer *peer, const char *kind,
                      const struct order *order, const struct answer *answer)
{
	bool named = *order->person;

	log_at(writer->log, answer->status == ANSWER_DONE ? LOG_LEVEL_NOTICE : LOG_LEVEL_WARNING,
	       "%s: %s by user %u (process %d)%s%s%s: %s%s%s%s%s", writer->file, kind,
	       (unsigned)peer->uid, (int)peer->pid, named ? " for \"" : "", order->person,
	       named ? "\"" : "", answer_word(answer->status), answer->has_tag ? ", tag " : "",
	       answer->tag, *answer->why ? ", " : "", answer->why);
}

/* A signal that ends the program waits until the change is whole. */
static void hold_signals(bool hold)
{
	sigset_t ends;

	sigemptyset(&ends);
	sigaddset(&ends, SIGTERM);
	sigaddset(&ends, SIGINT);
	sigprocmask(hold ? SIG_BLOCK : SIG_UNBLOCK, &ends, NULL);
}

void visit(const struct writer *writer, int fd, bool may)
{
	struct answer answer = {.status = ANSWER_ERROR};
	struct order order = {0};
	struct peer peer = {0};
	char *body = NULL, *text;
	size_t len = 0;
	int err = peer_look(fd, &peer);

	if (err)
		answer_say(&answer, ANSWER_ERROR, "%s", strerror(-err));
	else if (!may_write(writer, &peer))
		answer_say(&answer, ANSWER_REFUSED,
		           "no right to change the configuration: that is for root and the group "
		           "owsd-config, without the user owsd");
	else if (!may)
		answer_say(&answer, ANSWER_REFUSED,
		           "too many requests of this user wait: try again when one has ended");
	else
		body = receive_request(fd, &order, &answer);
	if (body) {
		hold_signals(true);
		store_change(writer->file, &order, body, &answer);
		if (answer.status == ANSWER_DONE)
			ask_reload(writer, &answer);
	}
	log_visit(writer, &peer,
	          !body                         ? "request"
	          : order.kind == ORDER_RESTORE ? "restore"
	          : order.kind == ORDER_RENAME  ? "rename"
	                                        : "replace",
	          &order, &answer);
	hold_signals(false);
	text = answer_print(&answer, &len);
	if (text)
		send_answer(fd, text, len, ows_now() + PATIENCE_NS);
	drain_peer(fd);
	free(text);
	free(body);
	answer_free(&answer);
	peer_forget(&peer);
}
