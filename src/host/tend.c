/* SPDX-License-Identifier: MIT */
/* The supervisor's upkeep: repairs the shared memory, and finishes what a reload has left to do. */
#include <errno.h>
#include <string.h>

#include "hal/bus/time.h"
#include "src/host/engine_thread.h"
#include "src/host/make.h"
#include "src/host/private.h"
#include "src/host/tend.h"
#include "src/libows/ows.h"
#include "src/shm/hint.h"
#include "src/shm/segment.h"

/* Where a consumer removes the command segment again and again, owsd makes it once a second. */
#define TEND_NS NS_PER_S
/* How often owsd logs that the image is lost. */
#define IMAGE_LOST_NS (60 * NS_PER_S)

static int show_renewed(struct host *h)
{
	int err = memory_show_commands(&h->now->memory);

	if (err)
		return err;
	h->unseen = false;
	h->tend_rate = (struct log_rate){0};
	return 0;
}

static int renew_commands(struct host *h)
{
	struct commands *renewed;
	int err = 0;

	/*
	 * memory_renew_commands() unmaps the segment before the lost one, which a slow thread may
	 * still use
	 */
	host_wait_for_ringers(h);
	renewed = memory_renew_commands(&h->now->memory, &err);
	if (!renewed)
		return err;
	h->unseen = true;
	__atomic_store_n(&h->renewed, renewed, __ATOMIC_RELEASE);
	host_ring(h);
	return 0;
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
	        "/dev/shm/owsd.%s.image was removed or replaced and programs that start now do not find it: "
	        "reload or restart owsd (of an ordinary user, logind's RemoveIPC= removes it at log-out)",
	        h->instance);
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

	if (h->unshown)
		h->unshown = memory_show(&h->now->memory, h->log, why, sizeof(why)) != 0;
	if (h->unshown)
		report_unfinished(h, why);
	if (h->unstarted)
		h->unstarted = host_start_workers(h->now, why, sizeof(why)) ||
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

void host_tend(struct host *h)
{
	int64_t now_ns = ows_now();
	char hint[SEGMENT_HINT];
	int err = 0;

	if ((h->unshown || h->unstarted) && now_ns >= h->finish_ns)
		host_finish_reload(h);
	look_for_image(h, now_ns);
	if (__atomic_load_n(&h->renewed, __ATOMIC_ACQUIRE)) /* the engine has not filled it yet */
		return;
	if (now_ns < h->tend_ns)
		return;
	if (h->unseen) {
		err = show_renewed(h);
		h->tend_ns = now_ns + TEND_NS;
	} else if (memory_commands_lost(&h->now->memory)) {
		err = renew_commands(h);
		h->tend_ns = err ? now_ns + TEND_NS : 0;
	}
	if (err && log_rate(&h->tend_rate, now_ns))
		log_err(h->log,
		        "the command segment was removed and cannot be made again: %s%s: "
		        "owsd tries again every second",
		        strerror(-err), segment_hint(h->instance, err, hint));
}
