/* SPDX-License-Identifier: MIT */
/* The state of owsd, its targets, devices and counters, or the last ones of an owsd that ended. */
#pragma once

#include <stdbool.h>

#include "src/faces/show/health.h"
#include "src/faces/show/json.h"
#include "src/faces/show/when.h"
#include "src/public/ows.h"

#define STATS_TARGETS 255

/* "live", "dead", "retired", "stopped"; "down", "up", "suspended". */
const char *stats_daemon_state(const struct ows_daemon *daemon);
const char *stats_target_state(uint32_t state);
/* Count the signals of the table that are not good. */
int stats_not_good(struct ows *h, int64_t now_ns);
/* How many signals each target serves now. */
void stats_served(struct ows *h, int64_t now_ns, unsigned served[STATS_TARGETS + 1]);
/* The health of each device, in the order of ows_device(), for free(); NULL: no memory. */
enum device_health *stats_healths(struct ows *h, int64_t now_ns);
/* "parasite", "external"; NULL: not known. */
const char *stats_power(uint32_t power);
/* Does the target of the device say what requests cost? Else retries and wire_us mean nothing. */
bool stats_device_costs(const struct ows_device *device);
/* The members "instance" and "host": which owsd, of which machine. */
void stats_whose(struct json *json, const char *instance);
/* All of it as members of an object. */
void stats_json(struct json *json, const char *instance, struct ows *h,
                const struct ows_daemon *daemon, const struct when *now);
