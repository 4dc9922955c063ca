/* SPDX-License-Identifier: MIT */
/*
 * Compares what an output reads with what was written, and reports where they differ. A power-on
 * flag that was clear and is set proves that the device restarted, where no alarm item watches it:
 * then the outputs of the device are written again. A flag that was never cleared says nothing, and
 * owsd does not clear it.
 */
#include <stdio.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/owfs/path.h"
#include "src/daemon/engine/alarm/alarm_effect.h"
#include "src/daemon/engine/alarm/alarm_item.h"
#include "src/daemon/engine/alarm/alarm_text.h"
#include "src/daemon/engine/command/read_back.h"
#include "src/daemon/engine/due.h"
#include "src/daemon/engine/lane.h"
#include "src/daemon/engine/retry.h"
#include "src/daemon/engine/scaling.h"
#include "src/daemon/engine/schedule.h"
#include "src/ground/signal/value.h"
#include "src/memory/shm/entries.h"

static bool is_watched(const struct alarm_machine *m, uint32_t device)
{
	for (uint32_t k = 0; k < m->count; k++)
		if (m->items[k]->device == device && m->items[k]->strings.por &&
		    *m->items[k]->strings.por)
			return true;
	return false;
}

/* The output was read back: ask for the flag if that is to be known. */
static void look_for_restart(struct lane *lane, const struct signal *s, bool agrees)
{
	const struct device *d;

	if (!s->item->has_por || !signal_has_device(s))
		return;
	d = &lane->engine->table.devices[s->device];
	if (agrees && lane->engine->time.now_ns < d->por_ns)
		return;
	if (d->por == (agrees ? POR_UNKNOWN : POR_CLEAR) && !is_watched(&lane->alarm, s->device))
		due_set_add(&lane->restarts, s->device);
}

bool engine_restart_ask(struct lane *lane, struct slot *slot)
{
	int64_t device = due_set_next(&lane->restarts);
	const struct signal *s;
	struct path path;

	if (device < 0)
		return false;
	s = lane->engine->table.devices[device].signals[0];
	if (s->lane != lane->index || path_split(s->item->path, strlen(s->item->path), &path)) {
		due_set_take(&lane->restarts, (uint32_t)device);
		return false;
	}
	snprintf(slot->path, sizeof(slot->path), "%.*s/por",
	         (int)(path.device.text + path.device.len - s->item->path), s->item->path);
	slot->purpose = FOR_RESTART;
	slot->row = (uint32_t)device;
	slot->req = (struct bus_req){.op = BUS_READ,
	                             .prio = BUS_INPUT,
	                             .fresh = true,
	                             .path = slot->path,
	                             .len = sizeof(slot->data)};
	if (!slot_lend(lane, slot))
		return false;
	due_set_take(&lane->restarts, (uint32_t)device);
	return true;
}

void engine_restart_done(struct lane *lane, const struct slot *slot,
                         const struct bus_answer *answer)
{
	struct device *d = &lane->engine->table.devices[slot->row];
	bool was_clear = d->por == POR_CLEAR;
	int set = answer->err ? answer->err : alarm_non_zero((const char *)slot->data, answer->len);

	if (set < 0) {
		d->por_ns = lane->engine->time.now_ns + RETRY_MAX_NS;
		return;
	}
	d->por = set ? POR_SET : POR_CLEAR;
	for (uint32_t k = 0; set && was_clear && k < d->count; k++) {
		const struct signal *s = d->signals[k];

		if (s->lane == lane->index && s->item->output) {
			engine_power_on_reset(lane, d, s, true);
			return;
		}
	}
}

/* Between two writes of a command that does not hold; doubled up to the longest. */
#define RESTORE_FIRST_NS (5 * NS_PER_S)
#define RESTORE_DOUBLINGS 4
/* So long after the last one the device counts as well again. */
#define RESTORE_WELL_NS (60 * NS_PER_S)

