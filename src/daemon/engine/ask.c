/* SPDX-License-Identifier: MIT */
/*
 * The order of a lane: this file chooses what the lane asks its bus next, and makes that request.
 */
#include <errno.h>

#include "src/daemon/engine/alarm/alarm.h"
#include "src/daemon/engine/ask.h"
#include "src/daemon/engine/command/intake.h"
#include "src/daemon/engine/command/read_back.h"
#include "src/daemon/engine/guests.h"
#include "src/daemon/engine/lane.h"
#include "src/daemon/engine/presence.h"
#include "src/daemon/engine/publish.h"
#include "src/daemon/engine/routing/known.h"
#include "src/daemon/engine/scaling.h"
#include "src/daemon/engine/schedule.h"
#include "src/daemon/engine/trace.h"

/*
 * Past the caches: also what somebody asks for, what is to confirm a reading that jumped, and what
 * is compared with its command, each ReadBack and while it differs.
 */
static bool reads_fresh(const struct signal *s, int64_t now_ns)
{
	const struct signal_command *c = &s->command;
	int64_t looked_ns = c->looked_ns > c->ended_ns ? c->looked_ns : c->ended_ns;

	return s->item->fresh || s->scaling.step.held || c->doubted || s->read.once ||
	       !signal_reads(s) ||
	       (s->item->read_back_ns &&
	        (c->differs || now_ns - looked_ns >= s->item->read_back_ns));
}

static bool ask_read(struct lane *lane, struct slot *slot, uint32_t row)
{
	struct engine *e = lane->engine;
	struct signal *s = &e->table.signals[row];

	slot->purpose = FOR_READ;
	slot->row = row;
	slot->shown = false;
	lane->lent.unshown = true;
	slot->req = (struct bus_req){
		.op = BUS_READ,
		.prio = BUS_INPUT,
		.fresh = reads_fresh(s, e->time.now_ns),
		.path = s->item->path,
		.number = !signal_is_string(s) && !trace_is_on(e->log),
		.len = sizeof(slot->data),
	};
	if (!slot_lend(lane, slot))
		return false;
	due_set_take(&lane->inputs, row);
	guest_passed(lane);
	lane->writes_in_row = 0;
	if (slot->req.fresh)
		s->command.looked_ns = e->time.now_ns;
	s->reading = true;
	slot->one_shot = s->read.once;
	s->read.once = false;
	signal_begin(s, e->time.period);
	return true;
}

/* A command of before a reload, or of an earlier owsd, that the file does not allow any more. */
static void refuse_output(struct engine *e, struct signal *s)
{
	log_warning(e->log, "%s: the command in force is refused: it is beyond Min and Max",
	            s->item->name);
	e->counters.refused_commands++;
	s->command.given = s->command.one_shot = false;
	s->command.err = -ERANGE;
	engine_write_check(e, s);
	engine_publish(e, s);
}

static bool ask_write(struct lane *lane, struct slot *slot, uint32_t row)
{
	struct engine *e = lane->engine;
	struct signal *s = &e->table.signals[row];

	/* the value that counts is the one of this moment */
	engine_intake_signal(e, s);
	if (!due_set_has(&lane->outputs, row)) {
		engine_publish(e, s);
		return true;
	}
	if (!signal_is_string(s) && !signal_accepts(s, s->command.value)) {
		refuse_output(e, s);
		return true;
	}
	slot->purpose = FOR_WRITE;
	slot->row = row;
	slot->stamp = s->command.stamp;
	slot->controller = s->command.controller;
	slot->serial = s->command.controller < OWS_CONTROLLERS
	                       ? e->controllers[s->command.controller].as.who.serial
	                       : 0;
	slot->one_shot = s->command.one_shot;
	slot->req = (struct bus_req){.prio = BUS_OUTPUT, .path = s->item->path};
	signal_write(slot, s, s->command.value, s->command_text, s->command.len);
	if (!slot_lend(lane, slot))
		return false;
	due_set_take(&lane->outputs, row);
	guest_passed(lane);
	lane->writes_in_row++;
	lane->lent.writes++;
	s->writing = true;
	s->command.one_shot = false;
	s->command.forced = false;
	s->sample.tried_ns = e->time.now_ns;
	signal_begin(s, e->time.period);
	engine_publish(e, s);
	return true;
}

