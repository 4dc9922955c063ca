/* SPDX-License-Identifier: MIT */
/* What a bus tells by itself, and a bus that tells nothing. */
#include "private.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

void lane_up(struct lane *lane, const char *text, int64_t now_ns)
{
	struct engine *e = lane->engine;

	if (lane->up)
		return;
	lane->up = true;
	engine_group(e, lane)->quiet = false;
	engine_way(e, lane)->up = true;
	engine_way(e, lane)->failed = lane->stuck;
	engine_way(e, lane)->up_ns = now_ns;
	if (lane->was_up) {
		lane->counters.reconnects++;
		e->reconnects++;
	}
	log_notice(e->log, "%s: from down to up%s%s", lane->port->target, *text ? ": " : "", text);
	lane->was_up = true;
	engine_publish_target(e, lane);
	engine_publish_driver(e, now_ns);
	engine_lane_up(e, lane, now_ns);
	engine_group_check(e, lane->port->group, now_ns);
}

/*
 * A server with a cache may give the same value again and again, and nobody sees that: once for each
 * target, those are named who ask it more often than it looks.
 */
static void say_cached(const struct lane *lane, int64_t cache_ns)
{
	const struct engine *e = lane->engine;
	const struct signal *first = NULL;
	unsigned count = 0;

	for (uint32_t row = 0; row < e->table.count; row++) {
		const struct signal *s = &e->table.signals[row];

		if (s->lane != lane->index || s->device == TABLE_NO_DEVICE || !signal_reads(s) ||
		    s->item->fresh || s->item->alarm ||
		    e->config->period_ns >= cache_ns / s->item->per_factor)
			continue;
		first = first ? first : s;
		count++;
	}
	if (count)
		log_notice(e->log, "%s: answers from a cache of %lld s, and %u of its signals (%s%s) "
		           "are read more often: Uncached on reads the device each time, "
		           "timeout_volatile in owfs.conf shortens the cache",
		           lane->port->target, (long long)(cache_ns / 1000000000), count,
		           first->item->name, count > 1 ? ", ..." : "");
}

/* Whatever another target does not take over goes bad. */
static void fail(struct lane *lane, int err, int64_t now_ns)
{
	struct engine *e = lane->engine;
	struct route_way *way = engine_way(e, lane);

	if (!way->failed)
		way->failed_ns = now_ns;
	way->failed = true;
	way->up = false;
	lane_forget_probes(lane);
	lane_disown_alarm(lane);
	engine_group_check(e, lane->port->group, now_ns);
	engine_lane_down(e, lane, err, now_ns);
}

static void go_down(struct lane *lane, int err, const char *text, int64_t now_ns)
{
	struct engine *e = lane->engine;

	log_at(e->log, engine_group(e, lane)->quiet ? LOG_LEVEL_DEBUG : LOG_LEVEL_WARNING,
	       "%s: %s: %s", lane->port->target, lane->up ? "from up to down" : "down",
	       *text ? text : strerror(-err));
	lane->up = false;
	lane->counters.target_failures++;
	engine_publish_target(e, lane);
	fail(lane, err, now_ns);
}

static int compare_rom(const void *rom, const void *device)
{
	return memcmp(rom, ((const struct device *)device)->rom, 8);
}

/* Those with a ROM id stand first, in its order. */
static uint32_t device_of(struct engine *e, const uint8_t rom[8])
{
	const struct device *d;
	uint32_t roms = 0;

	for (uint32_t low = 0, high = e->table.device_count; low < high;) {
		uint32_t middle = low + (high - low) / 2;

		if (e->table.devices[middle].has_rom)
			low = middle + 1;
		else
			high = middle;
		roms = low;
	}
	d = bsearch(rom, e->table.devices, roms, sizeof(*d), compare_rom);
	return d ? (uint32_t)(d - e->table.devices) : TABLE_NO_DEVICE;
}

static void device_event(struct lane *lane, const struct bus_event *event, int64_t now_ns)
{
	struct engine *e = lane->engine;
	uint32_t index = device_of(e, event->rom);
	struct device *device;

	if (index == TABLE_NO_DEVICE)
		return;
	device = &e->table.devices[index];
	if (event->news == BUS_FOUND)
		engine_place_found(e, lane, index);
	if (engine_open_lane(e, device->group) != lane) {
		if (event->news == BUS_LOST)
			engine_place(e, lane, index, ROUTE_ABSENT);
	} else if (event->news == BUS_LOST) {
		/* its signals go bad by their own failures; what comes back may have restarted */
		device->absent = true;
		engine_place(e, lane, index, ROUTE_ABSENT);
	} else if (event->news == BUS_POR || device->absent) {
		engine_device_back(e, lane, device, now_ns);
	}
}

static void said_up(struct lane *lane, const struct bus_event *event, int64_t now_ns)
{
	struct route_way *way = engine_way(lane->engine, lane);

	lane->said_up = true;
	if (lane->open) {
		bool first = !lane->was_up;

		lane_up(lane, event->text, now_ns);
		if (first && event->cache_ns)
			say_cached(lane, event->cache_ns);
	} else if (!lane->port->suspend && !way->back) { /* it cannot say so otherwise */
		way->back = true;
		way->back_ns = now_ns;
	}
}

/* What a way says that was asked to let go is of no interest, but for these two. */
static void suspended_event(struct lane *lane, const struct bus_event *event, int64_t now_ns)
{
	struct engine *e = lane->engine;
	struct route_way *way = engine_way(e, lane);

	if (lane->open)
		return;
	if (event->news == BUS_BACK) {
		way->back = true;
		way->back_ns = now_ns;
		log_debug(e->log, "%s: can be reached, and is kept closed", lane->port->target);
	} else if (!way->released) {
		way->released = true;
		engine_publish_target(e, lane);
		engine_doubts(e);
	}
	engine_group_check(e, lane->port->group, now_ns);
}

void lane_event(struct lane *lane, const struct bus_event *event, int64_t now_ns)
{
	lane->heard_ns = now_ns;
	switch ((enum bus_news)event->news) {
	case BUS_UP:
		said_up(lane, event, now_ns);
		break;
	case BUS_DOWN:
		lane->said_up = false;
		if (lane->open)
			go_down(lane, event->err, event->text, now_ns);
		break;
	case BUS_FOUND:
	case BUS_POR:
	case BUS_LOST:
		if (lane->open)
			device_event(lane, event, now_ns);
		break;
	case BUS_RELEASED:
	case BUS_BACK:
		suspended_event(lane, event, now_ns);
		break;
	case BUS_NOTE:
		log_notice(lane->engine->log, "%s: %s", lane->port->target, event->text);
		break;
	}
}

/*
 * The bus said nothing at all since the request began, or all it takes was given up: it is stuck,
 * not one device slow.
 */
void lane_stuck(struct lane *lane, int64_t now_ns)
{
	lane->stuck = true;
	if (!lane->open)
		return;
	log_err(lane->engine->log, "%s: no answer at all within Timeout", lane->port->target);
	lane->counters.target_failures++;
	fail(lane, -ETIMEDOUT, now_ns);
}

void lane_unstuck(struct lane *lane, int64_t now_ns)
{
	struct engine *e = lane->engine;
	struct route_way *way = engine_way(e, lane);

	lane->stuck = false;
	log_notice(e->log, "%s: answers again", lane->port->target);
	if (!lane->up)
		return;
	way->failed = false;
	way->up = true;
	way->up_ns = now_ns;
	engine_lane_up(e, lane, now_ns);
	engine_group_check(e, lane->port->group, now_ns);
}
