/* SPDX-License-Identifier: MIT */
/* The Modbus block: where it listens, and who may command what. */
#include <fnmatch.h>
#include <string.h>

#include "src/config/read/modbus.h"
#include "src/config/read/options.h"
#include "src/config/read/serve.h"

#define BLANK " \t"
#define PATTERN_MAX 255

/* The next word before end. False: there is none. */
static bool next_word(const char **at, const char *end, const char **word, size_t *len)
{
	*word = *at + strspn(*at, BLANK);
	*len = strcspn(*word, BLANK);
	if (*word >= end)
		return false;
	if (*word + *len > end)
		*len = (size_t)(end - *word);
	*at = *word + *len;
	return true;
}

/* A part of Allow: why it is none, NULL: it is one. */
static const char *check_part(const char *part, size_t size)
{
	const char *at = part, *end = part + size, *word, *why = NULL;
	struct listen_peers peers;
	unsigned words = 0;
	size_t len;

	while (!why && next_word(&at, end, &word, &len))
		if (!words++)
			why = len > PATTERN_MAX ? "the pattern is too long" : NULL;
		else if (listen_peers_parse(word, len, &peers, &why) == 0)
			why = NULL;
	return why         ? why
	       : words < 2 ? "expected a pattern of signals, then addresses, as pump* 192.168.1.10"
	                   : NULL;
}

void modbus_derive(struct build *build, const struct option_value *values)
{
	struct config_modbus *modbus = &build->box->config.modbus;
	const struct option_value *allow = &values[OPT_MODBUS_ALLOW];
	const char *rest = modbus->allow, *part, *why;
	size_t len;

	if (modbus->listen)
		serve_addresses(build, modbus->listen, values[OPT_MODBUS_LISTEN].node->value_at,
		                modbus->addresses, &modbus->address_count);
	while (build_part(&rest, ",", &part, &len)) {
		why = check_part(part, len);
		if (why)
			report_error(build->report, allow->node->value_at, "Allow \"%.*s\": %s",
			             (int)len, part, why);
	}
	if (modbus->write && !modbus->allow)
		report_warning(build->report, values[OPT_MODBUS_WRITE].node->at,
		               "Write without Allow: no client may command anything");
}

static bool part_allows(const char *part, size_t size, const char *name,
                        const struct listen_address *from)
{
	const char *at = part, *end = part + size, *word, *why;
	char pattern[PATTERN_MAX + 1];
	struct listen_peers peers;
	size_t len;

	if (!next_word(&at, end, &word, &len) || len > PATTERN_MAX)
		return false;
	memcpy(pattern, word, len);
	pattern[len] = '\0';
	if (fnmatch(pattern, name, 0) != 0)
		return false;
	while (next_word(&at, end, &word, &len))
		if (!listen_peers_parse(word, len, &peers, &why) &&
		    listen_peers_have(&peers, 1, from->is_v6, from->bytes))
			return true;
	return false;
}

bool modbus_allows(const char *allow, const char *name, const struct listen_address *from)
{
	const char *part;
	size_t len;

	while (build_part(&allow, ",", &part, &len))
		if (part_allows(part, len, name, from))
			return true;
	return false;
}
