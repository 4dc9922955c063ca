/* SPDX-License-Identifier: MIT */
/* What the text of a key may be, each by itself. */
#include <string.h>
#include <time.h>

#include "src/config/read/config.h"
#include "src/config/read/texts.h"
#include "src/ground/signal/utf8.h"

#define LONG_MAX_BYTES 255 /* of a path or another long text */
#define NAME_MAX_BYTES 63
#define SOCKET_MAX_BYTES 107
#define UNIT_MAX_BYTES 16
#define CLASS_MAX_BYTES 31
#define HOST_CHARS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-_, \t"
#define PROFILE_TEXT(name) #name,

/* Has it only these letters, and no more than that? */
static bool is_of(const char *text, const char *letters, size_t most)
{
	size_t len = strlen(text);

	return strspn(text, letters) == len && len <= most;
}

const char *text_is_short(const char *text)
{
	return strlen(text) <= LONG_MAX_BYTES ? NULL : "expected at most 255 bytes";
}

const char *text_is_path(const char *text)
{
	return text[0] == '/' && strlen(text) <= LONG_MAX_BYTES
	               ? NULL
	               : "expected a path from the root, at most 255 bytes";
}

const char *text_is_socket(const char *text)
{
	return text[0] == '/' && strlen(text) <= SOCKET_MAX_BYTES
	               ? NULL
	               : "expected a path from the root, at most 107 bytes";
}

const char *text_is_file(const char *text)
{
	return !text_is_path(text) || (is_of(text, TEXT_LETTERS, LONG_MAX_BYTES) && text[0] != '.')
	               ? NULL
	               : "expected a path from the root, or the name of a credential";
}

const char *text_is_name(const char *text)
{
	return is_of(text, TEXT_LETTERS, NAME_MAX_BYTES)
	               ? NULL
	               : "expected letters, digits, '-', '_' and '.', at most 63";
}

const char *text_is_url(const char *url)
{
	const char *host = strncmp(url, "http://", 7) == 0    ? url + 7
	                   : strncmp(url, "https://", 8) == 0 ? url + 8
	                                                      : NULL;
	const char *precision;

	if (!host || !strcspn(host, "/?#") || strlen(url) > LONG_MAX_BYTES)
		return "expected http://HOST:PORT/PATH or https://..., at most 255 bytes";
	for (const char *c = url; *c; c++)
		if (*c <= ' ' || *c >= 127)
			return "expected no blank and no special letter: write it as %20";
	if (memchr(host, '@', strcspn(host, "/?#")) || strstr(url, "?p=") || strstr(url, "&p="))
		return "no password stands in a Url: put USER:PASSWORD into the file of TokenFile";
	precision = strstr(url, "precision=");
	if (precision && (precision[10] != 'n' || strcspn(precision + 10, "&") > 2))
		return "the times are in nanoseconds: leave precision out";
	return NULL;
}

/* No blank and no line end: the addresses stand in the header of a mail. */
const char *text_is_mail(const char *text)
{
	static const char why[] = "expected ADDRESS, or several with commas, at most 255 bytes";

	for (const char *one = text;; one += strspn(one, " ")) {
		size_t user = strspn(one, TEXT_LETTERS "+%="), host = 0;

		if (one[user] == '@')
			host = 1 + strspn(one + user + 1, TEXT_LETTERS);
		/* nor what a program would take for an option */
		if (!user || host == 1 || *one == '-')
			return why;
		one += user + host;
		if (!*one)
			return strlen(text) <= LONG_MAX_BYTES ? NULL : why;
		if (*one++ != ',')
			return why;
	}
}

const char *text_is_fields(const char *text)
{
	const char *why = text_is_line(text);

	for (const char *one = text + strspn(text, " "); !why && *one; one += strspn(one, " ")) {
		size_t len = strcspn(one, " "), name = strcspn(one, "= ");

		if (!name || name == len)
			why = "expected NAME=TEXT, with blanks between them and none in TEXT";
		one += len;
	}
	return why;
}

static bool take_minutes(const char *text, unsigned *minutes)
{
	static const char digits[] = "0123456789";

	if (strspn(text, digits) != 2 || text[2] != ':' || strspn(text + 3, digits) != 2)
		return false;
	*minutes = (unsigned)(((text[0] - '0') * 10 + text[1] - '0') * 60 + (text[3] - '0') * 10 +
	                      text[4] - '0');
	return text[3] < '6' && *minutes <= 24 * 60;
}

bool text_hours(const char *text, unsigned *from, unsigned *until)
{
	return strlen(text) == strlen("22:00-06:30") && text[5] == '-' &&
	       take_minutes(text, from) && take_minutes(text + 6, until);
}

const char *text_is_hours(const char *text)
{
	unsigned from, until;

	return text_hours(text, &from, &until) && from != until
	               ? NULL
	               : "expected two times of a day, such as \"22:00-06:30\"";
}

const char *text_is_hosts(const char *hosts)
{
	return is_of(hosts, HOST_CHARS, SIZE_MAX)
	               ? NULL
	               : "expected names with commas between them, no ports";
}

static const char *check_utf8(const char *text)
{
	size_t left = strlen(text);

	while (left > 0) {
		int32_t code = utf8_next(&text, &left);

		if (code < 0)
			return "expected UTF-8: convert the file, as with iconv -f cp1250 -t utf-8";
		if (utf8_disturbs(code))
			return "expected no control character";
	}
	return NULL;
}

const char *text_is_unit(const char *text)
{
	return strlen(text) > UNIT_MAX_BYTES ? "expected at most 16 bytes" : check_utf8(text);
}

const char *text_is_line(const char *text)
{
	const char *why = text_is_short(text);

	return why ? why : check_utf8(text);
}

const char *text_is_date(const char *text)
{
	struct tm tm = {0}, day;
	const char *end = strptime(text, "%Y-%m-%d", &tm);

	/* timegm() takes the 30th of February for a day of March */
	day = tm;
	timegm(&day);
	/* no blanks, and no digit left out */
	return end && !*end && strspn(text, "0123456789-") == strlen("2026-11-22") &&
	                       day.tm_mday == tm.tm_mday
	               ? NULL
	               : "expected a date such as \"2026-11-22\"";
}

const char *text_is_class(const char *text)
{
	return is_of(text, "abcdefghijklmnopqrstuvwxyz0123456789_", CLASS_MAX_BYTES)
	               ? NULL
	               : "expected light, cover, or a device class such as door";
}

/* Names with slashes between them. */
const char *text_is_topic(const char *topic)
{
	return is_of(topic, TEXT_LETTERS "/", NAME_MAX_BYTES) && *topic && *topic != '/' &&
	                       topic[strlen(topic) - 1] != '/' && !strstr(topic, "//")
	               ? NULL
	               : "expected letters, digits, '-', '_', '.' and '/' between them, at most 63";
}

const char *text_is_profile(const char *profile)
{
	static const char *const words[] = {MQTT_PROFILES(PROFILE_TEXT)};

#ifndef OWSD_PROTOBUFC
	if (!strcmp(profile, "sparkplug"))
		return "owsd was built without libprotobuf-c";
#endif
	for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++)
		if (!strcmp(profile, words[i]))
			return NULL;
	return "expected one of" MQTT_PROFILES(MQTT_PROFILE_WORD);
}

const char *text_is_identity(const char *text)
{
	return *text == '/' && !text_is_line(text)
	               ? NULL
	               : "expected the path that the signal had, such as /28.FF01/temperature";
}
