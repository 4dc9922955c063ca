/* SPDX-License-Identifier: MIT */
/* Makes a client of libmosquitto, with its secrets, its will and what its callbacks note. */
#include <errno.h>
#include <mosquitto.h>
#include <mqtt_protocol.h>
#ifdef OWSD_OPENSSL
#include <openssl/ssl.h>
#endif
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/faces/kit/face.h"
#include "src/faces/kit/secret.h"
#include "src/faces/mqtt/advice.h"
#include "src/faces/mqtt/client.h"
#include "src/faces/mqtt/stream.h"
#include "src/ground/signal/utf8.h"

#define SESSION "session"
/* A birth of an earlier run has to come back whole, to be emptied; libmosquitto takes any length */
#define MESSAGE_MOST (1024 * 1024)
#define NO_KEEPALIVE 1 /* less than libmosquitto takes */
#define CA_PATH "/etc/ssl/certs"

bool client_mqtt5(const struct broker *b)
{
	return b->options->mqtt5 && !b->old_protocol;
}

int client_sure_qos(const struct broker *b)
{
	return b->options->profile->qos ? b->options->profile->qos : 1;
}

/* --- Callbacks ------------------------------------------------------------------------------- */

static void on_connect(struct mosquitto *client, void *ctx, int code, int flags,
                       const mosquitto_property *properties)
{
	struct broker *b = ctx;

	(void)client;
	(void)flags;
	(void)properties;
	if (code) {
		b->ended = true;
		b->end_code = advice_connack(code, !client_mqtt5(b));
		return;
	}
	b->state = BROKER_CONNECTED;
}

static void on_disconnect(struct mosquitto *client, void *ctx, int code,
                          const mosquitto_property *properties)
{
	struct broker *b = ctx;

	(void)client;
	(void)properties;
	if (!b->ended)
		b->end_code = code;
	b->ended = true;
}

void client_put(struct broker *b, int mid, const char *topic, size_t len)
{
	if (len <= b->large)
		return;
	b->large = len;
	b->large_mid = mid;
	snprintf(b->large_topic, sizeof(b->large_topic), "%s", topic);
}

bool client_too_large(const struct broker *b, int code, int err)
{
	return b->state == BROKER_CONNECTED && !client_mqtt5(b) && b->large_mid &&
	       b->large > b->large_taken &&
	       (code == MOSQ_ERR_CONN_LOST || (code == MOSQ_ERR_ERRNO && err == ECONNRESET));
}

static void on_publish(struct mosquitto *client, void *ctx, int mid, int reason,
                       const mosquitto_property *properties)
{
	struct broker *b = ctx;
	char name[MQTT_WAY_NAME];
	bool denied;

	(void)client;
	(void)properties;
	b->in_flight -= b->in_flight > 0;
	if (mid == b->large_mid) {
		b->large_mid = 0;
		if (b->large > b->large_taken)
			b->large_taken = b->large;
	}
	if (reason < 128) {
		b->acknowledged++;
		return;
	}
	b->refusals++;
	if (*b->refusal)
		return;
	/* what has no remedy of its own may be forbidden, too */
	denied = reason == 0x87 || !*advice_remedy(reason, 0, "");
	snprintf(b->refusal, sizeof(b->refusal), "%.100s refuses what is published: %s; %s%.60s%s",
	         mqtt_way_name(&b->options->ways[b->way], name), mosquitto_reason_string(reason),
	         denied ? "its access list has to let us write " : advice_remedy(reason, 0, ""),
	         denied ? b->options->prefix : "", denied ? "/# and the topics of discovery" : "");
	log_err(b->face->log, "%s", b->refusal);
}

void client_refuse(struct broker *b, const char *topic, int err)
{
	b->refusals++;
	if (*b->refusal)
		return;
	snprintf(b->refusal, sizeof(b->refusal), "%.150s cannot be published: %s", topic,
	         err == MOSQ_ERR_OVERSIZE_PACKET ? ADVICE_LARGE : mosquitto_strerror(err));
	log_err(b->face->log, "%s", b->refusal);
}

