/* SPDX-License-Identifier: MIT */
/* The controllers of a scene, and the disk of Start "last". */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/scene_private.h"

void scene_allow(struct scene *s, unsigned seat, unsigned record)
{
	s->limited = true;
	s->rights[seat][record / 32] |= 1u << record % 32;
}

void scene_join_again(struct scene *s, unsigned seat)
{
	struct joining_controller controller = {
		.who = {.serial = s->tokens[seat] ? s->tokens[seat] : 1000 + seat,
	                .uid = s->uid,
	                .pid = 100 + (int32_t)seat},
		.rights = s->limited ? s->rights[seat] : NULL,
	};

	snprintf(controller.who.name, sizeof(controller.who.name), "controller%u", seat);
	memcpy(controller.token, &s->tokens[seat], sizeof(s->tokens[seat]));
	giving_make(&s->controllers[seat], s->layout, controller.who.serial);
	controller.memory = s->controllers[seat].memory;
	engine_controller_join(s->engine, seat, &controller, s->now_ns);
}

void scene_join(struct scene *s, unsigned seat, uint32_t token)
{
	TEST_ASSERT_NULL(s->controllers[seat].memory.base);
	s->tokens[seat] = token;
	scene_join_again(s, seat);
}

void scene_leave(struct scene *s, unsigned seat)
{
	engine_controller_left(s->engine, seat, s->now_ns);
	giving_free(&s->controllers[seat]);
}

void scene_goodbye(struct scene *s, unsigned seat)
{
	giving_header(&s->controllers[seat])->goodbye = 1;
	scene_leave(s, seat);
}

struct ows_command_slot *scene_slot(struct scene *s, unsigned record)
{
	return giving_slot(&s->controllers[0], record);
}

void scene_ring(struct scene *s, unsigned record)
{
	giving_mark(&s->controllers[0], record);
}

void scene_set(struct scene *s, unsigned record, int64_t value)
{
	giving_set(&s->controllers[0], record, value);
}

void scene_set_by(struct scene *s, unsigned seat, unsigned record, int64_t value)
{
	giving_set(&s->controllers[seat], record, value);
}

void scene_set_text(struct scene *s, unsigned record, const char *text)
{
	giving_set_text(&s->controllers[0], record, text);
}

void scene_enable_reads(struct scene *s, unsigned record, bool on)
{
	giving_enable(&scene_slot(s, record)->read_enable, on);
	scene_ring(s, record);
}

void scene_enable_writes(struct scene *s, unsigned record, bool on)
{
	giving_enable(&scene_slot(s, record)->write_enable, on);
	scene_ring(s, record);
}

uint32_t scene_applied(struct scene *s, unsigned record)
{
	return scene_slot(s, record)->applied;
}

void scene_beat(struct scene *s, unsigned n, uint32_t period_ms, int64_t ns)
{
	for (int64_t t = 0; t < ns; t += 100 * SCENE_MS) {
		for (unsigned i = 0; i < n; i++)
			giving_beat(&s->controllers[i], period_ms);
		scene_run(s, 100 * SCENE_MS);
	}
}

/* --- The disk --------------------------------------------------------------------------------- */

static uint32_t put(void *ctx, uint32_t row, int64_t value, const char *text, uint32_t len)
{
	struct scene *s = ctx;
	struct scene_stored *at = &s->disk.rows[row];

	if (s->disk.full)
		return ++s->disk.tickets;
	at->name = s->items[row].name;
	at->known = true;
	at->value = value;
	at->len = len;
	if (text)
		memcpy(at->text, text, len);
	s->disk.tickets++;
	if (!s->disk.waits)
		s->disk.stored = s->disk.tickets;
	return s->disk.tickets;
}

static uint32_t stored(void *ctx)
{
	return ((struct scene *)ctx)->disk.stored;
}

static int error(void *ctx)
{
	return ((struct scene *)ctx)->disk.full ? -ENOSPC : 0;
}

static bool find(void *ctx, uint32_t row, int64_t *value, char *text, size_t room, uint32_t *len)
{
	const struct scene_stored *at = &((struct scene *)ctx)->disk.rows[row];

	TEST_ASSERT_LESS_OR_EQUAL(room, at->len);
	*value = at->value;
	*len = at->len;
	memcpy(text, at->text, at->len);
	return at->known;
}

const struct engine_last *scene_disk(struct scene *s)
{
	s->disk.seam = (struct engine_last){s, put, stored, error, find};
	return &s->disk.seam;
}

void scene_store(struct scene *s)
{
	s->disk.stored = s->disk.tickets;
}
