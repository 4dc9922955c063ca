/* SPDX-License-Identifier: MIT */
/* The state of a connection to a broker, and a client of libmosquitto that writes into it. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "src/faces/kit/backoff.h"
#include "src/faces/mqtt/advice.h"
#include "src/faces/mqtt/options.h"
#include "src/faces/mqtt/taken.h"

#define BROKER_TOPICS 6
#define BROKER_WORDS ADVICE_WORDS
#define BROKER_SESSION 20
#define CLIENT_ID "owsd-%s"
#define BROKER_IN_FLIGHT 100 /* messages that the broker has not taken yet, at most */
#define BROKER_PLACES 24     /* that client_look() takes */
#define BROKER_PERSON 32     /* as ows_for() takes it */

struct face;
struct outlet;
struct mosquitto;

/* What came on a topic that was subscribed to. */
struct broker_message {
	const char *topic, *text; /* NUL-terminated behind len bytes */
	size_t len;
	int64_t came_ns;              /* it came later than that */
	bool retained;                /* the broker has kept it */
	const char *fault;            /* what is wrong with it as a command; NULL: not known */
	char person[BROKER_PERSON];   /* who sent it, as it claims; "": nothing is claimed */
	char session[BROKER_SESSION]; /* of a will of owsd-mqtt: of which process; "": it is none */
	/* By MQTT 5: where an answer is wanted, NULL: nowhere; and what it has to bring along */
	const char *reply;
	const void *correlation;
	uint16_t correlation_len;
};

struct broker_ops {
	void (*connected)(void *ctx);
	void (*message)(void *ctx, const struct broker_message *message);
	/* What a message has had another program asked is answered, or will not be */
	void (*answered)(void *ctx);
	/* Have the will put; ending: what is published at the end. False: it was not taken. */
	bool (*will)(void *ctx, bool ending, const struct outlet *outlet);
};

/* A topic that we want to hear, as long as the connection lasts. */
struct broker_topic {
	char name[TOPIC_SIZE];
	int mid;      /* of the last request for it */
	bool refused; /* which the broker has refused */
};

enum broker_state {
	BROKER_OFF,
	BROKER_WAITING,
	BROKER_CONNECTING,
	BROKER_CONNECTED,
};

struct broker {
	struct face *face;
	const struct mqtt_options *options;
	const struct broker_ops *ops;
	void *ctx;
	struct mosquitto *client;
	enum broker_state state;
	int fd; /* that the face waits for; -1: none */
	unsigned way;
	bool v4;            /* the way is tried at its IPv4 address alone */
	bool tcp;           /* it has a connection, so far without a word of MQTT */
	bool old_protocol;  /* MQTT 3.1.1 in place of 5, as the broker wants it */
	bool ended;         /* libmosquitto has ended it */
	bool drained;       /* nothing is to be read any more */
	bool held;          /* what the broker holds for us is too old */
	int64_t came_ns;    /* what is read now came later than that */
	int end_code;       /* why */
	unsigned sent;      /* CONNECTs */
	struct taken taken; /* whether another client takes our id */
	bool thrown_out;    /* it took the last connection, or that looks so */
	unsigned in_flight; /* put, and not taken by the broker */
	size_t large;       /* of this connection the longest message, */
	int large_mid;      /* its number, 0: taken, */
	size_t large_taken; /* and the longest that was ever taken */
	char large_topic[128];
	bool marking; /* the broker may answer the last mark yet */
	bool marked;  /* it has */
	int mark;     /* its number */
	bool refused; /* a way that was tried since the last pause answered, and refused */
	struct backoff backoff;
	struct broker_topic topics[BROKER_TOPICS];
	unsigned topic_count;
	struct backoff asking; /* for those that are refused: a cluster may not be ready yet */
	int64_t ask_ns;        /* when they are asked for again; 0: none is refused */
	int64_t begun_ns, next_ns;
	int64_t tend_ns;                   /* when broker_tick() is due, once there is a client */
	unsigned known;                    /* ways that it was connected by, as bits */
	unsigned vain;                     /* those whose last connection was left for nothing */
	bool again;                        /* by this one before */
	char session[BROKER_SESSION];      /* of this process alone; stands in its will */
	char tls_words[BROKER_WORDS];      /* the last error that libmosquitto logged */
	char trouble[BROKER_WORDS];        /* what is wrong now, and its remedy; "": nothing */
	char last[BROKER_WORDS];           /* the same, kept after its end */
	int64_t last_ns;                   /* since when */
	char refusal[BROKER_WORDS];        /* what the broker refuses of us now; "": nothing */
	uint64_t logged[CONFIG_MQTT_WAYS]; /* a hash of what was logged of each way */
	uint64_t connects, failures, published, acknowledged, refusals;
};

/*
 * Make b->client for the present way: not connected, with callbacks that write into b. Reads the
 * files of secrets. False, with the reason in why; b->client is to be destroyed then, too.
 */
bool client_make(struct broker *b, char *why, size_t size);
/*
 * Let b->tls_words say why the certificate of the broker is refused, once TLS begins. Before what
 * comes is read.
 */
void client_explain(struct broker *b);
/* A message is under way, by that number. */
void client_put(struct broker *b, int mid, const char *topic, size_t len);
/*
 * By MQTT 3.1.1 a broker has no word for a packet that is too large: it closes the connection. Does
 * the end look so? The longest message was not taken, and none that long ever was.
 */
bool client_too_large(const struct broker *b, int code, int err);
/* What was to be published there is not, by an error of libmosquitto. */
void client_refuse(struct broker *b, const char *topic, int err);
/* MQTT 5, else 3.1.1. */
bool client_mqtt5(const struct broker *b);
/* The QoS of what has to come: the will and commands. */
int client_sure_qos(const struct broker *b);
/* Publish an answer to a message, once; one that the broker does not take now is lost. */
void client_answer(struct broker *b, const char *topic, const char *text, size_t len,
                   const struct broker_message *message);
/*
 * What the broker refuses is logged, and asked for again after a pause, until the connection ends.
 * What we publish there ourselves does not come, by MQTT 5.
 */
void client_subscribe(struct broker *b, const char *topic);
/* Those that are refused, when it is time. */
void client_subscribe_again(struct broker *b, int64_t now_ns);
/* A new connection has no subscription. */
void client_forget_topics(struct broker *b);
/*
 * The same for several at once, QoS 0, or their end. Only a refusal of the first is logged: whether
 * there is something at the others nobody knows.
 */
void client_look(struct broker *b, char *const *topics, int count, bool begin);