static struct broker_topic *topic_of(struct broker *b, int mid)
{
	for (unsigned i = 0; i < b->topic_count; i++)
		if (b->topics[i].mid == mid)
			return &b->topics[i];
	return NULL;
}

static void on_subscribe(struct mosquitto *client, void *ctx, int mid, int count,
                         const int *granted, const mosquitto_property *properties)
{
	struct broker *b = ctx;
	struct broker_topic *topic = topic_of(b, mid);
	char name[MQTT_WAY_NAME];

	(void)client;
	(void)properties;
	/* of several the first is our own, if there is one; the other profiles' may be refused */
	if (!count || granted[0] < 128 || (count > 1 && !b->options->profile->below))
		return;
	b->refusals++;
	if (topic) {
		topic->refused = true;
		if (b->ask_ns)
			return;
		b->ask_ns = ows_now() +
		            backoff_pause(&b->asking, BACKOFF_REFUSED, backoff_random());
		if (b->asking.failed[BACKOFF_REFUSED] > 1)
			return;
	}
	log_err(b->face->log,
	        "%.100s refuses a subscription; its access list has to let us read %.60s/# and "
	        "the topics of discovery",
	        mqtt_way_name(&b->options->ways[b->way], name), b->options->prefix);
}

static void on_unsubscribe(struct mosquitto *client, void *ctx, int mid,
                           const mosquitto_property *properties)
{
	struct broker *b = ctx;

	(void)client;
	(void)properties;
	if (!b->marking || mid != b->mark)
		return;
	b->marking = false;
	b->marked = true;
}

/* A user property of MQTT 5, if it can stand in a journal: a claim. */
static void take_property(const mosquitto_property *properties, const char *key, char *text,
                          size_t size)
{
	const mosquitto_property *at;
	char *name, *value;

	at = mosquitto_property_read_string_pair(properties, MQTT_PROP_USER_PROPERTY, &name, &value,
	                                         false);
	while (at) {
		const char *rest = value;
		size_t len = strlen(value);
		bool fits = !strcmp(name, key) && len && len < size;

		while (fits && len) {
			int32_t c = utf8_next(&rest, &len);

			fits = c > ' ' && !utf8_disturbs(c);
		}
		if (fits)
			snprintf(text, size, "%s", value);
		free(name);
		free(value);
		at = mosquitto_property_read_string_pair(at, MQTT_PROP_USER_PROPERTY, &name, &value,
		                                         true);
	}
}

static void on_message(struct mosquitto *client, void *ctx, const struct mosquitto_message *got,
                       const mosquitto_property *properties)
{
	struct broker *b = ctx;
	struct broker_message message = {
		.topic = got->topic,
		/* libmosquitto puts a NUL behind it */
		.text = got->payload ? got->payload : "",
		.len = got->payloadlen > 0 ? (size_t)got->payloadlen : 0,
		.came_ns = b->came_ns,
		.retained = got->retain,
	};

	char *reply = NULL;
	void *correlation = NULL;

	(void)client;
	take_property(properties, "person", message.person, BROKER_PERSON);
	take_property(properties, SESSION, message.session, BROKER_SESSION);
	mosquitto_property_read_string(properties, MQTT_PROP_RESPONSE_TOPIC, &reply, false);
	mosquitto_property_read_binary(properties, MQTT_PROP_CORRELATION_DATA, &correlation,
	                               &message.correlation_len, false);
	message.reply = reply;
	message.correlation = correlation;
	b->ops->message(b->ctx, &message);
	free(reply);
	free(correlation);
}

