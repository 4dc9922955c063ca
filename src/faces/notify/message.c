/* SPDX-License-Identifier: MIT */
/* The words: of an alarm in a line, and of several in a mail, as JSON, or for a command. */
#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "src/faces/notify/message.h"
#include "src/faces/show/digits.h"
#include "src/faces/show/json.h"
#include "src/ground/signal/value.h"
#include "src/ground/text/printable.h"

#define BYTES_MAX 3500 /* Telegram takes 4096 letters, ntfy as many bytes */
#define WORD_BYTES 20  /* of a header: each is three letters, and RFC 2047 wants 75 at most */

void message_line(struct entry *entry, const char *format, ...)
{
	va_list args;
	size_t len;

	va_start(args, format);
	vsnprintf(entry->text, sizeof(entry->text), format, args);
	va_end(args);
	len = printable_cut(entry->text, strlen(entry->text));
	entry->text[printable(entry->text, len)] = '\0';
	if (*entry->text == '-')
		*entry->text = '?';
	entry->head = (unsigned)strcspn(entry->text, ";");
}

static const struct {
	const char *name;
	size_t at;
} limits[] = {
	[OWS_ALARM_HH] = {"LimitHH", offsetof(struct ows_info, limit_hh)},
	[OWS_ALARM_H] = {"LimitH", offsetof(struct ows_info, limit_h)},
	[OWS_ALARM_L] = {"LimitL", offsetof(struct ows_info, limit_l)},
	[OWS_ALARM_LL] = {"LimitLL", offsetof(struct ows_info, limit_ll)},
};

/* "10 °C below LimitLL -30 °C"; "": it has no limit, or no number. */
static void limit_words(const struct ows_info *info, uint8_t kind, double number, char words[192])
{
	const char *blank = *info->unit ? " " : "";
	char by[VALUE_TEXT_MAX], at[VALUE_TEXT_MAX];
	double limit;

	*words = '\0';
	if (kind >= sizeof(limits) / sizeof(limits[0]) || !limits[kind].name)
		return;
	memcpy(&limit, (const char *)info + limits[kind].at, sizeof(limit));
	if (isnan(limit) || isnan(number))
		return;
	digits_print(OWS_DOUBLE, fabs(number - limit), 0, info->decimals, by);
	digits_print(OWS_DOUBLE, limit, 0, info->decimals, at);
	snprintf(words, 192, "; %s%s%s %s %s %s%s%s", by, blank, info->unit,
	         number >= limit ? "above" : "below", limits[kind].name, at, blank, info->unit);
}

/* Seconds are enough, and the offset is that of this machine. */
static const char *moment(const struct when *now, int64_t boot_ns, char text[WHEN_TEXT])
{
	when_iso(now, boot_ns, text);
	text[strcspn(text, ".")] = '\0';
	return text;
}

void message_alarm(struct entry *entry, const struct ows_info *info, const struct ows_alarm *alarm,
                   const struct when *now)
{
	const char *kind = ows_alarm_kind_text(alarm->kind), *blank = *info->unit ? " " : "";
	bool back = alarm->event == OWS_ALARM_RETURNED, whole = alarm->has_after;
	bool has = alarm->has_after || (alarm->event == OWS_ALARM_RAISED && alarm->has_before);
	bool good = ows_good(alarm->quality);
	char value[VALUE_TEXT_MAX] = "", limit[192] = "", since[WHEN_TEXT];

	entry->entered_ns = alarm->occurred_ns;
	/* of a value that is not good there is no number */
	if (has && good && alarm->type != OWS_STRING)
		digits_print((enum ows_type)alarm->type, whole ? alarm->after : alarm->before,
		             whole ? alarm->after_integer : alarm->before_integer, info->decimals,
		             value);
	if (alarm->event == OWS_ALARM_RAISED && *value)
		limit_words(info, alarm->kind, whole ? alarm->after : alarm->before, limit);
	message_line(entry, "%s %s%s%s%s%s%s%s%s%s; %s %s%s%s%s%s", info->name,
	             back ? "no longer " : "", kind,
	             alarm->event == OWS_ALARM_FAILED ? " alarm does not work" : "",
	             *value ? ": " : "", value, *value ? blank : "", *value ? info->unit : "",
	             limit, good || back ? "" : "; value not good", back ? "at" : "since",
	             moment(now, alarm->occurred_ns, since), *alarm->text ? "; " : "", alarm->text,
	             *info->description ? "; " : "", info->description);
}

void message_escalated(struct entry *entry, const struct ows_info *info, uint8_t kind,
                       int64_t raised_ns, const char *text, const struct when *now)
{
	char since[WHEN_TEXT], span[WHEN_TEXT];

	entry->escalated = true;
	entry->entered_ns = raised_ns;
	message_line(entry, "%s %s: %s%s%s; nobody has acknowledged this for %s; since %s%s%s",
	             info->name, ows_alarm_kind_text(kind), text, *info->unit && *text ? " " : "",
	             *text ? info->unit : "", when_span(now->boot - raised_ns, span),
	             moment(now, raised_ns, since), *info->description ? "; " : "",
	             info->description);
}

