/* SPDX-License-Identifier: MIT */
/* What owsd-mqtt does with the news of owsd and of the broker, at its ticks and at its end. */
#include "src/faces/mqtt/mqtt.h"

#include <errno.h>
#include <mosquitto.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/faces/kit/look.h"
#include "src/faces/kit/loop.h"
#include "src/faces/mqtt/health.h"
#include "src/faces/mqtt/profiles.h"
#include "src/ground/signal/hash.h"

/* Of changes of a signal that come closer together the newest is published */
#define PACE_NS (50 * NS_PER_MS)
/* A clock that nobody sets is believed so long after the boot */
#define CLOCK_WAIT_NS (600 * NS_PER_S)
#define HEALTH_NS (5 * NS_PER_S)
/* So long the broker may take to send what it keeps of us */
#define SWEEP_NS (10 * NS_PER_S)
/* Between two births that somebody asks for: who asks all the time gets no more */
#define ANNOUNCE_NS (10 * NS_PER_S)
/* The same where each birth that does not come makes a host ask again */
#define REBIRTH_NS NS_PER_S
/* Nothing is published for so long, and something waits: the log says what it waits for */
#define STUCK_NS (5 * NS_PER_S)
/* So long after its start owsd may be looking at a device for the first time */
#define FIRST_LOOK_NS (5 * NS_PER_S)
/* So long the host of a session may be away until it is looked for at another broker */
#define HOST_WAIT_NS (60 * NS_PER_S)

static struct mqtt *mqtt_own(struct face *face)
{
	return face->own;
}

/* struct stream.class_of */
static const char *class_of(void *ctx, const char *name)
{
	static unsigned at; /* of the item after the last one: mostly they come in their order */
	const struct config *config = ((struct face *)ctx)->config;

	for (unsigned k = 0; k < config->item_count; k++) {
		const struct config_item *item = &config->items[(at + k) % config->item_count];

		if (strcmp(item->name, name) != 0)
			continue;
		at += k + 1;
		return item->device_class ? item->device_class : "";
	}
	return "";
}

/* --- Beginning and end of a configuration ---------------------------------------------------- */

/* Of another one, or of another node there, nothing is known of what it has missed. */
static uint64_t broker_key(const struct mqtt_options *options)
{
	uint64_t key = hash_text(HASH_BEGIN, options->prefix, strlen(options->prefix));

	key = hash_text(key, options->node, strlen(options->node));
	return hash_text(key, (const char *)options->ways, sizeof(options->ways));
}

static void mqtt_begin(struct face *face, int64_t now_ns)
{
	struct mqtt *m = mqtt_own(face);

	m->stream.profile = m->options.profile;
	m->stream.prefix = m->options.prefix;
	m->stream.topic = m->options.topic;
	m->stream.node = m->options.node;
	m->stream.discovery = m->options.discovery;
	m->stream.host = m->options.profile->listen_host && *m->options.primary_host
	                         ? m->options.primary_host
	                         : NULL;
	m->stream.host_ms = 0;
	m->stream.link = m->options.link;
	m->stream.write = m->options.write;
	m->stream.old_readers = m->options.old_readers;
	m->stream.outlet = (struct outlet){.put = broker_put, .ctx = &m->broker};
	m->stream.class_of = class_of;
	m->stream.class_ctx = face;
	m->broker.face = face;
	m->broker.options = &m->options;
	m->broker.ctx = m;
	m->commands.log = face->log;
	m->commands.instance = face->arguments->instance;
	m->commands.program = face->ops->program;
	m->commands.stream = &m->stream;
	m->past.face = face;
	m->past.stream = &m->stream;
	m->past.broker = &m->broker;
	past_begin(&m->past, broker_key(&m->options));
	/* a will that comes late is of none of the last sessions then */
	if (m->past.on)
		m->bdseq = missed_number(&m->past.missed) + 1 - (int)m->broker.sent;
	broker_begin(&m->broker, now_ns);
}

static void mqtt_end(struct face *face)
{
	struct mqtt *m = mqtt_own(face);

	past_end(&m->past);
	broker_end(&m->broker);
	commands_tell(&m->commands, INT64_MAX);
	commands_close(&m->commands);
}

static void make_rows(struct face *face)
{
	struct mqtt *m = mqtt_own(face);

	m->sweep = true;
	past_drop(&m->past);
	if (stream_make(&m->stream, face->ows))
		log_err(face->log, "nothing is published: no memory for %d signals",
		        ows_count(face->ows));
}

