/* SPDX-License-Identifier: MIT */
/* The journal of commands. */
#include <errno.h>
#include <string.h>

#include "src/ground/signal/value.h"
#include "src/memory/libows/actor.h"
#include "src/memory/libows/journal.h"
#include "src/memory/shm/reader.h"

int journal_read(struct ows *h, enum ows_area area, uint32_t head, uint32_t number,
                 struct ows_journal_entry *e)
{
	uint32_t kept = map_count(&h->map, area);

	if (head - 1 - number >= kept)
		return -ENOENT;
	if (!reader_entry(map_entry(&h->map, area, number % kept), e, sizeof(*e)))
		return -EAGAIN;
	return e->number == number && e->record && e->record < h->map.count ? 0 : -ENOENT;
}

uint32_t ows_command_count(struct ows *h)
{
	return __atomic_load_n(&h->map.image->command_head, __ATOMIC_ACQUIRE);
}

int ows_command_entry(struct ows *h, uint32_t number, struct ows_commanded *commanded)
{
	struct ows_journal_entry e;
	int err = journal_read(h, OWS_AREA_COMMANDS, ows_command_count(h), number, &e);

	if (err)
		return err;
	*commanded = (struct ows_commanded){
		.signal = (int)e.record - 1,
		.taken_ns = e.occurred_ns,
		.more = e.more,
		.type = map_record(&h->map, e.record)->type,
		.reason = e.kind,
		.quality = e.quality,
		.who = actor_of(&e.who),
	};
	if (commanded->type == OWS_STRING) {
		memcpy(commanded->text, e.text, sizeof(commanded->text) - 1);
		return 0;
	}
	commanded->number = value_number((enum ows_type)commanded->type, e.after);
	if (!value_is_float((enum ows_type)commanded->type))
		commanded->integer = e.after;
	return 0;
}

const char *ows_reason_text(uint8_t reason)
{
	static const char *const texts[] = {
		[OWS_REASON_NONE] = "none",         [OWS_REASON_SET] = "set",
		[OWS_REASON_RETURNED] = "returned", [OWS_REASON_INIT] = "InitValue",
		[OWS_REASON_SAFE] = "SafeValue",    [OWS_REASON_LAST] = "last",
	};

	return reason < sizeof(texts) / sizeof(texts[0]) ? texts[reason] : "unknown";
}
