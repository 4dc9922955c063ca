/* SPDX-License-Identifier: MIT */
/*
 * The guests of the lanes: requests of clients of the served protocol wait here for their turns,
 * are lent to the bus and answered.
 */
#include <errno.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/owfs/path.h"
#include "src/daemon/engine/guest.h"
#include "src/daemon/engine/guests.h"
#include "src/daemon/engine/lane.h"
#include "src/daemon/engine/publish.h"
#include "src/daemon/engine/retry.h"
#include "src/daemon/engine/schedule.h"

/* So many requests of a busy table go before a guest that waits. */
#define GUEST_PASSED 4
#define GUESTS_LENT 64
#define GUESTS_AS_INPUTS 16
/*
 * How long one that came through another server waits for its turn: two servers that have each
 * other as targets may wait for each other's only connection.
 */
#define GUEST_SERVER_NS (2 * NS_PER_S)

static void answer_guest(struct engine *e, struct engine_guest *g)
{
	g->generation = e->image->header->generation;
	e->guests->answered(e->guests->ctx, g);
}

static void guest_waits(struct lane *lane, struct engine_guest *g)
{
	g->next = NULL;
	g->at = lane->index;
	if (lane->guests.last)
		lane->guests.last->next = g;
	else
		lane->guests.first = g;
	lane->guests.last = g;
}

static struct engine_guest *guest_leaves(struct lane *lane)
{
	struct engine_guest *g = lane->guests.first;

	lane->guests.first = g->next;
	if (!g->next)
		lane->guests.last = NULL;
	return g;
}

/*
 * The more precise of two errors: a missing property, then a missing device, then a target that is
 * down.
 */
static int more_telling(int a, int b)
{
	static const int order[] = {-ENOTCONN, -ENODEV, -ENXIO, -ENOENT};
	int at_a = -1, at_b = -1;

	for (int i = 0; i < 4; i++) {
		at_a = order[i] == a ? i : at_a;
		at_b = order[i] == b ? i : at_b;
	}
	return at_b > at_a || a == 0 ? b : a;
}

/* May another lane have what this one has not? Nothing was done there. */
static bool guest_goes_on(const struct engine_guest *g, int err)
{
	return g->lane == GUEST_ANY_LANE &&
	       (err == -ENODEV || err == -ENXIO || err == -ENOENT || err == -ENOTCONN);
}

/* The next lane that is asked; false: there is none. */
static bool guest_next_lane(struct engine *e, struct engine_guest *g)
{
	unsigned at = g->at;

	/* behind the first, which the table may have chosen, in their order */
	for (unsigned i = at == g->served ? 0 : at + 1; i < e->lane_count; i++) {
		if (i == g->served)
			continue;
		guest_waits(&e->lanes[i], g);
		return true;
	}
	return false;
}

static void guest_failed(struct engine *e, struct engine_guest *g, int err)
{
	g->best_err = more_telling(g->best_err, err);
	if (guest_goes_on(g, err) && guest_next_lane(e, g))
		return;
	g->answer = (struct bus_answer){.err = g->best_err};
	answer_guest(e, g);
}

/* The lane that serves the device of the path, if the table knows it. */
static unsigned lane_of_path(const struct engine *e, const char *path)
{
	struct path split;
	uint32_t device;

	if (path_split(path, strlen(path), &split) || !split.has_rom)
		return 0;
	device = table_device(&e->table, split.rom);
	if (device == TABLE_NO_DEVICE)
		return 0;
	return e->table.devices[device].signals[0]->lane;
}

static void look_at_waiting(struct engine *e, struct lane *lane)
{
	struct engine_guest *g = lane->guests.first;

	lane->guests.first = lane->guests.last = NULL;
	while (g) {
		struct engine_guest *next = g->next;

		if (!lane->state.up || lane->state.stuck)
			guest_failed(e, g, -ENOTCONN);
		else if (g->op != BUS_WRITE && __atomic_load_n(&g->unwanted, __ATOMIC_RELAXED))
			guest_failed(e, g, -ECANCELED);
		else if (e->time.now_ns >= g->until_ns)
			guest_failed(e, g, -ETIME);
		else
			guest_waits(lane, g);
		g = next;
	}
}

static int64_t patience_ns(const struct engine *e, const struct engine_guest *g)
{
	bool server = g->token_count > 1; /* ours is the last */

	return server && e->config->timeout_ns > GUEST_SERVER_NS ? GUEST_SERVER_NS
	                                                         : e->config->timeout_ns;
}

void guests_take(struct engine *e)
{
	struct engine_guest *g;

	if (!e->guests)
		return;
	while ((g = e->guests->take(e->guests->ctx)) != NULL) {
		g->until_ns = e->time.now_ns + patience_ns(e, g);
		g->lent = false;
		g->best_err = 0;
		g->served = g->lane == GUEST_ANY_LANE ? lane_of_path(e, g->path)
		                                      : (unsigned)g->lane;
		/* asked as a reload went on: its lane may be another target by now */
		if (g->served < e->lane_count &&
		    (g->lane == GUEST_ANY_LANE || g->generation == e->image->header->generation)) {
			guest_waits(&e->lanes[g->served], g);
		} else {
			g->answer = (struct bus_answer){.err = -ENODEV};
			answer_guest(e, g);
		}
	}
	/*
	 * in order: a request that a lane cannot serve goes to a later lane now, to an earlier one
	 * next time
	 */
	for (unsigned i = 0; i < e->lane_count; i++)
		if (e->lanes[i].guests.first)
			look_at_waiting(e, &e->lanes[i]);
}

static unsigned table_lent(const struct lane *lane)
{
	return lane->lent.count - lane->guests.lent;
}