static void read_back_enter(struct engine *e, const struct signal *s, enum ows_alarm_event event,
                            uint8_t quality)
{
	struct ows_journal_entry entry = signal_entry(s, OWS_ALARM_DIFFERS, event, e->time.now_ns);

	entry.quality = quality;
	entry.before = s->command.written;
	entry.after = s->sample.value;
	entry.flags = OWS_JOURNAL_BEFORE | OWS_JOURNAL_AFTER;
	image_alarm(e->image, &entry);
	e->published = true;
}

static void begin_difference(struct engine *e, struct signal *s)
{
	char reads[VALUE_TEXT_MAX], written[VALUE_TEXT_MAX];

	value_to_text(s->item->type, s->sample.value, reads);
	value_to_text(s->item->type, s->command.written, written);
	log_warning(e->log, "%s (%s): not as commanded: it reads %s, and %s was written",
	            s->item->name, s->item->path, reads, written);
	read_back_enter(e, s, OWS_ALARM_RAISED, OWS_Q_DIFFERS);
}

static void end_difference(struct engine *e, struct signal *s, uint8_t quality, const char *why)
{
	log_notice(e->log, "%s (%s): %s", s->item->name, s->item->path, why);
	read_back_enter(e, s, OWS_ALARM_RETURNED, quality);
}

void engine_compares_no_more(struct engine *e, struct signal *s, uint8_t quality)
{
	end_difference(e, s, quality, "not compared with its command any more");
}

/* Write a command again that the device lost, if it was not done just now; else later. */
static void restore_command(struct engine *e, struct signal *s)
{
	struct signal_restore *r = &s->restore;

	if (!(s->item->restores || s->command.unproven_ns) || !s->command.differs ||
	    !signal_writes(s) || e->time.now_ns < r->not_before_ns)
		return;
	s->command.unproven_ns = 0;
	r->not_before_ns = e->time.now_ns + (RESTORE_FIRST_NS << r->doublings);
	r->doublings += r->doublings < RESTORE_DOUBLINGS;
	log_notice(e->log, "%s (%s): the command is written again", s->item->name, s->item->path);
	s->command.confirmed = false;
	engine_write_check(e, s);
}

static void judge_read_back(struct engine *e, struct signal *s, bool agrees, uint8_t *quality)
{
	bool differed = s->command.differs;

	s->command.differs = !agrees;
	if (agrees) {
		if (differed)
			end_difference(e, s, *quality, "as commanded again");
		if (e->time.now_ns > s->restore.not_before_ns + RESTORE_WELL_NS)
			s->restore.doublings = 0;
		return;
	}
	*quality = OWS_Q_DIFFERS;
	if (!differed)
		begin_difference(e, s);
	restore_command(e, s);
}

bool engine_compare(struct engine *e, struct lane *lane, struct signal *s, const struct slot *slot,
                    uint8_t *quality)
{
	struct signal_command *c = &s->command;
	/* one that comes back is written anew */
	bool absent = signal_has_device(s) && e->table.devices[s->device].absent;
	bool agrees;

	if (!s->item->output || signal_is_string(s))
		return true;
	if (slot->begun_ns < c->ended_ns) /* it proves nothing, and may be older than the write */
		return false;
	if (!c->confirmed || s->writing) {
		if (c->differs && !s->writing && !signal_changed(s)) {
			c->differs = false;
			engine_compares_no_more(e, s, *quality);
		}
		*quality = c->differs ? OWS_Q_DIFFERS : *quality;
		return true;
	}
	agrees = signal_reads_as_written(s, quality);
	if (!agrees && (signal_changed(s) || absent)) {
		*quality = c->differs ? OWS_Q_DIFFERS : *quality;
		return true;
	}
	/* it may come from a cache, or be a disturbed reading of a chip without a checksum */
	if (s->item->read_back_ns && !agrees && !c->differs && !c->doubted) {
		c->doubted = true;
		return false;
	}
	c->doubted = false;
	if (agrees && slot->begun_ns >= c->unproven_ns)
		c->unproven_ns = 0;
	if (c->agrees && !agrees)
		alarm_output_differs(&lane->alarm, s->device);
	c->agrees = agrees;
	c->lapsed &= !agrees;
	if (s->item->read_back_ns) {
		look_for_restart(lane, s, agrees);
		judge_read_back(e, s, agrees, quality);
	}
	return true;
}
