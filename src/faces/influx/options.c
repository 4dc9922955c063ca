/* SPDX-License-Identifier: MIT */
/* What stands in the Influx block, as owsd-influx keeps it. */
#include <stdio.h>
#include <string.h>

#include "src/faces/influx/options.h"
#include "src/faces/kit/face.h"

void push_options_take(struct push_options *options, const struct face *face)
{
	const struct config_influx *influx = &face->config->influx;

	memset(options, 0, sizeof(*options));
	if (!influx->given)
		return;
	options->every_ns = influx->every_ns;
	options->clock_wait_ns = influx->clock_wait_ns;
	snprintf(options->url, sizeof(options->url), "%s", influx->url);
	snprintf(options->token_file, sizeof(options->token_file), "%s",
	         influx->token_file ? influx->token_file : "");
	snprintf(options->measurement, sizeof(options->measurement), "%s", influx->measurement);
}
