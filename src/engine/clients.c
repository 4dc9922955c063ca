/* SPDX-License-Identifier: MIT */
#include "private.h"

#include <string.h>

static void put_safe(struct engine *e, struct signal *s)
{
	s->safe = true;
	s->commanded = true;
	s->command = s->item->safe_value;
	if (signal_is_string(s)) {
		size_t len = strlen(s->item->safe_text);

		if (len > TABLE_TEXT_CAP)
			len = TABLE_TEXT_CAP;
		memcpy(s->command_text, s->item->safe_text, len);
		s->command_len = (uint32_t)len;
	}
	commands_put(e->commands, s->record, s->command,
	             signal_is_string(s) ? s->command_text : NULL, s->command_len);
	e->counters.safe_outputs++;
	engine_write_check(e, s);
	engine_publish(e, s);
}

/* It ended in order: its outputs stay as they are, whoever comes to sit in its place. */
static void forget(struct engine *e, unsigned client)
{
	for (uint32_t row = 0; row < e->table.count; row++)
		if (e->table.signals[row].client == client + 1)
			e->table.signals[row].client = 0;
	e->clients[client] = (struct client){ 0 };
}

static void lose(struct engine *e, unsigned client)
{
	unsigned safe = 0;

	for (uint32_t row = 0; row < e->table.count; row++) {
		struct signal *s = &e->table.signals[row];

		if (s->client != client + 1)
			continue;
		s->client = 0;
		if (s->item->has_safe) {
			put_safe(e, s);
			safe++;
		}
	}
	e->counters.lost_clients++;
	log_warning(e->log, "control program %u stopped beating: %u outputs go to SafeValue",
	            (unsigned)e->clients[client].pid, safe);
	e->clients[client] = (struct client){ 0 };
	commands_drop_client(e->commands, client);
}

void engine_clients(struct engine *e, int64_t now_ns)
{
	for (unsigned i = 0; i < OWS_CLIENTS; i++) {
		struct client *known = &e->clients[i];
		struct command_client c;

		commands_client(e->commands, i, &c);
		if (!c.pid) {
			if (known->known)
				forget(e, i);
			continue;
		}
		if (!known->known || known->pid != c.pid || known->beat != c.beat) {
			*known = (struct client){ true, c.pid, c.beat, now_ns };
			continue;
		}
		if (now_ns - known->heard_ns > (c.period_ms ? c.period_ms : 1000) * 1000000LL)
			lose(e, i);
	}
}