void message_add(struct message *message, const struct entry *entry)
{
	size_t len = strlen(entry->text) + strlen("! \n");

	if (message->count && message->bytes + len > BYTES_MAX) {
		message->others++;
		return;
	}
	message->list[message->count++] = entry;
	message->bytes += len;
}

const char *message_title(const struct message *message, char title[MESSAGE_TITLE])
{
	const struct entry *first = message->list[0];
	uint64_t all = message->count + message->others;
	size_t len = printable_cut(first->text, first->head < 80 ? first->head : 80);
	char number[40] = "";

	if (all > 1)
		snprintf(number, sizeof(number), "%" PRIu64 " messages; ", all);
	snprintf(title, MESSAGE_TITLE, "%s%s%.*s%s [%.60s %.30s]", number,
	         first->escalated ? "Not acknowledged: " : "", (int)len, first->text,
	         all > 1 ? " and others" : "", message->host, message->instance);
	len = printable_cut(title, strlen(title));
	title[printable(title, len)] = '\0';
	return title;
}

void message_text(const struct message *message, FILE *out)
{
	for (unsigned i = 0; i < message->count; i++)
		fprintf(out, "%s%s\n", message->list[i]->critical ? "! " : "",
		        message->list[i]->text);
	if (message->others)
		fprintf(out, "%" PRIu64 " others: owsctl journal has them\n", message->others);
	fprintf(out, "\nowsd %s on %s\n", message->instance, message->host);
	if (message->link)
		fprintf(out, "%s\n", message->link);
}

/* RFC 2047: words none of which cuts a letter. */
static void put_encoded(FILE *out, const char *text)
{
	size_t len;

	for (size_t left = strlen(text); left; text += len, left -= len) {
		len = left > WORD_BYTES ? printable_cut(text, WORD_BYTES) : left;
		fputs("=?UTF-8?Q?", out);
		for (size_t i = 0; i < len; i++)
			if (isalnum((unsigned char)text[i]))
				fputc(text[i], out);
			else
				fprintf(out, "=%02X", (unsigned char)text[i]);
		fputs(left > len ? "?=\n " : "?=", out);
	}
}

static bool is_plain(const char *text)
{
	for (; *text; text++)
		if (*text < ' ' || *text > '~')
			return false;
	return true;
}

void message_mail(const struct message *message, const char *to, const char *from, FILE *out)
{
	char title[MESSAGE_TITLE];

	message_title(message, title);
	if (from)
		fprintf(out, "From: %s\n", from);
	fprintf(out, "To: %s\nSubject: ", to);
	/* a word of RFC 2047 in a name would be taken for one */
	if (is_plain(title) && !strstr(title, "=?"))
		fputs(title, out);
	else
		put_encoded(out, title);
	fputs("\nAuto-Submitted: auto-generated\nMIME-Version: 1.0\n"
	      "Content-Type: text/plain; charset=utf-8\nContent-Transfer-Encoding: 8bit\n\n",
	      out);
	message_text(message, out);
}

static void put_fields(struct json *json, const char *fields)
{
	char name[64], text[256];

	for (const char *one = fields + strspn(fields, " "); *one; one += strspn(one, " ")) {
		size_t len = strcspn(one, " "), equal = strcspn(one, "=");

		snprintf(name, sizeof(name), "%.*s", (int)equal, one);
		snprintf(text, sizeof(text), "%.*s", (int)(len - equal - 1), one + equal + 1);
		json_string(json, name, text);
		one += len;
	}
}

void message_json(const struct message *message, FILE *out)
{
	char title[MESSAGE_TITLE], *text = NULL;
	struct json json;
	size_t len;
	FILE *memory = open_memstream(&text, &len);
	bool critical = false;

	for (unsigned i = 0; i < message->count; i++)
		critical |= message->list[i]->critical;
	if (memory) {
		message_text(message, memory);
		fclose(memory);
	}
	json_open(&json, out);
	json_object(&json, NULL);
	put_fields(&json, message->fields ? message->fields : "");
	json_string(&json, "title", message_title(message, title));
	/* servers call it the one or the other */
	json_string(&json, "message", text);
	json_string(&json, "text", text);
	json_int(&json, "priority", critical ? 5 : 3);
	json_string(&json, "instance", message->instance);
	json_string(&json, "host", message->host);
	if (message->link)
		json_string(&json, "click", message->link);
	json_array(&json, "alarms");
	for (unsigned i = 0; i < message->count; i++) {
		json_object(&json, NULL);
		json_string(&json, "text", message->list[i]->text);
		json_bool(&json, "critical", message->list[i]->critical);
		json_bool(&json, "escalated", message->list[i]->escalated);
		json_object_end(&json);
	}
	json_array_end(&json);
	json_uint(&json, "others", message->others);
	json_object_end(&json);
	json_end(&json);
	free(text);
}

bool message_url(const char *url, const char *token, char *out, size_t size)
{
	const char *at = strstr(url, "{token}");

	return at && snprintf(out, size, "%.*s%s%s", (int)(at - url), url, token,
	                      at + strlen("{token}")) < (int)size;
}
