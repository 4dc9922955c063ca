/* SPDX-License-Identifier: MIT */
/* The Influx block: where values are pushed, how often, and where they wait. */
#include <string.h>

#include "src/config/build.h"
#include "src/config/influx.h"

#define TEXT_MAX 255
#define MEASUREMENT_MAX 63
#define LETTERS "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.-"

/* Why it cannot be one; NULL: it can. */
static const char *check_url(const char *url)
{
	const char *host = strncmp(url, "http://", 7) == 0    ? url + 7
	                   : strncmp(url, "https://", 8) == 0 ? url + 8
	                                                      : NULL;
	const char *precision;

	if (!host || !strcspn(host, "/?#") || strlen(url) > TEXT_MAX)
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

static const char *check_path(const char *path)
{
	return path[0] == '/' && strlen(path) <= TEXT_MAX
	               ? NULL
	               : "expected a path from the root, at most 255 bytes";
}

static const char *check_token_file(const char *name)
{
	if (name[0] == '/')
		return check_path(name);
	return strspn(name, LETTERS) == strlen(name) && name[0] != '.' && strlen(name) <= TEXT_MAX
	               ? NULL
	               : "expected a path from the root, or the name of a credential";
}

static const char *check_measurement(const char *name)
{
	return strspn(name, LETTERS) == strlen(name) && strlen(name) <= MEASUREMENT_MAX
	               ? NULL
	               : "expected letters, digits, '-', '_' and '.', at most 63";
}

/* The text of a key that is given and not empty, checked; else what comes last. */
static const char *take(struct build *build, const struct option_value *values, enum option option,
                        const char *(*check)(const char *), const char *otherwise)
{
	const struct option_value *value = &values[option];
	const char *why;

	if (!value->given || !*value->text)
		return otherwise;
	why = check(value->text);
	if (why && strpbrk(value->text, "@?")) /* there may be a password in it */
		report_error(build->report, value->node->value_at, "%s: %s",
		             option_table[option].key, why);
	else if (why)
		report_error(build->report, value->node->value_at, "%s \"%s\": %s",
		             option_table[option].key, value->text, why);
	return build_keep(build, value->text, strlen(value->text));
}

void influx_build(struct build *build, const struct rio_node *block)
{
	static const struct rio_node none;
	struct config_influx *influx = &build->box->config.influx;
	struct option_value values[OPTION_COUNT_ALL];

	options_read(block ? block : &none, PLACE_INFLUX, values, build->report);
	influx->given = block != NULL;
	influx->url = take(build, values, OPT_INFLUX_URL, check_url, NULL);
	if (block && !influx->url)
		report_error(build->report, block->at,
		             "Influx without Url: give it the server, as "
		             "Url \"http://127.0.0.1:8428/write\"");
	influx->token_file = take(build, values, OPT_INFLUX_TOKEN_FILE, check_token_file, NULL);
	influx->measurement = take(build, values, OPT_INFLUX_MEASUREMENT, check_measurement,
	                           option_table[OPT_INFLUX_MEASUREMENT].preset);
	influx->spool = take(build, values, OPT_INFLUX_SPOOL, check_path, NULL);
	influx->spool_mb = (unsigned)values[OPT_INFLUX_SPOOL_SIZE].number;
	influx->every_ns = (int64_t)(values[OPT_INFLUX_EVERY].number * 1e9 + 0.5);
	influx->clock_wait_ns = (int64_t)(values[OPT_INFLUX_CLOCK_WAIT].number * 1e9 + 0.5);
}
