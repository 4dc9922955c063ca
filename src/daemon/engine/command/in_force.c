/* SPDX-License-Identifier: MIT */
/*
 * Which command is in force: by a controller, or by owsd itself, which puts InitValue, SafeValue
 * and what was stored last (section 3 of docs/semantics.md, "A command is in force").
 */
#include <errno.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/daemon/engine/command/in_force.h"
#include "src/daemon/engine/command/last.h"
#include "src/daemon/engine/command/origin.h"
#include "src/daemon/engine/publish.h"
#include "src/daemon/engine/scaling.h"
#include "src/daemon/engine/schedule.h"
#include "src/public/ows.h"

/* A program that lives needs a cycle or two to learn that there is another owsd. */
#define COME_BACK_NS (2 * NS_PER_S)

static const struct ows_who owsd_itself;

/* --- What the next owsd has to know ----------------------------------------------------------- */

void engine_remember_controller(struct engine *e, uint32_t controller)
{
	const struct known_controller *g = &e->controllers[controller];
	struct force_controller entry = {0};

	if (!e->force)
		return;
	if (g->is != CONTROLLER_FREE) {
		entry.who = g->as.who;
		memcpy(entry.token, g->as.token, sizeof(entry.token));
		entry.period_ms = g->period_ms;
	}
	force_controller(e->force, controller, &entry);
}

static void remember_command(struct engine *e, const struct signal *s)
{
	const struct signal_command *c = &s->command;
	/* the next owsd writes InitValue anew */
	bool given = c->given && c->reason != OWS_REASON_INIT;
	const struct force_command entry = {
		.value = c->value,
		.len = c->len,
		.stamp = c->stamp,
		.given = given,
		.safe = c->reason == OWS_REASON_SAFE,
		.applied = c->said,
		.controller = given ? c->controller : FORCE_NOBODY,
	};

	if (e->force)
		force_put(e->force, engine_row(s), &entry,
		          signal_is_string(s) ? s->command_text : NULL);
}

static void answer_for(struct engine *e, struct signal *s, uint32_t controller)
{
	if (s->command.controller != CONTROLLER_NOBODY)
		e->controllers[s->command.controller].rows--;
	s->command.controller = controller;
	if (controller == CONTROLLER_NOBODY)
		return;
	e->controllers[controller].rows++;
	e->controllers[controller].lose_ns = 0; /* the time of this row may be over first */
}

/* --- A new command ---------------------------------------------------------------------------- */

static void in_force_put_value(struct signal *s, int64_t value, const char *text, uint32_t len)
{
	s->command.given = true;
	s->command.awaited = s->command.said = false;
	s->command.confirmed &= !s->command.lapsed;
	s->command.lapsed = false;
	if (!signal_is_string(s)) {
		s->command.value = value;
		return;
	}
	if (len > TABLE_TEXT_CAP)
		len = TABLE_TEXT_CAP;
	memmove(s->command_text, text, len);
	s->command.len = len;
}

static void store_last(struct engine *e, struct signal *s)
{
	e->storing -= s->command.storing;
	s->command.storing = false;
	s->command.ticket = 0;
	if (s->item->starts_last && e->last && s->command.reason != OWS_REASON_INIT)
		s->command.ticket = e->last->put(e->last->ctx, engine_row(s), s->command.value,
		                                 signal_is_string(s) ? s->command_text : NULL,
		                                 s->command.len);
}

struct ows_who engine_who(const struct known_controller *g, uint32_t person)
{
	struct ows_who who = g->as.who;

	if (person)
		controller_person(&g->as.memory, person, who.person);
	return who;
}

void engine_command(struct engine *e, struct signal *s, uint32_t controller,
                    const struct controller_command *command, const char *text, uint32_t len)
{
	struct origin_before before = origin_before(s, command->value, text, len);
	struct ows_who who = engine_who(&e->controllers[controller], command->person);

	in_force_put_value(s, command->value, text, len);
	s->command.stamp = command->stamp;
	s->command.reason = OWS_REASON_SET;
	answer_for(e, s, controller);
	engine_origin(e, s, OWS_REASON_SET, &who, &before);
	store_last(e, s);
	remember_command(e, s);
}

