/* SPDX-License-Identifier: MIT */
/* What the recorder kept: trends, and the journals together with those of owsd's memory. */
#pragma once

#include <stdbool.h>

struct config;
struct request;

/* Has this instance a history? Looks at the directory. */
bool past_is_there(const char *instance, const struct config *config);
int past_trend(struct request *request);
/* The last hour of the first 200 signals, in stretches of two minutes. */
int past_hour(struct request *request);
int past_records(struct request *request);
int past_journal(struct request *request);
