/* SPDX-License-Identifier: MIT */
/* The engine looks into the memories of controllers, checks what they commanded, and takes it. */
#include <errno.h>

#include "hal/base/time.h"
#include "src/daemon/engine/command/in_force.h"
#include "src/daemon/engine/command/intake.h"
#include "src/daemon/engine/command/origin.h"
#include "src/daemon/engine/limits/limits.h"
#include "src/daemon/engine/publish.h"
#include "src/daemon/engine/retry.h"
#include "src/daemon/engine/scaling.h"
#include "src/daemon/engine/schedule.h"
#include "src/ground/text/log.h"

/* A controller that needs longer to store a text has none to store. */
#define BUSY_NS NS_PER_S
/*
 * Controllers that mark slots without end cost this many looks a second together. Each controller
 * has a budget of its own, so that it keeps no other waiting.
 */
#define LOOKS_PER_S 100000u
#define LOOKS_LEAST 5000u
#define LOOKS_SPAN_NS NS_PER_S
#define DEFER_NS (10 * NS_PER_MS)

static bool may_command(const struct known_controller *g, uint32_t record)
{
	return !g->as.rights || g->as.rights[record / 32] >> record % 32 & 1;
}

/*
 * Returns the length, -EBUSY: the controller may be just storing it, look again; -EBADMSG.
 */
static int copy_text(struct known_controller *g, uint32_t record, char *text, int64_t now_ns)
{
	int len = controller_text(&g->as.memory, record, text);

	if (len >= 0 || (g->busy == record && now_ns - g->busy_ns > BUSY_NS)) {
		if (g->busy == record)
			g->busy = 0;
		return len;
	}
	if (!g->busy) {
		g->busy = record;
		g->busy_ns = now_ns;
	}
	return g->busy == record ? -EBUSY : len;
}

static void take_command(struct engine *e, uint32_t controller, struct signal *s,
                         const struct controller_command *c)
{
	struct known_controller *g = &e->controllers[controller];
	char text[TABLE_TEXT_CAP + 1];
	int err = 0, len = 0;

	if (!config_item_takes_sets(s->item)) {
		err = -EROFS;
	} else if (!may_command(g, s->record)) {
		err = -EACCES;
	} else if (signal_is_string(s)) {
		len = copy_text(g, s->record, text, e->time.now_ns);
		err = len < 0 ? len : 0;
	} else if (!signal_accepts(s, c->value)) {
		err = -ERANGE;
	}
	if (err == -EBUSY)
		return;
	if (err) {
		engine_refuse(e, g, s, err);
	} else {
		/* a promise may have come along with it: a kill finds both, or none */
		engine_hear(e, controller);
		engine_command(e, s, controller, c, signal_is_string(s) ? text : NULL,
		               (uint32_t)len);
		g->commands++;
		e->counters.commands++;
	}
	/* after the origin: a reader of this finds there which command is in force */
	controller_taken(&g->as.memory, s->record, c->stamp, err);
}

static void take_enable(struct signal *s, uint8_t commanded, uint32_t flag)
{
	if (commanded == 2)
		s->attrs.flags |= flag;
	else if (commanded == 1)
		s->attrs.flags &= ~flag;
}

static void take_enables(struct engine *e, struct signal *s, const struct controller_command *c)
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
		engine_read_now(e, s); /* it may be read back */
		if (!s->item->output)
			s->sample.quality = OWS_Q_DISABLED;
	}
	engine_lane(e, s)->writers += signal_writes(s);
	engine_lane(e, s)->writers -= write_before;
	if (write_before && !signal_writes(s))
		s->command.err = 0;
}

static void look_at_signal(struct engine *e, uint32_t controller, struct signal *s)
{
	struct known_controller *g = &e->controllers[controller];
	struct controller_command c;
	struct ows_who who;

	controller_load(&g->as.memory, s->record, &c);
	if (c.fresh)
		take_command(e, controller, s, &c);
	else if (g->busy == s->record)
		g->busy = 0;
	if (!may_command(g, s->record))
		return;
	take_enables(e, s, &c);
	if (c.one_shot)
		s->command.one_shot = s->command.given && !s->command.awaited &&
		                      config_item_takes_sets(s->item);
	if (c.read_once)
		engine_read_once(e, s);
	if (c.dgn_reset)
		signal_reset_diagnostics(s, e->time.period, e->time.now_ns);
	if (c.acknowledged) {
		who = engine_who(g, c.person);
		engine_limits_acknowledge(e, s, &who);
	}
	engine_settle(e, s);
	engine_write_check(e, s);
}

void engine_intake_signal(struct engine *e, struct signal *s)
{
	uint32_t controller = s->command.controller;

	if (controller < OWS_CONTROLLERS && e->controllers[controller].is == CONTROLLER_CONNECTED)
		look_at_signal(e, controller, s);
}

