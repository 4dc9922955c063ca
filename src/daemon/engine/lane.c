/* SPDX-License-Identifier: MIT */
/*
 * A lane: rooms for requests. A slot is lent to the bus with its request, and comes back with the
 * answer. Rows of the table come to a lane and leave it; what is lent for them then, or while a
 * reload goes on, only frees its slot when it is answered.
 */
#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/owfs/path.h"
#include "src/daemon/engine/alarm/alarm_item.h"
#include "src/daemon/engine/due.h"
#include "src/daemon/engine/guest.h"
#include "src/daemon/engine/lane.h"

static int slots_init(struct lane *lane)
{
	lane->depth = lane->port->depth;
	lane->lent.look_ns = INT64_MAX;
	lane->lent.slots = calloc(lane->depth, sizeof(*lane->lent.slots));
	lane->lent.free = calloc(lane->depth, sizeof(*lane->lent.free));
	lane->lent.list = calloc(1, ALARM_LIST);
	if (!lane->lent.slots || !lane->lent.free || !lane->lent.list)
		return -ENOMEM;
	while (lane->lent.free_count < lane->depth) {
		lane->lent.free[lane->lent.free_count] = (uint16_t)(lane->depth - 1 -
		                                                    lane->lent.free_count);
		lane->lent.free_count++;
	}
	return 0;
}

struct slot *slot_next(struct lane *lane)
{
	return lane->lent.free_count ? &lane->lent.slots[lane->lent.free[lane->lent.free_count - 1]]
	                             : NULL;
}

/* What is lent stands for itself: the table may change meanwhile. */
static void slot_own_path(struct slot *slot)
{
	size_t len;

	slot->req.data = slot->data;
	if (slot->req.path == slot->path)
		return;
	len = strnlen(slot->req.path, sizeof(slot->path) - 1);
	memcpy(slot->path, slot->req.path, len);
	slot->path[len] = '\0';
	slot->req.path = slot->path;
}

bool slot_look_for(struct lane *lane, struct slot *slot, enum purpose purpose, uint32_t device)
{
	const struct table *table = &lane->engine->table;
	const struct device *d = &table->devices[device];
	const char *text = d->signals[0]->item->path;
	struct path path;

	if (path_split(text, strlen(text), &path))
		return false;
	snprintf(slot->path, sizeof(slot->path), "%.*s",
	         (int)(path.device.text + path.device.len - text), text);
	slot->purpose = purpose;
	slot->row = device;
	slot->req = (struct bus_req){.op = BUS_PROBE,
	                             .prio = BUS_INPUT,
	                             .fresh = true,
	                             .path = slot->path,
	                             .len = sizeof(slot->data)};
	return true;
}

bool slot_lend(struct lane *lane, struct slot *slot)
{
	bool guest = slot->purpose == FOR_GUEST;
	/* where only one request is under way, all others of the bus would wait for so long, too */
	bool longer = guest && slot->guest->parts && lane->depth > 1;
	int64_t parts = longer ? slot->guest->parts : 1, now_ns = lane->engine->time.now_ns;

	slot->generation++;
	slot->req.id = (uint32_t)(slot - lane->lent.slots) | (uint32_t)slot->generation << 16;
	slot->req.deadline_ns = now_ns + lane->engine->config->timeout_ns * parts;
	if (!guest)
		slot_own_path(slot);
	if (!slot->req.tokens && lane->engine->guests && lane->engine->guests->token) {
		slot->req.tokens = lane->engine->guests->token;
		slot->req.token_count = 1;
	}
	if (slot->req.op == BUS_DIR && slot->purpose == FOR_ALARM) {
		slot->req.data = (uint8_t *)lane->lent.list;
		slot->req.len = ALARM_LIST;
	}
	slot->begun_ns = now_ns;
	slot->begun = lane->engine->time.period;
	slot->given_up = slot->moved = slot->kept = false;
	if (lane->port->submit(lane->port->ctx, &slot->req))
		return false;
	slot->lent = true;
	lane->lent.count++;
	lane->lent.free_count--; /* it was the one on top */
	if (slot->req.deadline_ns + LANE_GRACE_NS < lane->lent.look_ns)
		lane->lent.look_ns = slot->req.deadline_ns + LANE_GRACE_NS;
	lane->counters.requests++;
	return true;
}

struct slot *slot_of_id(struct lane *lane, uint32_t id)
{
	struct slot *slot;

	if ((id & 0xffff) >= lane->depth)
		return NULL;
	slot = &lane->lent.slots[id & 0xffff];
	return slot->lent && slot->req.id == id ? slot : NULL;
}

bool slot_has_row(const struct slot *slot)
{
	return slot->row != TABLE_NO_ROW &&
	       (slot->purpose == FOR_READ || slot->purpose == FOR_WRITE ||
	        slot->purpose == FOR_ALARM);
}

struct signal *slot_signal(const struct lane *lane, const struct slot *slot)
{
	assert(slot_has_row(slot));
	return &lane->engine->table.signals[slot->row];
}

