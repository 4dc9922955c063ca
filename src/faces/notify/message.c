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
#include "src/ground/signal/quality.h"
#include "src/ground/signal/value.h"
#include "src/ground/text/printable.h"

#define BYTES_MAX 3500 /* Telegram takes 4096 letters, ntfy as many bytes */
#define WORD_BYTES 20  /* of a header: each is three letters, and RFC 2047 wants 75 at most */

#define UNIT_TEXT 32
#define ENDED 64 /* bytes of a text for how it ended */

static void add(struct entry *entry, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void add_args(struct entry *entry, const char *format, va_list args)
	__attribute__((format(printf, 2, 0)));
static void add_args(struct entry *entry, const char *format, va_list args)
{
	size_t len = strlen(entry->text);

	vsnprintf(entry->text + len, sizeof(entry->text) - ENDED - len, format, args);
}

static void add(struct entry *entry, const char *format, ...)
{
	va_list args;

	va_start(args, format);
	add_args(entry, format, args);
	va_end(args);
}

/* What was added is a line now. */
static void make_line(struct entry *entry)
{
	size_t len = printable_cut(entry->text, strlen(entry->text));

	entry->len = (unsigned)printable(entry->text, len);
	entry->text[entry->len] = '\0';
	if (*entry->text == '-')
		*entry->text = '?';
	entry->head = (unsigned)strcspn(entry->text, ";");
}

void message_line(struct entry *entry, const char *format, ...)
{
	va_list args;

	entry->text[0] = '\0';
	va_start(args, format);
	add_args(entry, format, args);
	va_end(args);
	make_line(entry);
}

/* Seconds are enough, and the offset is that of this machine. */
static const char *moment(const struct when *now, int64_t boot_ns, char text[WHEN_TEXT])
{
	when_iso(now, boot_ns, text);
	text[strcspn(text, ".")] = '\0';
	return text;
}

static void add_since(struct entry *entry, const char *word, int64_t since_ns,
                      const struct when *now)
{
	char since[WHEN_TEXT];

	entry->since_ns = since_ns;
	add(entry, "; %s ", word);
	/* as make_line() leaves what stands before it: what is not UTF-8 becomes shorter */
	entry->at = (unsigned)printable(entry->text, strlen(entry->text));
	entry->text[entry->at] = '\0';
	add(entry, "%s", moment(now, since_ns, since));
}

void message_renew(struct entry *entry, const struct when *now)
{
	char text[WHEN_TEXT];

	moment(now, entry->since_ns, text);
	if (entry->at && entry->at + strlen(text) <= entry->len)
		memcpy(entry->text + entry->at, text, strlen(text));
	entry->text[entry->len] = '\0';
	if (entry->ended)
		snprintf(entry->text + entry->len, ENDED, "; %s at %s", entry->ended,
		         moment(now, entry->ended_ns, text));
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

static bool is_value_limit(uint8_t kind)
{
	return kind < sizeof(limits) / sizeof(limits[0]) && limits[kind].name;
}

/* "10 °C below LimitLL -30 °C", if it has a limit, and there is a number. */
static void add_limit(struct entry *entry, const struct ows_info *info, uint8_t kind, double number)
{
	const char *blank = *info->unit ? " " : "";
	char by[VALUE_TEXT_MAX], at[VALUE_TEXT_MAX];
	double limit;

	if (!is_value_limit(kind))
		return;
	memcpy(&limit, (const char *)info + limits[kind].at, sizeof(limit));
	if (isnan(limit) || isnan(number))
		return;
	digits_print(OWS_DOUBLE, fabs(number - limit), 0, info->decimals, by);
	digits_print(OWS_DOUBLE, limit, 0, info->decimals, at);
	add(entry, "; %s%s%s %s %s %s%s%s", by, blank, info->unit,
	    number >= limit ? "above" : "below", limits[kind].name, at, blank, info->unit);
}

/* Where it is, and what it is. chip: for what a person has to look at there. */
static void add_place(struct entry *entry, const struct ows_info *info, bool chip)
{
	if (chip && *info->device)
		add(entry, "; %s%s%s", info->family, *info->family ? " " : "", info->device);
	if (*info->group)
		add(entry, "; %s", info->group);
	if (*info->description)
		add(entry, "; %s", info->description);
}

/* "high", "no longer high", "device alarm is over" */
static void add_kind(struct entry *entry, const struct ows_alarm *alarm)
{
	const char *word = alarm_word(alarm->kind, alarm->event);
	bool back = alarm->event == OWS_ALARM_RETURNED;

	if (back && alarm->kind == OWS_ALARM_DEVICE)
		word = "device alarm is over";
	else if (back && alarm->kind == OWS_ALARM_DIFFERS)
		word = "as commanded again";
	if (*word)
		add(entry, "%s", word);
	else
		add(entry, "%s%s", back ? "no longer " : "", ows_alarm_kind_text(alarm->kind));
}

/* The value before or after it, with the unit. Returns text. */
static const char *number_text(const struct ows_info *info, const struct ows_alarm *alarm,
                               bool after, char text[VALUE_TEXT_MAX + UNIT_TEXT])
{
	size_t len;

	digits_print((enum ows_type)alarm->type, after ? alarm->after : alarm->before,
	             after ? alarm->after_integer : alarm->before_integer, info->decimals, text);
	len = strlen(text);
	snprintf(text + len, UNIT_TEXT, "%s%s", *info->unit ? " " : "", info->unit);
	return text;
}

/* The value that it is about; of one that is not good there is no number. */
static void add_value(struct entry *entry, const struct ows_info *info,
                      const struct ows_alarm *alarm)
{
	char text[VALUE_TEXT_MAX + UNIT_TEXT], other[sizeof(text)];
	bool raised = alarm->event == OWS_ALARM_RAISED, after = alarm->has_after;
	bool number = alarm->type != OWS_STRING && (after || (raised && alarm->has_before));

	if (raised && alarm->kind == OWS_ALARM_DIFFERS && number && alarm->has_before) {
		add(entry, ": %s, written %s", number_text(info, alarm, after, text),
		    number_text(info, alarm, false, other));
	} else if (ows_good(alarm->quality) && number) {
		add(entry, ": %s", number_text(info, alarm, after, text));
		if (raised)
			add_limit(entry, info, alarm->kind, after ? alarm->after : alarm->before);
	} else if (raised && alarm->kind == OWS_ALARM_BAD) {
		add(entry, ": %s", ows_quality_text(alarm->quality));
	} else if (raised && !ows_good(alarm->quality)) {
		add(entry, "; value not good");
	}
	if (*alarm->text)
		add(entry, alarm->event == OWS_ALARM_FAILED ? ": %s" : "; its latch reads %s",
		    alarm->text);
}

/* What it means, and what to do: of a limit the words say it all. */
static void add_meaning(struct entry *entry, const struct ows_alarm *alarm)
{
	uint8_t quality = alarm->kind == OWS_ALARM_DIFFERS ? OWS_Q_DIFFERS
	                  : alarm->kind == OWS_ALARM_STALE ? OWS_Q_STALE
	                  : alarm->kind == OWS_ALARM_BAD   ? alarm->quality
	                                                   : OWS_Q_GOOD;
	const char *cause = alarm_cause(alarm->kind, alarm->event);

	if (*cause)
		add(entry, "; %s %s", cause, alarm_remedy(alarm->kind, alarm->event));
	else if (alarm->event == OWS_ALARM_RAISED && *quality_cause(quality))
		add(entry, "; %s %s", quality_cause(quality), quality_remedy(quality));
}

void message_alarm(struct entry *entry, const struct ows_info *info, const struct ows_alarm *alarm,
                   const struct when *now)
{
	entry->entered_ns = alarm->occurred_ns;
	entry->kind = alarm->event == OWS_ALARM_RAISED ? alarm->kind : 0;
	add(entry, "%s ", info->name);
	add_kind(entry, alarm);
	add_value(entry, info, alarm);
	add_since(entry, alarm->event == OWS_ALARM_RETURNED ? "at" : "since", alarm->occurred_ns,
	          now);
	add_place(entry, info, !is_value_limit(alarm->kind));
	add_meaning(entry, alarm);
	make_line(entry);
}

void message_bad(struct entry *entry, const struct ows_info *info, int64_t bad_ns, const char *why,
                 const char *remedy, const struct when *now)
{
	char span[WHEN_TEXT];

	entry->kind = ENTRY_BAD;
	add(entry, "%s bad: %s; for %s", info->name, why, when_span(now->boot - bad_ns, span));
	add_since(entry, "since", bad_ns, now);
	add_place(entry, info, true);
	if (*remedy)
		add(entry, "; %s", remedy);
	make_line(entry);
}

void message_escalated(struct entry *entry, const struct ows_info *info, uint8_t kind,
                       int64_t raised_ns, const char *text, const struct when *now)
{
	char span[WHEN_TEXT];

	entry->escalated = true;
	entry->entered_ns = raised_ns;
	entry->kind = kind;
	entry->text[0] = '\0'; /* it may be said anew */
	add(entry, "%s %s: %s%s%s; nobody has acknowledged this for %s", info->name,
	    ows_alarm_kind_text(kind), text, *info->unit && *text ? " " : "",
	    *text ? info->unit : "", when_span(now->boot - raised_ns, span));
	add_since(entry, "since", raised_ns, now);
	add_place(entry, info, !is_value_limit(kind));
	make_line(entry);
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
