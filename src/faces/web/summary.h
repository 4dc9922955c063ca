/* SPDX-License-Identifier: MIT */
/* An instance in a line, as one owsd-web gives it to another: of this machine, and of others. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "src/faces/show/json.h"
#include "src/public/ows.h"

struct summary {
	char instance[128], host[256], version[32];
	char first[256]; /* the signal of the worst alarm that waits; "": none does */
	char alarm[64];  /* its words */
	bool live;       /* owsd is there */
	uint32_t signals, not_good;
	uint32_t alarms; /* signals with one that nobody has acknowledged */
	uint32_t needs;  /* signals that somebody has to look at */
	int64_t up_s;    /* since owsd started; negative: not known */
};

/* Of an instance; h is NULL until it has run. ids: as show.h has them. */
void summary_make(struct summary *summary, const char *instance, struct ows *h, bool live,
                  const int *ids, int64_t now_ns);
/* Its members. */
void summary_json(struct json *json, const struct summary *summary);
/*
 * The other way; whoever sent it: a text that is too long, is no UTF-8 or disturbs a line refuses
 * it, and so does a number beyond all use. The bytes are changed. 0, or -EBADMSG. Pure.
 */
int summary_parse(char *text, size_t len, struct summary *summary);
