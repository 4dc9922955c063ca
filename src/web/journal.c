/* SPDX-License-Identifier: MIT */
/* The journals, on a worker: owsd may have ended, and its memory be there still. */
#include <errno.h>
#include <stdlib.h>

#include "hal/bus/time.h"
#include "src/show/journal_entry.h"
#include "src/web/http.h"
#include "src/web/journal.h"

#define ENTRIES 1000
#define DAY_MS (86400 * 1000LL)

struct journal_job {
	struct job job;
	char instance[128];
	int64_t from_ns;
	unsigned n;
};

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

/* Newest first: what is asked for most. */
static void put(struct journal_job *asked, const struct journal_entries *entries,
                const struct when *now)
{
	FILE *out = open_memstream(&asked->job.text, &asked->job.len);
	unsigned count = 0;
	struct json json;

	if (!out)
		return;
	asked->job.status = 200;
	json_open(&json, out);
	json_object(&json, NULL);
	json_array(&json, "entries");
	for (unsigned i = entries->count; i-- > 0 && count < asked->n;) {
		if (now->wall - (now->boot - entries->entry[i].when_ns) < asked->from_ns)
			continue;
		journal_json(&json, now, &entries->entry[i]);
		count++;
	}
	json_array_end(&json);
	json_object_end(&json);
	json_end(&json);
	fclose(out);
}

static void run(struct job *job)
{
	struct journal_job *asked = (struct journal_job *)job;
	struct journal_entries entries = {0};
	struct when now = when_now();
	struct ows *h = NULL;

	if (ows_open_as(asked->instance, OWS_READ, "owsd-web", &h) == 0 &&
	    !journal_look(h, NULL, 0, &entries))
		job_error(job, 500, "no memory");
	else
		put(asked, &entries, &now);
	journal_free(&entries);
	ows_close(h);
}

int journal_answer(struct request *request)
{
	long long since = when_now().wall / NS_PER_MS - 7 * DAY_MS, n = 200;
	const struct web *web = request->web;
	struct journal_job *asked;

	if (!number(request, "since", 0, 4000000000000LL, &since))
		return http_error(request, 400, "since=: expected milliseconds since 1970");
	if (!number(request, "n", 1, ENTRIES, &n))
		return http_error(request, 400, "n=: expected a number from 1 to %d", ENTRIES);
	asked = calloc(1, sizeof(*asked));
	if (!asked)
		return http_defer(request, web->past, NULL);
	asked->job.run = run;
	snprintf(asked->instance, sizeof(asked->instance), "%s", web->face->arguments->instance);
	asked->from_ns = since * NS_PER_MS;
	asked->n = (unsigned)n;
	return http_defer(request, web->past, &asked->job);
}