void slot_leaves_signal(const struct lane *lane, const struct slot *slot)
{
	struct signal *s = slot_signal(lane, slot);

	s->reading &= slot->purpose != FOR_READ;
	s->writing &= slot->purpose != FOR_WRITE;
	s->alarming &= slot->purpose != FOR_ALARM;
	signal_end(s, lane->engine->time.period, slot->begun);
}

void slot_give_back(struct lane *lane, struct slot *slot)
{
	slot->lent = false;
	lane->lent.count--;
	lane->lent.free[lane->lent.free_count++] = (uint16_t)(slot - lane->lent.slots);
	if (lane->lent.alarm == slot)
		lane->lent.alarm = NULL;
}

int lane_init(struct lane *lane, struct engine *engine, const struct engine_port *port,
              unsigned index)
{
	*lane = (struct lane){.engine = engine, .port = port, .index = index};
	if (slots_init(lane) || due_set_init(&lane->inputs, engine->table.count) ||
	    due_set_init(&lane->outputs, engine->table.count) ||
	    due_set_init(&lane->probes, engine->table.device_count) ||
	    due_set_init(&lane->watch, engine->table.device_count) ||
	    due_set_init(&lane->restarts, engine->table.device_count) ||
	    alarm_init(&lane->alarm, engine->alarm_count, port->searches)) {
		lane_free(lane);
		return -ENOMEM;
	}
	return 0;
}

void lane_free(struct lane *lane)
{
	free(lane->lent.slots);
	free(lane->lent.free);
	free(lane->lent.list);
	due_set_free(&lane->inputs);
	due_set_free(&lane->outputs);
	due_set_free(&lane->probes);
	due_set_free(&lane->watch);
	due_set_free(&lane->restarts);
	alarm_free(&lane->alarm);
}

void lane_take_row(struct lane *lane, uint32_t row)
{
	struct signal *s = &lane->engine->table.signals[row];

	s->lane = lane->index;
	lane->writers += signal_writes(s);
}

void lane_drop_row(struct lane *lane, uint32_t row)
{
	due_set_remove(&lane->inputs, row);
	due_set_remove(&lane->outputs, row);
	lane->writers -= signal_writes(&lane->engine->table.signals[row]);
}

static void disown_slot(struct lane *lane, struct slot *slot)
{
	slot->moved = true;
	if (!slot_has_row(slot))
		return;
	if (slot->purpose == FOR_WRITE)
		slot_signal(lane, slot)->command.one_shot |= slot->one_shot;
	if (slot->purpose == FOR_READ)
		slot_signal(lane, slot)->read.once |= slot->one_shot;
	slot_leaves_signal(lane, slot);
}

void lane_disown(struct lane *lane, bool all)
{
	for (unsigned i = 0; i < lane->depth; i++) {
		struct slot *slot = &lane->lent.slots[i];

		if (!slot->lent || slot->given_up || slot->moved)
			continue;
		if (all ? slot_has_row(slot) || slot->purpose == FOR_ALARM
		        : slot_has_row(slot) && slot_signal(lane, slot)->lane != lane->index)
			disown_slot(lane, slot);
	}
}

void lane_disown_alarm(struct lane *lane)
{
	struct slot *slot = lane->lent.alarm;

	if (slot && !slot->given_up && !slot->moved)
		disown_slot(lane, slot);
}

void lane_keep_reads(struct lane *lane)
{
	for (unsigned i = 0; i < lane->depth; i++) {
		struct slot *slot = &lane->lent.slots[i];

		slot->kept = slot->lent && !slot->given_up && !slot->moved &&
		             slot->purpose == FOR_READ;
	}
}

void lane_resume_reads(struct lane *lane)
{
	for (unsigned i = 0; i < lane->depth; i++) {
		struct slot *slot = &lane->lent.slots[i];
		struct signal *s;

		if (!slot->kept || slot->row == TABLE_NO_ROW)
			continue;
		s = &lane->engine->table.signals[slot->row];
		if (s->lane != lane->index || s->item->fresh != slot->req.fresh || !signal_reads(s))
			continue;
		slot->moved = false;
		due_set_remove(&lane->inputs, slot->row);
		s->reading = true;
		signal_begin(s, slot->begun);
	}
}

static void come_over(struct slot *slot, const uint32_t *successors)
{
	if (slot->purpose == FOR_GUEST)
		return;
	slot->moved = true;
	slot->row = slot_has_row(slot) ? successors[slot->row] : TABLE_NO_ROW;
}

void lane_adopt(struct lane *lane, struct lane *before, const uint32_t *successors)
{
	struct lane_lent own = lane->lent;

	assert(lane->depth == before->depth && !lane->lent.count);
	for (unsigned i = 0; i < before->depth; i++)
		if (before->lent.slots[i].lent)
			come_over(&before->lent.slots[i], successors);
	lane->state = before->state;
	lane->counters = before->counters;
	lane->lent = before->lent;
	before->lent = own;
}
