/* SPDX-License-Identifier: MIT */
/* The ways to a broker in turn: attempts, what ends them, and what a connection carries. */
#include <arpa/inet.h>
#include <errno.h>
#include <mosquitto.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>

#include "hal/base/time.h"
#include "src/faces/kit/loop.h"
#include "src/faces/kit/secret.h"
#include "src/faces/mqtt/advice.h"
#include "src/faces/mqtt/broker.h"
#include "src/faces/mqtt/client.h"
#include "src/faces/mqtt/stream.h"
#include "src/ground/signal/hash.h"

#define KEEPALIVE_S 30
#define ANSWER_NS (15 * NS_PER_S) /* for TCP, TLS and CONNACK together */
#define GOOD_NS (60 * NS_PER_S)
#define TEND_NS (5 * NS_PER_S)
#define READS 64 /* packets at a time */
#define END_NS (2 * NS_PER_S)
/* The step of one whose place another client takes each time; it has to last longer than a pause */
#define TAKEN_NS (120 * NS_PER_S)
#define TAKEN_GOOD_NS (150 * NS_PER_S)
#define SETTLED_NS (8 * NS_PER_S)

static void forget_trouble(struct broker *b)
{
	b->trouble[0] = '\0';
	memset(b->logged, 0, sizeof(b->logged));
}

/* --- An attempt ------------------------------------------------------------------------------ */

static void broker_watch(struct broker *b)
{
	int fd = b->client ? mosquitto_socket(b->client) : -1;
	short events = POLLIN;

	if (b->fd >= 0)
		face_ignore(b->face, b->fd);
	b->fd = fd;
	if (fd < 0)
		return;
	/* until TCP has connected libmosquitto does not ask for it with TLS */
	if (!b->tcp || mosquitto_want_write(b->client))
		events |= POLLOUT;
	if (face_watch(b->face, fd, events))
		b->fd = -1;
}

static void drop(struct broker *b)
{
	if (b->fd >= 0)
		face_ignore(b->face, b->fd);
	b->fd = -1;
	if (b->client)
		mosquitto_destroy(b->client);
	b->client = NULL;
	b->in_flight = 0;
	b->marking = false;
}

static int64_t pause_of(struct broker *b)
{
	enum backoff_why why = b->refused ? BACKOFF_REFUSED : BACKOFF_AWAY;
	bool thrown_out = b->thrown_out;

	b->refused = b->thrown_out = false;
	if (thrown_out)
		return backoff_spread(TAKEN_NS, backoff_random());
	return backoff_pause(&b->backoff, why, backoff_random());
}

/*
 * The next attempt: of the same way by IPv4 alone, which returns true; of the next way; or of the
 * first after a pause.
 */
static bool choose(struct broker *b, bool was_connected, int64_t now_ns)
{
	const struct mqtt_way *way = &b->options->ways[b->way];
	struct in_addr v4;

	b->next_ns = now_ns;
	b->state = BROKER_WAITING;
	if (!was_connected && !b->tcp && !b->v4 && !strchr(way->host, ':') &&
	    inet_pton(AF_INET, way->host, &v4) != 1) {
		b->v4 = true;
		return true;
	}
	b->v4 = false;
	b->way++;
	if (!was_connected && b->way < b->options->way_count)
		return false;
	b->way = 0;
	b->next_ns = now_ns + pause_of(b);
	return false;
}

/* For each way it is logged once, and once more when the reason is another. */
static void broker_fail(struct broker *b, const char *why, const char *remedy, int64_t now_ns)
{
	bool was_connected = b->state == BROKER_CONNECTED;
	char name[MQTT_WAY_NAME], words[BROKER_WORDS];
	unsigned way = b->way;
	uint64_t print;

	snprintf(words, sizeof(words), "%.80s %s: %.200s%s%.50s",
	         mqtt_way_name(&b->options->ways[b->way], name),
	         was_connected ? "is lost"
	         : b->client   ? "cannot be reached"
	                       : "is not tried",
	         why, *remedy ? "; " : "", remedy);
	drop(b);
	if (choose(b, was_connected, now_ns))
		return;
	b->failures++;
	b->vain &= ~(1u << way);
	print = hash_text(HASH_BEGIN, words, strlen(words));
	if (print != b->logged[way])
		log_warning(b->face->log, "%s", words);
	b->logged[way] = print;
	memcpy(b->trouble, words, sizeof(words));
	memcpy(b->last, words, sizeof(words));
	b->last_ns = now_ns;
}

