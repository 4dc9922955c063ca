/* SPDX-License-Identifier: MIT */
/* What stands in the Influx block, as owsd-influx keeps it. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "src/faces/influx/options.h"
#include "src/faces/kit/face.h"

static int choose_spool(const struct face *face, char path[HISTORY_PATH])
{
	const char *given = face->arguments->option ? face->arguments->option
	                                            : face->config->influx.spool;

	if (!given)
		return history_place_state(face->ops->program, "influx", face->arguments->instance,
		                           path);
	return snprintf(path, HISTORY_PATH, "%s", given) < HISTORY_PATH ? 0 : -ENAMETOOLONG;
}

int push_options_take(struct push_options *options, const struct face *face)
{
	const struct config_influx *influx = &face->config->influx;

	*options = (struct push_options){0};
	if (!influx->given)
		return 0;
	options->spool_mb = influx->spool_mb;
	options->every_ns = influx->every_ns;
	options->clock_wait_ns = influx->clock_wait_ns;
	snprintf(options->url, sizeof(options->url), "%s", influx->url);
	snprintf(options->token_file, sizeof(options->token_file), "%s",
	         influx->token_file ? influx->token_file : "");
	snprintf(options->measurement, sizeof(options->measurement), "%s", influx->measurement);
	return choose_spool(face, options->spool);
}

bool push_options_same(const struct push_options *a, const struct push_options *b)
{
	return !strcmp(a->url, b->url) && !strcmp(a->token_file, b->token_file) &&
	       !strcmp(a->measurement, b->measurement) && !strcmp(a->spool, b->spool) &&
	       a->spool_mb == b->spool_mb && a->every_ns == b->every_ns &&
	       a->clock_wait_ns == b->clock_wait_ns;
}
