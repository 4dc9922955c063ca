/* SPDX-License-Identifier: MIT */
/* Checks a new configuration as owsd does, before it takes the place of the old one. */
#include <stdbool.h>

#include "src/config/config.h"
#include "src/config/load.h"
#include "src/config/report.h"
#include "src/host/target.h"
#include "src/writer/answer.h"
#include "src/writer/check.h"

static void take_problem(void *ctx, bool is_error, int line, int column, const char *text)
{
	answer_problem(ctx, is_error, line, column, text);
}

int check_text(const char *file, const char *text, size_t len, struct answer *answer)
{
	struct config_report report = {.problem = take_problem, .ctx = answer};
	struct config *config;
	int err = config_parse(file, text, len, &report, &config);

	if (err)
		return err;
	err = target_check_config(config, &report);
	config_free(config);
	return err;
}