void client_answer(struct broker *b, const char *topic, const char *text, size_t len,
                   const struct broker_message *message)
{
	mosquitto_property *properties = NULL;

	/* who asks all the time leaves room for values */
	if (b->state != BROKER_CONNECTED || b->ended || b->in_flight >= BROKER_IN_FLIGHT / 2)
		return;
	if (client_mqtt5(b) && message->correlation &&
	    mosquitto_property_add_binary(&properties, MQTT_PROP_CORRELATION_DATA,
	                                  message->correlation, message->correlation_len))
		return;
	b->in_flight++;
	/* a topic that others name may be refused, which is no trouble of ours: so QoS 0 */
	if (mosquitto_publish_v5(b->client, NULL, topic, (int)len, text,
	                         message->topic ? 0 : client_sure_qos(b), false, properties))
		b->in_flight--;
	else
		b->published++;
	mosquitto_property_free_all(&properties);
}

static void on_log(struct mosquitto *client, void *ctx, int level, const char *text)
{
	struct broker *b = ctx;

	(void)client;
	if (level == MOSQ_LOG_ERR && !*b->tls_words)
		snprintf(b->tls_words, sizeof(b->tls_words), "%s", advice_tls(text));
	log_at(b->face->log, LOG_LEVEL_TRACE, "libmosquitto: %s", text);
}

/* --- A new client ---------------------------------------------------------------------------- */

static bool key_fails(const char *key, const char *reason, char *why, size_t size)
{
	snprintf(why, size, "%s: %s", key, reason);
	return false;
}

static bool set_password(struct broker *b, char *why, size_t size)
{
	char password[SECRET_SIZE], reason[SECRET_PATH + 128];
	int err;

	if (!*b->options->user)
		return true;
	if (secret_read(*b->options->password_file ? b->options->password_file : NULL, password,
	                reason, sizeof(reason)))
		return key_fails("PasswordFile", reason, why, size);
	err = mosquitto_username_pw_set(b->client, b->options->user, *password ? password : NULL);
	explicit_bzero(password, sizeof(password));
	snprintf(why, size, "%s", mosquitto_strerror(err));
	return !err;
}

#ifdef OWSD_OPENSSL
/* OpenSSL's own check, whose reason libmosquitto does not log. The host's name is checked in it. */
static int judge(X509_STORE_CTX *store, void *ctx)
{
	struct broker *b = ctx;
	int good = X509_verify_cert(store);

	if (good <= 0 && !*b->tls_words)
		snprintf(b->tls_words, sizeof(b->tls_words), "%s",
		         X509_verify_cert_error_string(X509_STORE_CTX_get_error(store)));
	return good;
}

#endif

void client_explain(struct broker *b)
{
#ifdef OWSD_OPENSSL
	SSL *tls = mosquitto_ssl_get(b->client);

	if (tls)
		SSL_CTX_set_cert_verify_callback(SSL_get_SSL_CTX(tls), judge, b);
#else
	(void)b;
#endif
}

static bool set_tls(struct broker *b, char *why, size_t size)
{
	const struct mqtt_options *o = b->options;
	char ca[SECRET_PATH], cert[SECRET_PATH], key[SECRET_PATH], reason[SECRET_PATH + 128];
	int err;

	if (!o->ways[b->way].tls)
		return true;
	if (*o->ca_file && secret_file(o->ca_file, false, ca, reason, sizeof(reason)))
		return key_fails("CaFile", reason, why, size);
	if (*o->cert_file && secret_file(o->cert_file, false, cert, reason, sizeof(reason)))
		return key_fails("CertFile", reason, why, size);
	if (*o->key_file && secret_file(o->key_file, true, key, reason, sizeof(reason)))
		return key_fails("KeyFile", reason, why, size);
	err = mosquitto_tls_set(b->client, *o->ca_file ? ca : NULL, *o->ca_file ? NULL : CA_PATH,
	                        *o->cert_file ? cert : NULL, *o->key_file ? key : NULL, NULL);
	snprintf(why, size, "TLS: %s", mosquitto_strerror(err));
	return !err;
}

/* struct outlet. MQTT 5: it says of which process it is. */
static bool set_will(void *ctx, const char *topic, const char *text, size_t len, bool retain)
{
	struct broker *b = ctx;
	mosquitto_property *session = NULL;

	if (client_mqtt5(b) && mosquitto_property_add_string_pair(&session, MQTT_PROP_USER_PROPERTY,
	                                                          SESSION, b->session))
		return false;
	if (!mosquitto_will_set_v5(b->client, topic, (int)len, text, client_sure_qos(b), retain,
	                           session))
		return true;
	mosquitto_property_free_all(&session);
	return false;
}