void engine_hear(struct engine *e, uint32_t seat)
{
	struct known_controller *g = &e->controllers[seat];
	struct controller_beat beat;
	bool changes;

	controller_beat(&g->as.memory, &beat);
	if (beat.goodbye)
		beat.period_ms = 0;
	else if (beat.beat == g->beat)
		beat.period_ms = g->period_ms;
	changes = beat.period_ms != g->period_ms;
	if (changes || beat.beat != g->beat) {
		g->heard_ns = engine_awake_ns(e);
		g->lose_ns = 0;
	}
	g->beat = beat.beat;
	g->period_ms = beat.period_ms;
	if (changes)
		engine_remember_controller(e, seat);
}

/* A command of owsd itself. who: the lost controller that is the reason, else owsd. */
static void put_own(struct engine *e, struct signal *s, enum ows_reason reason,
                    const struct ows_who *who, int64_t value, const char *text, uint32_t len)
{
	struct origin_before before = origin_before(s, value, text, len);
	struct ows_who because = *who; /* the controller that it is of may be forgotten below */

	in_force_put_value(s, value, text, len);
	s->command.stamp = 0;
	s->command.reason = reason;
	answer_for(e, s, CONTROLLER_NOBODY);
	engine_origin(e, s, reason, &because, &before);
	e->counters.safe_outputs += reason == OWS_REASON_SAFE;
	store_last(e, s); /* the owsd before may have been killed before it had stored it */
}

static void put_safe(struct engine *e, struct signal *s, const struct ows_who *who)
{
	put_own(e, s, OWS_REASON_SAFE, who, s->item->safe_value, s->item->safe_text,
	        (uint32_t)strlen(s->item->safe_text));
}

static void put_nothing(struct engine *e, struct signal *s)
{
	struct origin_before before = {0};

	s->command.given = s->command.awaited = s->command.said = false;
	s->command.stamp = 0;
	s->command.reason = OWS_REASON_NONE;
	answer_for(e, s, CONTROLLER_NOBODY);
	engine_origin(e, s, OWS_REASON_NONE, &owsd_itself, &before);
}

/* No command comes back: what the file says. left: the command that was in force; NULL: none. */
static void put_configured(struct engine *e, struct signal *s, const struct force_command *left,
                           const char *left_text)
{
	const struct config_item *item = s->item;
	char text[TABLE_TEXT_CAP];
	int64_t value;
	uint32_t len;

	if (item->starts_last && left && left->given)
		put_own(e, s, OWS_REASON_LAST, &owsd_itself, left->value, left_text, left->len);
	else if (item->starts_last && e->last &&
	         e->last->find(e->last->ctx, engine_row(s), &value, text, sizeof(text), &len) &&
	         (signal_is_string(s) || signal_accepts(s, value)))
		put_own(e, s, OWS_REASON_LAST, &owsd_itself, value, text, len);
	else if (item->output && item->has_init)
		put_own(e, s, OWS_REASON_INIT, &owsd_itself, item->init_value, item->init_text,
		        (uint32_t)strlen(item->init_text));
	else
		put_nothing(e, s);
}

/* --- A start ---------------------------------------------------------------------------------- */

/*
 * The index at which a controller of before is awaited; CONTROLLER_NOBODY: it promised no beat, or
 * ended in order, or there is no room.
 */
static uint32_t in_force_await(struct engine *e, const struct force_left *left, uint32_t index)
{
	struct force_controller was;
	uint32_t at = CONTROLLER_NOBODY;

	if (!force_find_controller(left, index, &was) || !was.period_ms || was.goodbye)
		return CONTROLLER_NOBODY;
	for (uint32_t i = OWS_CONTROLLERS; i < ENGINE_CONTROLLERS; i++) {
		const struct known_controller *g = &e->controllers[i];

		if (g->is == CONTROLLER_FREE && at == CONTROLLER_NOBODY)
			at = i;
		if (g->is == CONTROLLER_AWAITED && g->as.who.serial == was.who.serial &&
		    memcmp(g->as.token, was.token, sizeof(was.token)) == 0)
			return i;
	}
	if (at == CONTROLLER_NOBODY)
		return at;
	e->controllers[at] = (struct known_controller){
		.is = CONTROLLER_AWAITED,
		.as.who = was.who,
		.period_ms = was.period_ms,
		.heard_ns = engine_awake_ns(e),
		.joined_ns = e->time.now_ns,
	};
	memcpy(e->controllers[at].as.token, was.token, sizeof(was.token));
	engine_remember_controller(e, at);
	return at;
}

