/* SPDX-License-Identifier: MIT */
/* Asks another owsd-web for its summary: a GET by HTTP/1.0, with an end and a size. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "src/config/read/others.h"
#include "src/faces/web/summary.h"

#define ASK_MAX (16u << 10) /* of an answer, its head included */
#define ASK_WORDS 160

/*
 * Blocks, until until_ns (CLOCK_BOOTTIME) at the latest, but for a name server that is silent.
 * False: there is no summary, *why has the reason in words of our own.
 */
bool ask_summary(const struct other_place *place, int64_t until_ns, struct summary *summary,
                 char why[ASK_WORDS]);
/* What came, up to the end of the connection, as a summary; as ask_summary(). Pure. */
bool ask_parse(char *bytes, size_t len, struct summary *summary, char why[ASK_WORDS]);
