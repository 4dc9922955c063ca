/* SPDX-License-Identifier: MIT */
/* Times as people and programs read them. */
#ifndef SHOW_WHEN_H
#define SHOW_WHEN_H

#include <stdbool.h>
#include <stdint.h>

/* One moment on both clocks, ns. */
struct when {
	int64_t boot, wall;
};
struct when when_now(void);

#define WHEN_TEXT 40
/* boot_ns as local time by ISO 8601 with milliseconds and offset. Returns text. */
const char *when_iso(const struct when *now, int64_t boot_ns, char text[WHEN_TEXT]);
/* A time span in a few characters: "0.4s" "12s" "3m" "5h" "2d". Returns text. */
const char *when_span(int64_t ns, char text[WHEN_TEXT]);
/* The format of what to say to -s when it is none. */
#define WHEN_WANTED "-s %s: expected a time such as 90s, 30m, 24h or 7d"
/*
 * Parse a time span: a number above 0 of seconds, or one with s, m, h or d; a century at most.
 * False: it is none.
 */
bool when_parse(const char *text, int64_t *ns);
/*
 * Parse a moment as wall clock: a span before now, or a local time "2026-11-26", "2026-11-26T14:30"
 * or "2026-11-26 14:30:15". Never before 1970, nor after 2262. False: it is none.
 */
bool when_moment(const struct when *now, const char *text, int64_t *wall_ns);

#endif
