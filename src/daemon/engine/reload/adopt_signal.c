/* SPDX-License-Identifier: MIT */
/* A reload copies a signal here: the structures that it carries over are assigned whole. */
#include <string.h>

#include "src/config/read/config.h"
#include "src/daemon/engine/reload/adopt_signal.h"
#include "src/daemon/engine/scaling.h"

/* What a program has set stays, unless the file says something else than before. */
static uint32_t flag_of(const struct signal *s, const struct signal *was, uint32_t flag,
                        bool configured, bool before)
{
	return configured == before ? was->attrs.flags & flag : s->attrs.flags & flag;
}

static uint32_t flags_of(const struct signal *s, const struct signal *was)
{
	const uint32_t anew = OWS_ATTR_READ_ENABLE | OWS_ATTR_WRITE_ENABLE | OWS_ATTR_LIMITS |
	                      OWS_ATTR_IN_WORK | OWS_ATTR_ALARM_POLLED | OWS_ATTR_ALARM_UNARMED |
	                      OWS_ATTR_ALARM_WHY;
	const struct config_item *item = s->item, *before = was->item;
	uint32_t flags = was->attrs.flags & ~anew & ~(item->alarm ? 0u : OWS_ATTR_ALARM_STANDS);

	flags |= flag_of(s, was, OWS_ATTR_READ_ENABLE, item->readable, before->readable);
	if (config_item_takes_sets(item))
		flags |= flag_of(s, was, OWS_ATTR_WRITE_ENABLE, item->writable, before->writable);
	return flags | (s->attrs.flags & OWS_ATTR_LIMITS);
}

static void adopt_text(char *to, const char *from)
{
	if (to)
		memcpy(to, from, TABLE_TEXT_CAP);
}

bool signal_adopt(struct signal *s, const struct signal *was)
{
	const struct config_item *item = s->item, *before = was->item;
	uint32_t flags = flags_of(s, was);
	bool commanded = was->command.reason != OWS_REASON_NONE &&
	                 was->command.reason != OWS_REASON_INIT;
	bool goes_on = item->output == before->output || commanded;

	s->sample = was->sample;
	s->attrs = was->attrs;
	s->attrs.flags = flags;
	s->read = was->read;
	s->journal = was->journal;
	adopt_text(s->text, was->text);
	if (signal_reads(was) && !signal_reads(s) && !before->output) {
		s->sample.quality = OWS_Q_DISABLED;
		s->read.held = false;
	}
	if (goes_on) {
		s->command = was->command;
		adopt_text(s->command_text, was->command_text);
		adopt_text(s->written_text, was->written_text);
	}
	if (s->command.differs && before->read_back_ns && !item->read_back_ns) {
		s->command.differs = s->command.doubted = false;
		s->sample.quality = OWS_Q_LAST_USABLE;
	}
	s->restore = was->restore;
	s->scaling = was->scaling;
	if (item->type != OWS_STRING)
		signal_rescale(s, was);
	if (item->limits.any && before->limits.any) {
		s->limit = was->limit;
	} else if (!item->limits.any) {
		s->attrs.limit_state = 0;
		s->attrs.limit_condition = 0;
		s->attrs.shelved = 0;
	}
	return goes_on;
}
