/* SPDX-License-Identifier: MIT */
/*
 * The controllers that are connected, and those that owsd awaits: they join and leave, they beat,
 * and the image shows them.
 */
#include <assert.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/daemon/engine/command/controllers.h"
#include "src/daemon/engine/command/in_force.h"
#include "src/daemon/engine/command/intake.h"
#include "src/daemon/engine/schedule.h"
#include "src/daemon/engine/state.h"
#include "src/ground/text/log.h"
#include "src/memory/shm/entries.h"

static void show_controller(struct engine *e, uint32_t seat)
{
	struct known_controller *g = &e->controllers[seat];
	struct ows_controller_entry entry = {0};

	if (g->is == CONTROLLER_CONNECTED)
		entry = (struct ows_controller_entry){
			.flags = OWS_CONTROLLER_CONNECTED |
		                 (g->may_set ? OWS_CONTROLLER_MAY_SET : 0) |
		                 (g->late ? OWS_CONTROLLER_LATE : 0),
			.joined_ns = g->joined_ns,
			.who = g->as.who,
			.period_ms = g->period_ms,
			.commands = g->commands,
			.refused = g->refused,
		};
	image_controller(e->image, seat, &entry);
	g->shown = g->commands + g->refused;
}

/* --- The beat --------------------------------------------------------------------------------- */

static void lose_outputs(struct engine *e, uint32_t controller, int64_t awake_ns)
{
	struct known_controller *g = &e->controllers[controller];
	unsigned rows = g->rows, safe = engine_lose(e, controller, awake_ns, &g->lose_ns);

	if (g->rows == rows)
		return;
	e->counters.lost_controllers += g->is == CONTROLLER_AWAITED;
	log_warning(e->log, LOG_PROGRAM " %s: %u output%s to SafeValue", g->as.who.name,
	            (int)g->as.who.pid, (unsigned)g->as.who.uid,
	            g->is == CONTROLLER_AWAITED     ? "has not come back since owsd started"
	            : g->is == CONTROLLER_CONNECTED ? "stopped beating"
	                                            : "ended without a goodbye",
	            safe, safe == 1 ? " goes" : "s go");
}

static void controllers_forget(struct engine *e, uint32_t controller)
{
	e->controllers[controller] = (struct known_controller){0};
	engine_remember_controller(e, controller);
}

static void look_at_beat(struct engine *e, uint32_t seat, int64_t awake_ns)
{
	struct known_controller *g = &e->controllers[seat];
	bool changes, late;

	engine_hear(e, seat);
	late = g->period_ms && awake_ns - g->heard_ns > g->period_ms * NS_PER_MS;
	if (late && !g->late)
		e->counters.lost_controllers++;
	changes = late != g->late || g->period_ms != e->image->controllers[seat].period_ms;
	g->late = late;
	if (late && g->rows && awake_ns > g->lose_ns)
		lose_outputs(e, seat, awake_ns);
	if (changes || g->shown != g->commands + g->refused)
		show_controller(e, seat);
}

static void look_at_absent(struct engine *e, uint32_t index, int64_t awake_ns)
{
	struct known_controller *g = &e->controllers[index];

	if (g->rows && awake_ns > g->lose_ns)
		lose_outputs(e, index, awake_ns);
	if (!g->rows)
		controllers_forget(e, index);
}

void engine_look_controllers(struct engine *e)
{
	int64_t awake_ns = engine_awake_ns(e);
	bool quiet = true;

	if (e->controllers_quiet)
		return;
	for (uint32_t i = 0; i < e->seat_end; i++) {
		if (e->controllers[i].is != CONTROLLER_CONNECTED)
			continue;
		look_at_beat(e, i, awake_ns);
		quiet &= !e->controllers[i].period_ms && !e->controllers[i].busy;
	}
	for (uint32_t i = OWS_CONTROLLERS; i < ENGINE_CONTROLLERS; i++) {
		if (e->controllers[i].is != CONTROLLER_FREE)
			look_at_absent(e, i, awake_ns);
		quiet &= e->controllers[i].is == CONTROLLER_FREE;
	}
	e->controllers_quiet = quiet;
}

/* --- Joining ---------------------------------------------------------------------------------- */

static bool has_token(const struct known_controller *g)
{
	static const uint8_t none[sizeof(g->as.token)];

	return memcmp(g->as.token, none, sizeof(none)) != 0;
}

static bool may_set(const struct joining_controller *controller)
{
	const struct controller_layout *l = controller->memory.layout;
	uint32_t any = 0;

	for (uint32_t i = 0; controller->rights && i < l->header.dirty_words; i++)
		any |= controller->rights[i];
	return !controller->rights || any;
}

/* The controller that it was before, which has commands in force. */
static uint32_t find_former(const struct engine *e, uint32_t seat)
{
	const struct known_controller *g = &e->controllers[seat];

	for (uint32_t i = 0; i < ENGINE_CONTROLLERS && has_token(g); i++) {
		const struct known_controller *f = &e->controllers[i];

		if (i != seat && f->is != CONTROLLER_FREE && f->rows &&
		    f->as.who.uid == g->as.who.uid &&
		    memcmp(f->as.token, g->as.token, sizeof(g->as.token)) == 0)
			return i;
	}
	return CONTROLLER_NOBODY;
}