/*
 * Have the broker keep what is longer from us. No function sets a property of CONNECT alone; the
 * one that connects and waits keeps it for all that come after, though it refuses this keep-alive.
 * False: no memory.
 */
static bool bound_messages(struct broker *b)
{
	mosquitto_property *most = NULL;

	if (!client_mqtt5(b))
		return true;
	if (mosquitto_property_add_int32(&most, MQTT_PROP_MAXIMUM_PACKET_SIZE, MESSAGE_MOST))
		return false;
	mosquitto_connect_bind_v5(b->client, "", 0, NO_KEEPALIVE, NULL, most);
	mosquitto_property_free_all(&most);
	return true;
}

bool client_make(struct broker *b, char *why, size_t size)
{
	char id[160];

	snprintf(id, sizeof(id), CLIENT_ID, b->options->node);
	b->client = mosquitto_new(id, true, b);
	if (!b->client) {
		snprintf(why, size, "no memory");
		return false;
	}
	mosquitto_connect_v5_callback_set(b->client, on_connect);
	mosquitto_disconnect_v5_callback_set(b->client, on_disconnect);
	mosquitto_publish_v5_callback_set(b->client, on_publish);
	mosquitto_subscribe_v5_callback_set(b->client, on_subscribe);
	mosquitto_unsubscribe_v5_callback_set(b->client, on_unsubscribe);
	mosquitto_message_v5_callback_set(b->client, on_message);
	mosquitto_log_callback_set(b->client, on_log);
	mosquitto_int_option(b->client, MOSQ_OPT_PROTOCOL_VERSION,
	                     client_mqtt5(b) ? MQTT_PROTOCOL_V5 : MQTT_PROTOCOL_V311);
	mosquitto_int_option(b->client, MOSQ_OPT_TCP_NODELAY, 1);
	if (!bound_messages(b) ||
	    !b->ops->will(b->ctx, false, &(struct outlet){.put = set_will, .ctx = b})) {
		snprintf(why, size, "no memory");
		return false;
	}
	return set_password(b, why, size) && set_tls(b, why, size);
}

/* --- Subscriptions --------------------------------------------------------------------------- */

static int subscribe_options(const struct broker *b)
{
	return client_mqtt5(b) ? MQTT_SUB_OPT_RETAIN_AS_PUBLISHED | MQTT_SUB_OPT_NO_LOCAL : 0;
}

static void ask(struct broker *b, struct broker_topic *topic)
{
	topic->refused = false;
	mosquitto_subscribe_v5(b->client, &topic->mid, topic->name, client_sure_qos(b),
	                       subscribe_options(b), NULL);
}

void client_subscribe(struct broker *b, const char *name)
{
	struct broker_topic *topic = &b->topics[b->topic_count];

	if (!b->client || b->topic_count == BROKER_TOPICS)
		return;
	b->topic_count++;
	snprintf(topic->name, sizeof(topic->name), "%s", name);
	ask(b, topic);
}

void client_subscribe_again(struct broker *b, int64_t now_ns)
{
	if (!b->client || !b->ask_ns || now_ns < b->ask_ns)
		return;
	b->ask_ns = 0;
	for (unsigned i = 0; i < b->topic_count; i++)
		if (b->topics[i].refused)
			ask(b, &b->topics[i]);
}

void client_forget_topics(struct broker *b)
{
	b->topic_count = 0;
	b->ask_ns = 0;
	backoff_forget(&b->asking);
}

void client_look(struct broker *b, char *const *topics, int count, bool begin)
{
	if (b->client && begin)
		mosquitto_subscribe_multiple(b->client, NULL, count, topics, 0,
		                             subscribe_options(b), NULL);
	else if (b->client)
		mosquitto_unsubscribe_multiple(b->client, NULL, count, topics, NULL);
}
