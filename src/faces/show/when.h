/* SPDX-License-Identifier: MIT */
/* Times as people and programs read them. */
#pragma once

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
/*
 * Parse a time span: a number above 0 of seconds, or one with s, m, h or d, or the beginning of
 * seconds, minutes, hours or days; a century at most. False: it is none.
 */
bool when_parse(const char *text, int64_t *ns);
/*
 * Parse a moment as wall clock: a span before now, which may end with "ago"; now; today and
 * yesterday, which began at midnight; or a time as ISO 8601 has it, a day alone or with hours and
 * minutes, seconds, a fraction, and an offset (without: local time), so that what when_iso() prints
 * is one. Of the years 1970 to 2114. Returns NULL, or what is wrong, and *wall_ns stays.
 */
const char *when_moment(const struct when *now, const char *text, int64_t *wall_ns);