/* True: the alarm machine has given the slot's request to the bus, or has none to give now. */
static bool ask_alarm(struct lane *lane, struct slot *slot)
{
	struct engine *e = lane->engine;
	struct signal *s;

	/* one that was given up is still lent: the room for a list is not ours yet */
	if (lane->lent.alarm || lane->lent.writes || alarm_yields(&lane->alarm, lane))
		return false;
	slot->purpose = FOR_ALARM;
	slot->stamp = 0;
	slot->one_shot = false;
	slot->req = (struct bus_req){
		.prio = BUS_ALARM, .fresh = true, .path = slot->path, .len = sizeof(slot->data)};
	if (!alarm_run(&lane->alarm, lane, slot) || !slot_lend(lane, slot))
		return false;
	lane->lent.alarm = slot;
	alarm_started(&lane->alarm, lane);
	if (slot->row == TABLE_NO_ROW)
		return true;
	s = &e->table.signals[slot->row];
	s->alarming = true;
	s->sample.tried_ns = e->time.now_ns;
	signal_begin(s, e->time.period);
	engine_publish(e, s);
	return true;
}

/* The order of a lane: alarms, looks for devices, one changed output, the next input, guests. */
static bool ask_next(struct lane *lane, struct slot *slot)
{
	int64_t output, input;

	if (ask_alarm(lane, slot) || engine_probe_ask(lane, slot) ||
	    engine_restart_ask(lane, slot) || engine_watch_ask(lane, slot))
		return true;
	output = lane->lent.writes || alarm_holds(&lane->alarm) ? -1 : due_set_next(&lane->outputs);
	input = due_set_next(&lane->inputs);
	if (guest_turn(lane, output >= 0 || input >= 0))
		return guest_ask(lane, slot);
	/* a one-shot needs no writer, and has to come in its turn all the same */
	if (output >= 0 && (input < 0 || lane->writes_in_row < (lane->writers ? lane->writers : 1)))
		return ask_write(lane, slot, (uint32_t)output);
	if (input >= 0)
		return ask_read(lane, slot, (uint32_t)input);
	return false;
}

void lane_fill(struct lane *lane)
{
	struct slot *slot;

	while (lane->state.up && !lane->state.stuck && (slot = slot_next(lane)) != NULL)
		if (!ask_next(lane, slot))
			break;
}

void lane_show_reads(struct lane *lane)
{
	lane->lent.unshown = false;
	for (unsigned i = 0; i < lane->depth; i++) {
		struct slot *slot = &lane->lent.slots[i];
		struct signal *s;

		if (!slot->lent || slot->given_up || slot->moved || slot->shown ||
		    slot->purpose != FOR_READ)
			continue;
		slot->shown = true;
		s = &lane->engine->table.signals[slot->row];
		s->sample.tried_ns = later_ns(s->sample.tried_ns, slot->begun_ns);
		engine_publish(lane->engine, s);
	}
}

int64_t lane_wake(const struct lane *lane)
{
	int64_t look;

	if (!lane->state.up || lane->state.stuck || lane->lent.count == lane->depth)
		return INT64_MAX;
	look = lane->probes.count && !lane->probing ? lane->probe_ns : INT64_MAX;
	if (lane->watch.count && !lane->watching)
		look = earlier_ns(look, lane->watch_ns);
	/* the end of these wakes it */
	if (lane->lent.alarm || lane->lent.writes)
		return look;
	return earlier_ns(look, alarm_wake(&lane->alarm));
}