static struct force_signal force_key(const struct signal *s)
{
	return (struct force_signal){s->item->name, s->item->path, (uint8_t)s->item->type};
}

static void resume_signal(struct engine *e, struct signal *s, const struct force_left *left,
                          uint32_t *awaited)
{
	const struct force_signal key = force_key(s);
	char text[TABLE_TEXT_CAP];
	struct force_command was = {0};
	uint32_t controller = CONTROLLER_NOBODY;
	bool found = left && config_item_takes_sets(s->item) &&
	             force_find(left, &key, &was, text, sizeof(text)) && was.given &&
	             (signal_is_string(s) || signal_accepts(s, was.value));

	if (found && !was.safe && was.controller < FORCE_CONTROLLERS) {
		if (!awaited[was.controller])
			awaited[was.controller] = in_force_await(e, left, was.controller) + 1;
		controller = awaited[was.controller] - 1;
	}
	if (found && was.safe && s->item->has_safe && signal_repeats(s)) {
		put_safe(e, s, &owsd_itself);
	} else if (controller != CONTROLLER_NOBODY) {
		in_force_put_value(s, was.value, text, was.len);
		s->command.awaited = true;
		s->command.said = was.applied && !signal_repeats(s);
		s->command.stamp = was.stamp;
		s->command.reason = OWS_REASON_SET;
		answer_for(e, s, controller);
	} else {
		put_configured(e, s, found ? &was : NULL, text);
	}
	remember_command(e, s);
	engine_write_check(e, s);
}

void engine_resume(struct engine *e, const struct force_left *left)
{
	/* where each controller of before is awaited, + 1 */
	uint32_t awaited[FORCE_CONTROLLERS] = {0};

	for (struct signal *s = e->table.signals; left && s < table_end(&e->table); s++) {
		const struct force_signal key = force_key(s);

		force_keep(left, &key);
	}
	for (struct signal *s = e->table.signals; s < table_end(&e->table); s++)
		resume_signal(e, s, left, awaited);
}

/* --- A controller is lost, or comes back ------------------------------------------------------ */

/* Until then the commands of this controller's output stay, though it is not heard. */
static int64_t patience_end(const struct known_controller *g, const struct config_item *item)
{
	int64_t promised_ns = g->period_ms * NS_PER_MS;
	int64_t delay_ns = item->has_safe_delay ? item->safe_delay_ns : -1;

	switch (g->is) {
	case CONTROLLER_AWAITED:
		return g->heard_ns + (promised_ns < COME_BACK_NS ? COME_BACK_NS : promised_ns);
	case CONTROLLER_HUNG_UP:
		if (delay_ns >= 0)
			return g->left_ns + delay_ns - 1;
		return g->heard_ns + promised_ns;
	case CONTROLLER_CONNECTED:
	case CONTROLLER_FREE:
		break;
	}
	return g->heard_ns + (delay_ns > promised_ns ? delay_ns : promised_ns);
}

static void give_up(struct engine *e, struct signal *s, const struct ows_who *who)
{
	const struct force_command left = {
		.given = true, .value = s->command.value, .len = s->command.len};

	if (s->item->has_safe)
		put_safe(e, s, who);
	else if (s->command.awaited)
		put_configured(e, s, &left, s->command_text);
	else
		answer_for(e, s, CONTROLLER_NOBODY);
	remember_command(e, s);
	engine_write_check(e, s);
	engine_publish(e, s);
}

unsigned engine_lose(struct engine *e, uint32_t controller, int64_t awake_ns, int64_t *next)
{
	const struct known_controller *g = &e->controllers[controller];
	unsigned safe = 0;

	*next = INT64_MAX;
	for (struct signal *s = e->table.signals; s < table_end(&e->table) && g->rows; s++) {
		int64_t end_ns;

		if (s->command.controller != controller)
			continue;
		end_ns = patience_end(g, s->item);
		if (awake_ns > end_ns) {
			safe += s->item->has_safe;
			give_up(e, s, &g->as.who);
		} else if (end_ns < *next) {
			*next = end_ns;
		}
	}
	return safe;
}

void engine_hand_over(struct engine *e, uint32_t from, uint32_t to)
{
	const struct known_controller *g = &e->controllers[from];

	for (struct signal *s = e->table.signals; s < table_end(&e->table) && g->rows; s++) {
		if (s->command.controller != from)
			continue;
		answer_for(e, s, to);
		remember_command(e, s);
	}
}

