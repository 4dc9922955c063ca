/* SPDX-License-Identifier: MIT */
/*
 * Writes a JSON document piece by piece. The writer knows no depth: it keeps only whether the next
 * value needs a comma, and the end of an object or array leaves that true for the one around it.
 */
#include <inttypes.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/faces/show/json.h"
#include "src/ground/signal/utf8.h"
#include "src/ground/signal/value.h"

#define BROWSER_MOST ((INT64_C(1) << 53) - 1)

void json_open(struct json *json, FILE *out)
{
	json->out = out;
	json->inner = false;
}

void json_end(struct json *json)
{
	putc('\n', json->out);
	json->inner = false;
}

void json_list(struct json *json, FILE *out, bool wanted)
{
	json_open(json, out);
	json->list = wanted;
	if (wanted)
		json_array(json, NULL);
}

void json_list_end(struct json *json)
{
	if (!json->list)
		return;
	json_array_end(json);
	json_end(json);
}

bool json_start(struct json *json, char **text, size_t *len)
{
	*text = NULL;
	json_open(json, open_memstream(text, len));
	if (json->out)
		json_object(json, NULL);
	return json->out;
}

void json_finish(struct json *json)
{
	json_object_end(json);
	json_end(json);
	fclose(json->out);
}

static void put_string(FILE *out, const char *text, size_t len)
{
	putc('"', out);
	while (len > 0) {
		const char *at = text;
		int32_t c = utf8_next(&text, &len);

		if (c < 0)
			fputs("\xef\xbf\xbd", out);
		else if (c == '"' || c == '\\')
			fprintf(out, "\\%c", (char)c);
		else if (c == '\n')
			fputs("\\n", out);
		else if (c < 0x20 || (c >= 0x7f && c < 0xa0))
			fprintf(out, "\\u%04x", (unsigned)c);
		else
			fwrite(at, 1, (size_t)(text - at), out);
	}
	putc('"', out);
}

static void json_begin(struct json *json, const char *key)
{
	if (json->inner)
		putc(',', json->out);
	json->inner = true;
	if (key) {
		put_string(json->out, key, strlen(key));
		putc(':', json->out);
	}
}

void json_key(struct json *json, const char *key)
{
	json_begin(json, key);
	json->inner = false;
}

void json_object(struct json *json, const char *key)
{
	json_begin(json, key);
	putc('{', json->out);
	json->inner = false;
}

void json_object_end(struct json *json)
{
	putc('}', json->out);
	json->inner = true;
}

void json_array(struct json *json, const char *key)
{
	json_begin(json, key);
	putc('[', json->out);
	json->inner = false;
}

void json_array_end(struct json *json)
{
	putc(']', json->out);
	json->inner = true;
}

void json_string(struct json *json, const char *key, const char *text)
{
	if (text)
		json_bytes(json, key, text, strlen(text));
	else
		json_null(json, key);
}

void json_bytes(struct json *json, const char *key, const char *text, size_t len)
{
	json_begin(json, key);
	put_string(json->out, text, len);
}

static bool is_utf8(const char *text, size_t len)
{
	while (len > 0)
		if (utf8_next(&text, &len) < 0)
			return false;
	return true;
}

void json_text(struct json *json, const char *text, size_t len)
{
	json_bytes(json, "value", text, len);
	if (is_utf8(text, len))
		return;
	json_begin(json, "hex");
	putc('"', json->out);
	for (size_t i = 0; i < len; i++)
		fprintf(json->out, "%02x", (unsigned char)text[i]);
	putc('"', json->out);
}

void json_int(struct json *json, const char *key, int64_t number)
{
	json_begin(json, key);
	fprintf(json->out, "%" PRId64, number);
}

void json_uint(struct json *json, const char *key, uint64_t number)
{
	json_begin(json, key);
	fprintf(json->out, "%" PRIu64, number);
}

void json_exact(struct json *json, const char *key, int64_t number)
{
	char text[VALUE_TEXT_MAX];

	if (number >= -BROWSER_MOST && number <= BROWSER_MOST) {
		json_int(json, key, number);
		return;
	}
	value_to_text(OWS_LARGE, number, text);
	json_string(json, key, text);
}

void json_known(struct json *json, const char *key, int number)
{
	if (number >= 0)
		json_int(json, key, number);
	else
		json_null(json, key);
}

void json_bool(struct json *json, const char *key, bool value)
{
	json_begin(json, key);
	fputs(value ? "true" : "false", json->out);
}

void json_null(struct json *json, const char *key)
{
	json_begin(json, key);
	fputs("null", json->out);
}

void json_seconds(struct json *json, const char *key, int64_t ns)
{
	int64_t ms = ns / NS_PER_MS;

	json_begin(json, key);
	if (ms < 0)
		putc('-', json->out);
	fprintf(json->out, "%" PRIu64 ".%03u", (uint64_t)imaxabs(ms / 1000),
	        (unsigned)imaxabs(ms % 1000));
}

static bool skip_digits(const char **at, const char *end)
{
	const char *first = *at;

	while (*at < end && **at >= '0' && **at <= '9')
		(*at)++;
	return *at > first;
}

bool json_is_number(const char *at, size_t len)
{
	const char *end = at + len, *first;

	at += at < end && *at == '-';
	first = at;
	if (!skip_digits(&at, end) || (*first == '0' && at - first > 1))
		return false;
	if (at < end && *at == '.') {
		at++;
		if (!skip_digits(&at, end))
			return false;
	}
	if (at < end && (*at == 'e' || *at == 'E')) {
		at++;
		at += at < end && (*at == '+' || *at == '-');
		if (!skip_digits(&at, end))
			return false;
	}
	return at == end;
}

void json_number(struct json *json, const char *key, const char *text)
{
	json_begin(json, key);
	fputs(text && json_is_number(text, strlen(text)) ? text : "null", json->out);
}

void json_double(struct json *json, const char *key, double number)
{
	char text[VALUE_TEXT_MAX];

	value_to_text(OWS_DOUBLE, value_of_double(number), text);
	json_number(json, key, text);
}
