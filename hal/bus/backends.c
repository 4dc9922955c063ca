/* SPDX-License-Identifier: MIT */
/* Finds the backend that a target names. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "hal/bus/backends.h"

static const struct bus_ops *backend_of(const char *word, size_t len)
{
	for (const struct bus_ops *const *ops = bus_backends; *ops; ops++)
		if (strlen((*ops)->scheme) == len && memcmp((*ops)->scheme, word, len) == 0)
			return *ops;
	return NULL;
}

const struct bus_ops *bus_backend(const char *target, const char **where)
{
	const char *colon = strchr(target, ':');
	size_t len = colon ? (size_t)(colon - target) : strlen(target);
	const struct bus_ops *ops = backend_of(target, len);

	if (where)
		*where = !ops ? target : colon ? colon + 1 : "";
	return ops ? ops : backend_of("owserver", strlen("owserver"));
}

bool bus_caches(const char *target)
{
	const char *where;
	const struct bus_ops *ops = bus_backend(target, &where);

	return ops && ops->caches && strncmp(where, ops->caches, strlen(ops->caches)) == 0;
}

/* Does WORD:REST mean HOST:PORT, even with a wrong port? */
static bool is_host_and_port(const char *target, const char *colon)
{
	const char *rest = colon + 1 + strspn(colon + 1, " \t+-");
	size_t len = (size_t)(colon - target);

	return len == 0 || (*rest >= '0' && *rest <= '9') || memchr(target, '.', len) ||
	       (len == 9 && memcmp(target, "localhost", len) == 0);
}

/* Is the target an IPv6 address without its brackets? */
static bool is_bare_ipv6(const char *target, const char *colon)
{
	return strchr(colon + 1, ':') && target[strspn(target, "0123456789abcdefABCDEF:.")] == '\0';
}

/* "ds2482", "DS2482-800" or "i2c-1", and not a host as "i2c-garden". */
static bool is_i2c_word(const char *word, size_t len)
{
	const char *number = NULL, *end = word + len;

	if (len > 4 && strncasecmp(word, "i2c-", 4) == 0)
		number = word + 4;
	else if (len >= 6 && strncasecmp(word, "ds248", 5) == 0 && word[5] >= '2' && word[5] <= '5')
		number = len == 6 ? end : len > 7 && word[6] == '-' ? word + 7 : NULL;
	while (number && number < end && *number >= '0' && *number <= '9')
		number++;
	return number == end;
}

/* Chips and adapters that owsd reaches by another target: what each is, and the remedy. */
static const struct {
	const char *words[7];
	const char *remedy;
} others[] = {
	{{"usb", "ds9490", "ds9490r", "ds2490"}, "is a USB adapter: write usb:"},
	{{"link", "linkusb", "ds9097u", "ds2480b"},
         "is a serial adapter: write serial:/dev/ttyUSB0"},
	{{"passive", "ds9097"}, "is a passive serial adapter: write uart:/dev/ttyUSB0"},
};

/* NULL: the word is none of these. */
static const char *remedy_of(const char *word, size_t len)
{
	if (is_i2c_word(word, len))
		return "is a chip or an adapter of I2C: write i2c:/dev/i2c-1, or i2c:auto";
	for (size_t i = 0; i < sizeof(others) / sizeof(others[0]); i++)
		for (const char *const *known = others[i].words; *known; known++)
			if (strlen(*known) == len && strncasecmp(word, *known, len) == 0)
				return others[i].remedy;
	return NULL;
}

static int no_backend(const char *word, size_t word_len, char *why, size_t why_size)
{
	char names[160] = "";
	size_t used = 0;

	for (const struct bus_ops *const *ops = bus_backends; *ops; ops++) {
		int n = (*ops)->testing ? 0
		                        : snprintf(names + used, sizeof(names) - used,
		                                   " %s:", (*ops)->scheme);

		if (n < 0 || (size_t)n >= sizeof(names) - used)
			break;
		used += (size_t)n;
	}
	snprintf(why, why_size,
	         "'%.*s' is an unknown kind of target; there are%s, "
	         "and HOST, HOST:PORT, [IPv6]:PORT for an owserver",
	         (int)(word_len > 40 ? 40 : word_len), word, names);
	return -EPROTONOSUPPORT;
}

int bus_create(const char *target, const struct bus_env *env, struct bus **bus, char *why,
               size_t why_size)
{
	const char *colon = strchr(target, ':');
	size_t word_len = colon ? (size_t)(colon - target) : strlen(target);
	const struct bus_ops *ops = backend_of(target, word_len);
	const char *where = colon ? colon + 1 : "", *remedy;
	int err, shown = (int)(word_len > 40 ? 40 : word_len);

	if (why_size)
		why[0] = '\0';
	if (strcmp(target, "auto") == 0) {
		snprintf(why, why_size, "auto stands for several targets: name one of them");
		return -EINVAL;
	}
	if (!ops && ((word_len == 3 && memcmp(target, "sim", word_len) == 0) ||
	             strncmp(target, "replay:", 7) == 0)) {
		snprintf(why, why_size,
		         "simulated devices: this target needs owsd-sim in place of owsd "
		         "(and owsctl-sim, owsd-writer-sim)");
		return -EPROTONOSUPPORT;
	}
	remedy = remedy_of(target, word_len);
	if (!ops && remedy && !(colon && is_host_and_port(target, colon))) {
		snprintf(why, why_size, "%.*s %s (a host: owserver:%.*s)", shown, target, remedy,
		         shown, target);
		return -EINVAL;
	}
	if (!ops) {
		if (target[0] != '[' && colon && is_bare_ipv6(target, colon)) {
			snprintf(why, why_size,
			         "an IPv6 address is written in brackets, as in [::1]:4304");
			return -EINVAL;
		}
		if (strncmp(target, "/dev/tty", 8) == 0) {
			snprintf(why, why_size,
			         "a serial adapter: write serial:%.80s (DS9097U, LinkUSB), "
			         "or uart:%.80s (passive, DS9097)",
			         target, target);
			return -EINVAL;
		}
		if (target[0] == '/') {
			snprintf(why, why_size,
			         "a path has its way in front: i2c:/dev/i2c-1, "
			         "owserver:/SOCKET");
			return -EINVAL;
		}
		if (target[0] != '[' && colon && !is_host_and_port(target, colon))
			return no_backend(target, word_len, why, why_size);
		ops = backend_of("owserver", strlen("owserver"));
		if (!ops)
			return no_backend(target, word_len, why, why_size);
		where = target;
	}
	err = ops->create(where, env, bus, why, why_size);
	if (err == -ENOMEM)
		snprintf(why, why_size, "out of memory");
	return err;
}
