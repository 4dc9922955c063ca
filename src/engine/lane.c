/* SPDX-License-Identifier: MIT */
#include "private.h"

#include "../signal/value.h"

#include <assert.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* Between two looks for devices that are not there: the signals that are come first. */
#define PROBE_APART_NS 200000000LL

int lane_init(struct lane *lane, struct engine *engine, const struct engine_port *port,
              unsigned index)
{
	*lane = (struct lane){ .engine = engine, .port = port, .index = index, .depth = port->depth };
	lane->look_ns = INT64_MAX;
	lane->slots = calloc(lane->depth, sizeof(*lane->slots));
	lane->free = calloc(lane->depth, sizeof(*lane->free));
	lane->list = calloc(1, ALARM_LIST);
	if (!lane->slots || !lane->free || !lane->list ||
	    due_set_init(&lane->inputs, engine->table.count) ||
	    due_set_init(&lane->outputs, engine->table.count) ||
	    due_set_init(&lane->checks, engine->structure.count) ||
	    due_set_init(&lane->probes, engine->table.device_count) ||
	    alarm_init(&lane->alarm, engine->alarm_count, port->searches)) {
		lane_free(lane);
		return -ENOMEM;
	}
	while (lane->free_count < lane->depth) {
		lane->free[lane->free_count] = (uint16_t)(lane->depth - 1 - lane->free_count);
		lane->free_count++;
	}
	return 0;
}

void lane_free(struct lane *lane)
{
	free(lane->slots);
	free(lane->free);
	free(lane->list);
	due_set_free(&lane->inputs);
	due_set_free(&lane->outputs);
	due_set_free(&lane->checks);
	due_set_free(&lane->probes);
	alarm_free(&lane->alarm);
}

void lane_take_row(struct lane *lane, uint32_t row)
{
	struct engine *e = lane->engine;
	struct signal *s = &e->table.signals[row];

	s->lane = lane->index;
	lane->writers += signal_writes(s);
	if (e->structure.check_of[row] != STRUCTURE_NONE)
		due_set_add(&lane->checks, e->structure.check_of[row]);
}

void lane_drop_row(struct lane *lane, uint32_t row)
{
	due_set_remove(&lane->inputs, row);
	due_set_remove(&lane->outputs, row);
	lane->writers -= signal_writes(&lane->engine->table.signals[row]);
}

static struct slot *free_slot(struct lane *lane)
{
	return lane->free_count ? &lane->slots[lane->free[lane->free_count - 1]] : NULL;
}

/* What is lent stands for itself: the table may change meanwhile. */
static void own(struct slot *slot)
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

bool lane_lend(struct lane *lane, struct slot *slot, int64_t now_ns)
{
	slot->turn++;
	slot->req.id = (uint32_t)(slot - lane->slots) | (uint32_t)slot->turn << 16;
	slot->req.deadline_ns = now_ns + lane->engine->config->timeout_ns;
	if (slot->purpose != FOR_GUEST)
		own(slot);
	if (!slot->req.tokens && lane->engine->guests && lane->engine->guests->token) {
		slot->req.tokens = lane->engine->guests->token;
		slot->req.token_count = 1;
	}
	if (slot->req.op == BUS_DIR && slot->purpose == FOR_ALARM) {
		slot->req.data = (uint8_t *)lane->list;
		slot->req.len = ALARM_LIST;
	}
	slot->begun_ns = now_ns;
	slot->begun = lane->engine->period;
	slot->given_up = slot->moved = slot->kept = false;
	if (lane->port->submit(lane->port->ctx, &slot->req))
		return false;
	slot->lent = true;
	lane->lent++;
	lane->free_count--; /* it was the one on top */
	if (slot->req.deadline_ns + LANE_GRACE_NS < lane->look_ns)
		lane->look_ns = slot->req.deadline_ns + LANE_GRACE_NS;
	lane->counters.requests++;
	return true;
}

/* The next check that a signal of this lane needs; -1: none. */
static int64_t next_check(struct lane *lane)
{
	const struct structure *st = &lane->engine->structure;
	int64_t next;

	while ((next = due_set_next(&lane->checks)) >= 0) {
		const struct structure_check *check = &st->checks[next];

		for (uint32_t i = 0; i < check->count; i++)
			if (lane->engine->table.signals[st->rows[check->first + i]].lane ==
			    lane->index)
				return next;
		due_set_take(&lane->checks, (uint32_t)next);
	}
	return -1;
}

static bool ask_structure(struct lane *lane, struct slot *slot, uint32_t check, int64_t now_ns)
{
	slot->purpose = FOR_STRUCTURE;
	slot->row = check;
	slot->req = (struct bus_req){ .op = BUS_READ,
		                      .prio = BUS_INPUT,
		                      .path = lane->engine->structure.checks[check].path,
		                      .len = sizeof(slot->data) };
	if (!lane_lend(lane, slot, now_ns))
		return false;
	due_set_take(&lane->checks, check);
	return true;
}

static bool ask_probe(struct lane *lane, struct slot *slot, int64_t now_ns)
{
	if (lane->probing || now_ns < lane->probe_ns ||
	    !engine_probe_next(lane->engine, lane, slot, now_ns))
		return false;
	if (!lane_lend(lane, slot, now_ns))
		return false;
	due_set_take(&lane->probes, slot->row);
	lane->probing = true;
	lane->probe_ns = now_ns + PROBE_APART_NS;
	lane->counters.probes++;
	return true;
}

