/* SPDX-License-Identifier: MIT */
/* The engine looks into the command segment, checks what programs have set there, and takes it. */
#include <errno.h>
#include <string.h>

#include "hal/bus/time.h"
#include "src/engine/intake.h"
#include "src/engine/limits.h"
#include "src/engine/publish.h"
#include "src/engine/retry.h"
#include "src/engine/schedule.h"
#include "src/engine/state.h"
#include "src/signal/value.h"
#include "src/text/log.h"

/* A writer that holds a string's claim for longer has died. */
#define CLAIM_NS NS_PER_S
/*
 * A program that marks slots without end costs this many looks a second. An honest set waits for
 * none of it unless there is such a program; then it waits until the looks have gone round.
 */
#define LOOKS_PER_S 100000u
#define LOOKS_LEAST 5000u
#define LOOKS_SPAN_NS NS_PER_S
#define DEFER_NS (10 * NS_PER_MS)

static void refuse_command(struct engine *e, struct signal *s, int err, int64_t now_ns)
{
	char others[LOG_OTHERS];
	uint64_t n = log_rate(&e->refused, now_ns);

	e->counters.refused_commands++;
	if (err != -EROFS)
		s->command.err = err;
	if (n)
		log_warning(e->log, "%s: a value in the command segment was refused: %s%s",
		            s->item->name,
		            err == -EROFS    ? "it is an input, and Writable is off"
		            : err == -ERANGE ? "the type cannot hold it"
		                             : "its text is damaged",
		            log_others(n, others));
}

/* Look at a busy string again in the next step, for a second. */
static void remember_busy(struct engine *e, uint32_t slot, int64_t now_ns)
{
	for (unsigned i = 0; i < e->busy_count; i++)
		if (e->busy_slot[i] == slot)
			return;
	if (e->busy_count == sizeof(e->busy_slot) / sizeof(e->busy_slot[0]))
		return;
	e->busy_slot[e->busy_count] = slot;
	e->busy_since_ns[e->busy_count++] = now_ns;
}

/* 0 taken, -EBUSY to be looked at again, other: refused. */
static int take_command_text(struct engine *e, struct signal *s)
{
	char text[TABLE_TEXT_CAP + 1];
	int len = commands_text(e->commands, s->record, text);

	if (len < 0)
		return len;
	if (len > TABLE_TEXT_CAP)
		return -EBADMSG;
	memcpy(s->command_text, text, (size_t)len);
	s->command.len = (uint32_t)len;
	return 0;
}

/* 0 for a program that has signed off: it beats no more, and its outputs stay as they are. */
static uint32_t client_of(struct engine *e, const struct command *c)
{
	struct command_client client;

	if (!c->client)
		return 0;
	commands_client(e->commands, c->client - 1, &client);
	return client.pid ? c->client : 0;
}

static void take_command(struct engine *e, struct signal *s, const struct command *c,
                         int64_t now_ns)
{
	int err = 0;

	if (!config_item_takes_sets(s->item))
		err = -EROFS;
	else if (signal_is_string(s))
		err = take_command_text(e, s);
	else if (!value_holds(s->item->type, c->value))
		err = -ERANGE;
	if (err == -EBUSY) {
		remember_busy(e, s->record, now_ns);
		return;
	}
	s->seen.stamp = c->stamp;
	s->seen.awaited = false;
	if (err) {
		refuse_command(e, s, err, now_ns);
		return;
	}
	if (!signal_is_string(s))
		s->command.value = c->value;
	s->command.stamp = c->stamp;
	s->command.given = true;
	s->command.safe = false;
	s->seen.client = client_of(e, c);
	e->counters.commands++;
}

static void take_enable(struct signal *s, uint8_t commanded, uint32_t flag)
{
	if (commanded == 2)
		s->attrs.flags |= flag;
	else if (commanded == 1)
		s->attrs.flags &= ~flag;
}

static void take_enables(struct engine *e, struct signal *s, const struct command *c)
{
	bool read_before = signal_reads(s), write_before = signal_writes(s);

	take_enable(s, c->read_enable, OWS_ATTR_READ_ENABLE);
	if (config_item_takes_sets(s->item))
		take_enable(s, c->write_enable, OWS_ATTR_WRITE_ENABLE);
	if (signal_reads(s) && !read_before) {
		retry_clear(&s->read.retry);
		engine_read_now(e, s);
	} else if (!signal_reads(s) && read_before) {
		engine_read_never(e, s);
		if (!s->item->output)
			s->sample.quality = OWS_Q_DISABLED;
	}
	if (signal_writes(s) != write_before) {
		if (write_before) {
			s->command.err = 0;
			engine_lane(e, s)->writers--;
		} else {
			engine_lane(e, s)->writers++;
		}
	}
}

