/* SPDX-License-Identifier: MIT */
/* An instance, the stream of owsd-mqtt over it, and an outlet that keeps what it gets. */
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/published.h"

static bool put(void *ctx, const char *topic, const char *text, size_t len, bool retain)
{
	struct published *p = ctx;
	size_t at = strlen(p->said);

	if (!p->room)
		return false;
	p->room--;
	TEST_ASSERT_LESS_THAN(sizeof(p->said), at + strlen(topic) + len + 10);
	snprintf(p->said + at, sizeof(p->said) - at, "%s%s %.*s\n", topic, retain ? "" : " (once)",
	         (int)len, text);
	return true;
}

void published_start(struct published *p, const struct instance_signal *signals, uint32_t count,
                     const struct profile *profile)
{
	memset(p, 0, sizeof(*p));
	instance_start(&p->in, "published", signals, count);
	TEST_ASSERT_EQUAL_INT(0, ows_open(p->in.name, OWS_READ, &p->h));
	profiles_prefix(profile, "o", "pi", p->prefix);
	p->s = (struct stream){.profile = profile,
	                       .outlet = {.put = put, .ctx = p},
	                       .prefix = p->prefix,
	                       .topic = "o",
	                       .node = "pi",
	                       .discovery = "ha",
	                       .write = true};
	p->room = 1000;
	TEST_ASSERT_EQUAL_INT(0, stream_open(&p->s));
	TEST_ASSERT_EQUAL_INT(0, stream_make(&p->s, p->h));
	stream_live(&p->s, true);
	p->s.settled = true;
}

void published_end(struct published *p)
{
	stream_close(&p->s);
	ows_close(p->h);
	instance_end(&p->in);
}

const char *published_pump(struct published *p)
{
	p->said[0] = '\0';
	stream_pump(&p->s);
	return p->said;
}

const char *published_change(struct published *p, int signal)
{
	stream_changes(&p->s, &signal, 1);
	return published_pump(p);
}

const char *published_at(struct published *p, const char *topic)
{
	static char text[sizeof(p->said)];
	size_t len = strlen(topic);
	bool found = false;

	for (const char *line = p->said; *line; line += strcspn(line, "\n") + 1) {
		if (strncmp(line, topic, len) != 0 || line[len] != ' ')
			continue;
		found = true;
		snprintf(text, sizeof(text), "%.*s", (int)strcspn(line + len + 1, "\n"),
		         line + len + 1);
	}
	return found ? text : NULL;
}
