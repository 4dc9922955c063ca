/* SPDX-License-Identifier: MIT */
/*
 * Lines of InfluxDB's line protocol: a point each, with a time in nanoseconds. The rules are those
 * of its documentation ("Line protocol"): comma, blank and equals sign are escaped in tags, quote
 * and backslash in texts; a line ends with a line feed, so none can be in it. Pure.
 *
 *     ows,identity=/28.FF01/power,instance=OWS,signal=a,unit=V value=21.5 1700000000000000000
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "src/ground/signal/value.h"

#define INFLUX_SERIES 1024
#define INFLUX_MEASUREMENT "ows"
/* A text whose bytes are all escaped. */
#define INFLUX_FIELDS (2 * VALUE_STRING_MAX + 64)

/*
 * The begin of a line: measurement and tags. A tag that is empty, or that no line can have (a
 * control character; a backslash, which would take the next one with it), is left out. measurement
 * has nothing to be escaped. false: it does not fit, or there is no tag `signal`.
 */
bool influx_series(const char *measurement, const char *identity, const char *instance,
                   const char *signal, const char *unit, char series[INFLUX_SERIES]);

/*
 * The fields of a good value: `value`, a float for each type of number, as a field has one type in
 * all series; for a 64 bit number also `integer`, which is exact; for a string `text`. false: one
 * that no line can have (a control character, an infinity), or one that is too long.
 */
bool influx_fields(enum ows_type type, double number, int64_t integer, const char *text, size_t len,
                   char fields[INFLUX_FIELDS]);
