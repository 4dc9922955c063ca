/* SPDX-License-Identifier: MIT */
/* What a broker asks for and sends: the will, the begin of a connection, messages. */
#include "src/faces/mqtt/arrivals.h"

#include <errno.h>
#include <string.h>

#include "src/faces/kit/look.h"
#include "src/faces/mqtt/devices.h"
#include "src/faces/mqtt/mqtt.h"
#include "src/faces/mqtt/plain.h"
#include "src/faces/mqtt/profiles.h"

static bool will(void *ctx, bool ending, const struct outlet *to)
{
	struct mqtt *m = ctx;
	struct stream *s = &m->stream;
	struct outlet outlet = s->outlet;
	bool put;

	if (m->broker.state != BROKER_CONNECTED)
		s->bdseq = (uint8_t)(m->bdseq + (int)m->broker.sent); /* before this one */
	s->outlet = *to;
	put = s->profile->state(s, ending ? STREAM_ENDED : STREAM_KILLED);
	s->outlet = outlet;
	return put;
}

static void on_connected(void *ctx)
{
	struct mqtt *m = ctx;
	char topic[TOPIC_SIZE];

	past_lost(&m->past);
	if (m->past.on)
		missed_keep_number(&m->past.missed, m->stream.bdseq);
	m->stream.host_there = m->stream.born = false;
	m->stream.host_ms = 0; /* the clock of the host may have been set back */
	if (m->stream.host && m->broker.connects < 2)
		log_notice(m->broker.face->log,
		           "nothing is published until the primary host %s is online",
		           m->stream.host);
	for (int i = 0; i < BROKER_TOPICS; i++) {
		profiles_listen(&m->stream, m->options.rename, i, topic);
		if (!*topic)
			break;
		client_subscribe(&m->broker, topic);
	}
	m->health_ns = m->sweep_ns = 0;
	m->sweep = true;
	stream_begin(&m->stream);
}

/* What somebody takes for a command or a question is no topic for answers. */
static bool asks(const char *topic)
{
	const char *last = strrchr(topic, '/');

	return last && (!strcmp(last, "/set") || !strcmp(last, "/on") || !strcmp(last, "/get") ||
	                !strcmp(last, "/" TOPIC_READ) || !strcmp(last, "/" TOPIC_RENAME));
}

/*
 * The message that was begun is the answer: to all at the topic RESULT, and to whom the question
 * names. That one must not be a topic of the nodes, or of discovery: not every sender may publish
 * there, as we may.
 */
static void answer(struct mqtt *m, struct json *json, const struct broker_message *message)
{
	struct stream *s = &m->stream;
	const char *reply = message->reply;
	char topic[TOPIC_SIZE];

	json_object_end(json);
	if (fflush(s->out))
		return;
	snprintf(topic, sizeof(topic), "%.*s/" TOPIC_RESULT,
	         (int)(strrchr(message->topic, '/') - message->topic), message->topic);
	client_answer(&m->broker, topic, s->text, s->len, &(struct broker_message){0});
	if (reply && *reply != '$' && !asks(reply) && !stream_below(reply, s->topic) &&
	    !stream_below(reply, s->discovery))
		client_answer(&m->broker, reply, s->text, s->len, message);
}

static void mqtt_command(struct mqtt *m, const char *name, bool known, enum commands_form form,
                         const struct broker_message *message)
{
	struct broker_message one = *message;
	char place[OPTION_SIZE + 8];

	if (!m->options.write)
		one.fault = "Write is off in the block Mqtt: set it to on there, and reload owsd";
	snprintf(place, sizeof(place), "mqtt:%s", m->options.ways[m->broker.way].host);
	if (commands_take(&m->commands, name, known, form, &one, place, ows_now()) == -ETIME)
		broker_forget(&m->broker);
}

static void on_command(struct mqtt *m, const char *name, const struct row *row,
                       enum commands_form form, const struct broker_message *message)
{
	const struct commands *c = &m->commands;
	struct json json;

	mqtt_command(m, name, row, form, message);
	/* what is read then is published though only its time may be new */
	if (form == COMMANDS_READ && row && !*c->why)
		m->stream.rows[row - m->stream.rows].print = 0;
	if (!m->stream.profile->asks)
		return;
	stream_message(&m->stream, &json);
	json_object(&json, NULL);
	ask_answer_json(&json, &c->ask, *c->why ? c->why : NULL);
	answer(m, &json, message);
}

/* --- What others answer ---------------------------------------------------------------------- */

static void answer_devices(struct mqtt *m, const struct ask *ask, char *listing, const char *why,
                           const struct broker_message *message)
{
	struct json json;

	stream_message(&m->stream, &json);
	json_object(&json, NULL);
	if (look_is_current(m->broker.face))
		devices_json(&json, &m->stream, listing);
	else
		why = "owsd is away, or reloads: try again";
	json_bool(&json, "searched", listing);
	if (why)
		json_string(&json, "why", why);
	ask_id_json(&json, ask);
	answer(m, &json, message);
}

