/* SPDX-License-Identifier: MIT */
/* Points as InfluxDB's line protocol. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "src/ground/text/influx.h"

static bool is_control(char c)
{
	return (unsigned char)c < ' ' || c == 127;
}

/* last: the last byte of the room. Returns the end, or NULL: no room. */
static char *influx_put(char *at, const char *last, const char *text)
{
	size_t len = strlen(text);

	if (!at || (size_t)(last - at) < len)
		return NULL;
	memcpy(at, text, len + 1);
	return at + len;
}

static bool is_tag(const char *text)
{
	for (const char *c = text; *c; c++)
		if (is_control(*c) || *c == '\\')
			return false;
	return *text;
}

static char *put_tag(char *at, const char *last, const char *key, const char *text)
{
	if (!is_tag(text))
		return at;
	at = influx_put(at, last, key);
	for (; at && *text; text++) {
		const char one[] = {*text, '\0'};

		if (strchr(",= ", *text))
			at = influx_put(at, last, "\\");
		at = influx_put(at, last, one);
	}
	return at;
}

bool influx_series(const char *measurement, const char *identity, const char *instance,
                   const char *signal, const char *unit, char series[INFLUX_SERIES])
{
	const char *last = &series[INFLUX_SERIES - 1];
	char *at = influx_put(series, last, measurement);

	at = put_tag(at, last, ",identity=", identity);
	at = put_tag(at, last, ",instance=", instance);
	at = put_tag(at, last, ",signal=", signal);
	return put_tag(at, last, ",unit=", unit) && is_tag(signal);
}

static bool text_field(const char *text, size_t len, char fields[INFLUX_FIELDS])
{
	char *at = stpcpy(fields, "text=\"");

	if (len > VALUE_STRING_MAX)
		return false;
	for (size_t i = 0; i < len; i++) {
		if (is_control(text[i]))
			return false;
		if (text[i] == '"' || text[i] == '\\')
			*at++ = '\\';
		*at++ = text[i];
	}
	memcpy(at, "\"", 2);
	return true;
}

bool influx_fields(enum ows_type type, double number, int64_t integer, const char *text, size_t len,
                   char fields[INFLUX_FIELDS])
{
	char value[VALUE_TEXT_MAX];
	int n;

	if (type == OWS_STRING)
		return text_field(text, len, fields);
	if (!isfinite(number))
		return false;
	value_to_text(type, value_is_float(type) ? value_of_double(number) : integer, value);
	n = snprintf(fields, INFLUX_FIELDS, "value=%s", value);
	if (type == OWS_LARGE)
		snprintf(fields + n, INFLUX_FIELDS - (size_t)n, ",integer=%" PRId64 "i", integer);
	return true;
}
