/* SPDX-License-Identifier: MIT */
/*
 * The reload: puts another configuration in place of the served one, and ends what does not stay;
 * what it left to do, and else has to be looked after.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/daemon/host/engine_thread.h"
#include "src/daemon/host/indicator.h"
#include "src/daemon/host/last.h"
#include "src/daemon/host/make.h"
#include "src/daemon/host/private.h"
#include "src/daemon/host/reload.h"
#include "src/daemon/serve/serve.h"
#include "src/ground/text/printable.h"
#include "src/memory/control/control.h"
#include "src/memory/shm/entries.h"
#include "src/memory/shm/futex.h"
#include "src/memory/shm/porter.h"
#include "src/public/ows.h"

/* The time that all buses which a reload ends may take together. */
#define END_NS (2 * NS_PER_S)
/* How often owsd tries what a reload could not finish. */
#define TEND_NS NS_PER_S
/* How often owsd logs that the image is lost. */
#define IMAGE_LOST_NS (60 * NS_PER_S)

static void pause_until_null(void *word)
{
	static const uint32_t never = 0;

	while (__atomic_load_n((void **)word, __ATOMIC_ACQUIRE))
		segment_wait(&never, 0, HOST_LOOK_NS);
}

/* End the workers that do not stay; false: one of them does not end. */
static bool end_workers(struct serving *before, const struct adoption *plan)
{
	for (unsigned i = 0; i < before->worker_count; i++)
		before->taken[i] = plan->port_successors[i] >= 0;
	return serving_stop(before, END_NS);
}

/* One thread at a time stores in the file. */
static bool end_last(struct host *h, struct serving *before)
{
	bool ended = last_stop(before->last, END_NS);

	if (!ended)
		log_err(h->log,
		        "the disk of the last commands is stuck; owsd stores none until it restarts");
	h->disk_stuck |= !ended;
	if (h->disk_stuck)
		last_give_up(h->now->last);
	return ended;
}

/*
 * Free what was served before. ended: its buses have ended; stored, dark: so have its threads of
 * the disk and of the lamps.
 */
static void leave_before(struct host *h, struct serving *before, bool ended, bool stored, bool dark)
{
	if (ended) {
		__atomic_store_n(&h->ended, before->engine, __ATOMIC_RELEASE);
		host_ring(h);
		pause_until_null(&h->ended);
	} else {
		log_err(h->log,
		        "a bus that the reload ended is stuck in the kernel; owsd gives it up");
	}
	if (dark)
		memory_replaced(&before->memory);
	else
		log_err(h->log,
		        "AlarmLine or HeartbeatLine is stuck in the kernel; owsd gives it up");
	if (!ended || !stored || !dark) {
		h->left_behind = true;
		return;
	}
	serving_free(before);
	free(before);
}

static bool same_listeners(const struct config_serve *a, const struct config_serve *b)
{
	if (a->address_count != b->address_count || a->peer_count != b->peer_count ||
	    a->read_only != b->read_only || !a->socket != !b->socket ||
	    (a->socket && strcmp(a->socket, b->socket) != 0))
		return false;
	for (unsigned i = 0; i < a->address_count; i++)
		if (!listen_same(&a->addresses[i], &b->addresses[i]))
			return false;
	for (unsigned i = 0; i < a->peer_count; i++)
		if (!listen_same_peers(&a->peers[i], &b->peers[i]))
			return false;
	return true;
}

static void report_unfinished(struct host *h, const char *why)
{
	if (log_rate(&h->finish_rate, ows_now()))
		log_err(h->log, "%s: owsd tries again every second", why);
}

/*
 * Try again what a reload could not finish after the engine had taken it; log and count it
 * until it is done. host_tend() calls it once a second.
 */
static void finish_reload(struct host *h)
{
	bool before = h->unfinished != 0;
	char why[512];

	if (h->unshown) {
		h->unshown = memory_show(&h->now->memory, h->log, why, sizeof(why)) != 0;
		if (h->unshown)
			report_unfinished(h, why);
		else
			control_replaced(h->control);
	}
	if (h->unstarted)
		h->unstarted = host_start_workers(h->now, why, sizeof(why)) ||
		               last_start(h->now->last) ||
		               (!h->indicator && host_start_indicator(h, why, sizeof(why)));
	if (h->unstarted)
		report_unfinished(h, why);
	__atomic_store_n(&h->unfinished, (uint32_t)h->unshown + h->unstarted, __ATOMIC_RELAXED);
	h->finish_ns = ows_now() + TEND_NS;
	if (h->unfinished)
		return;
	h->finish_rate = (struct log_rate){0};
	if (before)
		log_notice(h->log, "the rest of the reload is done");
}

