/* SPDX-License-Identifier: MIT */
/* Has owsctl scan the buses of owsd, on a worker. */
#include <errno.h>
#include <microhttpd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/owfs/path.h"
#include "src/faces/web/child.h"
#include "src/faces/web/http.h"
#include "src/faces/web/paths.h"
#include "src/ground/signal/error.h"
#include "src/public/ows.h"

#define ALL_NS (30 * NS_PER_S)  /* from the request to the answer */
#define SPARE_NS (2 * NS_PER_S) /* owsctl ends its scan before it is killed */
#define IDS 128
#define WORDS 7 /* of the command besides */
#define FOUND_NOTHING 4

struct devices {
	struct job job;
	int64_t until_ns;
	unsigned id_count;
	char id[IDS][ROM_TEXT_MAX];
};

/* A scan that fails before its end prints what it has. */
static void devices_answer(struct devices *devices, struct child *child)
{
	bool whole = child->status == 0 || child->status == FOUND_NOTHING;
	char *text;
	int len;

	if (!child->out_len) {
		job_error(&devices->job, 503, "%s",
		          *child->why ? child->why : "owsctl ended without an answer");
		return;
	}
	len = asprintf(&text, "{\"whole\":%s,\"devices\":%s}", whole ? "true" : "false",
	               child->out);
	if (len < 0)
		return;
	devices->job.status = 200;
	devices->job.text = text;
	devices->job.len = (size_t)len;
}

static void devices_run(struct job *job)
{
	struct devices *devices = (struct devices *)job;
	int64_t left_ns = devices->until_ns - SPARE_NS - ows_now();
	char within[24], words[ERROR_WORDS];
	const char *argv[WORDS + IDS + 1] = {"owsctl", "-n",       job->instance, "--json",
	                                     "scan",   "--within", within};
	struct child child = {.argv = argv, .until_ns = devices->until_ns};
	int err;

	if (left_ns < NS_PER_S) {
		job_error(job, 503, "another scan takes long: try again in a moment");
		return;
	}
	snprintf(within, sizeof(within), "%.1f", (double)left_ns / 1e9);
	for (unsigned i = 0; i < devices->id_count; i++)
		argv[WORDS + i] = devices->id[i];
	err = child_run(&child);
	if (err)
		job_error(job, 503, "owsctl, which scans, %s",
		          err == -ETIMEDOUT ? "takes too long" : error_words(err, words));
	else
		devices_answer(devices, &child);
	free(child.out);
}

/* --- The request ----------------------------------------------------------------------------- */

/* "28.551DDF030000,28.67C6697351FF". False: one of them is no id, or there are too many. */
static bool parse_ids(const char *text, struct devices *devices)
{
	uint8_t rom[ROM_LEN];

	while (*text) {
		size_t len = strcspn(text, ",");

		if (devices->id_count == IDS || rom_parse(text, len, rom))
			return false;
		rom_print(rom, ROM_F_I, devices->id[devices->id_count++]);
		text += len + (text[len] == ',');
	}
	return devices->id_count > 0;
}

int devices_get(struct request *request)
{
	struct web *web = request->web;
	const char *ids = http_argument(request, "ids");
	struct devices *devices;

	if (!web->face->live)
		return http_error(
			request, 503,
			"a scan asks owsd, and owsd %s is not running: start it, or look with "
			"owsctl -t TARGET scan, and add items by their paths",
			web->face->arguments->instance);
	devices = (struct devices *)http_job(request, sizeof(*devices), devices_run);
	if (!devices)
		return MHD_NO;
	devices->until_ns = ows_now() + ALL_NS;
	if (ids && !parse_ids(ids, devices)) {
		job_free(&devices->job);
		return http_error(request, 400,
		                  "ids=: expected ids of at most %d devices, with commas between",
		                  IDS);
	}
	return http_defer(request, WEB_SCANS, &devices->job);
}
