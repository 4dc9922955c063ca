/* SPDX-License-Identifier: MIT */
/*
 * What owsd-mqtt publishes of an instance without owsd: its stream, with an outlet that keeps the
 * messages as text, "TOPIC TEXT\n" each. The node is "pi", and commands are taken.
 */
#pragma once

#include "src/faces/mqtt/profiles.h"
#include "tests/unit/aid/instance.h"

struct published {
	struct instance in;
	struct ows *h;
	struct stream s;
	char prefix[TOPIC_SIZE];
	char said[32768];
	int room; /* how many messages the outlet takes; 1000 from the start on */
};

void published_start(struct published *p, const struct instance_signal *signals, uint32_t count,
                     const struct profile *profile);
void published_end(struct published *p);
/* Put what waits. Returns the messages. */
const char *published_pump(struct published *p);
/* The same after that signal has changed. */
const char *published_change(struct published *p, int signal);
/* The text of the last message at the topic, without what follows it; NULL: there was none. */
const char *published_at(struct published *p, const char *topic);