/* The file may be another than before. */
static void renew(struct face *face, int64_t now_ns)
{
	struct mqtt *m = mqtt_own(face);
	struct mqtt_options options;

	m->sweep_ns = 0; /* the rows may be those of an image that is gone */
	mqtt_options_take(&options, face);
	/* All of it is zero but for what is set.
	   NOLINTNEXTLINE(bugprone-suspicious-memory-comparison,cert-exp42-c,cert-flp37-c) */
	if (memcmp(&options, &m->options, sizeof(options)) != 0) {
		mqtt_end(face);
		m->options = options;
		if (!face->live)
			stream_clear(&m->stream);
		mqtt_begin(face, now_ns);
	} else {
		broker_hurry(&m->broker, now_ns);
	}
	if (face->live)
		make_rows(face);
}

/*
 * Ask the broker what it keeps of this node, for a while, so that topics and devices that are no
 * more can be emptied: an earlier run may have published them.
 */
static void sweep(struct mqtt *m, int64_t now_ns)
{
	bool begins = m->sweep;
	char topics[BROKER_PLACES][TOPIC_SIZE], *all[BROKER_PLACES];
	int count = 0;

	if (!begins && (!m->sweep_ns || now_ns < m->sweep_ns))
		return;
	for (; count < BROKER_PLACES; count++) {
		profiles_place(&m->stream, count, topics[count]);
		if (!*topics[count])
			break;
		all[count] = topics[count];
	}
	client_look(&m->broker, all, count, begins);
	m->sweep = false;
	m->sweep_ns = begins ? now_ns + SWEEP_NS : 0;
}

static int64_t announce_ns(const struct mqtt *m)
{
	return m->announced_ns + (m->stream.profile->session ? REBIRTH_NS : ANNOUNCE_NS);
}

/* What is wrong now: the connection is there when that is published. */
static const char *trouble_of(const struct mqtt *m, int64_t now_ns)
{
	if (*m->broker.face->refused)
		return m->broker.face->refused;
	return *m->broker.refusal ? m->broker.refusal : commands_trouble(&m->commands, now_ns);
}

static bool publish_health(struct mqtt *m, int64_t now_ns)
{
	return health_publish(&m->stream, &(struct health){.trouble = trouble_of(m, now_ns),
	                                                   .commands = m->commands.taken,
	                                                   .refused_commands = m->commands.refused,
	                                                   .connects = m->broker.connects,
	                                                   .refused_messages = m->broker.refusals});
}

/*
 * Publish what waits. Returns what it waits for, NULL: nothing. Between two images no row can be
 * looked at.
 */
/*
 * The births of a session have all devices that are there, and go before any data. owsd may have
 * started with us, and not know yet which are there.
 */
static bool awaits_looks(const struct face *face, const struct stream *s, int64_t now_ns)
{
	struct ows_value value;

	if (!face->live || !s->profile->session || s->announced ||
	    now_ns - face->start_ns >= FIRST_LOOK_NS)
		return false;
	for (int i = 0; i < s->count; i++)
		if (!s->rows[i].info.output && !ows_get_signal(s->h, i, now_ns, &value) &&
		    value.quality == OWS_Q_INITIAL && !value.err)
			return true;
	return false;
}

static const char *pump(struct face *face, int64_t now_ns)
{
	struct mqtt *m = mqtt_own(face);
	bool session = m->stream.profile->session;

	if (m->broker.state != BROKER_CONNECTED)
		past_lost(&m->past);
	if (m->broker.state != BROKER_CONNECTED)
		return NULL;
	if (face->live && !look_is_current(face))
		return "a look at the new image of owsd";
	if (face->live && m->stream.count)
		sweep(m, now_ns);
	if (m->asked && (face->live || !session) && now_ns >= announce_ns(m)) {
		stream_announce(&m->stream, true);
		m->announced_ns = now_ns;
		m->asked = false;
	}
	/* who asks for a birth gets nothing else before, but that owsd is lost */
	if (m->asked && session && face->live)
		return "the pause between two births";
	if (awaits_looks(face, &m->stream, now_ns))
		return NULL;
	m->stream.settled = broker_is_settled(&m->broker, now_ns);
	if (!stream_pump(&m->stream))
		return m->stream.host && !m->stream.host_there ? NULL : "the broker to take it";
	if (!face->live)
		return NULL;
	past_pump(&m->past, now_ns);
	if (now_ns < m->health_ns)
		return NULL;
	if (m->stream.profile->health
	            ? publish_health(m, now_ns)
	            : !m->stream.profile->numbers || m->stream.profile->numbers(&m->stream))
		m->health_ns = now_ns + HEALTH_NS;
	return NULL;
}

