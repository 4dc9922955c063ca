/* SPDX-License-Identifier: MIT */
/* A controller by hand: what it stores in its memory. */
#include <stdlib.h>
#include <string.h>

#include "tests/unit/aid/giving.h"

#define TEXT_CAP 1024

void giving_layout(struct controller_layout *layout, const uint8_t *types, uint32_t count)
{
	const struct controller_plan plan = {.types = types,
	                                     .signal_count = count,
	                                     .text_cap = TEXT_CAP,
	                                     .generation = 1,
	                                     .start_id = 7};

	if (controller_layout_make(layout, &plan))
		abort();
}

void giving_make(struct giving *g, const struct controller_layout *layout, uint32_t serial)
{
	size_t room = ((size_t)layout->header.size + 63) / 64 * 64;

	g->memory = (struct controller_memory){aligned_alloc(64, room), layout};
	if (!g->memory.base)
		abort();
	memset(g->memory.base, 0, room);
	controller_build(&g->memory, serial);
	for (uint32_t i = 0; i < layout->header.slot_count; i++)
		controller_allow(&g->memory, i, true);
	controller_state(&g->memory, OWS_STATE_LIVE);
}

void giving_free(struct giving *g)
{
	free(g->memory.base);
	g->memory.base = NULL;
}

struct ows_controller_header *giving_header(struct giving *g)
{
	return (void *)g->memory.base;
}

struct ows_command_slot *giving_slot(struct giving *g, uint32_t record)
{
	return (struct ows_command_slot *)(void *)(g->memory.base +
	                                           g->memory.layout->header.slot_off) +
	       record;
}

struct ows_command_text *giving_text(struct giving *g, uint32_t record)
{
	const struct controller_layout *l = g->memory.layout;

	return (void *)(g->memory.base + l->header.text_off +
	                (size_t)l->places[record] *
	                        (sizeof(struct ows_command_text) + l->header.text_cap));
}

struct ows_command_shelf *giving_shelf(struct giving *g)
{
	return (void *)(g->memory.base + g->memory.layout->header.shelf_off);
}

void giving_mark(struct giving *g, uint32_t record)
{
	uint32_t *dirty = (void *)(g->memory.base + g->memory.layout->header.dirty_off);

	dirty[record / 32] |= 1u << record % 32;
	giving_header(g)->marked = 1;
}

void giving_set(struct giving *g, uint32_t record, int64_t value)
{
	giving_slot(g, record)->value = (uint64_t)value;
	giving_slot(g, record)->stamp = ++g->stamp;
	giving_mark(g, record);
}

void giving_set_text(struct giving *g, uint32_t record, const char *text)
{
	struct ows_command_text *t = giving_text(g, record);

	t->len = (uint32_t)strlen(text);
	memcpy(t + 1, text, t->len);
	t->check = ows_check_bytes((const char *)(t + 1), t->len);
	giving_slot(g, record)->stamp = ++g->stamp;
	giving_mark(g, record);
}

void giving_enable(uint32_t *word, bool on)
{
	*word = ((*word >> 2) + 1) << 2 | (on ? 2 : 1);
}

void giving_name_person(struct giving *g, unsigned index, const char *name)
{
	strncpy(g->memory.base + g->memory.layout->header.person_off + index * OWS_NAME, name,
	        OWS_NAME);
}

void giving_beat(struct giving *g, uint32_t period_ms)
{
	giving_header(g)->period_ms = period_ms;
	giving_header(g)->beat++;
}
