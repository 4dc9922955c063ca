/* SPDX-License-Identifier: MIT */
#include "private.h"

#include "../signal/value.h"

#include <assert.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

int lane_init(struct lane *lane, struct engine *engine, const struct engine_port *port,
              unsigned index)
{
	*lane = (struct lane){ .engine = engine, .port = port, .index = index, .depth = port->depth };
	lane->look_ns = INT64_MAX;
	lane->slots = calloc(lane->depth, sizeof(*lane->slots));
	lane->free = calloc(lane->depth, sizeof(*lane->free));
	if (!lane->slots || !lane->free || due_set_init(&lane->inputs, engine->table.count) ||
	    due_set_init(&lane->outputs, engine->table.count) ||
	    structure_init(&lane->structure, &engine->table, index) ||
	    alarm_init(&lane->alarm, &engine->table, index, port->searches, engine->start_ns)) {
		lane_free(lane);
		return -ENOMEM;
	}
	while (lane->free_count < lane->depth) {
		lane->free[lane->free_count] = (uint16_t)(lane->depth - 1 - lane->free_count);
		lane->free_count++;
	}
	for (uint32_t row = 0; row < engine->table.count; row++) {
		const struct signal *s = &engine->table.signals[row];

		lane->writers += s->lane == index && signal_writes(s);
	}
	return 0;
}

void lane_free(struct lane *lane)
{
	free(lane->slots);
	free(lane->free);
	due_set_free(&lane->inputs);
	due_set_free(&lane->outputs);
	structure_free(&lane->structure);
	alarm_free(&lane->alarm);
}

static struct slot *free_slot(struct lane *lane)
{
	return lane->free_count ? &lane->slots[lane->free[lane->free_count - 1]] : NULL;
}

/* Give the slot's request to the bus. */
static bool lend(struct lane *lane, struct slot *slot, int64_t now_ns)
{
	slot->turn++;
	slot->req.id = (uint32_t)(slot - lane->slots) | (uint32_t)slot->turn << 16;
	slot->req.deadline_ns = now_ns + lane->engine->config->timeout_ns;
	slot->req.data = slot->data;
	if (slot->req.op == BUS_DIR) {
		slot->req.data = (uint8_t *)lane->alarm.list;
		slot->req.len = ALARM_LIST;
	}
	slot->begun_ns = now_ns;
	slot->begun = lane->engine->period;
	slot->given_up = false;
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

static bool ask_structure(struct lane *lane, struct slot *slot, int64_t now_ns)
{
	const struct structure_check *check = &lane->structure.checks[lane->structure.next];

	slot->purpose = FOR_STRUCTURE;
	slot->row = lane->structure.next;
	slot->req = (struct bus_req){
		.op = BUS_READ, .prio = BUS_INPUT, .path = check->path, .len = sizeof(slot->data)
	};
	if (!lend(lane, slot, now_ns))
		return false;
	lane->structure.next++;
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
	if (!lend(lane, slot, now_ns))
		return false;
	due_set_take(&lane->inputs, row);
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
	if (!lend(lane, slot, now_ns))
		return false;
	due_set_take(&lane->outputs, row);
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
	if (!lend(lane, slot, now_ns))
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

/* The order of a lane: what the bus is made of, alarms, one changed output, the next due input. */
static bool ask_next(struct lane *lane, struct slot *slot, int64_t now_ns)
{
	int64_t output, input;

	if (lane->structure.next < lane->structure.count)
		return ask_structure(lane, slot, now_ns);
	if (ask_alarm(lane, slot, now_ns))
		return true;
	output = lane->writes_in_work || alarm_holds(&lane->alarm) ? -1
	                                                          : due_set_next(&lane->outputs);
	input = due_set_next(&lane->inputs);
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
	if (!lane->up || lane->stuck || lane->lent == lane->depth)
		return INT64_MAX;
	/* the end of these wakes it */
	if (lane->alarm_slot || lane->writes_in_work)
		return INT64_MAX;
	return alarm_wake(&lane->alarm);
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

	e->transactions += counts;
	switch (slot->purpose) {
	case FOR_STRUCTURE:
		engine_structure_done(e, lane, slot, answer);
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
static bool writes_output(const struct engine *e, const struct slot *slot)
{
	if (slot->purpose == FOR_ALARM)
		return slot->req.op == BUS_WRITE && slot->row != TABLE_NO_ROW &&
		       strcmp(slot->req.path, e->table.signals[slot->row].item->path) == 0;
	return slot->purpose == FOR_WRITE;
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
	if (!slot->given_up) {
		complete(lane, slot, answer, now_ns);
	} else {
		lane->counters.late_answers++;
		if (writes_output(e, slot)) {
			/* it may have reached the relay after the engine moved on */
			e->table.signals[slot->row].forced = true;
			engine_write_check(e, &e->table.signals[slot->row]);
		}
	}
	if (lane->stuck) {
		lane->stuck = false;
		log_notice(e->log, "%s: answers again", lane->port->target);
		if (lane->up)
			engine_lane_up(e, lane, now_ns);
	}
}

static void go_up(struct lane *lane, const char *text, int64_t now_ns)
{
	struct engine *e = lane->engine;

	if (lane->up)
		return;
	lane->up = true;
	if (lane->was_up) {
		lane->counters.reconnects++;
		e->reconnects++;
	}
	log_notice(e->log, "%s: from down to up%s%s", lane->port->target, *text ? ": " : "", text);
	lane->was_up = true;
	engine_publish_target(e, lane);
	engine_publish_driver(e, now_ns);
	engine_lane_up(e, lane, now_ns);
}

static void go_down(struct lane *lane, int err, const char *text, int64_t now_ns)
{
	struct engine *e = lane->engine;

	log_warning(e->log, "%s: %s: %s", lane->port->target,
	            lane->up ? "from up to down" : "down", *text ? text : strerror(-err));
	lane->up = false;
	lane->counters.target_failures++;
	engine_publish_target(e, lane);
	engine_lane_down(e, lane, err, now_ns);
}

static struct device *device_of(struct engine *e, const uint8_t rom[8])
{
	for (uint32_t i = 0; i < e->table.device_count; i++) {
		struct device *d = &e->table.devices[i];

		if (d->has_rom && memcmp(d->rom, rom, 8) == 0)
			return d;
	}
	return NULL;
}

void lane_event(struct lane *lane, const struct bus_event *event, int64_t now_ns)
{
	struct device *device;

	lane->heard_ns = now_ns;
	switch ((enum bus_news)event->news) {
	case BUS_UP:
		go_up(lane, event->text, now_ns);
		break;
	case BUS_DOWN:
		go_down(lane, event->err, event->text, now_ns);
		break;
	case BUS_FOUND:
	case BUS_POR:
		device = device_of(lane->engine, event->rom);
		if (device && (event->news == BUS_POR || device->absent))
			engine_device_back(lane->engine, lane, device, now_ns);
		break;
	case BUS_LOST:
		/* its signals go bad by their own failures; what comes back may have restarted */
		device = device_of(lane->engine, event->rom);
		if (device)
			device->absent = true;
		break;
	case BUS_RELEASED:
	case BUS_BACK:
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
	log_err(lane->engine->log, "%s: no answer at all within Timeout", lane->port->target);
	lane->counters.target_failures++;
	engine_lane_down(lane->engine, lane, -ETIMEDOUT, now_ns);
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
		complete(lane, slot, &answer, now_ns);
	}
	lane->look_ns = next;
	if (!lane->stuck && (silent || lost == lane->depth))
		get_stuck(lane, now_ns);
	return next;
}
