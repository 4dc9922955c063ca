/* SPDX-License-Identifier: MIT */
/* Reads the configuration of owsd for a face. */
#include <stdio.h>

#include "src/config/load.h"
#include "src/face/face.h"
#include "src/face/load.h"

/* Warnings are owsd's to report, of the same file. ctx: a log; NULL: stderr */
static void report_line(void *ctx, bool is_error, const char *message)
{
	if (!is_error)
		return;
	if (ctx)
		log_err((struct log *)ctx, "%s", message);
	else
		fprintf(stderr, "%s\n", message);
}

int load_first(struct face *face)
{
	struct config_report report = {.line = report_line};

	return config_load(face->arguments->file, &report, &face->config);
}

void load_again(struct face *face)
{
	struct config_report report = {.line = report_line, .ctx = face->log};
	struct config *config;

	if (config_load(face->arguments->file, &report, &config)) {
		log_err(face->log, "%s is refused: what it said before counts on",
		        face->arguments->file);
		return;
	}
	config_free(face->config);
	face->config = config;
}

void load_free(struct face *face)
{
	config_free(face->config);
	face->config = NULL;
}