/* A question that has no more than this for an answer. */
static void answer_why(struct mqtt *m, const struct ask *ask, const char *why,
                       const struct broker_message *message)
{
	struct json json;

	stream_message(&m->stream, &json);
	json_object(&json, NULL);
	json_string(&json, "why", why);
	ask_id_json(&json, ask);
	answer(m, &json, message);
}

static void answer_rename(struct mqtt *m, const struct ask *ask, const char *name, const char *why,
                          const struct broker_message *message)
{
	struct json json;

	if (why)
		commands_refuse(&m->commands, name, why, ows_now());
	else
		log_notice(m->broker.face->log, "\"%s\" is called \"%.63s\" now", name, ask->value);
	stream_message(&m->stream, &json);
	json_object(&json, NULL);
	ask_answer_json(&json, ask, why);
	answer(m, &json, message);
}

/* What owsd-writer says against it; NULL: nothing. */
static const char *fault_of_writer(char *text)
{
	bool done = text && !strncmp(text, "status: done\n", strlen("status: done\n"));
	bool served = text && !strstr(text, "\nreload: refused\n");
	char *why = text ? strstr(text, "\nproblem: E ") : NULL;
	int skip = 0;

	if (done && served)
		return NULL;
	/* of a text with errors the first one says more: "E 3 9 words" */
	if (why && sscanf(why, "\nproblem: E %*d %*d %n", &skip) == 0 && skip) {
		why += skip;
	} else {
		why = text ? strstr(text, "\nwhy: ") : NULL;
		if (!why)
			return "owsd-writer gave no answer: nobody knows whether the name was "
			       "changed";
		why += strlen("\nwhy: ");
	}
	why[strcspn(why, "\n")] = '\0';
	return why;
}

static void on_answered(void *ctx)
{
	struct mqtt *m = ctx;
	struct errand *e = &m->errand;
	char *listing;

	if (e->kind == ERRAND_RENAME) {
		answer_rename(m, &e->ask, e->name, fault_of_writer(e->got), &e->message);
	} else {
		listing = e->got ? devices_listing(e->got, e->len) : NULL;
		answer_devices(m, &e->ask, listing,
		               listing ? NULL : "owsd gave no list of what is on its wires",
		               &e->message);
	}
	errand_end(e, m->broker.face);
}

#define FAULT_TEXT 120

/* Why it could not begin. */
static const char *errand_fault(const struct mqtt *m, int err, enum errand_kind kind,
                                char text[FAULT_TEXT])
{
	if (err == -EBUSY)
		return "another one is under way: try again";
	if (err == -EACCES || err == -EPERM)
		return "the user owsd-mqtt has to be in the group owsd-config";
	if (kind == ERRAND_DEVICES)
		return "owsd gave no list of what is on its wires";
	snprintf(text, FAULT_TEXT, "owsd-writer is not there: sudo owsctl -n %s enable mqtt",
	         m->commands.instance);
	return text;
}

/* Each list costs owsd a directory of all devices, each rename a file and a reload. */
static const struct credit_rate lists_rate = {NS_PER_S, 10};
static const struct credit_rate renames_rate = {10 * NS_PER_S, 50};

/* Which devices there are: those of the table at least, if owsd gives no list of all. */
static void on_devices(struct mqtt *m, const struct broker_message *message)
{
	unsigned char request[DEVICES_REQUEST];
	int len = devices_request(request), err;
	char text[FAULT_TEXT];
	struct ask ask;

	ask_read(&ask, message->text, message->len, false);
	if (!credit_spend(&m->lists, &lists_rate, ows_now())) {
		answer_why(m, &ask, "more than one list in a second: try again", message);
		return;
	}
	err = errand_begin(&m->errand, ERRAND_DEVICES, m->broker.face, "sock", request, (size_t)len,
	                   TOPIC_CHIP, message);
	if (err)
		answer_devices(m, &ask, NULL, errand_fault(m, err, ERRAND_DEVICES, text), message);
}

/* Another name for a signal: the identity stays, and what hangs on it. */
static void on_rename(struct mqtt *m, const char *name, const struct row *row,
                      const struct broker_message *message)
{
	const char *host = m->options.ways[m->broker.way].host;
	struct ask ask;
	const char *wrong = ask_read(&ask, message->text, message->len, false);
	const char *why = commands_fault(message);
	char order[ASK_MOST + 512], text[FAULT_TEXT];
	int len, err;

	why = why ? why : wrong;
	/* a broker can send what nobody has subscribed to */
	if (!m->options.rename)
		why = "Rename is off in the block Mqtt: set it to on there, and reload owsd";
	if (!why && (!row || !look_is_current(m->broker.face)))
		why = row ? "owsd is away, or reloads: try again" : "there is no such signal";
	len = snprintf(order, sizeof(order),
	               "owsd-writer 1\ndo: rename\nfor: %s%.*s\nlength: %zu\n\n%s\n%s",
	               *message->person ? "" : "mqtt:", BROKER_PERSON,
	               *message->person ? message->person : host,
	               strlen(name) + 1 + strlen(ask.value), name, ask.value);
	if (!why && !credit_spend(&m->renames, &renames_rate, ows_now()))
		why = "more than one rename in 10 seconds: try again";
	if (!why) {
		err = errand_begin(&m->errand, ERRAND_RENAME, m->broker.face, "config", order,
		                   (size_t)len, name, message);
		why = err ? errand_fault(m, err, ERRAND_RENAME, text) : NULL;
	}
	if (why)
		answer_rename(m, &ask, name, why, message);
}