/* Once when nothing goes on, once when it does. */
static void report_stuck(struct face *face, const char *what, int64_t now_ns)
{
	struct mqtt *m = mqtt_own(face);
	uint64_t taken = m->broker.acknowledged;

	if (!what || taken != m->pumped) {
		if (m->stuck && m->broker.state == BROKER_CONNECTED)
			log_notice(face->log, "messages go out again");
		m->pumped_ns = now_ns;
		m->pumped = taken;
		m->stuck = false;
	} else if (!m->stuck && now_ns - m->pumped_ns >= STUCK_NS) {
		m->stuck = true;
		log_warning(face->log,
		            "nothing is published for %d s: it waits for %s; %u under way",
		            (int)(STUCK_NS / NS_PER_S), what, m->broker.in_flight);
	}
}

static void look_at_clock(struct face *face, int64_t now_ns)
{
	struct mqtt *m = mqtt_own(face);

	bool before = m->stream.clock_set;

	wall_clock_look(&m->clock, now_ns);
	m->past.missed.dated = m->stream.clock_right = m->clock.trusted;
	m->stream.clock_set = m->clock.trusted || now_ns >= CLOCK_WAIT_NS;
	/* where a message has to have a time it had a wrong one */
	if (m->stream.clock_set && !before && m->stream.live && m->stream.profile->session)
		stream_announce(&m->stream, true);
}

void mqtt_report(struct face *face, FILE *out)
{
	struct mqtt *m = mqtt_own(face);
	const struct broker *b = &m->broker;
	bool commanded = *m->commands.trouble && m->commands.trouble_ns >= b->last_ns;
	const struct {
		const char *name;
		uint64_t value;
	} counters[] = {
		{"messages_published", b->published},
		{"messages_acknowledged", b->acknowledged},
		{"messages_refused", b->refusals},
		{"messages_under_way", b->in_flight},
		{"values_sent_again", m->past.missed.sent},
		{"connects", b->connects},
		{"connects_failed", b->failures},
		{"commands_taken", m->commands.taken},
		{"commands_refused", m->commands.refused},
	};

	if (b->state == BROKER_CONNECTED)
		fprintf(out, "since %lld\n", (long long)b->begun_ns);
	if (*m->commands.trouble || *b->last)
		fprintf(out, "trouble %s\ntroubled %lld\n",
		        commanded ? m->commands.trouble : b->last,
		        (long long)(commanded ? m->commands.trouble_ns : b->last_ns));
	for (size_t i = 0; i < sizeof(counters) / sizeof(counters[0]); i++)
		fprintf(out, "count %s %llu\n", counters[i].name,
		        (unsigned long long)counters[i].value);
}

/*
 * As Sparkplug has it: a session ends when its host is offline, and the next one waits for it, at
 * each of the brokers in turn.
 */
static void look_at_host(struct face *face, int64_t now_ns)
{
	struct mqtt *m = mqtt_own(face);
	struct broker *b = &m->broker;
	char name[MQTT_WAY_NAME];

	if (m->stream.host && m->stream.host_there && b->vain) {
		b->vain = 0;
		log_notice(face->log, "the primary host %s is online, at %.150s", m->stream.host,
		           mqtt_way_name(&m->options.ways[b->way], name));
	}
	if (!m->stream.host || m->stream.host_there || b->state != BROKER_CONNECTED)
		return;
	if (m->stream.born)
		log_warning(face->log,
		            "the primary host %s is offline: nothing is published until it is back",
		            m->stream.host);
	if (m->stream.born || (m->options.way_count > 1 && now_ns - b->begun_ns > HOST_WAIT_NS))
		broker_leave(b, !m->stream.born, now_ns);
}

