/* SPDX-License-Identifier: MIT */
/* Asks the pages of other machines, each on a thread, and keeps what they answered last. */
#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "hal/base/time.h"
#include "src/faces/web/ask.h"
#include "src/faces/web/others.h"
#include "src/public/ows.h"

#define EVERY_S 10
#define DEADLINE_NS (2 * NS_PER_S)
#define OLD_NS (30 * NS_PER_S) /* an answer that old counts no more, whatever holds up the next */
#define STACK (256u << 10)     /* of a thread: an answer, and what the resolver wants */
/* At once, with those of lists before, which a silent name server may hold. */
#define THREADS_MAX (2u * OTHERS_MAX)

struct other {
	struct others *all;
	struct other_place place;
	/* under the lock of all */
	struct summary summary; /* as it was at heard_ns */
	int64_t heard_ns;       /* the last good answer; 0: there was none */
	int64_t since_ns;       /* since when it answers; before the first answer: was asked */
	bool asked, answers;
	char why[ASK_WORDS]; /* it does not answer */
};

struct others {
	pthread_mutex_t lock;
	pthread_cond_t woken;
	unsigned users; /* the loop, and each thread */
	bool ended;
	char *list;
	unsigned count;
	struct other other[];
};

static atomic_uint threads;

/* Under the lock, which it gives back. */
static void leave(struct others *others)
{
	bool last = --others->users == 0;

	pthread_mutex_unlock(&others->lock);
	if (!last)
		return;
	pthread_cond_destroy(&others->woken);
	pthread_mutex_destroy(&others->lock);
	free(others->list);
	free(others);
}

static void note(struct other *other, const struct summary *summary, const char *why,
                 int64_t began_ns)
{
	if (!other->asked)
		other->since_ns = began_ns;
	if (summary) {
		if (!other->answers)
			other->since_ns = began_ns;
		other->summary = *summary;
		other->heard_ns = ows_now();
	} else {
		snprintf(other->why, sizeof(other->why), "%s", why);
	}
	other->answers = summary;
	other->asked = true;
}

static void *ask_again(void *ctx)
{
	struct other *other = ctx;
	struct others *all = other->all;
	struct summary summary;
	char why[ASK_WORDS];

	pthread_mutex_lock(&all->lock);
	while (!all->ended) {
		int64_t now_ns = ows_now();
		struct timespec until;
		bool is;

		pthread_mutex_unlock(&all->lock);
		is = ask_summary(&other->place, now_ns + DEADLINE_NS, &summary, why);
		pthread_mutex_lock(&all->lock);
		note(other, is ? &summary : NULL, why, now_ns);
		clock_gettime(CLOCK_MONOTONIC, &until);
		until.tv_sec += EVERY_S;
		while (!all->ended &&
		       pthread_cond_timedwait(&all->woken, &all->lock, &until) != ETIMEDOUT)
			continue;
	}
	leave(all);
	threads--;
	return NULL;
}

static bool start(struct other *other)
{
	pthread_attr_t how;
	pthread_t thread;
	bool is;

	if (threads >= THREADS_MAX)
		return false;
	threads++;
	pthread_attr_init(&how);
	pthread_attr_setdetachstate(&how, PTHREAD_CREATE_DETACHED);
	pthread_attr_setstacksize(&how, STACK);
	is = pthread_create(&thread, &how, ask_again, other) == 0;
	pthread_attr_destroy(&how);
	if (!is)
		threads--;
	return is;
}

/* Those of the list that can be asked. */
static unsigned take_list(struct others *others)
{
	const char *text = others->list, *why;
	struct other_place place;
	unsigned n = 0;

	while (n < OTHERS_MAX && other_next(&text, &place, &why))
		if (!why)
			others->other[n++] = (struct other){.all = others, .place = place};
	return n;
}

struct others *others_begin(const char *list)
{
	pthread_condattr_t clock;
	struct others *others;

	if (!list)
		return NULL;
	others = calloc(1, sizeof(*others) + OTHERS_MAX * sizeof(others->other[0]));
	if (!others)
		return NULL;
	pthread_mutex_init(&others->lock, NULL);
	pthread_condattr_init(&clock);
	pthread_condattr_setclock(&clock, CLOCK_MONOTONIC);
	pthread_cond_init(&others->woken, &clock);
	pthread_condattr_destroy(&clock);
	others->list = strdup(list);
	pthread_mutex_lock(&others->lock);
	others->users = 1;
	others->count = others->list ? take_list(others) : 0;
	for (unsigned i = 0; i < others->count; i++)
		if (start(&others->other[i]))
			others->users++;
		else
			note(&others->other[i], NULL,
			     "it is not asked, for want of a thread: reload owsd later", ows_now());
	if (!others->count) {
		leave(others);
		return NULL;
	}
	pthread_mutex_unlock(&others->lock);
	return others;
}

void others_end(struct others *others)
{
	if (!others)
		return;
	pthread_mutex_lock(&others->lock);
	others->ended = true;
	pthread_cond_broadcast(&others->woken);
	leave(others);
}

unsigned others_count(const struct others *others)
{
	return others ? others->count : 0;
}

bool others_has(const struct others *others, const char *list)
{
	return others ? list && !strcmp(others->list, list) : !list;
}

static void other_json(struct json *json, const struct other *other, int64_t now_ns)
{
	bool old = now_ns - other->heard_ns > OLD_NS, answers = other->answers && !old;
	int64_t since_ns = answers || !other->heard_ns ? other->since_ns : other->heard_ns;

	json_object(json, NULL);
	json_string(json, "name", other->place.name);
	json_string(json, "page", *other->place.page ? other->place.page : NULL);
	if (!other->asked) {
		json_null(json, "answers");
		json_null(json, "since");
	} else {
		json_bool(json, "answers", answers);
		json_seconds(json, "since", now_ns - since_ns);
	}
	if (answers) {
		json_seconds(json, "age", now_ns - other->heard_ns);
		json_null(json, "why");
		json_object(json, "summary");
		summary_json(json, &other->summary);
		json_object_end(json);
	} else {
		json_null(json, "age");
		json_string(json, "why",
		            !other->asked    ? NULL
		            : other->answers ? "it does not answer in time"
		                             : other->why);
		json_null(json, "summary");
	}
	json_object_end(json);
}

void others_json(struct others *others, struct json *json, int64_t now_ns)
{
	if (!others)
		return;
	pthread_mutex_lock(&others->lock);
	for (unsigned i = 0; i < others->count; i++)
		other_json(json, &others->other[i], now_ns);
	pthread_mutex_unlock(&others->lock);
}
