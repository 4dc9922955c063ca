/* SPDX-License-Identifier: MIT */
/* The profile "plain": values, states and alarms as JSON. Others are built on it. */
#pragma once

#include "src/faces/mqtt/stream.h"

extern const char *const plain_below[];
void plain_topic(const struct stream *s, const struct row *row, char topic[TOPIC_SIZE]);
void plain_problem_topic(const struct stream *s, const struct chip *chip, char topic[TOPIC_SIZE]);
bool plain_writes(const struct stream *s, const char *topic, const char *below);
/* Count the quality of a row for its chip. True: the first that shows that the chip is there. */
bool plain_chip_look(struct stream *s, struct row *row, uint8_t quality);
/*
 * Is the chip there, by all that was counted? Of one with outputs alone only a command can show it:
 * it counts as there until then.
 */
bool plain_chip_there(const struct stream *s, const struct chip *chip);
/* The limit alarm of a row. False: it has none, or owsd is away. */
bool plain_limit(const struct stream *s, const struct row *row, struct ows_alarm_state *state);
/* Does it stand? */
bool plain_stands(const struct ows_alarm_state *state);
bool plain_value(struct stream *s, struct row *row);
/* The members of a value as it is now, without the object around them. */
void plain_value_json(struct json *json, struct stream *s, struct row *row);
bool plain_state(struct stream *s, enum stream_node node);
/* "online", "offline", "unknown" */
const char *plain_chip_word(const struct stream *s, const struct chip *chip);
void plain_alarm(struct stream *s, const struct ows_alarm *alarm);

/* What the profiles that are built on it have of it. */
#define PLAIN \
	.qos = 1, .health = true, .commands = "+/set", .asks = "+/get", .below = plain_below, \
	.none = "{\"v\":null,\"good\":false,\"q\":4,\"why\":\"not configured\"}", \
	.writes = plain_writes, .topic = plain_topic, .value = plain_value, .state = plain_state, \
	.alarm = plain_alarm
