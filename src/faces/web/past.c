/* SPDX-License-Identifier: MIT */
/* Trends and journals, on the worker for the past. */
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/faces/show/journal_past.h"
#include "src/faces/web/http.h"
#include "src/faces/web/paths.h"
#include "src/public/ows_history.h"

#define DIRECTORY 512
#define POINTS 2000
#define ENTRIES 1000
#define RECORDS 20000 /* in one answer: 1 MB */
#define RINGS 512     /* entries that owsd keeps */
#define NAME 256
#define DAY_MS (86400 * 1000LL)
#define TIME_MOST 4000000000000LL /* ms since 1970 */
#define HOUR_SIGNALS 200          /* in one answer */
#define HOUR_POINTS 30            /* of two minutes, which come from sums */

struct past_job {
	struct job job;
	char directory[DIRECTORY], name[NAME];
	char identity[2 * NAME]; /* of the signal that has the name now; else the name */
	int64_t from_ns, until_ns;
	int n, first;
};

static bool place(const char *instance, const struct config *config, char path[DIRECTORY])
{
	const char *given = config->recorder.directory;

	if (!given)
		return ows_history_place(instance, path, DIRECTORY) == 0;
	return snprintf(path, DIRECTORY, "%s", given) < DIRECTORY;
}

bool past_is_there(const char *instance, const struct config *config)
{
	char path[DIRECTORY];

	return place(instance, config, path) && access(path, R_OK | X_OK) == 0;
}

/* A whole number of the arguments. False: it is none, or not within the limits. */
static bool number(const struct request *request, const char *name, long long least, long long most,
                   long long *value)
{
	const char *text = http_argument(request, name);
	char *end;

	if (!text)
		return true;
	errno = 0;
	*value = strtoll(text, &end, 10);
	return end != text && !*end && !errno && *value >= least && *value <= most;
}

static struct past_job *make(struct request *request, void (*run)(struct job *job))
{
	const struct face *face = request->web->face;
	struct past_job *past = (struct past_job *)http_job(request, sizeof(*past), run);

	if (past && !place(past->job.instance, face->config, past->directory))
		past->directory[0] = '\0';
	return past;
}

/* False after answering: there is no history. */
static bool open_history(struct past_job *past, struct ows_history **h)
{
	int err = *past->directory ? ows_history_open(NULL, past->directory, h) : -ENOENT;

	if (err == -ENOENT)
		job_error(&past->job, 404,
		          "there is no history: start owsd-recorder, which keeps one");
	else if (err)
		job_error(&past->job, err == -EACCES ? 403 : 500, "%s: %s%s", past->directory,
		          strerror(-err), err == -EACCES ? "; the group owsd may read it" : "");
	return !err;
}

/* --- Trends ---------------------------------------------------------------------------------- */

static void put_column(struct json *json, const char *key, const struct ows_history_point *points,
                       int n)
{
	json_array(json, key);
	for (int i = 0; i < n; i++) {
		const struct ows_history_point *point = &points[i];

		if (!strcmp(key, "from"))
			json_int(json, NULL, point->from_ns / NS_PER_MS);
		else if (!strcmp(key, "min"))
			json_double(json, NULL, point->min);
		else if (!strcmp(key, "max"))
			json_double(json, NULL, point->max);
		else if (!strcmp(key, "last"))
			json_double(json, NULL, point->last);
		else if (!strcmp(key, "quality"))
			json_int(json, NULL, point->quality);
		else
			json_int(json, NULL, point->gap);
	}
	json_array_end(json);
}

static void put_columns(struct json *json, const struct ows_history_point *points, int n,
                        bool with_times)
{
	static const char *const columns[] = {"min", "max", "last", "quality", "from", "gap"};

	for (size_t i = 0; i < (with_times ? 6 : 4); i++)
		put_column(json, columns[i], points, n);
}

static void put_trend(struct past_job *past, const struct ows_history_signal *signal,
                      const struct ows_history_point *points)
{
	struct json json;

	if (!job_json(&past->job, 200, &json))
		return;
	json_string(&json, "name", past->name);
	json_string(&json, "unit", *signal->unit ? signal->unit : NULL);
	json_int(&json, "until", points[past->n - 1].until_ns / NS_PER_MS);
	put_columns(&json, points, past->n, true);
	json_finish(&json);
}

/* The index of a signal that has numbers. */
static int find(struct past_job *past, struct ows_history *h, struct ows_history_signal *signal)
{
	int index = ows_history_find(h, past->identity), err;

	/* of a file without identities */
	if (index < 0)
		index = ows_history_find(h, past->name);
	err = index < 0 ? index : ows_history_signal(h, index, signal);

	if (err)
		return err;
	return signal->type == OWS_STRING ? -EOPNOTSUPP : index;
}