static void take_driver_reset(struct engine *e, const struct known_controller *g)
{
	struct controller_command c;
	char others[LOG_OTHERS];
	uint64_t n;

	controller_load(&g->as.memory, 0, &c);
	if (!c.dgn_reset || !may_command(g, 0))
		return;
	e->driver.transactions = 0;
	e->driver.reconnects = 0;
	for (uint32_t row = 0; row < e->table.count; row++) {
		signal_reset_diagnostics(&e->table.signals[row], e->time.period, e->time.now_ns);
		engine_publish(e, &e->table.signals[row]);
	}
	n = log_rate(&e->resets, e->time.now_ns);
	if (n)
		log_info(e->log, "reset the diagnostics of all signals%s", log_others(n, others));
}

static void look_at_record(struct engine *e, uint32_t controller, uint32_t record)
{
	struct signal *s;

	if (record == 0) {
		take_driver_reset(e, &e->controllers[controller]);
	} else if (record <= e->table.count) {
		s = &e->table.signals[record - 1];
		look_at_signal(e, controller, s);
		engine_publish(e, s);
	}
}

static void look_at_shelf(struct engine *e, struct known_controller *g)
{
	struct controller_shelf shelf;
	struct ows_who who;
	int err;

	if (!controller_shelf(&g->as.memory, &shelf))
		return;
	who = engine_who(g, shelf.person);
	if (!shelf.record || shelf.record > e->table.count) {
		err = -EINVAL;
	} else if (!may_command(g, shelf.record)) {
		err = -EACCES;
	} else {
		struct signal *s = &e->table.signals[shelf.record - 1];

		err = engine_shelve(e, s, shelf.seconds, &who, shelf.why);
		engine_publish(e, s);
	}
	controller_shelf_done(&g->as.memory, shelf.count, err);
}

/* Look at the marked slots from one on, at most so many. False: there are more. */
static bool look_at_marked(struct engine *e, uint32_t controller, uint32_t *from, uint32_t *looks)
{
	while (*looks) {
		uint32_t cost;
		int record = controller_next_dirty(&e->controllers[controller].as.memory, *from);

		if (record < 0)
			return true;
		/* the driver's slot may reset all rows */
		cost = record ? 1 : 1 + e->table.count;
		look_at_record(e, controller, (uint32_t)record);
		*from = (uint32_t)record + 1;
		*looks -= cost < *looks ? cost : *looks;
	}
	return false;
}

void engine_intake(struct engine *e, uint32_t controller)
{
	struct known_controller *g = &e->controllers[controller];
	uint32_t all = UINT32_MAX, from = 0;

	engine_hear(e, controller);
	if (g->busy)
		look_at_record(e, controller, g->busy);
	controller_marked(&g->as.memory);
	look_at_marked(e, controller, &from, &all);
	look_at_shelf(e, g);
}

/* A look that was not needed yet is kept, up to two for each slot and some. */
static void refill_looks(struct engine *e, struct known_controller *g)
{
	uint64_t most = 2 * (uint64_t)e->table.count + LOOKS_LEAST;
	uint64_t rate = LOOKS_PER_S / (e->greedy ? e->greedy : 1);
	int64_t since_ns = e->time.now_ns - g->looks_ns;
	uint64_t more = since_ns < LOOKS_SPAN_NS ? (uint64_t)since_ns * rate / 1000000000u : most;

	if (!more)
		return;
	g->looks = g->looks + more < most ? (uint32_t)(g->looks + more) : (uint32_t)most;
	g->looks_ns = e->time.now_ns;
}

/*
 * Look once round: the first slots, marked again and again, do not keep the last ones waiting.
 * Returns whether nothing is left. That it is asked at all costs some looks too.
 */
static bool look_round(struct engine *e, uint32_t controller)
{
	struct known_controller *g = &e->controllers[controller];
	uint32_t begin = g->look_from, cost = 1 + g->as.memory.layout->header.dirty_words / 64;

	if (g->looks <= cost)
		return false;
	g->looks -= cost;
	controller_marked(&g->as.memory);
	look_at_shelf(e, g);
	if (!look_at_marked(e, controller, &g->look_from, &g->looks))
		return false;
	g->look_from = 0;
	if (begin && !look_at_marked(e, controller, &g->look_from, &g->looks))
		return false;
	g->look_from = 0;
	return true;
}

static void look_at_controller(struct engine *e, uint32_t controller)
{
	struct known_controller *g = &e->controllers[controller];

	e->controllers_quiet = false;
	if (g->more) {
		g->more = false;
		e->greedy--;
	}
	engine_hear(e, controller);
	refill_looks(e, g);
	if (look_round(e, controller))
		return;
	e->counters.deferred_commands++;
	g->more = true;
	e->greedy++;
	g->defer_ns = e->time.now_ns + DEFER_NS;
}

int64_t engine_intake_limited(struct engine *e)
{
	int64_t next = INT64_MAX;

	for (uint32_t i = 0; i < e->seat_end; i++) {
		struct known_controller *g = &e->controllers[i];

		if (g->is != CONTROLLER_CONNECTED)
			continue;
		if (g->busy)
			look_at_record(e, i, g->busy);
		if (g->more ? e->time.now_ns >= g->defer_ns : controller_is_marked(&g->as.memory))
			look_at_controller(e, i);
		if (g->more && g->defer_ns < next)
			next = g->defer_ns;
	}
	return next;
}
