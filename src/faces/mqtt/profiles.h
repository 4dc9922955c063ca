/* SPDX-License-Identifier: MIT */
/* All profiles: by their names, and what one of them has left at the broker. */
#pragma once

#include "src/config/read/config.h"
#include "src/faces/mqtt/stream.h"

#define PROFILE_EXTERN(name) extern const struct profile profile_##name;
MQTT_PROFILES(PROFILE_EXTERN)
#undef PROFILE_EXTERN

/* The profile of a name of MQTT_PROFILES. */
const struct profile *profiles_find(const char *name);
/* What all its topics begin with: TOPIC/NODE, or its root and the id of the node, or TOPIC. */
void profiles_prefix(const struct profile *profile, const char *topic, const char *node,
                     char prefix[TOPIC_SIZE]);

/* The topics to listen to, with wildcards, by number; "" after the last. No two overlap. */
void profiles_listen(const struct stream *s, bool rename, int number, char topic[TOPIC_SIZE]);
/*
 * The topics where the broker may keep what is no more, of other profiles too; "" after the last.
 * None overlaps with those of profiles_listen(): a broker hands out a message for each that fits.
 */
void profiles_place(const struct stream *s, int number, char topic[TOPIC_SIZE]);
/* A retained message that came there, NULL if empty: nobody writes the topic any more, so empty
 * it. */
void profiles_kept(struct stream *s, const char *topic, const char *text);
