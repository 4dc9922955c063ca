/* SPDX-License-Identifier: MIT */
/* How owsd, its targets and the broker do, as one retained message; and as entities of a device. */
#pragma once

#include "src/faces/mqtt/stream.h"

struct health {
	const char *trouble; /* of the broker or of commands, with the remedy; "": none */
	uint64_t connects, refused_messages, commands, refused_commands;
};
/* Publish it if it is another than before. False: the outlet does not take it now. */
bool health_publish(struct stream *s, const struct health *health);
/* Targets that are down, signals that are not good, errors on the wire, reconnects to targets. */
void health_count(struct stream *s, int64_t numbers[HEALTH_NUMBERS]);
/* Components of Home Assistant's discovery. */
void health_entities_json(struct json *json, const struct stream *s, const char *owner);
