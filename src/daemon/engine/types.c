/* SPDX-License-Identifier: MIT */
/*
 * The check of types on a lane: it asks /structure of its target about the properties of its
 * signals, and reports each signal whose type cannot hold its property.
 */
#include <string.h>

#include "src/daemon/engine/publish.h"
#include "src/daemon/engine/retry.h"
#include "src/daemon/engine/slots.h"
#include "src/daemon/engine/structure.h"
#include "src/daemon/engine/types.h"
#include "src/ground/text/log.h"

int64_t types_next(struct lane *lane)
{
	const struct structure *st = &lane->engine->structure;
	int64_t next;

	while ((next = due_set_next(&lane->checks)) >= 0) {
		const struct structure_check *check = &st->checks[next];

		for (uint32_t i = 0; i < check->count; i++)
			if (lane->engine->table.signals[st->rows[check->first + i]].lane ==
			    lane->index)
				return next;
		due_set_take(&lane->checks, (uint32_t)next);
	}
	return -1;
}

bool types_ask(struct lane *lane, struct slot *slot, uint32_t check)
{
	slot->purpose = FOR_STRUCTURE;
	slot->row = check;
	slot->req = (struct bus_req){.op = BUS_READ,
	                             .prio = BUS_INPUT,
	                             .path = lane->engine->structure.checks[check].path,
	                             .len = sizeof(slot->data)};
	if (!slot_lend(lane, slot))
		return false;
	due_set_take(&lane->checks, check);
	return true;
}

void types_done(struct lane *lane, const struct slot *slot, const struct bus_answer *answer)
{
	struct engine *e = lane->engine;
	const struct structure_check *check = &e->structure.checks[slot->row];
	struct structure_entry entry;

	if (failure_of(answer->err) == FAILURE_TARGET) {
		due_set_add(&lane->checks, slot->row);
		return;
	}
	if (answer->err || structure_parse((const char *)slot->data, answer->len, &entry))
		return;
	for (uint32_t i = 0; i < check->count; i++) {
		struct signal *s = &e->table.signals[e->structure.rows[check->first + i]];
		const char *fault;
		int err = structure_fault(&entry, s->item, &fault);

		if (s->lane != lane->index)
			continue;
		s->scaling.whole = strchr("yiu", entry.type) != NULL;
		if (!err)
			continue;
		s->sample.quality = failure_quality(err);
		s->sample.err = err;
		log_err(e->log, "%s (line %d): %s does not fit: %s", s->item->name, s->item->line,
		        s->item->path, fault);
		engine_publish(e, s);
	}
}
