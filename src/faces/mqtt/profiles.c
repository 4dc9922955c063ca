/* SPDX-License-Identifier: MIT */
/* The table of profiles, and what the broker keeps of any of them that is no more. */
#include <stdio.h>
#include <string.h>

#include "src/faces/mqtt/profiles.h"

#ifndef OWSD_PROTOBUFC
#define profile_sparkplug profile_plain /* the configuration refuses its name */
#endif
#define PROFILE_TABLE(name) &profile_##name,

static const struct profile *const profiles[] = {MQTT_PROFILES(PROFILE_TABLE)};
#define PROFILES (sizeof(profiles) / sizeof(profiles[0]))

const struct profile *profiles_find(const char *name)
{
	size_t i = PROFILES - 1;

	while (i && strcmp(profiles[i]->name, name) != 0)
		i--;
	return profiles[i];
}

void profiles_prefix(const struct profile *profile, const char *topic, const char *node,
                     char prefix[TOPIC_SIZE])
{
	char id[TOPIC_SIZE / 2];

	if (profile->root && !profile->dash) {
		snprintf(prefix, TOPIC_SIZE, "%s%s", profile->root, topic);
	} else if (profile->root) {
		topic_slug(node, profile->dash, id, sizeof(id));
		snprintf(prefix, TOPIC_SIZE, "%s%s", profile->root, id);
	} else {
		snprintf(prefix, TOPIC_SIZE, "%s/%s", topic, node);
	}
}

/*
 * Are the topics that another profile gives this node its own? Pi and pi have one slug, so they are
 * taken for those of pi.
 */
static bool is_own(const struct profile *profile, const struct stream *s)
{
	char id[TOPIC_SIZE / 2];

	if (!profile->dash)
		return true;
	topic_slug(s->node, profile->dash, id, sizeof(id));
	return profile == s->profile || !strcmp(id, s->node);
}

void profiles_listen(const struct stream *s, bool rename, int number, char topic[TOPIC_SIZE])
{
	const struct profile *p = s->profile;
	void (*const by[])(const struct stream *,
	                   char *) = {p->listen, s->host ? p->listen_host : NULL, p->listen_write};
	/* without Write they are refused, with a reason */
	const char *const below[] = {p->commands, p->asks, p->asks ? "+/" TOPIC_READ : NULL,
	                             p->asks && rename ? "+/" TOPIC_RENAME : NULL};

	topic[0] = '\0';
	for (size_t i = 0; i < sizeof(by) / sizeof(by[0]); i++)
		if (by[i] && !number--) {
			by[i](s, topic);
			return;
		}
	for (size_t i = 0; i < sizeof(below) / sizeof(below[0]); i++)
		if (below[i] && !number--) {
			snprintf(topic, TOPIC_SIZE, "%.300s/%s", s->prefix, below[i]);
			return;
		}
}

void profiles_place(const struct stream *s, int number, char topic[TOPIC_SIZE])
{
	const char *const *last = NULL;

	topic[0] = '\0';
	for (size_t i = 0; i <= PROFILES; i++) {
		/* our own first: the others' may be refused */
		const struct profile *p = i ? profiles[i - 1] : s->profile;
		/* profiles that are built on one another have the same */
		bool again = i &&
		             (p->below == s->profile->below || p->below == last || !is_own(p, s));
		char prefix[TOPIC_SIZE];

		last = p->below;
		profiles_prefix(p, s->topic, s->node, prefix);
		/* who reads the births lets go of a topic before that is emptied */
		for (int n = 0; p->births && (!i || p != s->profile) && p->births(s, n, topic); n++)
			if (!number--)
				return;
		topic[0] = '\0';
		for (const char *const *below = p->below; below && *below && !again; below++)
			if (!number--) {
				snprintf(topic, TOPIC_SIZE, "%.300s/%s", prefix, *below);
				return;
			}
	}
}

/* What is to be published at a topic that is not below the prefix; NULL: nothing. */
static const char *outlived(struct stream *s, const char *topic, const char *text)
{
	for (size_t i = 0; i < PROFILES; i++) {
		const struct profile *p = profiles[i];
		const char *put = p->outlived ? p->outlived(s, topic, text) : NULL;
		char prefix[TOPIC_SIZE];

		if (put)
			return put;
		profiles_prefix(p, s->topic, s->node, prefix);
		if (p->below && is_own(p, s) && stream_below(topic, prefix))
			return "";
	}
	return NULL;
}

void profiles_kept(struct stream *s, const char *topic, const char *text)
{
	const char *below = stream_below(topic, s->prefix);

	if (!s->live || !s->count || !text)
		return;
	if (below && s->profile->below)
		text = s->profile->writes(s, topic, below) ? NULL : "";
	else
		text = outlived(s, topic, text);
	if (text)
		stream_gone(s, topic, text);
}