/* What is proved, else what it looks like. */
static const char *taken_words(const struct broker *b, char words[BROKER_WORDS])
{
	snprintf(words, BROKER_WORDS,
	         b->taken.contested
	                 ? "another client took the id " CLIENT_ID
	                 : "the broker closes each connection; has another client the id " CLIENT_ID
	                   "?",
	         b->options->node);
	return words;
}

void broker_taken(struct broker *b)
{
	char name[MQTT_WAY_NAME], words[BROKER_WORDS];

	if (b->taken.contested)
		return;
	taken_proved(&b->taken);
	snprintf(b->last, sizeof(b->last), "%.80s was lost: %.200s; %.50s",
	         mqtt_way_name(&b->options->ways[b->way], name), taken_words(b, words),
	         advice_remedy(ADVICE_TAKEN_OVER, 0, ""));
	b->last_ns = ows_now();
	log_warning(b->face->log, "%s", b->last);
}

/* How long a connection has to last until it counts as a good one */
static int64_t good_ns(const struct broker *b)
{
	return taken_again(&b->taken) ? TAKEN_GOOD_NS : GOOD_NS;
}

bool broker_is_settled(const struct broker *b, int64_t now_ns)
{
	return b->state == BROKER_CONNECTED &&
	       now_ns - b->begun_ns > (taken_again(&b->taken) ? TAKEN_GOOD_NS : SETTLED_NS);
}

static void attempt(struct broker *b, int64_t now_ns)
{
	const struct mqtt_way *way = &b->options->ways[b->way];
	char why[SECRET_PATH + 128];
	int err;

	b->state = BROKER_CONNECTING;
	b->ended = b->tcp = b->held = false;
	b->large = 0;
	b->large_mid = 0;
	b->drained = true;
	b->tls_words[0] = '\0';
	b->begun_ns = b->came_ns = now_ns;
	if (!client_make(b, why, sizeof(why))) {
		drop(b);
		b->tcp = b->refused = true; /* no other address helps, and no haste */
		broker_fail(b, why, "", now_ns);
		return;
	}
	errno = 0;
	err = mosquitto_connect_bind_async(b->client, way->host, way->port, KEEPALIVE_S,
	                                   b->v4 ? "0.0.0.0" : NULL);
	if (err) {
		const char *words = advice_words(err, errno, b->tls_words);

		taken_end(&b->taken, TAKEN_OTHER, 0);
		broker_fail(b, words, advice_remedy(err, errno, b->tls_words), ows_now());
		return;
	}
	broker_watch(b);
}

static enum taken_end end_of(const struct broker *b, int code, int err)
{
	if (code == ADVICE_TAKEN_OVER)
		return TAKEN_TOLD;
	return b->state == BROKER_CONNECTED && code == MOSQ_ERR_CONN_LOST && !err ? TAKEN_CLOSED
	                                                                          : TAKEN_OTHER;
}

/* It is over, or libmosquitto reports that. */
static void finish(struct broker *b, int code, int err, int64_t now_ns)
{
	char said[BROKER_WORDS];
	const char *words, *remedy;
	bool soon, large;

	if (b->ended)
		code = b->end_code;
	if (code == ADVICE_PROTOCOL && b->options->mqtt5 && !b->old_protocol) {
		log_notice(b->face->log, "the broker has no MQTT 5: going on with 3.1.1");
		b->old_protocol = true;
		drop(b);
		b->state = BROKER_WAITING;
		b->next_ns = now_ns;
		return;
	}
	soon = b->state == BROKER_CONNECTED && now_ns - b->begun_ns <= good_ns(b);
	large = client_too_large(b, code, err);
	b->thrown_out = taken_end(&b->taken, large ? TAKEN_OTHER : end_of(b, code, err),
	                          now_ns - b->begun_ns);
	words = advice_words(code, err, b->tls_words);
	remedy = advice_remedy(b->thrown_out && b->taken.contested ? ADVICE_TAKEN_OVER : code, err,
	                       b->tls_words);
	if (!*remedy && b->state == BROKER_CONNECTING && b->tcp &&
	    (code == MOSQ_ERR_CONN_LOST || (code == MOSQ_ERR_ERRNO && err == ECONNRESET)))
		remedy = advice_hung_up(b->options->ways[b->way].tls);
	if (b->thrown_out)
		words = taken_words(b, said);
	if (large)
		words = advice_closed(b->large, b->large_topic, &remedy, said);
	/* a connection that ends soon was thrown out, or its line is bad: both want time */
	b->refused |= soon || (b->state != BROKER_CONNECTED && advice_refuses(code));
	broker_fail(b, words, remedy, now_ns);
}

