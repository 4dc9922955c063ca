/* SPDX-License-Identifier: MIT */
/* The functions behind the paths (api.c), as struct web_path has them. */
#pragma once

struct request;
struct json;

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
