/* SPDX-License-Identifier: MIT */
/* A controller by hand: a memory on the heap, in which a test commands as libows does, or worse. */
#pragma once

#include "src/memory/shm/controller.h"

struct giving {
	struct controller_memory memory; /* base NULL: not made */
	uint32_t stamp;                  /* of the last command */
};

/* The layout of a configuration of that many signals. */
void giving_layout(struct controller_layout *layout, const uint8_t *types, uint32_t count);
/* Make a memory that is live. The stamps go on from before. */
void giving_make(struct giving *g, const struct controller_layout *layout, uint32_t serial);
void giving_free(struct giving *g);

struct ows_controller_header *giving_header(struct giving *g);
struct ows_command_slot *giving_slot(struct giving *g, uint32_t record);
struct ows_command_text *giving_text(struct giving *g, uint32_t record);
struct ows_command_shelf *giving_shelf(struct giving *g);
void giving_mark(struct giving *g, uint32_t record);
void giving_set(struct giving *g, uint32_t record, int64_t value);
void giving_set_text(struct giving *g, uint32_t record, const char *text);
/* Switch _ReadEnable or _WriteEnable: word is a member of a slot. The slot has to be marked. */
void giving_enable(uint32_t *word, bool on);
void giving_name_person(struct giving *g, unsigned index, const char *name);
void giving_beat(struct giving *g, uint32_t period_ms);