static int read_points(struct past_job *past, struct ows_history *h,
                       struct ows_history_signal *signal, struct ows_history_point *points)
{
	int index = find(past, h, signal);

	return index < 0 ? index
	                 : ows_history_points(h, index, past->from_ns, past->until_ns, points,
	                                      past->n);
}

static void refuse(struct past_job *past, int err)
{
	if (err == -ENOENT)
		job_error(&past->job, 404, "the history has no signal %s", past->name);
	else if (err == -EOPNOTSUPP)
		job_error(&past->job, 404, "%s is a text, which has no trend", past->name);
	else
		job_error(&past->job, 500, "%s: %s", past->name, strerror(-err));
}

static void run_trend(struct job *job)
{
	struct past_job *past = (struct past_job *)job;
	struct ows_history_point *points = calloc((size_t)past->n, sizeof(*points));
	struct ows_history_signal signal = {.name = "", .unit = ""};
	struct ows_history *h = NULL;
	int got;

	if (points && open_history(past, &h)) {
		got = read_points(past, h, &signal, points);
		if (got == past->n)
			put_trend(past, &signal, points);
		else
			refuse(past, got);
		ows_history_close(h);
	}
	free(points);
}

static void put_record(struct json *json, const struct ows_history_item *item)
{
	bool good = item->known && ows_good(item->quality);

	json_array(json, NULL);
	json_int(json, NULL, item->time_ns / NS_PER_MS);
	if (good && item->type == OWS_LARGE)
		json_exact(json, NULL, item->integer);
	else
		json_double(json, NULL, good ? item->number : NAN);
	json_int(json, NULL, item->known ? item->quality : 0);
	json_array_end(json);
}

/* What was recorded, one by one; "next": where the rest begins, null if this is all. */
static void put_records(struct past_job *past, struct ows_history *h)
{
	struct ows_history_item item;
	struct json json;
	int got, count = 0;

	if (!job_json(&past->job, 200, &json))
		return;
	json_string(&json, "name", past->name);
	json_array(&json, "records");
	while ((got = ows_history_next(h, &item, 1)) > 0 && count++ < RECORDS)
		put_record(&json, &item);
	json_array_end(&json);
	if (got > 0)
		json_int(&json, "next", item.time_ns / NS_PER_MS);
	else
		json_null(&json, "next");
	json_finish(&json);
	if (got < 0)
		refuse(past, got);
}

static void run_records(struct job *job)
{
	struct past_job *past = (struct past_job *)job;
	struct ows_history_signal signal = {.name = ""};
	struct ows_history *h = NULL;
	int got;

	if (!open_history(past, &h))
		return;
	got = find(past, h, &signal);
	if (got >= 0)
		got = ows_history_read(h, got, past->from_ns, past->until_ns);
	if (got < 0)
		refuse(past, got);
	else
		put_records(past, h);
	ows_history_close(h);
}

static const char *identity_of(struct ows *h, const char *name)
{
	struct ows_info info;

	for (int i = 0; h && !ows_info(h, i, &info); i++)
		if (!strcmp(info.name, name))
			return info.identity;
	return name;
}

static int past_stretch(struct request *request, void (*run)(struct job *job))
{
	long long now_ms = when_now().wall / NS_PER_MS, until = now_ms, from = until - DAY_MS,
		  n = 500;
	const char *name = http_argument(request, "name");
	struct past_job *past;

	if (!name || !*name || strlen(name) >= NAME)
		return http_error(request, 400, "name=: expected the name of a signal");
	if (!number(request, "until", 1, TIME_MOST, &until))
		return http_error(request, 400, "until=: expected milliseconds since 1970");
	if (!http_argument(request, "from"))
		from = until - DAY_MS;
	if (!number(request, "from", 0, TIME_MOST, &from) || from >= until)
		return http_error(request, 400,
		                  "from=: expected milliseconds since 1970, before until");
	if (!number(request, "points", 1, POINTS, &n))
		return http_error(request, 400, "points=: expected a number from 1 to %d", POINTS);
	past = make(request, run);
	if (!past)
		return http_defer(request, WEB_PAST, NULL);
	snprintf(past->name, sizeof(past->name), "%s", name);
	snprintf(past->identity, sizeof(past->identity), "%s",
	         identity_of(request->web->face->ows, name));
	past->from_ns = from * NS_PER_MS;
	past->until_ns = until * NS_PER_MS;
	past->n = (int)n;
	return http_defer(request, WEB_PAST, &past->job);
}

int past_trend(struct request *request)
{
	return past_stretch(request, run_trend);
}

int past_records(struct request *request)
{
	return past_stretch(request, run_records);
}

/* --- The last hour ---------------------------------------------------------------------------- */

