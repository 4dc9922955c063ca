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
	if (!lane->slots || !lane->free || due_set_init(&lane->inputs, engine->table.count) ||
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

bool lane_lend(struct lane *lane, struct slot *slot, int64_t now_ns)
{
	slot->turn++;
	slot->req.id = (uint32_t)(slot - lane->slots) | (uint32_t)slot->turn << 16;
	slot->req.deadline_ns = now_ns + lane->engine->config->timeout_ns;
	if (slot->purpose != FOR_GUEST)
		slot->req.data = slot->data;
	if (slot->req.op == BUS_DIR && slot->purpose == FOR_ALARM) {
		slot->req.data = (uint8_t *)lane->alarm.list;
		slot->req.len = ALARM_LIST;
	}
	slot->begun_ns = now_ns;
	slot->begun = lane->engine->period;
	slot->given_up = slot->moved = false;
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

	/* one that was given up is still lent: its path and room are not ours yet */
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

static struct slot *slot_of(struct lane *lane, uint32_t id)
{
	struct slot *slot;

	if ((id & 0xffff) >= lane->depth)
		return NULL;
	slot = &lane->slots[id & 0xffff];
	return slot->lent && slot->req.id == id ? slot : NULL;
}

/* The request's time as the table sees it is over: by an answer, or given up. */
static void complete(struct lane *lane, struct slot *slot, const struct bus_answer *answer,
                     int64_t now_ns)
{
	bool counts = failure_of(answer->err) != FAILURE_VOID;
	struct engine *e = lane->engine;
	struct signal *s;

	if (slot->purpose == FOR_GUEST) {
		engine_guest_done(e, lane, slot, answer);
		return;
	}
	e->transactions += counts;
	switch (slot->purpose) {
	case FOR_GUEST:
		break;
	case FOR_STRUCTURE:
		engine_structure_done(e, lane, slot, answer);
		break;
	case FOR_PROBE:
		engine_probe_done(e, lane, slot, answer, now_ns);
		break;
	case FOR_READ:
		s = &e->table.signals[slot->row];
		s->reading = false;
		s->attrs.transactions += counts;
		signal_end(s, e->period, slot->begun);
		engine_read_done(e, lane, slot, answer, now_ns);
		engine_publish(e, s);
		alarm_passed(&lane->alarm);
		break;
	case FOR_WRITE:
		s = &e->table.signals[slot->row];
		s->writing = false;
		lane->writes_in_work--;
		s->attrs.transactions += counts;
		signal_end(s, e->period, slot->begun);
		engine_write_done(e, lane, slot, answer, now_ns);
		engine_publish(e, s);
		alarm_passed(&lane->alarm);
		break;
	case FOR_ALARM:
		if (slot->row == TABLE_NO_ROW) {
			alarm_answered(&lane->alarm, lane, slot, answer, now_ns);
			break;
		}
		s = &e->table.signals[slot->row];
		s->alarming = false;
		s->attrs.transactions += counts;
		signal_end(s, e->period, slot->begun);
		alarm_answered(&lane->alarm, lane, slot, answer, now_ns);
		engine_publish(e, s);
		break;
	}
}

static void give_back(struct lane *lane, struct slot *slot)
{
	slot->lent = false;
	lane->lent--;
	lane->free[lane->free_count++] = (uint16_t)(slot - lane->slots);
	if (lane->alarm_slot == slot)
		lane->alarm_slot = NULL;
}

/* A write of the write step, or of InitValue by the alarm machine. */
bool lane_writes_output(const struct lane *lane, const struct slot *slot)
{
	const struct engine *e = lane->engine;

	if (slot->purpose == FOR_ALARM)
		return slot->req.op == BUS_WRITE && slot->row != TABLE_NO_ROW &&
		       strcmp(slot->req.path, e->table.signals[slot->row].item->path) == 0;
	return slot->purpose == FOR_WRITE;
}

bool lane_in_doubt(const struct lane *lane, const struct slot *slot)
{
	struct engine *e = lane->engine;

	return slot->lent && (slot->given_up || slot->moved) && lane_writes_output(lane, slot) &&
	       e->table.signals[slot->row].lane != lane->index &&
	       !engine_way(e, lane)->released;
}

/* It may have reached the relay after the engine moved on. */
static void end_doubt(struct engine *e, const struct slot *slot)
{
	struct signal *s = &e->table.signals[slot->row];

	s->forced = true;
	s->doubts = 0; /* but for what is still lent */
	engine_doubts(e);
	engine_write_check(e, s);
	engine_publish(e, s);
}

static void answers_again(struct lane *lane, int64_t now_ns)
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

static void disown(struct lane *lane, struct slot *slot)
{
	struct engine *e = lane->engine;
	struct signal *s;

	slot->moved = true;
	if (slot->row == TABLE_NO_ROW)
		return;
	s = &e->table.signals[slot->row];
	switch (slot->purpose) {
	case FOR_READ:
		s->reading = false;
		break;
	case FOR_WRITE:
		s->writing = false;
		s->one_shot |= slot->one_shot;
		break;
	case FOR_ALARM:
		s->alarming = false;
		break;
	case FOR_STRUCTURE:
	case FOR_PROBE:
	case FOR_GUEST:
		return;
	}
	signal_end(s, e->period, slot->begun);
}

void lane_disown(struct lane *lane, bool all)
{
	for (unsigned i = 0; i < lane->depth; i++) {
		struct slot *slot = &lane->slots[i];

		if (!slot->lent || slot->given_up || slot->moved ||
		    slot->purpose == FOR_STRUCTURE || slot->purpose == FOR_PROBE ||
		    slot->purpose == FOR_GUEST)
			continue;
		if (all || (slot->row != TABLE_NO_ROW &&
		            lane->engine->table.signals[slot->row].lane != lane->index))
			disown(lane, slot);
	}
}

void lane_forget_probes(struct lane *lane)
{
	int64_t device;

	while ((device = due_set_next(&lane->probes)) >= 0) {
		due_set_take(&lane->probes, (uint32_t)device);
		lane->engine->table.devices[device].probing = false;
	}
}

void lane_answer(struct lane *lane, const struct bus_answer *answer, int64_t now_ns)
{
	struct slot *slot = slot_of(lane, answer->id);
	struct engine *e = lane->engine;

	lane->heard_ns = now_ns;
	if (!slot) {
		lane->counters.unknown_answers++;
		return;
	}
	give_back(lane, slot);
	if (!slot->given_up && !slot->moved) {
		complete(lane, slot, answer, now_ns);
	} else {
		lane->counters.late_answers += slot->given_up;
		if (!slot->given_up && slot->purpose == FOR_WRITE)
			lane->writes_in_work--;
		if (slot->purpose == FOR_GUEST)
			engine_guest_gone(e, slot);
		else if (lane_writes_output(lane, slot))
			end_doubt(e, slot);
	}
	if (lane->stuck)
		answers_again(lane, now_ns);
}

void lane_up(struct lane *lane, const char *text, int64_t now_ns)
{
	struct engine *e = lane->engine;

	if (lane->up)
		return;
	lane->up = true;
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
	engine_group_check(e, lane->port->group, now_ns);
	engine_lane_down(e, lane, err, now_ns);
}

static void go_down(struct lane *lane, int err, const char *text, int64_t now_ns)
{
	struct engine *e = lane->engine;

	log_warning(e->log, "%s: %s: %s", lane->port->target,
	            lane->up ? "from up to down" : "down", *text ? text : strerror(-err));
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
		lane_up(lane, event->text, now_ns);
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
		log_info(e->log, "%s: is there again", lane->port->target);
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
static void get_stuck(struct lane *lane, int64_t now_ns)
{
	lane->stuck = true;
	if (!lane->open)
		return;
	log_err(lane->engine->log, "%s: no answer at all within Timeout", lane->port->target);
	lane->counters.target_failures++;
	fail(lane, -ETIMEDOUT, now_ns);
}

int64_t lane_timeouts(struct lane *lane, int64_t now_ns)
{
	int64_t next = INT64_MAX;
	bool silent = false;
	unsigned lost = 0;

	if (!lane->lent)
		return next;
	if (now_ns < lane->look_ns)
		return lane->look_ns;
	for (unsigned i = 0; i < lane->depth; i++) {
		struct slot *slot = &lane->slots[i];
		int64_t end = slot->req.deadline_ns + LANE_GRACE_NS;
		struct bus_answer answer = { .id = slot->req.id, .err = -EINPROGRESS };

		if (!slot->lent)
			continue;
		if (slot->given_up) {
			lost++;
			continue;
		}
		if (end > now_ns) {
			if (end < next)
				next = end;
			continue;
		}
		slot->given_up = true;
		lost++;
		lane->counters.given_up++;
		if (lane->heard_ns <= slot->begun_ns) {
			answer.err = -ETIMEDOUT;
			silent = true;
		}
		if (!slot->moved)
			complete(lane, slot, &answer, now_ns);
		else if (slot->purpose == FOR_WRITE)
			lane->writes_in_work--;
	}
	lane->look_ns = next;
	if (!lane->stuck && (silent || lost == lane->depth))
		get_stuck(lane, now_ns);
	return next;
}