static bool ask_read(struct lane *lane, struct slot *slot, uint32_t row, int64_t now_ns)
{
	struct engine *e = lane->engine;
	struct signal *s = &e->table.signals[row];

	slot->purpose = FOR_READ;
	slot->row = row;
	slot->req = (struct bus_req){
		.op = BUS_READ,
		.prio = BUS_INPUT,
		.fresh = s->item->fresh,
		.path = s->item->path,
		.len = sizeof(slot->data),
	};
	if (!lane_lend(lane, slot, now_ns))
		return false;
	due_set_take(&lane->inputs, row);
	guest_passed(lane);
	lane->writes_in_row = 0;
	s->reading = true;
	s->sample.tried_ns = now_ns;
	signal_begin(s, e->period);
	engine_publish(e, s);
	return true;
}

static bool ask_write(struct lane *lane, struct slot *slot, uint32_t row, int64_t now_ns)
{
	struct engine *e = lane->engine;
	struct signal *s = &e->table.signals[row];

	/* the value that counts is the one of this moment */
	engine_intake_signal(e, s, now_ns);
	if (!due_set_has(&lane->outputs, row)) {
		engine_publish(e, s);
		return true;
	}
	slot->purpose = FOR_WRITE;
	slot->row = row;
	slot->value = s->command;
	slot->stamp = s->command_stamp;
	slot->one_shot = s->one_shot;
	slot->req = (struct bus_req){ .op = BUS_WRITE, .prio = BUS_OUTPUT, .path = s->item->path };
	if (signal_is_string(s)) {
		memcpy(slot->data, s->command_text, s->command_len);
		slot->req.len = s->command_len;
	} else {
		char text[VALUE_TEXT_MAX];

		slot->req.len = (uint32_t)value_to_text(s->item->type, s->command, text);
		memcpy(slot->data, text, slot->req.len);
	}
	if (!lane_lend(lane, slot, now_ns))
		return false;
	due_set_take(&lane->outputs, row);
	guest_passed(lane);
	lane->writes_in_row++;
	lane->writes_in_work++;
	s->writing = true;
	s->one_shot = false;
	s->forced = false;
	s->sample.tried_ns = now_ns;
	signal_begin(s, e->period);
	engine_publish(e, s);
	return true;
}

/* True: the alarm machine has given the slot's request to the bus, or has none to give now. */
static bool ask_alarm(struct lane *lane, struct slot *slot, int64_t now_ns)
{
	struct engine *e = lane->engine;
	struct alarm_request *r = &lane->alarm_request;
	struct signal *s;

	/* one that was given up is still lent: the room for a list is not ours yet */
	if (lane->alarm_slot || lane->writes_in_work ||
	    !alarm_run(&lane->alarm, lane, r, now_ns))
		return false;
	slot->purpose = FOR_ALARM;
	slot->row = r->row;
	slot->req = (struct bus_req){ .op = (uint8_t)r->op, .prio = BUS_ALARM, .fresh = true,
		                      .path = r->path, .len = sizeof(slot->data) };
	if (r->op == BUS_WRITE) {
		memcpy(slot->data, r->data, r->len);
		slot->req.len = r->len;
	}
	if (r->row != TABLE_NO_ROW) {
		slot->value = e->table.signals[r->row].item->init_value;
		slot->stamp = e->table.signals[r->row].sample.applied;
	}
	if (!lane_lend(lane, slot, now_ns))
		return false;
	lane->alarm_slot = slot;
	alarm_started(&lane->alarm, lane, now_ns);
	if (r->row == TABLE_NO_ROW)
		return true;
	s = &e->table.signals[r->row];
	s->alarming = true;
	s->sample.tried_ns = now_ns;
	signal_begin(s, e->period);
	engine_publish(e, s);
	return true;
}

/*
 * The order of a lane: what the bus is made of, alarms, one changed output, the next due input,
 * guests.
 */
static bool ask_next(struct lane *lane, struct slot *slot, int64_t now_ns)
{
	int64_t output, input, check = next_check(lane);

	if (check >= 0)
		return ask_structure(lane, slot, (uint32_t)check, now_ns);
	if (ask_alarm(lane, slot, now_ns) || ask_probe(lane, slot, now_ns))
		return true;
	output = lane->writes_in_work || alarm_holds(&lane->alarm) ? -1
	                                                          : due_set_next(&lane->outputs);
	input = due_set_next(&lane->inputs);
	if (guest_turn(lane, output >= 0 || input >= 0))
		return guest_ask(lane, slot, now_ns);
	/* a one-shot needs no writer, and has to come in its turn all the same */
	if (output >= 0 &&
	    (input < 0 || lane->writes_in_row < (lane->writers ? lane->writers : 1)))
		return ask_write(lane, slot, (uint32_t)output, now_ns);
	if (input >= 0)
		return ask_read(lane, slot, (uint32_t)input, now_ns);
	return false;
}

void lane_fill(struct lane *lane, int64_t now_ns)
{
	struct slot *slot;

	while (lane->up && !lane->stuck && (slot = free_slot(lane)) != NULL)
		if (!ask_next(lane, slot, now_ns))
			break;
}

int64_t lane_wake(const struct lane *lane)
{
	int64_t alarm, probe;

	if (!lane->up || lane->stuck || lane->lent == lane->depth)
		return INT64_MAX;
	probe = lane->probes.count && !lane->probing ? lane->probe_ns : INT64_MAX;
	/* the end of these wakes it */
	if (lane->alarm_slot || lane->writes_in_work)
		return probe;
	alarm = alarm_wake(&lane->alarm);
	return probe < alarm ? probe : alarm;
}