static void show_status(struct face *face)
{
	struct mqtt *m = mqtt_own(face);
	char name[MQTT_WAY_NAME];
	const struct broker *b = &m->broker;
	bool waits = m->stream.host && !m->stream.host_there;

	face_status(face, "%s%.150s; %llu published, %llu refused, %llu times connected",
	            b->state == BROKER_CONNECTED ? !face->live ? "waiting for owsd, at "
	                                           : waits     ? "waiting for the primary host, at "
	                                                       : "publishing to "
	            : *b->trouble                ? ""
	                                         : "connecting to ",
	            *b->trouble ? b->trouble : mqtt_way_name(&m->options.ways[b->way], name),
	            (unsigned long long)b->acknowledged, (unsigned long long)b->refusals,
	            (unsigned long long)b->connects);
	m->shown = b->state;
}

static void go_on(struct face *face, int64_t now_ns)
{
	struct mqtt *m = mqtt_own(face);

	look_at_host(face, now_ns);
	m->past.due = false;
	report_stuck(face, pump(face, now_ns), now_ns);
	face->tick_ns = broker_next(&m->broker);
	if (past_next(&m->past) < face->tick_ns)
		face->tick_ns = past_next(&m->past);
	if (m->errand.kind && m->errand.until_ns < face->tick_ns)
		face->tick_ns = m->errand.until_ns;
	if (m->asked && announce_ns(m) > now_ns && announce_ns(m) < face->tick_ns)
		face->tick_ns = announce_ns(m);
	if (now_ns < face->start_ns + FIRST_LOOK_NS && !m->stream.announced)
		face->tick_ns = earlier_ns(face->tick_ns, face->start_ns + FIRST_LOOK_NS);
	/* the next tick may be minutes away; to show each count at once would cost too much */
	if (m->broker.state != m->shown)
		show_status(face);
}

/* --- The face -------------------------------------------------------------------------------- */

int mqtt_open(struct face *face)
{
	struct mqtt *m = mqtt_own(face);
	int64_t now_ns = ows_now();

	/* nothing else bounds how long the look-up of a name may take */
	setenv("RES_OPTIONS", "timeout:2 attempts:1", 0);
	m->broker.fd = -1;
	if (stream_open(&m->stream) || mosquitto_lib_init()) {
		face_complain(face->ops->program, "libmosquitto cannot be used: no memory");
		return -ENOMEM;
	}
	wall_clock_open(&m->clock);
	look_at_clock(face, now_ns);
	face->pace_ns = PACE_NS;
	face->tick_ns = now_ns;
	mqtt_options_take(&m->options, face);
	mqtt_begin(face, now_ns);
	return 0;
}

void mqtt_close(struct face *face)
{
	struct mqtt *m = mqtt_own(face);

	errand_end(&m->errand, face);
	mqtt_end(face);
	stream_close(&m->stream);
	mosquitto_lib_cleanup();
}

void mqtt_tick(struct face *face, int64_t now_ns)
{
	struct mqtt *m = mqtt_own(face);

	look_at_clock(face, now_ns);
	commands_tell(&m->commands, now_ns);
	broker_tick(&m->broker, now_ns);
	if (errand_late(&m->errand, now_ns))
		m->broker.ops->answered(m);
	stream_repeat(&m->stream, now_ns);
	go_on(face, now_ns);
	show_status(face);
}

void mqtt_changes(struct face *face, const int *signals, int n)
{
	struct mqtt *m = mqtt_own(face);

	stream_changes(&m->stream, signals, n);
	go_on(face, ows_now());
}

void mqtt_event(struct face *face, const struct face_event *event)
{
	struct mqtt *m = mqtt_own(face);
	int64_t now_ns = ows_now();

	switch (event->news) {
	case FACE_FOUND:
	case FACE_RELOADED:
		renew(face, now_ns);
		stream_live(&m->stream, true);
		break;
	case FACE_FILE:
		renew(face, now_ns);
		break;
	case FACE_LOST:
		stream_live(&m->stream, false);
		log_warning(face->log, "owsd is lost: no value is good");
		break;
	case FACE_ALARM:
		/* its value need not have changed */
		if (event->alarm->signal >= 0)
			stream_changes(&m->stream, &event->alarm->signal, 1);
		if (m->broker.state == BROKER_CONNECTED && m->stream.profile->alarm)
			m->stream.profile->alarm(&m->stream, event->alarm);
		break;
	case FACE_OVERRUN:
	case FACE_COMMAND:
	case FACE_ENTRIES_LOST:
		break;
	case FACE_DESCRIPTOR:
		if (errand_ready(&m->errand, event->fd))
			m->broker.ops->answered(m);
		broker_ready(&m->broker, event->fd, event->ready, now_ns);
		break;
	}
	go_on(face, now_ns);
}
