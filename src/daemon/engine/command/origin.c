/* SPDX-License-Identifier: MIT */
/*
 * Who gave the command in force: the origins in the image, and the journal of commands. Whose
 * command was refused.
 */
#include <errno.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/daemon/engine/command/origin.h"
#include "src/ground/text/log.h"
#include "src/memory/shm/entries.h"

/* A controller that commands a signal without end for one person has one entry a second. */
#define APART_NS NS_PER_S
/* Controllers that command a signal in turn have so many entries at once, then one a second. */
#define AT_ONCE 8

static bool same_text(const struct signal *s, const char *text, uint32_t len)
{
	return s->command.len == len && memcmp(s->command_text, text, len) == 0;
}

struct origin_before origin_before(const struct signal *s, int64_t value, const char *text,
                                   uint32_t len)
{
	return (struct origin_before){
		.given = s->command.given,
		.changes = !s->command.given || (signal_is_string(s) ? !same_text(s, text, len)
	                                                             : s->command.value != value),
		.value = s->command.value,
	};
}

static void enter_command(struct engine *e, const struct signal *s, enum ows_reason reason,
                          const struct ows_who *who, const struct origin_before *before,
                          int64_t occurred_ns)
{
	struct ows_journal_entry entry = {
		.record = s->record,
		.occurred_ns = occurred_ns,
		.kind = (uint8_t)reason,
		.quality = s->sample.quality,
		.more = s->journal.more,
		.who = *who,
	};

	if (signal_is_string(s)) {
		memcpy(entry.text, s->command_text,
		       s->command.len < sizeof(entry.text) ? s->command.len
		                                           : sizeof(entry.text) - 1);
	} else {
		entry.after = s->command.value;
		entry.before = before->value;
		entry.flags = OWS_JOURNAL_AFTER | (before->given ? OWS_JOURNAL_BEFORE : 0);
	}
	image_command(e->image, &entry);
	e->published = true;
}

/* The last of the controller before that was not entered: it was in force until now. */
static void enter_rest(struct engine *e, struct signal *s, const struct origin_before *before)
{
	const struct ows_origin_entry *was = &e->image->origins[s->record];
	struct ows_journal_entry entry = {
		.record = s->record,
		.occurred_ns = was->taken_ns,
		.kind = (uint8_t)was->reason,
		.quality = s->sample.quality,
		.more = s->journal.more - 1,
		.after = before->value,
		.flags = signal_is_string(s) ? 0 : OWS_JOURNAL_AFTER,
		.who = was->who,
	};

	image_command(e->image, &entry);
	s->journal.more = 0;
}

/* May controllers enter one more of this signal? What owsd does itself is always entered. */
static bool has_room(struct signal *s, int64_t now_ns)
{
	int64_t from_ns = s->journal.until_ns > now_ns ? s->journal.until_ns : now_ns;

	if (from_ns - now_ns > (AT_ONCE - 1) * APART_NS)
		return false;
	s->journal.until_ns = from_ns + APART_NS;
	return true;
}

static void journal_command(struct engine *e, struct signal *s, enum ows_reason reason,
                            const struct ows_who *who, const struct origin_before *before)
{
	const struct ows_who *was = &e->image->origins[s->record].who;
	bool same = s->journal.serial == who->serial && s->journal.reason == (uint32_t)reason &&
	            strncmp(was->person, who->person, sizeof(was->person)) == 0;

	if (same && !before->changes)
		return;
	if ((same && e->time.now_ns - s->journal.entered_ns < APART_NS) ||
	    (reason == OWS_REASON_SET && !has_room(s, e->time.now_ns))) {
		s->journal.more++;
		engine_origin_wait(e, s);
		return;
	}
	if (!same && s->journal.more)
		enter_rest(e, s, before);
	enter_command(e, s, reason, who, before, e->time.now_ns);
	s->journal.entered_ns = e->time.now_ns;
	s->journal.serial = who->serial;
	s->journal.reason = (uint32_t)reason;
	s->journal.more = 0;
}

void engine_origin(struct engine *e, struct signal *s, enum ows_reason reason,
                   const struct ows_who *who, const struct origin_before *before)
{
	const struct ows_origin_entry entry = {
		.reason = (uint32_t)reason,
		.taken_ns = reason == OWS_REASON_NONE ? 0 : e->time.now_ns,
		.who = *who,
	};

	if (reason != OWS_REASON_NONE)
		journal_command(e, s, reason, who, before);
	image_origin(e->image, s->record, &entry);
}

void engine_origin_wait(struct engine *e, const struct signal *s)
{
	int64_t at_ns = s->journal.entered_ns + APART_NS,
		room_ns = s->journal.until_ns - (AT_ONCE - 1) * APART_NS;

	if (s->journal.more)
		due_wheel_at(&e->wheel, engine_row_wait(s, WAIT_JOURNAL),
		             engine_period_at(e, at_ns > room_ns ? at_ns : room_ns));
}

void engine_origin_rest(struct engine *e, struct signal *s)
{
	const struct ows_origin_entry *last = &e->image->origins[s->record];
	const struct origin_before before = {0};

	if (!s->journal.more)
		return;
	if (!has_room(s, e->time.now_ns)) {
		engine_origin_wait(e, s);
		return;
	}
	s->journal.more--;
	enter_command(e, s, (enum ows_reason)last->reason, &last->who, &before, last->taken_ns);
	s->journal = (struct signal_journal){.entered_ns = e->time.now_ns,
	                                     .until_ns = s->journal.until_ns,
	                                     .serial = last->who.serial,
	                                     .reason = last->reason};
}

void engine_origin_carry(struct engine *e, const struct signal *s, const struct engine *old,
                         uint32_t record)
{
	image_origin(e->image, s->record, &old->image->origins[record]);
}

void engine_origin_begin(struct engine *e, struct signal *s)
{
	struct ows_origin_entry entry = e->image->origins[s->record];
	const struct origin_before before = {.changes = true};

	if (entry.reason == OWS_REASON_NONE)
		return;
	entry.taken_ns = e->time.now_ns;
	s->journal = (struct signal_journal){.reason = entry.reason, .entered_ns = entry.taken_ns};
	enter_command(e, s, (enum ows_reason)entry.reason, &entry.who, &before, entry.taken_ns);
	image_origin(e->image, s->record, &entry);
}

void engine_refuse(struct engine *e, struct known_controller *g, const struct signal *s, int err)
{
	char others[LOG_OTHERS];
	uint64_t n = log_rate(&e->refused, e->time.now_ns);

	e->counters.refused_commands++;
	g->refused++;
	if (n)
		log_warning(
			e->log, "%s: a command of " LOG_PROGRAM " was refused: %s%s", s->item->name,
			g->as.who.name, (int)g->as.who.pid, (unsigned)g->as.who.uid,
			err == -EROFS    ? "the signal is an input, and Writable is off"
			: err == -EACCES ? "ControlAllow does not let it command the signal"
			: err == -ERANGE ? "the type cannot hold it, or it is beyond Min and Max"
			: err == -ESTALE ? "owsd ended before the bus had confirmed it"
					 : "the text is damaged",
			log_others(n, others));
}