/* A part of what the bus takes, and where the table is at work a part of what the bus has of it. */
static unsigned most_lent(const struct lane *lane)
{
	unsigned own = table_lent(lane);
	unsigned most = own ? own / GUEST_PASSED : lane->depth / 4;

	return most == 0 ? 1 : most > GUESTS_LENT ? GUESTS_LENT : most;
}

bool guest_turn(const struct lane *lane, bool others)
{
	return lane->guests.first && lane->guests.lent < most_lent(lane) &&
	       (!others || lane->guests.passed >= GUEST_PASSED);
}

void guest_passed(struct lane *lane)
{
	if (lane->guests.first)
		lane->guests.passed++;
}

/*
 * A bus that the table keeps busy would never come to its guests. So the few requests of guests
 * that are lent beside the table's have the priority of inputs, and some of those on an idle bus
 * too.
 */
bool guest_ask(struct lane *lane, struct slot *slot)
{
	struct engine_guest *g = lane->guests.first;

	slot->purpose = FOR_GUEST;
	slot->row = TABLE_NO_ROW;
	slot->guest = g;
	slot->as_input = table_lent(lane) || lane->guests.as_inputs < GUESTS_AS_INPUTS;
	slot->req = (struct bus_req){.op = g->op,
	                             .fresh = g->fresh,
	                             .path = g->path,
	                             .prio = slot->as_input ? BUS_INPUT : BUS_GUEST,
	                             .len = g->len,
	                             .offset = g->offset,
	                             .data = g->data,
	                             .unwanted = &g->unwanted,
	                             .tokens = g->tokens,
	                             .token_count = g->token_count};
	if (!slot_lend(lane, slot))
		return false;
	guest_leaves(lane);
	lane->guests.as_inputs += slot->as_input;
	lane->guests.passed = 0;
	lane->guests.lent++;
	lane->counters.guests++;
	return true;
}

static const char *stem_end(struct path_slice property)
{
	const char *end = property.text + property.len, *p = end;

	while (p > property.text && p[-1] != '.' && p[-1] != '/')
		p--;
	return p > property.text && p[-1] == '.' ? p - 1 : end;
}

/* Do both write the same latch: PIO.0, PIO.BYTE? */
static bool same_latch(const struct path *a, const char *path)
{
	struct path b;
	size_t len;

	if (path_split(path, strlen(path), &b) || !path_same_device(a, &b))
		return false;
	len = (size_t)(stem_end(a->property) - a->property.text);
	return len == (size_t)(stem_end(b.property) - b.property.text) &&
	       memcmp(a->property.text, b.property.text, len) == 0;
}

/* The control program owns its outputs: what a guest wrote over one is written over again. */
static void restore_outputs(struct engine *e, const char *path)
{
	struct path split;

	if (path_split(path, strlen(path), &split) || !split.last.len)
		return;
	for (struct signal *s = e->table.signals; s < table_end(&e->table); s++) {
		if (!s->command.given || !signal_writes(s) || !same_latch(&split, s->item->path))
			continue;
		if (signal_repeats(s))
			s->command.forced = true;
		else
			signal_forget_written(s);
		engine_write_check(e, s);
		if (!signal_is_read(s) && !signal_changed(s))
			signal_lapse(s); /* what it has now is not known */
		engine_publish(e, s);
	}
}

void guest_done(struct engine *e, struct lane *lane, struct slot *slot, const struct bus_answer *a)
{
	struct engine_guest *g = slot->guest;
	bool lent = slot->lent;

	lane->guests.lent--;
	lane->guests.as_inputs -= slot->as_input;
	if (g->op == BUS_WRITE &&
	    (!a->err || failure_of(a->err) == FAILURE_TARGET || a->err == -EINPROGRESS))
		restore_outputs(e, g->path);
	if (a->err)
		lane->counters.guest_errors++;
	if (lent) {
		g->answer = *a;
		g->lent = true;
		answer_guest(e, g);
		return;
	}
	slot->guest = NULL;
	if (a->err && guest_goes_on(g, a->err)) {
		guest_failed(e, g, a->err);
		return;
	}
	g->answer = *a;
	g->served = lane->index;
	answer_guest(e, g);
}

void guest_gone(struct engine *e, struct slot *slot)
{
	struct engine_guest *g = slot->guest;

	slot->guest = NULL;
	e->guests->released(e->guests->ctx, g);
}

void guests_adopt(struct lane *lane, struct lane *before)
{
	lane->guests = before->guests;
	memset(&before->guests, 0, sizeof(before->guests));
	for (struct engine_guest *g = lane->guests.first; g; g = g->next)
		g->at = g->served = lane->index;
	for (unsigned i = 0; i < lane->depth; i++) {
		const struct slot *slot = &lane->lent.slots[i];

		if (slot->lent && slot->purpose == FOR_GUEST)
			slot->guest->at = slot->guest->served = lane->index;
	}
}

void guests_refuse(struct lane *lane)
{
	const struct bus_answer down = {.err = -ENOTCONN};

	while (lane->guests.first) {
		struct engine_guest *g = guest_leaves(lane);

		g->answer = down;
		answer_guest(lane->engine, g);
	}
	for (unsigned i = 0; i < lane->depth; i++) {
		struct slot *slot = &lane->lent.slots[i];

		if (!slot->lent || slot->purpose != FOR_GUEST || slot->given_up)
			continue;
		slot->given_up = true;
		guest_done(lane->engine, lane, slot, &down);
	}
}

void guests_release(struct lane *lane)
{
	for (unsigned i = 0; i < lane->depth; i++) {
		struct slot *slot = &lane->lent.slots[i];

		if (!slot->lent || slot->purpose != FOR_GUEST)
			continue;
		slot->lent = false;
		guest_gone(lane->engine, slot);
	}
}