/* The broker publishes the will, and the birth follows it. */
static void begin_anew(struct broker *b, int64_t now_ns)
{
	log_warning(b->face->log,
	            "commands have waited for longer than 2 seconds: connecting again, so that the "
	            "broker drops those that it holds");
	drop(b);
	b->state = BROKER_WAITING;
	b->next_ns = now_ns;
}

void broker_forget(struct broker *b)
{
	b->held = true;
}

static void connected(struct broker *b, int64_t now_ns)
{
	bool mqtt5 = client_mqtt5(b);
	char name[MQTT_WAY_NAME];

	b->begun_ns = now_ns;
	b->connects++;
	b->refused = false;
	backoff_met(&b->backoff);
	b->again = b->known & 1u << b->way;
	b->known |= 1u << b->way;
	b->refusal[0] = '\0';
	client_forget_topics(b);
	if (b->vain & 1u << b->way) {
		b->trouble[0] = '\0';
		b->ops->connected(b->ctx);
		return;
	}
	forget_trouble(b);
	log_notice(b->face->log, "connected to %.100s by MQTT %s",
	           mqtt_way_name(&b->options->ways[b->way], name), mqtt5 ? "5" : "3.1.1");
	if (!mqtt5 && b->options->write)
		log_warning(
			b->face->log,
			"MQTT 3.1.1 does not show that a command which comes is retained: it is "
			"carried out; publish commands without retain");
	b->ops->connected(b->ctx);
}

/* --- Its work -------------------------------------------------------------------------------- */

static int read_all(struct broker *b)
{
	int64_t came_ns = face_came(b->face, b->fd);
	int code = 0;

	if (came_ns > b->came_ns && b->drained)
		b->came_ns = came_ns;
	b->drained = false;
	for (int i = 0; !code && !b->ended && !b->drained && i < READS; i++) {
		int64_t now_ns = ows_now();

		/* a TLS library may hold more than the socket shows */
		errno = 0;
		code = mosquitto_loop_read(b->client, 1);
		b->drained = errno == EAGAIN;
		if (b->drained)
			b->came_ns = now_ns;
	}
	return code;
}

/*
 * One turn of a connection: libmosquitto writes, reads and tends; the first error ends the turn.
 * What comes of it is the first of: what the broker holds is too old (connect anew); an error, or
 * an end that libmosquitto reports (it is over, even if its CONNACK came in this turn); no CONNACK
 * in time (likewise); else it waits for the socket.
 */
static void work(struct broker *b, short ready, int64_t now_ns)
{
	bool was_connected = b->state == BROKER_CONNECTED;
	int code = 0, err = 0;
	socklen_t size = sizeof(err);

	if (!b->tcp && (ready & (POLLERR | POLLHUP))) {
		getsockopt(b->fd, SOL_SOCKET, SO_ERROR, &err, &size);
		b->tcp = !err; /* it took the connection, and has closed it since */
		finish(b, MOSQ_ERR_ERRNO, err ? err : ECONNRESET, now_ns);
		return;
	}
	client_explain(b);
	if (ready & POLLOUT) {
		b->sent += !b->tcp;
		b->tcp = true;
	}
	if (mosquitto_want_write(b->client) || (ready & POLLOUT))
		code = mosquitto_loop_write(b->client, 1);
	client_explain(b); /* TLS may have begun in that */
	if (!code && b->tcp)
		code = read_all(b);
	if (!code)
		code = mosquitto_loop_misc(b->client);
	err = errno;
	if (!code && !b->ended && !was_connected && b->state == BROKER_CONNECTED)
		connected(b, now_ns);
	if (b->state == BROKER_CONNECTED && now_ns - b->begun_ns > good_ns(b))
		backoff_forget(&b->backoff);
	if (b->held)
		begin_anew(b, now_ns);
	else if (code || b->ended)
		finish(b, code, err, now_ns);
	else if (b->state == BROKER_CONNECTING && now_ns - b->begun_ns > ANSWER_NS)
		finish(b, MOSQ_ERR_ERRNO, ETIMEDOUT, now_ns);
	else
		broker_watch(b);
	if (b->state == BROKER_CONNECTED && !b->drained)
		b->tend_ns = now_ns;
}

bool broker_ready(struct broker *b, int fd, short ready, int64_t now_ns)
{
	if (fd != b->fd || fd < 0)
		return false;
	work(b, ready, now_ns);
	return true;
}