static void come_back(struct engine *e, uint32_t seat, uint32_t former)
{
	struct known_controller *g = &e->controllers[seat], *f = &e->controllers[former];

	if (!g->period_ms)
		g->period_ms = f->period_ms; /* until it says more: at its first beat */
	engine_remember_controller(e, seat);
	engine_hand_over(e, former, seat);
	engine_come_back(e, seat);
	log_info(e->log, LOG_PROGRAM " came back: its command%s of %u output%s in force",
	         g->as.who.name, (int)g->as.who.pid, (unsigned)g->as.who.uid,
	         g->rows == 1 ? "" : "s", g->rows, g->rows == 1 ? " is" : "s are");
	if (former >= OWS_CONTROLLERS)
		controllers_forget(e, former);
}

void engine_controller_join(struct engine *e, unsigned seat,
                            const struct joining_controller *controller, int64_t now_ns)
{
	struct known_controller *g = &e->controllers[seat];
	struct controller_beat beat;
	uint32_t former;

	assert(seat < OWS_CONTROLLERS && g->is == CONTROLLER_FREE);
	engine_begin_call(e, now_ns);
	e->controllers_quiet = false;
	controller_beat(&controller->memory, &beat);
	*g = (struct known_controller){
		.is = CONTROLLER_CONNECTED,
		.as = *controller,
		.may_set = may_set(controller),
		.beat = beat.beat,
		.period_ms = beat.goodbye ? 0 : beat.period_ms,
		.joined_ns = now_ns,
		.heard_ns = engine_awake_ns(e),
		.looks_ns = INT64_MIN / 2, /* all are left */
	};
	if (e->seat_end <= seat)
		e->seat_end = seat + 1;
	engine_remember_controller(e, seat);
	former = find_former(e, seat);
	if (former != CONTROLLER_NOBODY)
		come_back(e, seat, former);
	show_controller(e, seat);
	e->published = true;
}

/* --- Leaving ---------------------------------------------------------------------------------- */

static uint32_t free_absent(const struct engine *e)
{
	for (uint32_t i = OWS_CONTROLLERS; i < ENGINE_CONTROLLERS; i++)
		if (e->controllers[i].is == CONTROLLER_FREE)
			return i;
	return CONTROLLER_NOBODY;
}

/* It promised a beat and said no goodbye: it may come back until its time is over. */
static void begin_absence(struct engine *e, uint32_t seat, int64_t awake_ns)
{
	struct known_controller *g = &e->controllers[seat];
	uint32_t to = free_absent(e);

	e->counters.lost_controllers += !g->late;
	g->is = CONTROLLER_HUNG_UP;
	g->left_ns = awake_ns;
	g->lose_ns = 0;
	if (to == CONTROLLER_NOBODY) {
		g->heard_ns = g->left_ns = INT64_MIN / 2; /* all of its time is over */
		lose_outputs(e, seat, awake_ns);
		return;
	}
	lose_outputs(e, seat, awake_ns); /* what has SafeDelay 0 */
	e->controllers[to] = *g;
	e->controllers[to].rows = 0;
	e->controllers[to].as.memory = (struct controller_memory){0};
	e->controllers[to].as.rights = NULL;
	engine_remember_controller(e, to);
	engine_hand_over(e, seat, to);
	if (!e->controllers[to].rows)
		controllers_forget(e, to);
}

void engine_controller_left(struct engine *e, unsigned seat, int64_t now_ns)
{
	struct known_controller *g = &e->controllers[seat];

	assert(seat < OWS_CONTROLLERS);
	if (g->is != CONTROLLER_CONNECTED)
		return;
	engine_begin_call(e, now_ns);
	e->controllers_quiet = false;
	engine_intake(e, seat);
	engine_hear(e, seat);
	if (g->more)
		e->greedy--;
	if (g->period_ms && g->rows)
		begin_absence(e, seat, engine_awake_ns(e));
	else
		engine_hand_over(e, seat, CONTROLLER_NOBODY);
	controllers_forget(e, seat);
	while (e->seat_end && e->controllers[e->seat_end - 1].is != CONTROLLER_CONNECTED)
		e->seat_end--;
	show_controller(e, seat);
	e->published = true;
}

bool engine_controllers_marked(const struct engine *e)
{
	for (uint32_t i = 0; i < e->seat_end; i++) {
		const struct known_controller *g = &e->controllers[i];

		if (g->is == CONTROLLER_CONNECTED && !g->more &&
		    controller_is_marked(&g->as.memory))
			return true;
	}
	return false;
}

/* --- A reload --------------------------------------------------------------------------------- */

void engine_controllers_retire(struct engine *old, const struct engine *e, int64_t now_ns)
{
	for (uint32_t i = 0; i < OWS_CONTROLLERS; i++) {
		struct known_controller *g = &old->controllers[i];

		if (g->is != CONTROLLER_CONNECTED)
			continue;
		controller_state(&g->as.memory, OWS_STATE_RETIRED);
		if (e->controllers[i].is == CONTROLLER_CONNECTED)
			engine_intake(old, i);
		else
			engine_controller_left(old, i, now_ns);
	}
}

void engine_controllers_adopt(struct engine *e, const struct engine *old, const uint32_t *rows)
{
	for (uint32_t i = 0; i < ENGINE_CONTROLLERS; i++) {
		const struct known_controller *was = &old->controllers[i];
		struct known_controller *g = &e->controllers[i];
		struct joining_controller as = g->as;

		if (was->is == CONTROLLER_FREE)
			continue;
		if (was->is == CONTROLLER_CONNECTED)
			controller_copy(&as.memory, &was->as.memory, rows);
		else
			as = was->as;
		*g = *was;
		g->as = as;
		g->rows = g->busy = g->look_from = 0;
		g->lose_ns = 0;
		g->more = false;
		if (g->is != CONTROLLER_CONNECTED)
			continue;
		g->may_set = may_set(&as);
		show_controller(e, i);
	}
}