/* Give next to the engine. From here on the reload cannot be refused any more. */
static void exchange_serving(struct host *h, struct serving *next, const struct adoption *plan)
{
	struct serving *before = h->now;
	bool dark, stored;

	control_prepare(h->control, next->config, &next->memory.layout);
	h->plan = plan;
	__atomic_store_n(&h->next, next, __ATOMIC_RELEASE);
	host_ring(h);
	pause_until_null(&h->next);
	control_reloaded(h->control);
	h->plan = NULL;
	h->unshown = true;
	h->unstarted =
		false; /* the threads start only after the old ones have released the hardware */
	finish_reload(h);
	if (h->serve)
		serve_reload(h->serve, next->config, &next->memory.image, plan->ports);
	dark = indicator_stop(h->indicator, END_NS);
	if (dark)
		indicator_destroy(h->indicator);
	h->indicator = NULL;
	stored = end_last(h, before);
	leave_before(h, before, end_workers(before, plan), stored, dark);
	h->unstarted = true;
	finish_reload(h);
}

bool host_may_reload(const struct host *h)
{
	return !h->unshown;
}

struct control *host_control(const struct host *h)
{
	return h->control;
}

void host_refused(struct host *h, int err, const char *why)
{
	char text[OWS_LINE];
	size_t len = printable_cut(why, sizeof(text) - 1);

	memcpy(text, why, len);
	image_refused(&h->now->memory.image, ows_now(), err == -ERESTART, text,
	              printable(text, len));
	__atomic_fetch_add(&h->refused_reloads, 1, __ATOMIC_RELAXED);
}

int host_reload(struct host *h, struct config *config, char *why, size_t why_size)
{
	struct adoption plan;
	struct serving *next;
	int err;

	if (!same_listeners(&config->serve, &h->now->config->serve)) {
		snprintf(why, why_size,
		         "Listen, ListenSocket, ListenAllow and ListenReadOnly "
		         "change by a restart only");
		return -ERESTART;
	}
	snprintf(why, why_size, "%s", strerror(ENOMEM));
	if (h->serve && serve_prepare(h->serve, config))
		return -ENOMEM;
	err = adoption_plan(&plan, config, h->now->config);
	if (err)
		return err;
	err = host_make_serving(h, config, &plan, &next, why, why_size);
	if (!err) {
		log_notice(h->log, "reload: %u signal%s, %u of them go on; %u target%s, %u of them",
		           config->item_count, config->item_count == 1 ? "" : "s", plan.kept_rows,
		           config->target_count, config->target_count == 1 ? "" : "s",
		           plan.kept_ports);
		exchange_serving(h, next, &plan);
	}
	adoption_free(&plan);
	return err;
}

/*
 * Log that the image is lost. Only a reload makes a new image, since all readers have to open it.
 */
static void look_for_image(struct host *h, int64_t now_ns)
{
	if ((h->image_lost_ns && now_ns - h->image_lost_ns < IMAGE_LOST_NS) ||
	    !memory_image_lost(&h->now->memory))
		return;
	h->image_lost_ns = now_ns;
	log_err(h->log,
	        "%s/%s.image was removed or replaced and programs that start now do not find it: "
	        "reload or restart owsd",
	        h->dir->path, h->instance);
}

/* While there is none, threads of owsd do what peers can make slow. */
static void tend_porter(struct host *h, int64_t now_ns)
{
	switch (porter_tend(h->porter, now_ns)) {
	case PORTER_ENDED:
		log_err(h->log, "the process for connections, owsd-porter, was killed: owsd starts "
		                "it again; until then programs that connect can delay owsd");
		return;
	case PORTER_FAILED:
		log_err(h->log, "the process for connections cannot be started: owsd tries again, "
		                "each minute at last");
		return;
	case PORTER_IS_BACK:
		log_notice(h->log, "the process for connections runs again (process %d)",
		           porter_process(h->porter));
		return;
	case PORTER_GOES_ON:
		return;
	}
}

void host_tend(struct host *h)
{
	int64_t now_ns = ows_now();

	if (h->porter)
		tend_porter(h, now_ns);
	if ((h->unshown || h->unstarted) && now_ns >= h->finish_ns)
		finish_reload(h);
	look_for_image(h, now_ns);
}
