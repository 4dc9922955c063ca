/* SPDX-License-Identifier: MIT */
/* The state of owsd, its targets, devices and counters, or the last ones of an owsd that ended. */
#pragma once

#include <stdbool.h>

#include "src/faces/show/json.h"
#include "src/faces/show/when.h"
#include "src/ground/signal/quality.h"
#include "src/public/ows.h"

/* The health of devices: what their signals and counters say of them. */

/* HEALTH_MAINTENANCE: of 1000 requests and more since owsd started, one of a hundred failed. */
enum device_health health_of_wire(const struct ows_device *device);
/*
 * What nobody has set yet and a key that is away are as they should be; what is simulated is no
 * measurement.
 */
enum device_health health_of_signal(const struct ows_info *info, uint8_t quality, bool simulated);
/* By NE 107 a failure counts for more than a check, that for more than off spec, and so on. */
enum device_health health_worse(enum device_health a, enum device_health b);
/* The worst of its wire and its signals, of the first count devices as of ows_device(). */
void health_devices(struct ows *h, int64_t now_ns, enum device_health *healths, int count);
/* The device of that ROM id, and its index as of ows_device(); -1: there is none. */
int health_find(struct ows *h, const char *id, struct ows_device *device);
/* Is the signal the presence of a key, which comes and goes? */
bool health_is_key(const struct ows_info *info);

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
