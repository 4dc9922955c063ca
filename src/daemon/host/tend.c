/* SPDX-License-Identifier: MIT */
/* The supervisor's upkeep: looks for the image, and finishes what a reload has left to do. */
#include <string.h>

#include "hal/base/time.h"
#include "src/daemon/host/last.h"
#include "src/daemon/host/make.h"
#include "src/daemon/host/private.h"
#include "src/daemon/host/tend.h"
#include "src/memory/control/control.h"
#include "src/memory/shm/porter.h"
#include "src/public/ows.h"

/* How often owsd tries what a reload could not finish. */
#define TEND_NS NS_PER_S
/* How often owsd logs that the image is lost. */
#define IMAGE_LOST_NS (60 * NS_PER_S)

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

static void report_unfinished(struct host *h, const char *why)
{
	if (log_rate(&h->finish_rate, ows_now()))
		log_err(h->log, "%s: owsd tries again every second", why);
}

void host_finish_reload(struct host *h)
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
		host_finish_reload(h);
	look_for_image(h, now_ns);
}