static void put_hour(struct past_job *past, struct ows *ows, struct ows_history *h)
{
	struct ows_history_point points[HOUR_POINTS];
	struct ows_history_signal signal;
	struct ows_info info;
	struct json json;
	int i;

	if (!job_json(&past->job, 200, &json))
		return;
	json_int(&json, "from", past->from_ns / NS_PER_MS);
	json_int(&json, "step", (past->until_ns - past->from_ns) / HOUR_POINTS / NS_PER_MS);
	json_object(&json, "signals");
	for (i = past->first; i < past->first + HOUR_SIGNALS && !ows_info(ows, i, &info); i++) {
		snprintf(past->name, sizeof(past->name), "%s", info.name);
		snprintf(past->identity, sizeof(past->identity), "%s", info.identity);
		if (read_points(past, h, &signal, points) != HOUR_POINTS)
			continue;
		json_object(&json, info.name);
		put_columns(&json, points, HOUR_POINTS, false);
		json_object_end(&json);
	}
	json_object_end(&json);
	if (i < ows_count(ows))
		json_int(&json, "next", i);
	else
		json_null(&json, "next");
	json_finish(&json);
}

static void run_hour(struct job *job)
{
	struct past_job *past = (struct past_job *)job;
	struct ows_history *h = NULL;
	struct ows *ows = NULL;

	if (!open_history(past, &h))
		return;
	if (ows_open_as(past->job.instance, OWS_READ, "owsd-web", &ows))
		job_error(job, 503, "owsd %s has not run yet: start it", past->job.instance);
	else
		put_hour(past, ows, h);
	ows_close(ows);
	ows_history_close(h);
}

int past_hour(struct request *request)
{
	struct past_job *past;
	long long first = 0;

	if (!number(request, "first", 0, INT_MAX - HOUR_SIGNALS, &first))
		return http_error(request, 400,
		                  "first=: expected the \"next\" of the answer before");
	past = make(request, run_hour);
	if (past) {
		past->first = (int)first;
		past->until_ns = when_now().wall;
		past->from_ns = past->until_ns - 3600 * NS_PER_S;
		past->n = HOUR_POINTS;
	}
	return http_defer(request, WEB_PAST, past ? &past->job : NULL);
}

/* --- Journals -------------------------------------------------------------------------------- */

/* Newest first: what is asked for most. */
static void put_journal(struct past_job *past, const struct journal_entries *entries,
                        const struct when *now)
{
	unsigned count = 0;
	struct json json;

	if (!job_json(&past->job, 200, &json))
		return;
	json_array(&json, "entries");
	for (unsigned i = entries->count; i-- > 0 && count < (unsigned)past->n;) {
		int64_t at_ns = now->wall - (now->boot - entries->entry[i].when_ns);

		if (at_ns < past->from_ns || at_ns >= past->until_ns)
			continue;
		journal_json(&json, now, &entries->entry[i], true);
		count++;
	}
	json_array_end(&json);
	json_finish(&json);
}

/* A history that cannot be read hides nothing of what owsd has in memory. */
static void run_journal(struct job *job)
{
	struct past_job *past = (struct past_job *)job;
	struct journal_entries entries = {0}, older = {0};
	struct ows_history *history = NULL;
	struct when now = when_now();
	struct ows *h = NULL;

	if (*past->directory && ows_history_open(NULL, past->directory, &history) == 0)
		journal_past(history, &now, past->from_ns, past->until_ns, NULL, 0,
		             (unsigned)past->n + RINGS, &older);
	if ((ows_open_as(past->job.instance, OWS_READ, "owsd-web", &h) == 0 &&
	     !journal_look(h, NULL, 0, &entries)) ||
	    !journal_past_drop(&older, &entries) || !journal_add(&entries, &older))
		job_error(job, 500, "no memory");
	else
		put_journal(past, &entries, &now);
	journal_free(&older);
	journal_free(&entries);
	ows_history_close(history);
	ows_close(h);
}

int past_journal(struct request *request)
{
	long long since = when_now().wall / NS_PER_MS - 7 * DAY_MS, until = TIME_MOST, n = 200;
	struct past_job *past;

	if (!number(request, "since", 0, TIME_MOST, &since))
		return http_error(request, 400, "since=: expected milliseconds since 1970");
	if (!number(request, "until", 0, TIME_MOST, &until))
		return http_error(request, 400, "until=: expected milliseconds since 1970");
	if (!number(request, "n", 1, ENTRIES, &n))
		return http_error(request, 400, "n=: expected a number from 1 to %d", ENTRIES);
	past = make(request, run_journal);
	if (past) {
		past->from_ns = since * NS_PER_MS;
		past->until_ns = until * NS_PER_MS;
		past->n = (int)n;
	}
	return http_defer(request, WEB_PAST, past ? &past->job : NULL);
}
