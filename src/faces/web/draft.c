/* SPDX-License-Identifier: MIT */
/* Edits of a draft, on the worker for them. */
#include <errno.h>
#include <microhttpd.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/config/check/own.h"
#include "src/config/check/targets.h"
#include "src/config/read/load.h"
#include "src/faces/web/child.h"
#include "src/faces/web/draft.h"
#include "src/faces/web/draft_edit.h"
#include "src/faces/web/http.h"
#include "src/faces/web/model.h"
#include "src/faces/web/writer.h"
#include "src/ground/signal/utf8.h"

#define CHECK_NS (10 * NS_PER_S)
#define NAME "draft" /* of the file, in messages, whose place the page shows itself */

bool draft_is_text(const char *text, size_t len)
{
	while (len)
		if (utf8_next(&text, &len) <= 0)
			return false;
	return true;
}

/* owsd-writer knows what the chips have, and warns of what no item can have of them. */
static void check_items(const char *text, size_t len, struct config_report *report)
{
	static const char *const argv[] = {"owsd-writer", "--draft", NULL};
	struct child child = {
		.argv = argv, .input = text, .input_len = len, .until_ns = ows_now() + CHECK_NS};
	struct writer_answer answer = {0};
	int err = child_run(&child);

	if (!err)
		err = writer_parse(child.out, child.out_len, &answer);
	if (err)
		report_warning(report, (struct rio_position){0},
		               "owsd-writer does not check the items against their chips: %s",
		               *child.why ? child.why : strerror(-err));
	for (unsigned i = 0; i < answer.problems.count; i++) {
		const struct problem *problem = &answer.problems.list[i];

		report->problem(report->ctx, problem->error, problem->line, problem->column,
		                problem->text);
	}
	problems_free(&answer.problems);
	free(child.out);
}

/*
 * Check a text as owsd does, as far as it needs no device. rio: its document, with what could be
 * read; free it. 0, -EINVAL (with an error in problems), -ENOMEM.
 */
static int check_text(const char *text, size_t len, struct problems *problems, struct rio **rio)
{
	struct config_report report = problems_report(problems), silent = {0};
	struct config *config = NULL;
	int err = config_parse(NAME, text, len, &report, &config);

	if (!err)
		err = config_check_targets(config, &report);
	if (!err)
		err = config_check_own(config, &report);
	config_free(config);
	if (err != -ENOMEM)
		check_items(text, len, &report);
	*rio = NULL;
	if (err == -ENOMEM)
		return err;
	return rio_parse(NAME, text, len, &silent, rio) == -ENOMEM ? -ENOMEM : err;
}

static void draft_answer(struct job *job, const struct rio *rio, int err,
                         const struct problems *problems)
{
	struct json json;

	if (!job_json(job, 200, &json))
		return;
	json_bytes(&json, "text", rio->text, rio->len);
	json_bool(&json, "valid", err == 0);
	problems_json(&json, problems, rio);
	model_json(&json, rio);
	json_finish(&json);
}

/* An edit whose result is wrong where the text before was right. */
static void draft_refuse(struct job *job, const struct problems *problems, const struct rio *rio)
{
	struct json json;
	int line;

	if (!job_json(job, 422, &json))
		return;
	json_string(&json, "error", problems_first(problems, &line));
	problems_json(&json, problems, rio);
	json_finish(&json);
}

static unsigned errors_of(const struct problems *problems)
{
	unsigned count = 0;

	for (unsigned i = 0; i < problems->count; i++)
		count += problems->list[i].error;
	return count;
}

/* Does the text have fewer errors than that? */
static bool is_better(const char *text, unsigned errors)
{
	struct problems before = {0};
	struct rio *rio = NULL;
	bool better = check_text(text, strlen(text), &before, &rio) != -ENOMEM &&
	              errors_of(&before) < errors;

	problems_free(&before);
	rio_free(rio);
	return better;
}

static void check(struct job *job, const struct rio *edited, const struct body *body)
{
	bool checks = strcmp(body_string(body, "do"), "check") == 0;
	struct problems problems = {0};
	struct rio *rio = NULL;
	int err = check_text(edited->text, edited->len, &problems, &rio);

	if (err == -ENOMEM || !rio)
		job_error(job, 500, "no memory");
	else if (rio->len > DRAFT_MAX)
		job_error(job, 422, "the text would be longer than 1 MiB");
	else if (err && !checks && is_better(body_string(body, "text"), errors_of(&problems)))
		draft_refuse(job, &problems, rio);
	else
		draft_answer(job, rio, err, &problems);
	problems_free(&problems);
	rio_free(rio);
}

static void edit(struct job *job, struct rio **rio, const struct body *body,
                 struct config_report *report)
{
	const struct problems *problems = report->ctx;
	bool may = report->errors == 0 || strcmp(body_string(body, "do"), "check") == 0 ||
	           strcmp(body_string(body, "do"), "new") == 0;
	int line, err;

	if (!may) {
		const char *words = problems_first(problems, &line);

		job_error(job, 422, "line %d: %s: correct the text first", line, words);
		return;
	}
	report->errors = 0;
	err = draft_edit(rio, body, report);
	if (!err)
		check(job, *rio, body);
	else if (err == -EINVAL)
		job_error(job, 422, "%s", problems_first(problems, &line));
	else
		job_error(job, err == -EFBIG ? 422 : 500,
		          err == -EFBIG ? "the text would be longer than 1 MiB" : "no memory");
}

static void draft_run(struct job *job)
{
	struct problems problems = {0};
	struct config_report report = problems_report(&problems);
	struct rio *rio = NULL;
	struct body body;
	const char *text;

	if (body_parse(job->posted.bytes, job->posted.len, &body) || !body_find(&body, "do")) {
		job_error(job, 400,
		          "expected a JSON object, such as {\"text\":\"...\",\"do\":\"check\"}");
	} else {
		text = body_string(&body, "text");
		if (strlen(text) > DRAFT_MAX)
			job_error(job, 413, "the text is longer than 1 MiB");
		else if (rio_parse(NAME, text, strlen(text), &report, &rio))
			job_error(job, 500, "no memory");
		else
			edit(job, &rio, &body, &report);
	}
	problems_free(&problems);
	rio_free(rio);
}

int draft_post(struct request *request)
{
	return http_defer(request, WEB_DRAFTS, http_job(request, sizeof(struct job), draft_run));
}
