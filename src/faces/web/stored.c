/* SPDX-License-Identifier: MIT */
/* Reads the configuration for the page, on the worker for drafts. */
#include <microhttpd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "hal/base/time.h"
#include "src/config/edit/tag.h"
#include "src/config/read/rio_file.h"
#include "src/faces/web/draft.h"
#include "src/faces/web/edit.h"
#include "src/faces/web/http.h"
#include "src/faces/web/model.h"
#include "src/faces/web/paths.h"
#include "src/faces/web/writer.h"

#define FILE_MAX 4096

struct stored {
	struct job job;
	const char *file;
	bool configurable;
	const char *why; /* it is not configurable */
};

/* The person may; may the text be edited? Only what JSON carries unchanged can be saved again. */
static void judge(struct stored *stored, const char *text, size_t len)
{
	if (!stored->configurable || draft_is_text(text, len))
		return;
	stored->configurable = false;
	stored->why = DRAFT_NO_TEXT;
}

/* The file of before, which the writer keeps beside it. */
static void put_backup(struct json *json, const char *file)
{
	struct config_report silent = {0};
	char path[FILE_MAX + 8], tag[TAG_TEXT], *text = NULL;
	struct stat st;
	size_t len;

	snprintf(path, sizeof(path), "%s.before", file);
	if (stat(path, &st) || rio_read(path, &silent, &text, &len)) {
		json_null(json, "backup");
		return;
	}
	tag_print(text, len, tag);
	free(text);
	json_object(json, "backup");
	json_string(json, "tag", tag);
	json_int(json, "time", (int64_t)st.st_mtim.tv_sec * 1000 + st.st_mtim.tv_nsec / NS_PER_MS);
	json_object_end(json);
}

static void stored_answer(struct stored *stored, const char *text, size_t len,
                          const struct rio *rio)
{
	char tag[TAG_TEXT], remedy[WRITER_WORDS];
	struct json json;

	if (!job_json(&stored->job, 200, &json))
		return;
	tag_print(text, len, tag);
	json_string(&json, "file", stored->file);
	json_string(&json, "tag", tag);
	json_bytes(&json, "text", text, len);
	json_bool(&json, "configurable", stored->configurable);
	writer_remedy(stored->job.instance, remedy);
	json_string(&json, "writer", writer_is_there(stored->job.instance) ? NULL : remedy);
	json_string(&json, "why", stored->configurable ? NULL : stored->why);
	put_backup(&json, stored->file);
	json_bool(&json, "edit", edit_is_on());
	model_json(&json, rio);
	json_finish(&json);
}

static void stored_run(struct job *job)
{
	struct stored *stored = (struct stored *)job;
	struct problems problems = {0};
	struct config_report report = problems_report(&problems);
	struct rio *rio = NULL;
	char *text = NULL;
	size_t len;
	int line;

	if (rio_read(stored->file, &report, &text, &len))
		job_error(job, 500, "%s: %s", stored->file, problems_first(&problems, &line));
	else if (len > DRAFT_MAX)
		job_error(job, 500,
		          "%s is longer than 1 MiB: edit it with owsctl config, or an editor",
		          stored->file);
	else if (rio_parse(stored->file, text, len, &report, &rio))
		job_error(job, 500, "%s: no memory for its blocks", stored->file);
	else {
		judge(stored, text, len);
		stored_answer(stored, text, len, rio);
	}
	problems_free(&problems);
	rio_free(rio);
	free(text);
}

int stored_get(struct request *request)
{
	struct stored *stored = (struct stored *)http_job(request, sizeof(*stored), stored_run);
	char person[PERSON];

	if (!stored)
		return MHD_NO;
	stored->file = request->web->face->arguments->file;
	stored->configurable = http_may(request, PERSON_CONFIGURE, person, &stored->why);
	return http_defer(request, WEB_DRAFTS, &stored->job);
}

void stored_keys(struct json *json, const struct request *request)
{
	(void)request;
	model_keys(json);
}
