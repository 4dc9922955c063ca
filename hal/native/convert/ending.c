/* SPDX-License-Identifier: MIT */
/* When to ask whether a conversion has ended, and what follows. */
#include <errno.h>

#include "hal/chips/thermometers/thermometer_proof.h"
#include "hal/native/convert/ending.h"
#include "hal/native/master.h"

/* The first question, and the next ones; earlier than the last end was, as it varies a little. */
#define FIRST_SHARE 2 /* of the longest time */
#define AGAIN_NS (10 * TXN_MS)
#define BEFORE_SHARE 16

static bool is_early(const struct job *job, unsigned n, int64_t now)
{
	const struct device *device = job->txn.device;

	/* What else a family makes of a conversion looks at no proof. */
	return job->state == JOB_CONVERTING && device && device->channel == n &&
	       job->ready_ns > now + AGAIN_NS && device->power == POWER_EXTERNAL && job->property &&
	       job->property->type == PROPERTY_TEMPERATURE && thermometer_last(device).can_prove;
}

void ending_begin(struct native *native, unsigned n, int64_t longest)
{
	struct channel *channel = &native->channel[n];
	struct ending *ending = &channel->ending;
	int64_t now = native_now(native), before = ending->took_ns / BEFORE_SHARE;

	ending->resets = link_cost_of(channel->link).resets;
	ending->asks = ending->resets && !channel->trunk && channel->link->facts->splits &&
	               n < NATIVE_CHANNELS;
	ending->begun_ns = now;
	ending->next_ns = now + longest / FIRST_SHARE;
	if (ending->took_ns - before > longest / FIRST_SHARE && ending->took_ns < longest)
		ending->next_ns = now + ending->took_ns - before;
}

static void ended(struct native *native, unsigned n, int64_t now)
{
	struct ending *ending = &native->channel[n].ending;

	ending->took_ns = now - ending->begun_ns;
	for (struct job *job = NULL; (job = native_job(native, job));) {
		if (!is_early(job, n, now))
			continue;
		thermometer_seems_over(job->txn.device, now);
		job->ready_ns = now;
	}
}

static void ending_ask(struct native *native, unsigned n)
{
	struct link *link = native->channel[n].link;
	struct ending *ending = &native->channel[n].ending;
	uint8_t busy = 0;
	const struct link_part slots = {.in = &busy, .in_n = 1};
	int err = link->ops->run(link, &slots);
	int64_t now = native_now(native);

	native_count(native, COUNT_TRANSACTIONS);
	ending->next_ns = now + AGAIN_NS;
	ending->asks = !err && busy != 0xff;
	if (!err && busy == 0xff)
		ended(native, n, now);
	if (!err)
		master_good(native, n);
	else if (err != -ECOMM && err != -EHOSTDOWN)
		master_recover(native, n, err);
}

static bool has_early(const struct native *native, unsigned n, int64_t now)
{
	for (const struct job *job = NULL; (job = native_job(native, job));)
		if (is_early(job, n, now))
			return true;
	return false;
}

bool ending_step(struct native *native, int64_t now, int64_t *next)
{
	for (unsigned n = 0; n < native->channels; n++) {
		struct ending *ending = &native->channel[n].ending;

		if (!ending->asks)
			continue;
		/* A question would end the strong pull-up of another channel of the chip. */
		int64_t held = native_held(native, n, NULL, now);
		if (held) {
			*next = earlier_ns(held, *next);
			continue;
		}
		ending->asks = link_cost_of(native->channel[n].link).resets == ending->resets &&
		               has_early(native, n, now);
		if (!ending->asks)
			continue;
		if (ending->next_ns <= now) {
			ending_ask(native, n);
			return true;
		}
		*next = earlier_ns(ending->next_ns, *next);
	}
	return false;
}
