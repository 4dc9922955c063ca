/* SPDX-License-Identifier: MIT */
/*
 * The connection to a broker, by libmosquitto in the loop of the face: the ways in turn, with a
 * pause that grows and is different on each machine; each attempt is a new client, so nothing of a
 * lost connection is sent again. Nothing here blocks but the look-up of a host's name, for a few
 * seconds at most, and broker_end().
 */
#ifndef MQTT_BROKER_H
#define MQTT_BROKER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "src/mqtt/options.h"

#define BROKER_WORDS 256
#define BROKER_PERSON 32 /* as ows_for() takes it */

struct face;
struct mosquitto;

/* What came on a topic that was subscribed to. */
struct broker_message {
	const char *topic, *text; /* NUL-terminated behind len bytes */
	size_t len;
	bool retained;              /* the broker has kept it */
	char person[BROKER_PERSON]; /* who is said to have sent it; "": nobody is */
};

struct broker_ops {
	void (*connected)(void *ctx);
	void (*message)(void *ctx, const struct broker_message *message);
	/* The topic and text of the will. */
	const char *(*will)(void *ctx, char topic[OPTION_SIZE]);
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
	int end_code;       /* why */
	bool refused_said;  /* that the broker refuses what is published */
	unsigned brief;     /* connections in a row that did not last */
	unsigned in_flight; /* put, and not taken by the broker */
	int64_t begun_ns, next_ns, step_ns;
	char tls_words[BROKER_WORDS];    /* the last error that libmosquitto logged */
	char trouble[BROKER_WORDS];      /* what is wrong now, and its remedy; "": nothing */
	uint64_t said[CONFIG_MQTT_WAYS]; /* a hash of what was logged of each way */
	uint64_t connects, failures, acknowledged, refusals;
};

/* options and what ops needs stay until broker_end(). Begins to connect. */
void broker_begin(struct broker *b, int64_t now_ns);
/* Say goodbye, after what was put has gone: two seconds at most. */
void broker_end(struct broker *b);
/* fd is ready, as poll(2) has it. True: it was the broker's. */
bool broker_ready(struct broker *b, int fd, short ready, int64_t now_ns);
void broker_tick(struct broker *b, int64_t now_ns);
/* When to tick at the latest. */
int64_t broker_next(const struct broker *b, int64_t now_ns);
/* Try again at once, if it is not connected. */
void broker_hurry(struct broker *b, int64_t now_ns);

/* struct outlet: QoS 1. */
bool broker_put(void *ctx, const char *topic, const char *text, size_t len, bool retain);
/* QoS 1. A refusal is logged when it comes. */
void broker_subscribe(struct broker *b, const char *topic);
/* "mqtt://localhost:1883" */
const char *broker_name(const struct broker *b, char text[BROKER_WORDS + 64]);

#endif
