/* SPDX-License-Identifier: MIT */
/* Reads where the pages of other machines are. */
#include <stdlib.h>
#include <string.h>

#include "src/config/read/build.h"
#include "src/config/read/others.h"
#include "src/config/read/texts.h"

#define BLANKS " \t"
#define SOCKET_MAX 107 /* bytes of a path that the kernel takes */
#define WORDS 3

struct word {
	const char *at;
	size_t len;
};

/* The words of an entry; more than WORDS: there are too many. */
static int split(const char *text, size_t len, struct word words[WORDS])
{
	int n = 0;

	for (size_t at = 0; at < len;) {
		size_t start = at;

		while (at < len && !strchr(BLANKS, text[at]))
			at++;
		if (at > start && n < WORDS)
			words[n] = (struct word){text + start, at - start};
		n += at > start;
		while (at < len && strchr(BLANKS, text[at]))
			at++;
	}
	return n;
}

static bool copy(struct word word, char *to, size_t size)
{
	if (!word.len || word.len >= size)
		return false;
	memcpy(to, word.at, word.len);
	to[word.len] = '\0';
	return true;
}

static bool is_port(const char *port)
{
	unsigned long number = strtoul(port, NULL, 10);

	return strspn(port, "0123456789") == strlen(port) && number > 0 && number < 65536;
}

/* HOST, HOST:PORT or [IPv6]:PORT, and a path that ends with "/". */
static bool take_http(struct word rest, struct other_place *place)
{
	static const char of_path[] = TEXT_LETTERS "/~%";
	const char *slash = memchr(rest.at, '/', rest.len), *colon;
	size_t len = slash ? (size_t)(slash - rest.at) : rest.len;
	bool v6 = len && *rest.at == '[';
	size_t host = v6 ? 1 : 0, end = host;

	while (end < len && !strchr(v6 ? "]" : ":", rest.at[end]))
		end++;
	if (!copy((struct word){rest.at + host, end - host}, place->host, sizeof(place->host)) ||
	    strspn(place->host, v6 ? "0123456789abcdefABCDEF:." : TEXT_LETTERS) != end - host)
		return false;
	if (v6 && (end == len || !strchr(place->host, ':')))
		return false;
	colon = rest.at + end + v6;
	len -= end + v6;
	memcpy(place->port, "80", sizeof("80"));
	if (len && (*colon != ':' ||
	            !copy((struct word){colon + 1, len - 1}, place->port, sizeof(place->port)) ||
	            !is_port(place->port)))
		return false;
	memcpy(place->path, "/", sizeof("/"));
	if (!slash)
		return true;
	len = rest.len - (size_t)(slash - rest.at);
	if (!copy((struct word){slash, len}, place->path, sizeof(place->path) - 1) ||
	    strspn(place->path, of_path) != len)
		return false;
	if (place->path[len - 1] != '/')
		memcpy(place->path + len, "/", sizeof("/"));
	return true;
}

static bool take_socket(struct word word, struct other_place *place)
{
	memcpy(place->path, "/", sizeof("/"));
	return copy(word, place->host, SOCKET_MAX + 1) && word.len > 4 &&
	       !strcmp(place->host + word.len - 4, ".web");
}

static const char *take_page(struct word word, struct other_place *place)
{
	const char *why;

	if (!copy(word, place->page, sizeof(place->page)))
		return "the address of the page is longer than 255 bytes";
	why = text_is_url(place->page);
	return why ? "expected the address of the page, http://... or https://..." : NULL;
}

const char *other_parse(const char *text, size_t len, struct other_place *place)
{
	static const char http[] = "http://", https[] = "https://";
	struct word words[WORDS], address;
	int n = split(text, len, words);

	*place = (struct other_place){0};
	if (n < 2 || n > WORDS)
		return "expected NAME ADDRESS, or NAME ADDRESS PAGE";
	if (!copy(words[0], place->name, sizeof(place->name)) || text_is_line(place->name))
		return "expected a name of at most 63 bytes, in UTF-8";
	address = words[1];
	if (address.len >= strlen(https) && !memcmp(address.at, https, strlen(https)))
		return "owsd-web asks by http alone: name a port of this machine that a proxy or "
		       "ssh -L leads there, and then the page, https://...";
	if (*address.at == '/') {
		if (!take_socket(address, place))
			return "expected the socket of an owsd-web, as /run/owsd/NAME.web";
	} else {
		if (address.len < strlen(http) || memcmp(address.at, http, strlen(http)) ||
		    !take_http((struct word){address.at + strlen(http), address.len - strlen(http)},
		               place))
			return "expected http://HOST:PORT/ or the socket of an owsd-web";
		if (n < WORDS)
			return take_page(address, place);
	}
	return n < WORDS ? NULL : take_page(words[2], place);
}

bool other_next(const char **text, struct other_place *place, const char **why)
{
	const char *part;
	size_t len;

	if (!build_part(text, ",", &part, &len))
		return false;
	*why = other_parse(part, len, place);
	return true;
}
