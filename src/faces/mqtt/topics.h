/* SPDX-License-Identifier: MIT */
/* The topics of a node: TOPIC/NODE/SIGNAL and what stands beside and below it. Pure functions. */
#pragma once

#include <stddef.h>

#define TOPIC_SIZE 512
#define TOPIC_NAME 192 /* the name of a signal, with what is escaped in it */

/* Levels beside the signals; a signal of such a name has its first letter as %XX. */
#define TOPIC_STATE "state" /* of the node; below a chip, of that */
#define TOPIC_HEALTH "health"
#define TOPIC_CHIP "chip"
#define TOPIC_RESULT "result"   /* beside commands */
#define TOPIC_READ "read"       /* likewise */
#define TOPIC_RENAME "rename"   /* likewise */
#define TOPIC_PROBLEM "problem" /* below a chip */

/* The level of a signal: '+', '#', '/' and '%' as %XX. name: at most 63 bytes. */
void topic_escape(const char *name, char level[TOPIC_NAME]);
/*
 * The text in lower case, with one dash for each run of what is no letter or digit of ASCII: what
 * the conventions let stand in an id. Other texts may have the same.
 */
void topic_slug(const char *text, char dash, char *id, size_t size);
/* The text with '_' for all but letters, digits, '-' and '_', as Home Assistant takes ids. */
void topic_id(const char *text, char *id, size_t size);
