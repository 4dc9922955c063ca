/* SPDX-License-Identifier: MIT */
/* The words: of an alarm in a line, and of several in a mail, as JSON, or for a command. Pure. */
#pragma once

#include <stdio.h>

#include "src/faces/notify/queue.h"
#include "src/faces/show/when.h"
#include "src/public/ows.h"

/* "freezer low low: -40 °C; 10 °C below LimitLL -30 °C; since 2026-11-29T02:13:05; Cellar" */
void message_alarm(struct entry *entry, const struct ows_info *info, const struct ows_alarm *alarm,
                   const struct when *now);
/* Of a value that stays bad since then. */
void message_bad(struct entry *entry, const struct ows_info *info, int64_t bad_ns, const char *why,
                 const char *remedy, const struct when *now);
/* Of an alarm that nobody has acknowledged, also once more; text: its value. */
void message_escalated(struct entry *entry, const struct ows_info *info, uint8_t kind,
                       int64_t raised_ns, const char *text, const struct when *now);
/* Before it is told: its time by the clock as it is now, and how it ended. */
void message_renew(struct entry *entry, const struct when *now);
/* Make the line printable, and no option of a program that gets it; find its head. */
void message_line(struct entry *entry, const char *format, ...)
	__attribute__((format(printf, 2, 3)));

struct message {
	const char *instance, *host, *link, *fields; /* link, fields: NULL: none */
	const struct entry *list[QUEUE_ENTRIES];
	unsigned count;  /* of those that it names, at least 1 */
	size_t bytes;    /* of their lines */
	uint64_t others; /* that it only counts: the journal has them */
};

/* Name the entry, or count it where the message would be longer than servers of messages take. */
void message_add(struct message *message, const struct entry *entry);

#define MESSAGE_TITLE 256
/* Returns title: one line, printable. */
const char *message_title(const struct message *message, char title[MESSAGE_TITLE]);
void message_text(const struct message *message, FILE *out);
/* A whole mail. from NULL: the program that takes it knows one. */
void message_mail(const struct message *message, const char *to, const char *from, FILE *out);
void message_json(const struct message *message, FILE *out);
/* Url with {token} in it replaced. False: it has none, or there is no room. */
bool message_url(const char *url, const char *token, char *out, size_t size);
