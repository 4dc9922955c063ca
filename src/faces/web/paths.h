/* SPDX-License-Identifier: MIT */
/* The functions behind the paths (api.c), as struct web_path has them. */
#pragma once

#include "src/faces/web/web.h"

struct config;

/* A path (without the first "/"); NULL: there is none. */
const struct web_path *api_find(const char *path, bool post);

/* What owsd has now besides values: present alarms, targets, counters, the log. */
void lists_alarms(struct json *json, const struct request *request);
void lists_stats(struct json *json, const struct request *request);
void lists_log(struct json *json, const struct request *request);

/* This machine in a line, and what the pages of others say of theirs. */
void machines_summary(struct json *json, const struct request *request);
void machines_others(struct json *json, const struct request *request);

/* GET api/special?name=: the special signals of a signal. */
int special_get(struct request *request);

/* What a person may do: set outputs, acknowledge and shelve alarms. */
int command_set(struct request *request);
int command_alarm(struct request *request);

/*
 * GET api/devices: the devices on the buses of owsd, whether they have signals or not. With ids=
 * those devices alone, read past the cache. One scan at a time.
 */
int devices_get(struct request *request);

/* POST api/config/save and api/config/restore: what the writer does with the file. */
int save_post(struct request *request);
int save_restore(struct request *request);

/* The configuration as it is on disk, and the table of its keys. */
int stored_get(struct request *request);
void stored_keys(struct json *json, const struct request *request);

/* What the recorder kept: trends, and the journals together with those of owsd's memory. */
int past_trend(struct request *request);
/* The last hour of the first 200 signals, in stretches of two minutes. */
int past_hour(struct request *request);
int past_records(struct request *request);
int past_journal(struct request *request);
/* Has this instance a history? Looks at the directory. */
bool past_is_there(const char *instance, const struct config *config);
