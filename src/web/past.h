/* SPDX-License-Identifier: MIT */
/* What the recorder kept: trends, and the journals together with those of owsd's memory. */
#ifndef WEB_PAST_H
#define WEB_PAST_H

#include <stdbool.h>

struct config;
struct request;

/* Has this instance a history? Looks at the directory. */
bool past_is_there(const char *instance, const struct config *config);
int past_trend(struct request *request);
int past_journal(struct request *request);

#endif
