/* SPDX-License-Identifier: MIT */
/* The health of devices: what their signals and counters say of them. */
#pragma once

#include <stdbool.h>

#include "src/ground/signal/quality.h"
#include "src/public/ows.h"

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