void broker_tick(struct broker *b, int64_t now_ns)
{
	/* news that come all the time must not put it off */
	b->tend_ns = now_ns + (b->state == BROKER_CONNECTED ? TEND_NS : NS_PER_S);
	if (b->state == BROKER_CONNECTED)
		client_subscribe_again(b, now_ns);
	if (b->state == BROKER_WAITING && now_ns >= b->next_ns)
		attempt(b, now_ns);
	else if (b->client)
		work(b, 0, now_ns);
}

int64_t broker_next(const struct broker *b)
{
	switch (b->state) {
	case BROKER_OFF:
		return INT64_MAX;
	case BROKER_WAITING:
		return b->next_ns;
	case BROKER_CONNECTING:
	case BROKER_CONNECTED:
		return b->tend_ns;
	}
	return INT64_MAX;
}

void broker_begin(struct broker *b, int64_t now_ns)
{
	b->client = NULL;
	b->fd = -1;
	b->way = b->known = b->vain = 0;
	b->v4 = b->old_protocol = false;
	b->refused = b->thrown_out = false;
	backoff_forget(&b->backoff);
	b->next_ns = now_ns;
	b->state = BROKER_WAITING;
	forget_trouble(b);
	if (!*b->session)
		snprintf(b->session, sizeof(b->session), "%016llx",
		         (unsigned long long)backoff_random());
}

void broker_hurry(struct broker *b, int64_t now_ns)
{
	if (b->state != BROKER_WAITING)
		return;
	b->next_ns = now_ns;
	backoff_forget(&b->backoff);
	forget_trouble(b);
}

/* Has the broker acknowledged all? */
static bool drain(struct broker *b, int64_t until_ns)
{
	while (b->in_flight && !b->ended && ows_now() < until_ns)
		if (mosquitto_loop(b->client, 50, 1))
			break;
	return !b->in_flight && !b->ended;
}

static bool publish(struct broker *b, const char *topic, const char *text, size_t len, int qos,
                    bool retain)
{
	int err, mid;

	if (b->state != BROKER_CONNECTED || b->ended || b->in_flight >= BROKER_IN_FLIGHT)
		return false;
	b->in_flight++; /* of QoS 0 it may have gone when that returns */
	err = mosquitto_publish_v5(b->client, &mid, topic, (int)len, text, qos, retain, NULL);
	if (!err) {
		b->published++;
		client_put(b, mid, topic, qos ? len : 0);
		return true;
	}
	b->in_flight--;
	if (err == MOSQ_ERR_NO_CONN || err == MOSQ_ERR_CONN_LOST || err == MOSQ_ERR_NOMEM)
		return false;
	/* it would never be taken, and must not stand in the way of the others */
	client_refuse(b, topic, err);
	return true;
}

bool broker_put(void *ctx, const char *topic, const char *text, size_t len, bool retain)
{
	struct broker *b = ctx;

	return publish(b, topic, text, len, b->options->profile->qos, retain);
}

static bool put_last(void *ctx, const char *topic, const char *text, size_t len, bool retain)
{
	return publish(ctx, topic, text, len, client_sure_qos(ctx), retain);
}

void broker_end(struct broker *b)
{
	int64_t until_ns = ows_now() + END_NS;

	if (b->state == BROKER_CONNECTED && drain(b, until_ns)) {
		/* the goodbye takes the will back: nobody hears of the end twice */
		if (b->ops->will(b->ctx, true, &(struct outlet){.put = put_last, .ctx = b}) &&
		    drain(b, until_ns))
			mosquitto_disconnect(b->client);
		/* it ends the connection when the goodbye is out */
		while (!b->in_flight && !b->ended && ows_now() < until_ns)
			if (mosquitto_loop(b->client, 50, 1))
				break;
	}
	drop(b);
	b->state = BROKER_OFF;
}

void broker_leave(struct broker *b, bool vain, int64_t now_ns)
{
	b->vain = vain ? b->vain | 1u << b->way : 0;
	broker_end(b);
	choose(b, false, now_ns);
}

/* The end of a subscription that there is not: the cheapest that a broker has to answer. */
bool broker_mark(struct broker *b)
{
	char topic[160];

	if (b->state != BROKER_CONNECTED || b->ended || b->marking)
		return false;
	snprintf(topic, sizeof(topic), CLIENT_ID "/mark", b->options->node);
	b->marked = false;
	b->marking = !mosquitto_unsubscribe(b->client, &b->mark, topic);
	return b->marking;
}
