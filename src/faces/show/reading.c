/* SPDX-License-Identifier: MIT */
/* Prints a value, its quality and its error, for persons and as JSON. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "src/faces/show/digits.h"
#include "src/faces/show/newest.h"
#include "src/faces/show/reading.h"
#include "src/faces/show/text.h"
#include "src/ground/signal/value.h"

int reading_get(struct ows *h, int id, int64_t now_ns, struct reading *reading)
{
	int err;

	memset(&reading->value, 0, sizeof(reading->value));
	reading->text[0] = '\0';
	err = ows_get_text(h, id, now_ns, &reading->value, reading->text, sizeof(reading->text));
	reading->err = err == -ENOSPC ? 0 : err;
	reading->len = strlen(reading->text);
	if (reading->value.type == OWS_STRING && reading->value.len > reading->len &&
	    reading->value.len < sizeof(reading->text) && err == 0)
		reading->len = reading->value.len;
	return reading->err;
}

void reading_round(struct reading *reading, int decimals)
{
	const struct ows_value *value = &reading->value;

	if (!reading_filled(reading) || value->type == OWS_STRING)
		return;
	digits_print((enum ows_type)value->type, value->number, value->integer, decimals,
	             reading->text);
	reading->len = strlen(reading->text);
}

bool reading_filled(const struct reading *reading)
{
	return face_value_counts(reading->err);
}

bool reading_has_value(const struct reading *reading)
{
	bool is_zero = reading->value.type == OWS_STRING ? !reading->len
	                                                 : reading->value.number == 0;

	return reading_filled(reading) &&
	       (reading->value.measured_ns || reading_good(reading) || !is_zero);
}

bool reading_good(const struct reading *reading)
{
	return reading->err == 0 && ows_good(reading->value.quality);
}

const char *reading_quality(const struct reading *reading, char words[READING_WORDS])
{
	snprintf(words, READING_WORDS, "%s%s",
	         reading_filled(reading) ? ows_quality_text(reading->value.quality)
	                                 : error_text(reading->err),
	         reading->value.detail & OWS_DETAIL_SIMULATED ? " (sim)" : "");
	return words;
}

const char *reading_why(const struct reading *reading, char words[READING_WORDS])
{
	const struct ows_value *value = &reading->value;
	char span[WHEN_TEXT], error[ERROR_WORDS + 4] = "", own[ERROR_WORDS];

	if (!reading_filled(reading)) {
		snprintf(words, READING_WORDS, "%s", error_text(reading->err));
		return words;
	}
	if (value->err) {
		/* do not repeat the quality: "no such property (check its spelling ...)" */
		bool same = strcmp(ows_quality_text(value->quality), error_text(value->err)) == 0;

		snprintf(error, sizeof(error), " (%s)",
		         same ? error_remedy(value->err) : error_words(value->err, own));
	}
	if (value->measured_ns)
		snprintf(words, READING_WORDS, "%s%s, measured %s ago",
		         ows_quality_text(value->quality), error, when_span(value->age_ns, span));
	else
		snprintf(words, READING_WORDS, "%s%s, never measured",
		         ows_quality_text(value->quality), error);
	return words;
}

void reading_show(const struct reading *reading, char *out, size_t size)
{
	size_t len;

	if (!reading_filled(reading)) {
		snprintf(out, size, "-");
	} else if (reading->value.type != OWS_STRING) {
		snprintf(out, size, "%s", reading->text);
	} else {
		out[0] = '"';
		text_clean(reading->text, reading->len, (unsigned)size - 3, out + 1, size - 2);
		len = strlen(out);
		memcpy(out + len, "\"", 2);
	}
}

void reading_json_number(struct json *json, const char *key, const struct ows_value *value,
                         const char *text)
{
	if (value->type == OWS_STRING)
		json_string(json, key, text);
	else if (value->type == OWS_BOOL)
		json_bool(json, key, value->integer != 0);
	else if (value_is_float((enum ows_type)value->type))
		json_number(json, key, text);
	else if (value_type_ok(value->type))
		json_int(json, key, value->integer);
	else
		json_null(json, key);
}

static void json_when(struct json *json, const char *key, const struct when *now, int64_t ns)
{
	char text[WHEN_TEXT];

	json_string(json, key, ns ? when_iso(now, ns, text) : NULL);
}

void reading_json(struct json *json, struct ows *h, const struct reading *reading,
                  const struct when *now)
{
	const struct ows_value *value = &reading->value;
	struct ows_target target;

	if (!reading_filled(reading)) {
		json_null(json, "value");
		json_bool(json, "good", false);
		json_string(json, "error", error_text(reading->err));
		return;
	}
	if (!reading_has_value(reading))
		json_null(json, "value");
	else if (reading->value.type == OWS_STRING)
		json_text(json, reading->text, reading->len);
	else
		reading_json_number(json, "value", &reading->value, reading->text);
	json_string(json, "type", value_type_name((enum ows_type)value->type));
	json_bool(json, "good", reading_good(reading));
	json_string(json, "quality", ows_quality_text(value->quality));
	json_int(json, "quality_code", value->quality);
	json_seconds(json, "age", value->age_ns);
	json_when(json, "measured", now, value->measured_ns);
	json_when(json, "tried", now, value->tried_ns);
	json_int(json, "err", value->err);
	json_string(json, "error", value->err ? error_text(value->err) : NULL);
	json_uint(json, "count", value->count);
	json_uint(json, "applied", value->applied);
	json_string(json, "target",
	            ows_target(h, value->target, &target) == 0 ? target.name : NULL);
	json_bool(json, "simulated", value->detail & OWS_DETAIL_SIMULATED);
	json_bool(json, "cached", value->detail & OWS_DETAIL_CACHED);
}
