/* SPDX-License-Identifier: MIT */
/* A thread that does jobs. */
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/bell.h"
#include "hal/base/time.h"
#include "src/faces/show/json.h"
#include "src/faces/web/head.h"
#include "src/faces/web/jobs.h"

struct queue {
	struct job *first, **last;
	unsigned count;
};

struct jobs {
	int bell;
	pthread_t thread;
	pthread_mutex_t lock;
	pthread_cond_t woken;
	struct queue wait, done;
	uint64_t turn; /* of the job that was taken last */
	bool ended;
};

static void jobs_put(struct queue *queue, struct job *job)
{
	job->next = NULL;
	*queue->last = job;
	queue->last = &job->next;
	queue->count++;
}

/* After all jobs of its turn. A peer has one job in each turn. False: it has too many. */
static bool put_fairly(struct queue *queue, struct job *job, uint64_t turn)
{
	struct job **at = &queue->first;
	unsigned same = 0;

	job->turn = turn;
	for (const struct job *other = queue->first; other; other = other->next) {
		if (other->peer != job->peer)
			continue;
		job->turn = other->turn;
		same++;
	}
	job->turn++;
	if (queue->count == JOBS || same == JOBS_OF_PEER)
		return false;
	while (*at && (*at)->turn <= job->turn)
		at = &(*at)->next;
	job->next = *at;
	*at = job;
	if (!job->next)
		queue->last = &job->next;
	queue->count++;
	return true;
}

static struct job *jobs_get(struct queue *queue)
{
	struct job *job = queue->first;

	if (!job)
		return NULL;
	queue->first = job->next;
	if (!queue->first)
		queue->last = &queue->first;
	queue->count--;
	return job;
}

static void *work(void *ctx)
{
	struct jobs *jobs = ctx;
	struct job *job;

	pthread_mutex_lock(&jobs->lock);
	while (!jobs->ended) {
		job = jobs_get(&jobs->wait);
		if (!job) {
			pthread_cond_wait(&jobs->woken, &jobs->lock);
			continue;
		}
		jobs->turn = job->turn;
		pthread_mutex_unlock(&jobs->lock);
		job->run(job);
		pthread_mutex_lock(&jobs->lock);
		jobs_put(&jobs->done, job);
		bell_ring(jobs->bell);
	}
	while ((job = jobs_get(&jobs->wait)))
		jobs_put(&jobs->done, job);
	pthread_mutex_unlock(&jobs->lock);
	return NULL;
}

struct jobs *jobs_start(int bell)
{
	struct jobs *jobs = calloc(1, sizeof(*jobs));

	if (!jobs)
		return NULL;
	jobs->bell = bell;
	jobs->wait.last = &jobs->wait.first;
	jobs->done.last = &jobs->done.first;
	pthread_mutex_init(&jobs->lock, NULL);
	pthread_cond_init(&jobs->woken, NULL);
	if (pthread_create(&jobs->thread, NULL, work, jobs) == 0)
		return jobs;
	jobs->ended = true;
	free(jobs);
	return NULL;
}

bool jobs_give(struct jobs *jobs, struct job *job)
{
	bool room;

	pthread_mutex_lock(&jobs->lock);
	room = put_fairly(&jobs->wait, job, jobs->turn);
	pthread_cond_signal(&jobs->woken);
	pthread_mutex_unlock(&jobs->lock);
	return room;
}

struct job *jobs_take(struct jobs *jobs)
{
	struct job *job;

	pthread_mutex_lock(&jobs->lock);
	job = jobs_get(&jobs->done);
	pthread_mutex_unlock(&jobs->lock);
	return job;
}

void jobs_end(struct jobs *jobs)
{
	pthread_mutex_lock(&jobs->lock);
	jobs->ended = true;
	pthread_cond_signal(&jobs->woken);
	pthread_mutex_unlock(&jobs->lock);
	pthread_join(jobs->thread, NULL);
}

void jobs_free(struct jobs *jobs)
{
	pthread_cond_destroy(&jobs->woken);
	pthread_mutex_destroy(&jobs->lock);
	free(jobs);
}

void job_free(struct job *job)
{
	posted_free(&job->posted);
	free(job->text);
	free(job);
}

bool job_json(struct job *job, unsigned status, struct json *json)
{
	job->status = status;
	return json_start(json, &job->text, &job->len);
}

void job_error(struct job *job, unsigned status, const char *format, ...)
{
	char words[512];
	struct json json;
	va_list args;

	va_start(args, format);
	vsnprintf(words, sizeof(words), format, args);
	va_end(args);
	free(job->text);
	job->text = NULL;
	if (!job_json(job, status, &json))
		return;
	json_string(&json, "error", words);
	json_finish(&json);
}

/* --- The body of a request ------------------------------------------------------------------- */

void posted_begin(struct posted *posted, size_t size, unsigned *large, bool may, int64_t now_ns)
{
	*posted = (struct posted){.size = size, .until_ns = now_ns + POSTED_S * NS_PER_S};
	if (size <= BODY_MAX)
		return;
	posted->dropped = !may || *large == POSTED_LARGE;
	if (posted->dropped)
		return;
	posted->large = large;
	++*large;
}

bool posted_add(struct posted *posted, const char *bytes, size_t len, int64_t now_ns)
{
	if (len > posted->size - posted->len || now_ns > posted->until_ns)
		return false;
	if (!posted->dropped && !posted->bytes)
		posted->bytes = malloc(posted->size);
	if (!posted->dropped && !posted->bytes)
		return false;
	if (!posted->dropped)
		memcpy(posted->bytes + posted->len, bytes, len);
	posted->len += len;
	return true;
}

void posted_free(struct posted *posted)
{
	if (posted->large)
		--*posted->large;
	free(posted->bytes);
	*posted = (struct posted){0};
}
