/* SPDX-License-Identifier: MIT */
/* owsctl mission download: the log of a logger as CSV or JSON, sample by sample. */

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "src/faces/show/json.h"
#include "src/tool/owsctl/mission/mission_download.h"

#define AT_ONCE 32 /* samples that are asked for together: a page of a log */
#define TRIES 3
#define ROOM 16
/* A cache may have the page of an older sample: it was whole that long ago. */
#define CACHED_S (5 * 60)

enum { QUANTITIES = 2 };
static const char *const quantities[QUANTITIES] = {"temperature", "humidity"};

struct download {
	struct mission *mission;
	unsigned elements;
	bool has[QUANTITIES];
	double begin, interval, clock; /* clock: of the logger, when the download began */
	bool moves; /* the log is full and rolls over: each place gets another sample */
	struct ask ask[AT_ONCE];
	char path[AT_ONCE][256], text[AT_ONCE][ROOM];
	char value[QUANTITIES][AT_ONCE][ROOM];
	struct json json;
};

/*
 * May a cache have these samples as they were before they were logged? So it may the page that is
 * logged to, and a page whose last sample came a moment ago.
 */
static bool is_young(const struct download *download, unsigned first, unsigned n)
{
	double last = download->begin + download->interval * (first + n - 1);

	return download->moves || first + n == download->elements ||
	       !(last + CACHED_S < download->clock);
}

/* Samples of one quantity from the first on; what failed is asked for again. */
static int ask_for(struct download *download, unsigned quantity, unsigned first, unsigned n)
{
	char property[64], given[256];
	bool fresh;
	int err = -EIO;

	for (unsigned try = 0; try < TRIES && err; try++) {
		err = 0;
		for (unsigned i = 0; i < n; i++) {
			snprintf(property, sizeof(property), "log/%s.%u", quantities[quantity],
			         first + i);
			if (snprintf(given, sizeof(given), "%s/%s", download->mission->device,
			             property) >= (int)sizeof(given) ||
			    !target_path(given, download->path[i], &fresh))
				return -ENODEV;
			download->ask[i] = (struct ask){
				.req = {.op = BUS_READ,
			                .prio = BUS_GUEST,
			                .path = download->path[i],
			                .fresh = is_young(download, first, n),
			                .data = (uint8_t *)download->text[i],
			                .len = ROOM - 1}};
		}
		target_ask(&download->mission->target, download->ask, n);
		for (unsigned i = 0; i < n && !err; i++)
			err = download->ask[i].answer.err;
	}
	for (unsigned i = 0; i < n && !err; i++) {
		size_t len = target_unpad(download->text[i], download->ask[i].answer.len);

		memcpy(download->value[quantity][i], download->text[i], len);
		download->value[quantity][i][len] = '\0';
	}
	return err;
}

static void print_sample(const struct ctl *ctl, struct download *download, unsigned first,
                         unsigned i)
{
	char when[MISSION_TIME];

	mission_time(download->begin + download->interval * (first + i), when);
	if (ctl->json) {
		json_object(&download->json, NULL);
		json_string(&download->json, "time", when);
	} else {
		fputs(when, stdout);
	}
	for (unsigned q = 0; q < QUANTITIES; q++) {
		if (!download->has[q])
			continue;
		if (ctl->json)
			json_number(&download->json, quantities[q], download->value[q][i]);
		else
			printf(",%s", download->value[q][i]);
	}
	if (ctl->json)
		json_object_end(&download->json);
	else
		putchar('\n');
}

/* On a terminal, in one line that the next one overwrites. */
static void show_progress(unsigned done, unsigned all)
{
	if (isatty(STDERR_FILENO))
		fprintf(stderr, "\r%u of %u samples%s", done, all, done == all ? "\n" : "");
}

static int print_all(const struct ctl *ctl, struct download *download)
{
	for (unsigned first = 0; first < download->elements; first += AT_ONCE) {
		unsigned n = download->elements - first < AT_ONCE ? download->elements - first
		                                                  : AT_ONCE;

		for (unsigned q = 0; q < QUANTITIES; q++) {
			int err = download->has[q] ? ask_for(download, q, first, n) : 0;

			if (err)
				return mission_failed(download->mission, "log", err);
		}
		for (unsigned i = 0; i < n; i++)
			print_sample(ctl, download, first, i);
		show_progress(first + n, download->elements);
	}
	return CTL_DONE;
}

/* How many samples, from when on, of what. */
static int mission_download_look(struct download *download)
{
	struct mission *mission = download->mission;
	double elements, samples = 0, running = 0, logs = 0;
	int err = mission_read(mission, "log/elements", &elements);

	if (!err)
		err = mission_read(mission, "mission/samples", &samples);
	if (!err)
		err = mission_read(mission, "mission/running", &running);
	/* without it all samples are young */
	if (!err && mission_read(mission, "clock/udate", &download->clock))
		download->clock = 0;
	if (!err)
		err = mission_interval(mission, &download->interval);
	if (!err && !mission->minutes)
		err = mission_read(mission, "mission/samplinghumidity", &logs);
	if (!err && elements > 0)
		err = mission_read(mission, "log/udate.0", &download->begin);
	if (err)
		return mission_failed(mission, "log", err);
	download->elements = (unsigned)elements;
	download->moves = running != 0 && samples > elements;
	download->has[0] = true;
	download->has[1] = logs != 0;
	return CTL_DONE;
}

/* A log that rolls over while it is read is a mixture. */
static int check_begin(struct download *download)
{
	double begin = download->begin;

	if (download->elements && mission_need(download->mission, "log/udate.0", &begin))
		return CTL_FAILED;
	if (begin == download->begin)
		return CTL_DONE;
	return ctl_fail("%s: the log rolled over meanwhile; stop the mission, or download again",
	                download->mission->device);
}

int mission_download(const struct ctl *ctl, struct mission *mission)
{
	static struct download download;
	int status;

	download = (struct download){.mission = mission};
	status = mission_download_look(&download);
	if (status)
		return status;
	json_list(&download.json, stdout, ctl->json);
	if (!ctl->json)
		printf("time,temperature%s\n", download.has[1] ? ",humidity" : "");
	status = print_all(ctl, &download);
	json_list_end(&download.json);
	return status ? status : check_begin(&download);
}
