/* SPDX-License-Identifier: MIT */
/* The links of the native bus: opened, grown, lost and recovered. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/bus/tap.h"
#include "hal/chips/thermometers/thermometer_proof.h"
#include "hal/native/answer.h"
#include "hal/native/branches.h"
#include "hal/native/first_asked.h"
#include "hal/native/master.h"
#include "hal/native/presence.h"

#define PAUSE_MIN_NS (NS_PER_S / 5)
#define PAUSE_MAX_NS (5 * NS_PER_S)
#define PAUSE_BACK_NS (NS_PER_S / 2) /* one that was there may be plugged in again */
#define GROW_MIN_NS NS_PER_S
#define GROW_MAX_NS (10 * NS_PER_S)
#define TROUBLE_NS (60 * NS_PER_S)

static const char gone[] =
	"the adapter is gone: look at its plug and its supply; owsd takes it again when it is back";

/* From the first on; those before are known. */
static void take_channels(struct native *native, unsigned first)
{
	struct tap *tap = native->bus.env->tap;

	native->channels = native->master->ops->channels(native->master);
	if (native->channels > NATIVE_CHANNELS)
		native->channels = NATIVE_CHANNELS;
	for (unsigned i = first; i < native->channels; i++) {
		struct link *link = native->master->ops->channel(native->master, i);

		if (tap && tap->link)
			link = tap->link(tap, i, link);
		native_open_channel(native, i, branches_wire(native, i, link), i);
	}
}

static void take_all_channels(struct native *native)
{
	take_channels(native, 0);
	memset(native->hold_ns, 0, sizeof(native->hold_ns));
	memset(native->holder, 0, sizeof(native->holder));
	native->grow_ns = native->master->ops->grow ? native_now(native) : INT64_MAX;
	native->grow_pause_ns = GROW_MIN_NS;
	native->grow_told = false;
	/* A chip that is missing now has taken its channels with it. */
	for (unsigned i = 0; i < native->table.count; i++)
		if (!native_has(native, native->table.devices[i].channel))
			presence_lost(native, &native->table.devices[i]);
}

/* After the master was opened, a link has failed, or while there is trouble. */
static void look_for_trouble(struct native *native, bool failed)
{
	char text[BUS_EVENT_TEXT] = "";

	if (native->master->ops->trouble)
		native->master->ops->trouble(native->master, failed, text, sizeof(text));
	native->trouble_ns = *text ? native_now(native) + TROUBLE_NS : INT64_MAX;
	if (strcmp(text, native->trouble) == 0)
		return;
	memcpy(native->trouble, text, sizeof(text));
	native_event(native, BUS_TROUBLE, NULL, 0, text);
}

void master_trouble(struct native *native, int64_t now, int64_t *next)
{
	if (now >= native->trouble_ns)
		look_for_trouble(native, false);
	*next = earlier_ns(native->trouble_ns, *next);
}

/* Masters or channels that were missing are looked for again, less and less often. */
void master_grow(struct native *native, int64_t now, int64_t *next)
{
	unsigned before = native->channels;
	char why[BUS_EVENT_TEXT] = "";

	if (now >= native->grow_ns) {
		int left = native->master->ops->grow(native->master, why, sizeof(why));

		if (left < 0) {
			master_down(native, left, why);
			return;
		}
		native->grow_ns = left ? native_now(native) + native->grow_pause_ns : INT64_MAX;
		native->grow_pause_ns = native->grow_pause_ns * 2 < GROW_MAX_NS
		                                ? native->grow_pause_ns * 2
		                                : GROW_MAX_NS;
		take_channels(native, before);
		for (unsigned n = before; n < native->channels; n++)
			native->channel[n].search_ns = now;
		if (*why && left && !native->grow_told)
			native_event(native, BUS_NOTE, NULL, -ENXIO, why);
		native->grow_told = left && *why;
	}
	*next = earlier_ns(native->grow_ns, *next);
}

/* All channels are searched at once. */
static void search_anew(struct native *native, int64_t now)
{
	for (unsigned n = native_next(native, 0); n < NATIVE_ALL; n = native_next(native, n + 1)) {
		native->channel[n].listed = false;
		native->channel[n].searching = native->channel[n].cuts = false;
		native->channel[n].search_ns = now;
		native->channel[n].first = (struct first){.tried = false};
	}
}

/*
 * What a master advises for one that is missing is for the first start. One that was there was
 * unplugged, or has lost its supply.
 */
static int open_master(struct native *native, char why[BUS_EVENT_TEXT])
{
	int err = native->master->ops->open(native->master, why, BUS_EVENT_TEXT);

	if (err == -ENODEV && native->up_ns)
		snprintf(why, BUS_EVENT_TEXT, "%s", gone);
	return err;
}

static void tell_down(struct native *native, int err, const char *why)
{
	if (bus_loss_news(&native->loss, err == -ENODEV))
		native_event(native, BUS_DOWN, NULL, err, why);
}

