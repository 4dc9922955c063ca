/* SPDX-License-Identifier: MIT */
/* Has the writer save the configuration, on a worker of its own: it waits for owsd's reload. */
#include <errno.h>
#include <limits.h>
#include <microhttpd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/config/read/load.h"
#include "src/config/read/rio_file.h"
#include "src/faces/kit/body.h"
#include "src/faces/show/json.h"
#include "src/faces/web/draft.h"
#include "src/faces/web/http.h"
#include "src/faces/web/paths.h"
#include "src/faces/web/writer.h"
#include "src/ground/signal/error.h"

#define SAVE_FILES 256 /* the configuration refuses a longer path */

struct save {
	struct job job;
	bool restore;
	const char *file;       /* that is saved */
	char files[SAVE_FILES]; /* where the files of the page are; "": the program's own place */
	struct body body;
};

static void put_done(struct json *json, const struct writer_answer *answer)
{
	json_string(json, "tag", answer->tag);
	json_string(json, "reload", answer->reload);
	json_string(json, "why", *answer->why ? answer->why : NULL);
	if (!*answer->backup) {
		json_null(json, "backup");
		return;
	}
	json_object(json, "backup");
	json_string(json, "tag", answer->backup);
	json_int(json, "time", answer->backup_ms);
	json_object_end(json);
}

static void put_refusal(struct json *json, const struct writer_answer *answer, const char *text)
{
	struct config_report silent = {0};
	struct rio *rio = NULL;

	json_string(json, "error", *answer->why ? answer->why : "the writer refuses it");
	if (*answer->tag)
		json_string(json, "tag", answer->tag);
	if (answer->status != WRITER_INVALID)
		return;
	/* a text that cannot be read has problems without items */
	if (text)
		rio_parse("draft", text, strlen(text), &silent, &rio);
	problems_json(json, &answer->problems, rio);
	rio_free(rio);
}

static void answer_with(struct save *save, const struct writer_answer *answer, const char *text)
{
	static const unsigned statuses[] = {
		[WRITER_DONE] = 200,    [WRITER_CONFLICT] = 409, [WRITER_INVALID] = 422,
		[WRITER_REFUSED] = 403, [WRITER_ERROR] = 500,
	};
	struct json json;

	if (!job_json(&save->job, statuses[answer->status], &json))
		return;
	if (answer->status == WRITER_DONE)
		put_done(&json, answer);
	else
		put_refusal(&json, answer, text);
	json_finish(&json);
}

static void save_ask(struct save *save, const struct writer_order *order)
{
	struct writer_answer answer;
	char words[WRITER_WORDS], error[ERROR_WORDS];
	int err = writer_ask(order, &answer);

	if (!err) {
		answer_with(save, &answer, order->text);
		problems_free(&answer.problems);
	} else if (err == -ENOENT || err == -ECONNREFUSED) {
		writer_remedy(save->job.instance, words);
		job_error(&save->job, 503, "%s", words);
	} else if (err == -EACCES || err == -EPERM) {
		job_error(&save->job, 503,
		          "owsd-web may not ask the writer: add its user to the group owsd-config "
		          "and start it again");
	} else if (err == -EPROTO) {
		job_error(&save->job, 502,
		          "owsd-writer answers what owsd-web does not understand (are they of the "
		          "same version?): it is not known whether the file was saved");
	} else if (err == -EINPROGRESS) {
		job_error(&save->job, 504,
		          "owsd-writer has the order and gave no answer: it is not known whether "
		          "the file was saved");
	} else if (err == -EAGAIN) {
		job_error(&save->job, 503, "the writer is busy: try again in a minute");
	} else {
		job_error(&save->job, 503, "owsd-writer: %s", error_words(err, error));
	}
}

/*
 * Would the page then serve the files of another directory? That is for who has the machine: it
 * would give away what owsd-web may read. A text with errors is the writer's to refuse.
 */
static bool moves_files(const struct save *save, const char *text, size_t len)
{
	struct config_report silent = {0};
	struct config *config;
	bool moves = false;

	if (config_parse("draft", text, len, &silent, &config) == 0) {
		moves = strcmp(config->web.files ? config->web.files : "", save->files) != 0;
		config_free(config);
	}
	return moves;
}

/* The same of the file of before, which a restore would put in place. */
static bool before_moves_files(const struct save *save)
{
	struct config_report silent = {0};
	char path[PATH_MAX], *text = NULL;
	size_t len = 0;
	bool moves;

	snprintf(path, sizeof(path), "%s.before", save->file);
	moves = rio_read(path, &silent, &text, &len) == 0 && moves_files(save, text, len);
	free(text);
	return moves;
}

/* Has the file bytes that the page did not get as they are? One that is not read has none. */
static bool loses_bytes(const struct save *save)
{
	struct config_report silent = {0};
	char *text = NULL;
	size_t len = 0;
	bool loses = rio_read(save->file, &silent, &text, &len) == 0 && !draft_is_text(text, len);

	free(text);
	return loses;
}

static void save_run(struct job *job)
{
	struct save *save = (struct save *)job;
	struct writer_order order = {.instance = job->instance, .person = job->person};
	const struct body_member *text, *base;

	if (body_parse(job->posted.bytes, job->posted.len, &save->body)) {
		job_error(job, 400, "expected a JSON object, such as {\"base\":\"...\"}");
		return;
	}
	text = body_find(&save->body, "text");
	base = body_find(&save->body, "base");
	if (!base || base->kind != BODY_STRING || !writer_is_tag(base->text)) {
		job_error(job, 400, "expected \"base\": the tag that api/config has");
	} else if (!save->restore && (!text || text->kind != BODY_STRING)) {
		job_error(job, 400, "expected \"text\": the new configuration");
	} else if (!save->restore && strlen(text->text) > DRAFT_MAX) {
		job_error(job, 413, "the text is longer than 1 MiB");
	} else if (!save->restore && loses_bytes(save)) {
		job_error(job, 409, DRAFT_NO_TEXT);
	} else if (save->restore ? before_moves_files(save)
	                         : moves_files(save, text->text, strlen(text->text))) {
		job_error(job, 403,
		          "Files of the block Web stays as owsd-web has it: change it on that "
		          "machine, and reload");
	} else {
		order.base = base->text;
		order.text = save->restore ? NULL : text->text;
		save_ask(save, &order);
	}
}

static int save_give(struct request *request, bool restore)
{
	struct web *web = request->web;
	struct save *save = (struct save *)http_job(request, sizeof(*save), save_run);

	if (!save)
		return MHD_NO;
	save->restore = restore;
	save->file = web->face->arguments->file;
	snprintf(save->files, sizeof(save->files), "%s",
	         web->face->config->web.files ? web->face->config->web.files : "");
	return http_defer(request, WEB_SAVES, &save->job);
}

int save_post(struct request *request)
{
	return save_give(request, false);
}

int save_restore(struct request *request)
{
	return save_give(request, true);
}
