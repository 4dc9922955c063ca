/* SPDX-License-Identifier: MIT */
/* The profile "plain": values, states and alarms as JSON. Others are built on it. */
#ifndef MQTT_PLAIN_H
#define MQTT_PLAIN_H

#include "src/mqtt/stream.h"

/* How often a value that stays the same is published again, ns; 0: never. From StaleAfter. */
int64_t plain_repeat_ns(const struct ows_info *info);
/* Is it a key that touches the wire: "/01.7A3B4C5D6E7F/present"? */
bool plain_is_key(const struct row *row);

bool plain_value(struct stream *s, struct row *row);
bool plain_state(struct stream *s, bool online);
void plain_alarm(struct stream *s, const struct ows_alarm *alarm);

#endif
