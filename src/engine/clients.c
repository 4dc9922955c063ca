/* SPDX-License-Identifier: MIT */
/*
 * Whose commands are in force: the heartbeats of control programs, and what becomes of the commands
 * that the owsd before has left (section 3 of docs/semantics.md, "A command is in force").
 */
#include <string.h>

#include "hal/bus/time.h"
#include "src/engine/clients.h"
#include "src/engine/intake.h"
#include "src/engine/publish.h"
#include "src/engine/schedule.h"
#include "src/engine/state.h"
#include "src/text/log.h"

/* A program that lives needs a cycle or two to learn that there is another owsd. */
#define COME_BACK_NS (2 * NS_PER_S)

static void put_safe(struct engine *e, struct signal *s)
{
	s->command.safe = true;
	s->command.given = true;
	s->command.value = s->item->safe_value;
	if (signal_is_string(s)) {
		size_t len = strlen(s->item->safe_text);

		if (len > TABLE_TEXT_CAP)
			len = TABLE_TEXT_CAP;
		memcpy(s->command_text, s->item->safe_text, len);
		s->command.len = (uint32_t)len;
	}
	commands_put_safe(e->commands, s->record, s->command.value,
	                  signal_is_string(s) ? s->command_text : NULL, s->command.len);
	e->counters.safe_outputs++;
}

static void resume_command(struct engine *e, struct signal *s, const struct command *c,
                           int64_t now_ns)
{
	struct command_client client = {0};

	/* it is not taken unless it is set once more, or its giver beats */
	s->seen.stamp = c->stamp;
	if (!c->stamp)
		return;
	if (c->safe && s->item->has_safe)
		put_safe(e, s);
	if (!c->client)
		return;
	commands_client(e->commands, c->client - 1, &client);
	if (!client.pid)
		return;
	s->seen.client = c->client;
	s->seen.awaited = true;
	e->clients[c->client - 1] = (struct client){true, true, client.pid, client.beat, now_ns};
}

void engine_resume(struct engine *e, int64_t now_ns)
{
	struct command c;

	commands_load(e->commands, 0, &c);
	e->driver.resets = c.dgn_reset;
	for (uint32_t row = 0; row < e->table.count; row++) {
		struct signal *s = &e->table.signals[row];

		commands_load(e->commands, s->record, &c);
		s->seen.one_shots = c.one_shot;
		s->seen.dgn_resets = c.dgn_reset;
		s->seen.acknowledged = c.acknowledged;
		resume_command(e, s, &c, now_ns);
		engine_intake_signal(e, s, now_ns);
	}
}

void engine_give_up(struct engine *e, struct signal *s)
{
	s->seen.client = 0;
	s->seen.awaited = false;
	if (s->item->has_safe)
		put_safe(e, s);
	engine_write_check(e, s);
	engine_publish(e, s);
}

/* A program that ends in order takes its place off its commands. */
static bool is_signed_off(const struct engine *e, const struct signal *s)
{
	struct command c;

	commands_load(e->commands, s->record, &c);
	return c.client != s->seen.client;
}

/*
 * It ended in order: its outputs stay as they are, whoever comes to sit in its place. What it
 * commanded before owsd's start is not repeated. Not all: another program sits there already, and
 * may have set some.
 */
static void forget_client(struct engine *e, unsigned client, bool all)
{
	for (uint32_t row = 0; row < e->table.count; row++) {
		struct signal *s = &e->table.signals[row];

		if (s->seen.client != client + 1 ||
		    !(all || s->seen.awaited || is_signed_off(e, s)))
			continue;
		s->seen.client = 0;
		if (!s->seen.awaited)
			continue;
		s->seen.awaited = false;
		engine_write_check(e, s);
		engine_publish(e, s);
	}
	e->clients[client] = (struct client){0};
}

/* It beats for the first time since owsd's start: it lives, and its commands are in force. */
static void welcome_client(struct engine *e, unsigned client, int64_t now_ns)
{
	unsigned kept = 0;

	for (uint32_t row = 0; row < e->table.count; row++) {
		struct signal *s = &e->table.signals[row];

		if (s->seen.client != client + 1 || !s->seen.awaited)
			continue;
		s->seen.stamp = 0;
		engine_intake_signal(e, s, now_ns);
		engine_publish(e, s);
		kept++;
	}
	log_info(e->log, "control program %u beats again: its commands of %u outputs stay in force",
	         (unsigned)e->clients[client].pid, kept);
}

static void lose_client(struct engine *e, unsigned client)
{
	const struct client *known = &e->clients[client];
	unsigned safe = 0;

	for (uint32_t row = 0; row < e->table.count; row++) {
		struct signal *s = &e->table.signals[row];

		if (s->seen.client != client + 1)
			continue;
		safe += s->item->has_safe;
		if (s->item->has_safe || s->seen.awaited)
			engine_give_up(e, s);
		s->seen.client = 0;
	}
	e->counters.lost_clients++;
	log_warning(e->log, "control program %u %s: %u output%s to SafeValue", (unsigned)known->pid,
	            known->awaited
	                    ? "has not beaten since owsd started, and its commands are dropped"
	                    : "stopped beating",
	            safe, safe == 1 ? " goes" : "s go");
	e->clients[client] = (struct client){0};
	commands_drop_client(e->commands, client);
}

static int64_t client_patience(const struct client *known, const struct command_client *c)
{
	int64_t promised_ns = (c->period_ms ? c->period_ms : 1000) * NS_PER_MS;

	return known->awaited && promised_ns < COME_BACK_NS ? COME_BACK_NS : promised_ns;
}

void engine_clients(struct engine *e, int64_t now_ns)
{
	for (unsigned i = 0; i < OWS_CLIENTS; i++) {
		struct client *known = &e->clients[i];
		struct command_client c;

		commands_client(e->commands, i, &c);
		if (!c.pid) {
			if (known->known)
				forget_client(e, i, true);
			continue;
		}
		if (known->known && known->pid != c.pid)
			forget_client(e, i, false);
		if (!known->known || known->pid != c.pid || known->beat != c.beat) {
			if (known->awaited)
				welcome_client(e, i, now_ns);
			*known = (struct client){true, false, c.pid, c.beat, now_ns};
			continue;
		}
		if (now_ns - known->heard_ns > client_patience(known, &c))
			lose_client(e, i);
	}
}