int64_t master_step(struct native *native, int64_t now)
{
	char why[BUS_EVENT_TEXT] = "";

	if (now < native->open_ns)
		return native->open_ns;
	int err = open_master(native, why);
	native->down_err = err;
	if (err) {
		int64_t most = native->up_ns ? PAUSE_BACK_NS : PAUSE_MAX_NS;

		native->pause_ns = native->pause_ns ? native->pause_ns * 2 : PAUSE_MIN_NS;
		if (native->pause_ns > most)
			native->pause_ns = most;
		native->open_ns = native_now(native) + native->pause_ns;
		if (err != -ECANCELED)
			tell_down(native, err, why);
		return native->open_ns;
	}
	native->pause_ns = 0;
	native->loss = (struct bus_loss){0};
	native->up = true;
	native->up_ns = native_now(native);
	take_all_channels(native);
	for (unsigned i = 0; i < native->table.count; i++)
		family_forget(&native->table.devices[i]);
	search_anew(native, native->up_ns);
	native_event(native, BUS_UP, NULL, 0, "");
	look_for_trouble(native, false);
	return native->up_ns;
}

void master_down(struct native *native, int err, const char *why)
{
	native->master->ops->close(native->master);
	native->up = false;
	native->down_err = err;
	native->open_ns = native_now(native) + PAUSE_MIN_NS;
	native->pause_ns = PAUSE_MIN_NS;
	for (struct job *job = NULL; (job = native_job(native, job));)
		job_answer(native, job, job->begun ? -ECONNRESET : -ENOTCONN);
	if (err)
		tell_down(native, err, why);
}

/* Conversions that were under way are void. */
static void convert_again(struct native *native)
{
	first_void(native);
	for (unsigned i = 0; i < native->table.count; i++)
		if (native->table.devices[i].family->thermometer)
			thermometer_void(&native->table.devices[i]);
	for (struct job *job = NULL; (job = native_job(native, job));)
		if (job->state == JOB_CONVERTING)
			job_restart(native, job);
}

/* Between two steps: a channel has forgotten that it is waited for, or is gone with its chip. */
static void begin_anew(struct native *native)
{
	for (struct job *job = NULL; (job = native_job(native, job));)
		if (job->state == JOB_DUE || job->state == JOB_PREPARE ||
		    (job->txn.device && !native_has(native, job->txn.channel)))
			job_restart(native, job);
}

static bool reopen_master(struct native *native)
{
	char why[BUS_EVENT_TEXT] = "";

	native->master->ops->close(native->master);
	int err = open_master(native, why);
	if (err) {
		master_down(native, err, why);
		return false;
	}
	take_all_channels(native);
	begin_anew(native);
	search_anew(native, native_now(native));
	return true;
}

static void power_cycled(struct native *native, unsigned channel)
{
	unsigned wire = native->channel[channel].wire;

	for (unsigned i = 0; i < native->table.count; i++) {
		struct device *device = &native->table.devices[i];

		if (device->present &&
		    (native->channel[device->channel].wire == wire || native->master->one_supply))
			presence_restarted(native, device);
	}
}

/* The recovery ladder (channel.rung): the link's own rungs are between the first and the last. */
enum { RETRY, OF_LINK, REOPEN = OF_LINK + LINK_RUNGS, GIVE_UP };

static const enum native_count counts[LINK_RUNGS] = {
	[LINK_BUS_RESET] = COUNT_BUS_RESETS,
	[LINK_CHIP_RESET] = COUNT_CHIP_RESETS,
	[LINK_POWER_CYCLE] = COUNT_POWER_CYCLES,
};

/* Climb rungs of the link until one is done. False: none was. */
static bool recover_link(struct native *native, unsigned n)
{
	struct channel *channel = &native->channel[n];
	struct link *link = channel->link;

	while (link->ops->recover && channel->rung < REOPEN) {
		enum link_rung rung = (enum link_rung)(channel->rung++ - OF_LINK);
		int done = link->ops->recover(link_wire(link), rung);

		if (done == -EOPNOTSUPP)
			continue;
		if (done == -EBUSY)
			channel->rung = REOPEN;
		native_count(native, counts[rung]);
		if (rung >= LINK_CHIP_RESET)
			convert_again(native);
		if (done == 0 && rung == LINK_POWER_CYCLE)
			power_cycled(native, n);
		if (done == 0 || done == -ECOMM) {
			look_for_trouble(native, true);
			return true;
		}
	}
	return false;
}

/*
 * After an error of a link: climb the ladder by one rung that has an effect. True: the caller may
 * try again, or the chip is gone and others are left. False: the master is down, and its jobs were
 * answered.
 */
bool master_recover(struct native *native, unsigned n, int err)
{
	struct channel *channel = &native->channel[n];

	native_count(native, COUNT_LINK_ERRORS);
	channel->errors++;
	if (err == -ENODEV || err == -ECANCELED) {
		master_down(native, err, err == -ENODEV ? gone : "shutting down");
		return false;
	}
	if (!native_has(native, n))
		return true;
	if (err == -ENXIO && channel->rung < OF_LINK + LINK_CHIP_RESET)
		channel->rung = OF_LINK + LINK_CHIP_RESET;
	if (channel->rung == RETRY) {
		channel->rung = OF_LINK;
		native_count(native, COUNT_RETRIES);
		look_for_trouble(native, true);
		return true;
	}
	if (recover_link(native, n))
		return true;
	if (channel->rung < GIVE_UP) {
		native_count(native, COUNT_REOPENS);
		if (!reopen_master(native))
			return false;
		look_for_trouble(native, true);
		convert_again(native);
		native->channel[n].rung = GIVE_UP;
		return true;
	}
	master_down(native, err, "the master chip does not recover");
	return false;
}

void master_good(struct native *native, unsigned channel)
{
	native->channel[channel].rung = RETRY;
}
