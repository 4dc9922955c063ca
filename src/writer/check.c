/* SPDX-License-Identifier: MIT */
/* Checks a new configuration as owsd does, before it takes the place of the old one. */
#include <stdbool.h>

#include "src/config/buses.h"
#include "src/config/config.h"
#include "src/config/load.h"
#include "src/config/own.h"
#include "src/config/report.h"
#include "src/host/target.h"
#include "src/writer/answer.h"
#include "src/writer/check.h"

static void take_problem(void *ctx, bool is_error, int line, int column, const char *text)
{
	answer_problem(ctx, is_error, line, column, text);
}

static int check_target(const struct config *config, const struct config_target *target,
                        struct config_report *report)
{
	struct place place = {config->file, target->line, target->column};
	char why[256];
	int err = target_check(target->text, why, sizeof(why));

	if (err)
		report_error(report, place, "target \"%s\": %s", target->text, why);
	return err;
}

int check_text(const char *file, const char *text, size_t len, struct answer *answer)
{
	struct config_report report = {.problem = take_problem, .ctx = answer};
	struct config *config;
	int err = config_parse(file, text, len, &report, &config);

	if (err)
		return err;
	err = config_check_own(config, &report);
	for (unsigned i = 0; !err && i < config->target_count; i++)
		err = check_target(config, &config->targets[i], &report);
	if (!err)
		err = target_check_options(config, &report);
	if (!err)
		config_check_buses(config, &report);
	config_free(config);
	return err;
}