/*
 * A set of an input of before the start was an event: owsd does not write it again, nor late. What
 * the bus had not confirmed is refused: whether the device has it is not known.
 */
static int end_event(struct signal *s)
{
	struct signal_command *c = &s->command;

	c->confirmed = c->lapsed = true;
	c->written = c->value;
	c->written_len = c->len;
	if (signal_is_string(s))
		memcpy(s->written_text, s->command_text, c->len);
	return c->said ? 0 : -ESTALE;
}

void engine_come_back(struct engine *e, uint32_t to)
{
	struct known_controller *g = &e->controllers[to];
	struct origin_before before = {.given = true, .changes = true};

	for (struct signal *s = e->table.signals; s < table_end(&e->table); s++) {
		int err;

		if (s->command.controller != to)
			continue;
		err = s->command.awaited && !signal_repeats(s) ? end_event(s) : 0;
		controller_taken(&g->as.memory, s->record, s->command.stamp, err);
		if (err) {
			engine_refuse(e, g, s, err);
			s->command.stamp = 0; /* nor does the next owsd say that it is applied */
			s->command.said = true;
		} else if (s->command.said) {
			controller_applied(&g->as.memory, s->record, s->command.stamp);
		}
		before.value = s->command.value;
		s->command.reason = OWS_REASON_RETURNED;
		engine_origin(e, s, OWS_REASON_RETURNED, &g->as.who, &before);
		if (s->command.awaited)
			store_last(e, s);
		s->command.awaited = false;
		remember_command(e, s);
		engine_settle(e, s);
		engine_write_check(e, s);
		engine_publish(e, s);
	}
}

/* --- Confirmed -------------------------------------------------------------------------------- */

static void say_applied(struct engine *e, struct signal *s, uint32_t controller, uint32_t serial,
                        uint32_t stamp)
{
	const struct known_controller *g;

	s->sample.confirmed++;
	if (!stamp || controller >= OWS_CONTROLLERS)
		return;
	g = &e->controllers[controller];
	if (g->is == CONTROLLER_CONNECTED && g->as.who.serial == serial)
		controller_applied(&g->as.memory, s->record, stamp);
}

void engine_settle(struct engine *e, struct signal *s)
{
	struct signal_command *c = &s->command;

	if (c->said || !signal_settled(s))
		return;
	if (c->ticket && (int32_t)(e->last->stored(e->last->ctx) - c->ticket) < 0) {
		e->storing += !c->storing;
		c->storing = true;
		return;
	}
	e->storing -= c->storing;
	c->storing = false;
	c->said = true;
	if (!signal_repeats(s)) /* the next owsd has to know */
		remember_command(e, s);
	say_applied(e, s, c->controller,
	            c->controller < OWS_CONTROLLERS ? e->controllers[c->controller].as.who.serial
	                                            : 0,
	            c->stamp);
}

void engine_settle_earlier(struct engine *e, struct signal *s, const struct slot *slot)
{
	/* what stands on the disk in the end is the later one */
	if (slot->stamp && slot->stamp != s->command.stamp && !s->item->starts_last)
		say_applied(e, s, slot->controller, slot->serial, slot->stamp);
}

void engine_look_stored(struct engine *e)
{
	uint32_t stored;
	int err;

	if (!e->storing)
		return;
	stored = e->last->stored(e->last->ctx);
	err = e->last->error(e->last->ctx);
	if (stored == e->stored && err == e->store_err)
		return;
	e->stored = stored;
	e->store_err = err;
	for (struct signal *s = e->table.signals; s < table_end(&e->table); s++) {
		if (!s->command.storing)
			continue;
		engine_settle(e, s);
		engine_publish(e, s);
	}
}

/* --- A reload --------------------------------------------------------------------------------- */

void engine_in_force_adopted(struct engine *e)
{
	for (uint32_t i = 0; i < ENGINE_CONTROLLERS; i++)
		engine_remember_controller(e, i);
	e->storing = 0;
	for (struct signal *s = e->table.signals; s < table_end(&e->table); s++) {
		if (s->command.controller != CONTROLLER_NOBODY)
			e->controllers[s->command.controller].rows++;
		s->command.storing = false;
		if (s->command.given && !s->command.awaited)
			store_last(e, s);
		engine_settle(e, s);
		remember_command(e, s);
	}
}
