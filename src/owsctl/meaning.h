/* SPDX-License-Identifier: MIT */
/* What the value of a signal means: unit, decimals, description, and the raw value beside it. */
#ifndef OWSCTL_MEANING_H
#define OWSCTL_MEANING_H

#include <stdbool.h>

#include "src/libows/ows.h"
#include "src/show/json.h"

struct meaning {
	char *unit, *description; /* "": none */
	int decimals;             /* -1: not known */
	int raw;                  /* the id of _Raw; negative: none */
};

/* All of it copied, so that it outlives ows_reopen(). False: no memory. */
bool meaning_of(struct ows *h, const struct ows_info *info, struct meaning *meaning);
void meaning_free(struct meaning *meaning);

/* As members of a JSON object. */
void meaning_json(struct json *json, struct ows *h, const struct meaning *meaning, int64_t now_ns);

#endif