/* Somebody asks for a value: the newest one that owsd has. */
static void on_question(struct mqtt *m, const char *name, const struct row *row,
                        const struct broker_message *message)
{
	struct stream *s = &m->stream;
	struct json json;
	struct ask ask;

	if (message->retained)
		return;
	if (!row && !strcmp(name, TOPIC_CHIP)) {
		on_devices(m, message);
		return;
	}
	ask_read(&ask, message->text, message->len, false);
	if (!row || !look_is_current(m->broker.face)) {
		answer_why(m, &ask,
		           row ? "owsd is away, or reloads: try again" : "there is no such signal",
		           message);
		return;
	}
	stream_message(s, &json);
	json_object(&json, NULL);
	plain_value_json(&json, s, &s->rows[row - s->rows]);
	ask_id_json(&json, &ask);
	answer(m, &json, message);
}

/* A message that has commands, and who takes them. */
struct several {
	struct mqtt *m;
	const struct broker_message *message;
};

static void mqtt_take(void *ctx, const char *name, const char *text, const char *fault)
{
	const struct several *several = ctx;
	struct broker_message one = *several->message;

	one.text = text;
	one.len = strlen(text);
	one.fault = fault;
	mqtt_command(several->m, name, true, COMMANDS_TEXT, &one);
}

static void on_commands(struct mqtt *m, const struct broker_message *message)
{
	struct several several = {.m = m, .message = message};

	if (!look_is_current(m->broker.face))
		mqtt_take(&several, m->options.node, "", "owsd is away, or reloads: try again");
	else if (m->stream.profile->take(&m->stream, message->topic, message->text, message->len,
	                                 mqtt_take, &several))
		m->asked = m->asked || !message->retained;
}

/* struct outlet: true if it is the topic of ctx. */
static bool is_topic(void *ctx, const char *topic, const char *text, size_t len, bool retain)
{
	(void)text;
	(void)len;
	(void)retain;
	return !strcmp(topic, ctx);
}

/*
 * What a message is, by its topic. Two cases end it:
 *   below the prefix, of a profile that reads them itself: commands of a session
 *   the topic of a row, with the last level of commands: a command of that row, or a question
 * Any other may be several of these:
 *   the will of this node, kept: of another process, which had our id meanwhile
 *   kept, while the broker is asked what it keeps: something of ours that may be no more
 *   what the profile listens to besides: a word that asks for the birth, or of the host
 */
static void on_message(void *ctx, const struct broker_message *message)
{
	struct mqtt *m = ctx;
	const struct profile *profile = m->stream.profile;
	char name[TOPIC_SIZE];
	const struct row *row;
	enum stream_ask ask;

	if (profile->take && stream_below(message->topic, m->stream.prefix)) {
		on_commands(m, message);
		return;
	}
	ask = stream_command(&m->stream, message->topic, &row, name);
	if (ask == STREAM_SET)
		on_command(m, name, row,
		           row && row->info.type == OWS_STRING ? COMMANDS_TEXT : COMMANDS_VALUE,
		           message);
	if (ask == STREAM_READ)
		on_command(m, name, row, COMMANDS_READ, message);
	if (ask == STREAM_GET)
		on_question(m, name, row, message);
	if (ask == STREAM_RENAME)
		on_rename(m, name, row, message);
	if (ask)
		return;
	snprintf(name, sizeof(name), "%s", message->topic);
	/* that of the first connection may be of a run of yesterday */
	if (message->retained && *message->session && m->broker.again &&
	    strcmp(message->session, m->broker.session) != 0 &&
	    will(m, false, &(struct outlet){.put = is_topic, .ctx = name}))
		broker_taken(&m->broker);
	if (message->retained && m->sweep_ns && look_is_current(m->broker.face))
		profiles_kept(&m->stream, message->topic, message->len ? message->text : NULL);
	if (profile->heard &&
	    profile->heard(&m->stream, message->topic, message->text, message->len))
		m->asked = true;
}

const struct broker_ops arrivals_ops = {
	.connected = on_connected,
	.message = on_message,
	.answered = on_answered,
	.will = will,
};
