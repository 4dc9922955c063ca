/* SPDX-License-Identifier: MIT */
/* The strict look at the head of a request. */
#include <ctype.h>
#include <string.h>
#include <strings.h>

#include "src/faces/web/head.h"

struct part {
	const char *at;
	size_t len;
};

/* Headers that may stand once, because they decide something. */
static const char *const once[] = {
	"Host",   "Content-Length", "Content-Type",       "Origin", "Sec-Fetch-Site",
	"X-Owsd", "X-Remote-User",  "X-Remote-User-Name", "Expect", "Last-Event-ID",
};
#define ONCE (sizeof(once) / sizeof(once[0]))
enum { HOST, CONTENT_LENGTH };

struct seen {
	unsigned times[ONCE];
	size_t length; /* of the body */
	bool get, large;
};

/* Paths whose bodies have a configuration. */
static const char *const large[] = {"/api/config/draft", "/api/config/save"};

bool head_large(const char *path)
{
	for (size_t i = 0; i < sizeof(large) / sizeof(large[0]); i++)
		if (strcmp(path, large[i]) == 0)
			return true;
	return false;
}

static int head_refuse(int status, const char *reason, const char **why)
{
	*why = reason;
	return status;
}

static bool is_token(struct part part)
{
	for (size_t i = 0; i < part.len; i++) {
		unsigned char c = (unsigned char)part.at[i];

		if (!isalnum(c) && !strchr("!#$%&'*+-.^_`|~", c))
			return false;
	}
	return part.len > 0;
}

static bool head_is(struct part part, const char *word)
{
	return part.len == strlen(word) && strncasecmp(part.at, word, part.len) == 0;
}

/* The length of the line that begins there, -1: it has no end yet, -2: no line by the letter. */
static long line_length(const char *at, size_t len)
{
	for (size_t i = 0; i < len; i++) {
		unsigned char c = (unsigned char)at[i];

		if (c == '\r' && i + 1 == len)
			return -1;
		if (c == '\r' && at[i + 1] == '\n')
			return (long)i;
		if ((c < ' ' && c != '\t') || c == 0x7f)
			return -2;
	}
	return -1;
}

static bool is_large(struct part target)
{
	char path[32];

	if (target.len >= sizeof(path))
		return false;
	memcpy(path, target.at, target.len);
	path[target.len] = '\0';
	return head_large(path);
}

/* METHOD /target HTTP/1.x */
static int check_request(struct part line, struct seen *seen, const char **why)
{
	const char *end = line.at + line.len, *target = memchr(line.at, ' ', line.len), *version;

	if (!target || !is_token((struct part){line.at, (size_t)(target - line.at)}))
		return head_refuse(400, "the request line is wrong", why);
	seen->get = head_is((struct part){line.at, (size_t)(target - line.at)}, "GET");
	target++;
	version = memchr(target, ' ', (size_t)(end - target));
	if (!version || *target != '/')
		return head_refuse(400, "the request line is wrong", why);
	for (const char *at = target; at < version; at++)
		if (!strncmp(at, "%00", 3) || *at <= ' ' || *at == '\\' ||
		    (unsigned char)*at >= 0x7f)
			return head_refuse(400, "the path has letters that have to be escaped",
			                   why);
	seen->large = is_large((struct part){target, (size_t)(version - target)});
	version++;
	if (end - version != 8 || memcmp(version, "HTTP/1.", 7) != 0 ||
	    (version[7] != '0' && version[7] != '1'))
		return head_refuse(505, "expected HTTP/1.1", why);
	return 200;
}

static int check_length(struct part value, struct seen *seen, const char **why)
{
	seen->length = 0;
	for (size_t i = 0; i < value.len; i++) {
		if (!isdigit((unsigned char)value.at[i]))
			return head_refuse(400, "Content-Length is no number", why);
		seen->length = seen->length * 10 + (size_t)(value.at[i] - '0');
		if (seen->length > (seen->large ? BODY_LARGE : BODY_MAX))
			return head_refuse(413,
			                   seen->large ? "the body is longer than 1.5 MiB"
			                               : "the body is longer than 8192 bytes",
			                   why);
	}
	return value.len ? 200 : head_refuse(400, "Content-Length is no number", why);
}

/* Name: value; a line that begins with a blank would go on with the one before it. */
static int check_header(struct part line, struct seen *seen, const char **why)
{
	const char *colon = memchr(line.at, ':', line.len);
	struct part name = {line.at, colon ? (size_t)(colon - line.at) : 0}, value;

	if (!is_token(name))
		return head_refuse(400, "a header is wrong: expected Name: value in one line", why);
	value = (struct part){colon + 1, line.len - name.len - 1};
	while (value.len && (*value.at == ' ' || *value.at == '\t')) {
		value.at++;
		value.len--;
	}
	while (value.len && (value.at[value.len - 1] == ' ' || value.at[value.len - 1] == '\t'))
		value.len--;
	if (head_is(name, "Transfer-Encoding"))
		return head_refuse(501, "Transfer-Encoding is not taken: send Content-Length", why);
	for (size_t i = 0; i < ONCE; i++)
		if (head_is(name, once[i]) && seen->times[i]++)
			return head_refuse(400, "a header stands twice", why);
	return head_is(name, once[CONTENT_LENGTH]) ? check_length(value, seen, why) : 200;
}

static int check_end(const struct seen *seen, const char **why)
{
	if (!seen->times[HOST])
		return head_refuse(400, "the header Host is missing", why);
	if (seen->get && seen->length)
		return head_refuse(400, "GET takes no body", why);
	return 200;
}

int head_check(const char *bytes, size_t len, const char **why)
{
	struct seen seen = {0};
	size_t at = 0;

	*why = "";
	for (int number = 0;; number++) {
		long got = line_length(bytes + at, len - at);
		struct part line = {bytes + at, got > 0 ? (size_t)got : 0};
		int status;

		if (got == -2)
			return head_refuse(
				400, "a line has a control character, or ends without CR", why);
		if (got < 0)
			return len < HEAD_MAX
			               ? 0
			               : head_refuse(431, "the head is longer than 8192 bytes",
			                             why);
		at += line.len + 2;
		if (at > HEAD_MAX)
			return head_refuse(431, "the head is longer than 8192 bytes", why);
		if (number && !line.len)
			return check_end(&seen, why);
		status = number ? check_header(line, &seen, why) : check_request(line, &seen, why);
		if (status != 200)
			return status;
	}
}