void engine_intake_signal(struct engine *e, struct signal *s, int64_t now_ns)
{
	struct command c;

	commands_load(e->commands, s->record, &c);
	/* 0 is no command: a segment that a consumer truncated is all 0 */
	if (c.stamp && c.stamp != s->seen.stamp)
		take_command(e, s, &c, now_ns);
	take_enables(e, s, &c);
	if (c.one_shot && c.one_shot != s->seen.one_shots) {
		s->seen.one_shots = c.one_shot;
		s->command.one_shot = s->command.given && config_item_takes_sets(s->item);
	}
	if (c.dgn_reset && c.dgn_reset != s->seen.dgn_resets) {
		s->seen.dgn_resets = c.dgn_reset;
		signal_reset_diagnostics(s, e->time.period, now_ns);
	}
	if (c.acknowledged && c.acknowledged != s->seen.acknowledged) {
		s->seen.acknowledged = c.acknowledged;
		engine_limits_acknowledge(e, s);
	}
	signal_settle(s);
	engine_write_check(e, s);
}

static void take_driver_reset(struct engine *e, int64_t now_ns)
{
	struct command c;

	commands_load(e->commands, 0, &c);
	if (!c.dgn_reset || c.dgn_reset == e->driver.resets)
		return;
	e->driver.resets = c.dgn_reset;
	e->driver.transactions = 0;
	e->driver.reconnects = 0;
	for (uint32_t row = 0; row < e->table.count; row++) {
		signal_reset_diagnostics(&e->table.signals[row], e->time.period, now_ns);
		engine_publish(e, &e->table.signals[row]);
	}
	log_info(e->log, "diagnostics of all signals reset");
}

static void look_at_slot(struct engine *e, uint32_t slot, int64_t now_ns)
{
	struct signal *s;

	if (slot == 0) {
		take_driver_reset(e, now_ns);
	} else if (slot <= e->table.count) {
		s = &e->table.signals[slot - 1];
		engine_intake_signal(e, s, now_ns);
		engine_publish(e, s);
	}
}

/* Texts that a program was just writing. */
static void look_at_busy(struct engine *e, int64_t now_ns)
{
	unsigned busy = e->busy_count;

	e->busy_count = 0;
	for (unsigned i = 0; i < busy; i++) {
		uint32_t again = e->busy_slot[i];
		int64_t since = e->busy_since_ns[i];

		if (now_ns - since > CLAIM_NS) {
			commands_unclaim(e->commands, again);
			log_warning(e->log, "%s: a program died while it set this text",
			            e->table.signals[again - 1].item->name);
		}
		look_at_slot(e, again, now_ns);
		if (e->busy_count && e->busy_slot[e->busy_count - 1] == again)
			e->busy_since_ns[e->busy_count - 1] = since;
	}
}

/* Look at the marked slots from one on, at most so many. False: there are more. */
static bool look_at_marked(struct engine *e, uint32_t *from, uint32_t *looks, int64_t now_ns)
{
	while (*looks) {
		int slot = commands_next_dirty(e->commands, *from);

		if (slot < 0)
			return true;
		look_at_slot(e, (uint32_t)slot, now_ns);
		*from = (uint32_t)slot + 1;
		--*looks;
	}
	return false;
}

void engine_intake(struct engine *e, int64_t now_ns)
{
	uint32_t all = UINT32_MAX, from = 0;

	look_at_busy(e, now_ns);
	look_at_marked(e, &from, &all, now_ns);
}

/* A look that was not needed yet is kept, up to two for each slot and some. */
static void refill_looks(struct engine *e, int64_t now_ns)
{
	uint64_t most = 2 * (uint64_t)e->table.count + LOOKS_LEAST;
	int64_t since_ns = now_ns - e->looks_ns;
	uint64_t more = since_ns < LOOKS_SPAN_NS ? (uint64_t)since_ns * LOOKS_PER_S / 1000000000u
	                                         : most;

	if (!more)
		return;
	e->looks = e->looks + more < most ? (uint32_t)(e->looks + more) : (uint32_t)most;
	e->looks_ns = now_ns;
}

int64_t engine_intake_limited(struct engine *e, int64_t now_ns)
{
	uint32_t begin = e->look_from;

	look_at_busy(e, now_ns);
	if (now_ns < e->defer_ns)
		return e->defer_ns;
	refill_looks(e, now_ns);
	/*
	 * once round: whoever marks the first slots again and again does not keep the last ones
	 * waiting
	 */
	if (look_at_marked(e, &e->look_from, &e->looks, now_ns)) {
		e->look_from = 0;
		if (!begin || look_at_marked(e, &e->look_from, &e->looks, now_ns)) {
			e->look_from = 0;
			return INT64_MAX;
		}
	}
	e->counters.deferred_commands++;
	e->defer_ns = now_ns + DEFER_NS;
	return e->defer_ns;
}
