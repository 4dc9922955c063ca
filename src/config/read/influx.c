/* SPDX-License-Identifier: MIT */
/* The Influx block: where values are pushed, how often, and where they wait. */
#include <string.h>

#include "src/config/read/build.h"
#include "src/config/read/influx.h"

/* Why it cannot be one; NULL: it can. */
static const char *check_url(const char *url)
{
	const char *host = strncmp(url, "http://", 7) == 0    ? url + 7
	                   : strncmp(url, "https://", 8) == 0 ? url + 8
	                                                      : NULL;
	const char *precision;

	if (!host || !strcspn(host, "/?#") || strlen(url) > TEXT_KEY_MAX)
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

void influx_build(struct build *build, const struct rio_node *block)
{
	struct config_influx *influx = &build->box->config.influx;
	struct option_value values[OPTION_COUNT_ALL];

	options_read(block, PLACE_INFLUX, values, build->report);
	influx->given = block != NULL;
	influx->url = text_key(build, values, OPT_INFLUX_URL, check_url);
	if (block && !influx->url)
		report_error(build->report, block->at,
		             "Influx without Url: give it the server, as "
		             "Url \"http://127.0.0.1:8428/write\"");
	influx->token_file = text_key(build, values, OPT_INFLUX_TOKEN_FILE, text_is_file);
	influx->measurement = text_key(build, values, OPT_INFLUX_MEASUREMENT, text_is_name);
	influx->spool = text_key(build, values, OPT_INFLUX_SPOOL, text_is_path);
	influx->spool_mb = (unsigned)values[OPT_INFLUX_SPOOL_SIZE].number;
	influx->every_ns = option_ns(&values[OPT_INFLUX_EVERY]);
	influx->clock_wait_ns = option_ns(&values[OPT_INFLUX_CLOCK_WAIT]);
}
