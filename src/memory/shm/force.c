/* SPDX-License-Identifier: MIT */
/* NAME.force and NAME.last, as one owsd writes them and the next reads them. */
#include <assert.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "src/memory/shm/force.h"
#include "src/memory/shm/word.h"
#include "src/public/ows.h"

#define FORCE_MAGIC 0x4653574fu /* "OWSF" */
#define FORCE_VERSION 2
#define FORCE_MAX 0x7fffffffu
#define FORCE_ROWS_MAX 0x100000u
#define GIVEN 0x01u
#define SAFE 0x02u
#define APPLIED 0x04u /* where it is not known, an input is not written again either */

/* All of this file is of owsd alone: another version of owsd that lays it out anew counts up. */
struct force_header { /* 64 bytes */
	uint32_t magic, version;
	uint64_t boot;
	uint32_t size, row_count, text_cap;
	uint32_t row_off, controller_off, text_off, pool_off;
	uint32_t controller_count;
	uint32_t spare[3];
	uint32_t check; /* of the words before */
};
struct row_slot { /* 40 bytes */
	int64_t value;
	uint32_t len, text_check; /* strings */
	uint32_t stamp, flags, controller, serial;
	uint32_t spare;
	uint32_t check; /* of the words before */
};
/* seq counts what was written; slot[seq & 1] is the newest. */
struct force_row { /* 112 bytes */
	uint32_t seq;
	uint32_t name_off, path_off;
	uint32_t type;
	uint32_t text_off; /* strings: two texts of text_cap bytes, of slot 0 and 1; else 0 */
	uint32_t name_check, path_check;
	uint32_t spare;
	struct row_slot slot[2];
};
struct controller_slot { /* 112 bytes */
	struct force_controller controller;
	uint32_t spare;
	uint32_t check;
};
struct controller_row { /* 232 bytes */
	uint32_t seq, spare;
	struct controller_slot slot[2];
};
_Static_assert(sizeof(struct force_header) == 64, "laid out by hand");
_Static_assert(sizeof(struct row_slot) == 40, "laid out by hand");
_Static_assert(sizeof(struct force_row) == 112, "laid out by hand");
_Static_assert(sizeof(struct controller_slot) == 112, "laid out by hand");

#define CHECK_OF(record) \
	ows_check((const uint32_t *)(const void *)(record), sizeof(*(record)) / 4 - 1)

/* --- Writing ---------------------------------------------------------------------------------- */

struct force_areas {
	uint64_t row, controller, text, pool, end;
};

static void find_areas(const struct force_plan *plan, struct force_areas *a)
{
	uint64_t texts = 0, pool = 0;

	for (uint32_t i = 0; i < plan->signal_count; i++) {
		pool += strlen(plan->signals[i].name) + 1 + strlen(plan->signals[i].path) + 1;
		texts += plan->signals[i].type == OWS_STRING ? 2 : 0;
	}
	a->row = sizeof(struct force_header);
	a->controller = a->row + (uint64_t)plan->signal_count * sizeof(struct force_row);
	a->text = a->controller +
	          (plan->stored ? 0 : FORCE_CONTROLLERS) * sizeof(struct controller_row);
	a->pool = a->text + texts * plan->text_cap;
	a->end = (a->pool + pool + 7) & ~(uint64_t)7;
}

size_t force_size(const struct force_plan *plan)
{
	struct force_areas a;

	find_areas(plan, &a);
	return a.end <= FORCE_MAX && plan->signal_count <= FORCE_ROWS_MAX ? (size_t)a.end : 0;
}

static struct force_row *row_at(const struct force *force, uint32_t row)
{
	assert(row < force->row_count);
	return (struct force_row *)(void *)(force->base + force->row_off) + row;
}

static struct controller_row *controller_at(const struct force *force, uint32_t index)
{
	assert(index < force->controller_count);
	return (struct controller_row *)(void *)(force->base + force->controller_off) + index;
}

static uint32_t add_string(char *base, uint64_t *pool, const char *text, uint32_t *check)
{
	size_t len = strlen(text);
	uint32_t off = (uint32_t)*pool;

	memcpy(base + off, text, len + 1);
	*pool += len + 1;
	*check = ows_check_bytes(text, len);
	return off;
}

void force_build(const struct force_plan *plan, void *memory, struct force *force)
{
	struct force_header *h = memory;
	uint64_t text, pool;
	struct force_areas a;

	assert(plan->text_cap % 4 == 0);
	find_areas(plan, &a);
	text = a.text;
	pool = a.pool;
	*force = (struct force){.base = memory,
	                        .row_off = (uint32_t)a.row,
	                        .row_count = plan->signal_count,
	                        .controller_off = (uint32_t)a.controller,
	                        .controller_count = plan->stored ? 0 : FORCE_CONTROLLERS,
	                        .text_cap = plan->text_cap};
	for (uint32_t i = 0; i < plan->signal_count; i++) {
		const struct force_signal *s = &plan->signals[i];
		struct force_row *r = row_at(force, i);

		r->name_off = add_string(memory, &pool, s->name, &r->name_check);
		r->path_off = add_string(memory, &pool, s->path, &r->path_check);
		r->type = s->type;
		r->slot[0].check = CHECK_OF(&r->slot[0]);
		if (s->type != OWS_STRING)
			continue;
		r->text_off = (uint32_t)text;
		text += 2 * (uint64_t)plan->text_cap;
	}
	for (uint32_t i = 0; i < force->controller_count; i++)
		controller_at(force, i)->slot[0].check = CHECK_OF(
			&controller_at(force, i)->slot[0]);
	*h = (struct force_header){.magic = FORCE_MAGIC,
	                           .version = FORCE_VERSION,
	                           .boot = plan->boot,
	                           .size = (uint32_t)a.end,
	                           .row_count = plan->signal_count,
	                           .text_cap = plan->text_cap,
	                           .row_off = (uint32_t)a.row,
	                           .controller_off = (uint32_t)a.controller,
	                           .text_off = (uint32_t)a.text,
	                           .pool_off = (uint32_t)a.pool,
	                           .controller_count = force->controller_count};
	h->check = CHECK_OF(h);
}

void force_controller(struct force *force, uint32_t index,
                      const struct force_controller *controller)
{
	struct controller_row *g = controller_at(force, index);
	uint32_t next = g->seq + 1;
	struct controller_slot *slot = &g->slot[next & 1];

	slot->controller = *controller;
	slot->check = CHECK_OF(slot);
	__atomic_store_n(&g->seq, next, __ATOMIC_RELEASE);
	word_fence(__ATOMIC_RELEASE); /* the next writes into the slot that was whole until now */
}

static const struct controller_slot *newest_controller(const struct force *force, uint32_t index)
{
	const struct controller_row *g = controller_at(force, index);

	return &g->slot[g->seq & 1];
}

static char *text_at(const struct force *force, const struct force_row *r, uint32_t seq)
{
	return force->base + r->text_off + (seq & 1) * force->text_cap;
}

void force_put(struct force *force, uint32_t row, const struct force_command *command,
               const char *text)
{
	struct force_row *r = row_at(force, row);
	uint32_t next = r->seq + 1;
	struct row_slot slot = {
		.value = command->value,
		.stamp = command->stamp,
		.flags = (command->given ? GIVEN : 0) | (command->safe ? SAFE : 0) |
	                 (command->applied ? APPLIED : 0),
		.controller = command->controller,
	};

	if (command->controller < force->controller_count)
		slot.serial = newest_controller(force, command->controller)->controller.who.serial;
	if (text && r->text_off) {
		char *to = text_at(force, r, next);

		assert(command->len <= force->text_cap);
		for (uint32_t i = 0; i < command->len; i++)
			__atomic_store_n(&to[i], text[i], WORD_STORE);
		slot.len = command->len;
		slot.text_check = ows_check_bytes(text, command->len);
	}
	slot.check = CHECK_OF(&slot);
	words_store(&r->slot[next & 1], &slot, sizeof(slot) / 4);
	__atomic_store_n(&r->seq, next, __ATOMIC_RELEASE);
	word_fence(__ATOMIC_RELEASE); /* the next writes into the slot that was whole until now */
}

/* --- Reading ---------------------------------------------------------------------------------- */

void force_get(const struct force *force, uint32_t row, struct force_command *command, char *text)
{
	const struct force_row *r = row_at(force, row);
	struct row_slot slot;
	uint32_t seq;

	do {
		seq = __atomic_load_n(&r->seq, __ATOMIC_ACQUIRE);
		words_load(&slot, &r->slot[seq & 1], sizeof(slot) / 4);
		for (uint32_t i = 0; text && i < slot.len && i < force->text_cap; i++)
			text[i] = __atomic_load_n(&text_at(force, r, seq)[i], WORD_LOAD);
		word_fence(__ATOMIC_ACQUIRE);
	} while (word_get(&r->seq) != seq);
	*command = (struct force_command){
		.value = slot.value,
		.len = slot.len,
		.stamp = slot.stamp,
		.given = slot.flags & GIVEN,
		.safe = slot.flags & SAFE,
		.applied = slot.flags & APPLIED,
		.controller = slot.controller,
	};
	/* its entry is another's by now: no controller would come back for the command */
	if (slot.controller >= force->controller_count || !slot.serial ||
	    newest_controller(force, slot.controller)->controller.who.serial != slot.serial)
		command->controller = FORCE_NOBODY;
}

struct force_key {
	const char *name, *path;
	uint32_t type, row;
	bool kept;
};

static int compare_places(const void *a, const void *b)
{
	const struct force_key *x = a, *y = b;
	int order = strcmp(x->path, y->path);

	return order ? order : (x->type > y->type) - (x->type < y->type);
}

/* Names last: those of one place stand together. */
static int compare_keys(const void *a, const void *b)
{
	const struct force_key *x = a, *y = b;
	int order = compare_places(x, y);

	return order ? order : strcmp(x->name, y->name);
}

/* A string between off and end that is ended, and whole; NULL: it is not. */
static const char *left_string(const char *base, uint32_t off, uint32_t pool, uint32_t end,
                               uint32_t check)
{
	const char *text = base + off;
	size_t len;

	if (off < pool || off >= end)
		return NULL;
	len = strnlen(text, end - off);
	return len < end - off && ows_check_bytes(text, len) == check ? text : NULL;
}

static bool row_whole(const struct force *force, const struct force_header *h, uint32_t row,
                      struct force_key *key)
{
	const struct force_row *r = row_at(force, row);
	const struct row_slot *slot = &r->slot[r->seq & 1];

	*key = (struct force_key){
		.name = left_string(force->base, r->name_off, h->pool_off, h->size, r->name_check),
		.path = left_string(force->base, r->path_off, h->pool_off, h->size, r->path_check),
		.type = r->type,
		.row = row,
	};
	if (!key->name || !key->path || slot->check != CHECK_OF(slot) ||
	    slot->controller > FORCE_NOBODY)
		return false;
	if (r->type != OWS_STRING)
		return r->text_off == 0 && slot->len == 0;
	return r->text_off >= h->text_off && r->text_off <= h->pool_off &&
	       2 * (uint64_t)force->text_cap <= h->pool_off - r->text_off &&
	       slot->len <= force->text_cap &&
	       (!(slot->flags & GIVEN) ||
	        ows_check_bytes(text_at(force, r, r->seq), slot->len) == slot->text_check);
}

static bool header_whole(const struct force_header *h, size_t size)
{
	return h->check == CHECK_OF(h) && h->size == size && h->row_count <= FORCE_ROWS_MAX &&
	       h->controller_count <= FORCE_CONTROLLERS && h->row_off == sizeof(*h) &&
	       h->controller_off ==
	               h->row_off + (uint64_t)h->row_count * sizeof(struct force_row) &&
	       h->text_off ==
	               h->controller_off + h->controller_count * sizeof(struct controller_row) &&
	       h->text_off <= size && h->pool_off >= h->text_off && h->pool_off <= size;
}

static bool controllers_whole(const struct force *force)
{
	for (uint32_t i = 0; i < force->controller_count; i++)
		if (newest_controller(force, i)->check != CHECK_OF(newest_controller(force, i)))
			return false;
	return true;
}

int force_open(const void *memory, size_t size, uint64_t boot, struct force_left *left)
{
	const struct force_header *h = memory;
	bool whole;

	*left = (struct force_left){0};
	if (size < sizeof(*h) || size > FORCE_MAX || h->magic != FORCE_MAGIC ||
	    h->version != FORCE_VERSION || !header_whole(h, size))
		return -EPROTO;
	if (h->boot != boot)
		return -ESTALE;
	left->force = (struct force){.base = (char *)(uintptr_t)memory,
	                             .row_off = h->row_off,
	                             .row_count = h->row_count,
	                             .controller_off = h->controller_off,
	                             .controller_count = h->controller_count,
	                             .text_cap = h->text_cap};
	left->keys = malloc(((size_t)h->row_count + 1) * sizeof(*left->keys));
	if (!left->keys)
		return -ENOMEM;
	whole = controllers_whole(&left->force);
	for (uint32_t row = 0; whole && row < h->row_count; row++)
		whole = row_whole(&left->force, h, row, &left->keys[row]);
	if (!whole) {
		force_close(left);
		return -EPROTO;
	}
	qsort(left->keys, h->row_count, sizeof(*left->keys), compare_keys);
	return 0;
}

void force_close(struct force_left *left)
{
	free(left->keys);
	*left = (struct force_left){0};
}

static struct force_key *find_key(const struct force_left *left, const struct force_signal *signal,
                                  int (*compare)(const void *, const void *))
{
	const struct force_key wanted = {signal->name, signal->path, signal->type, 0, false};

	return left->force.row_count ? bsearch(&wanted, left->keys, left->force.row_count,
	                                       sizeof(wanted), compare)
	                             : NULL;
}

void force_keep(const struct force_left *left, const struct force_signal *signal)
{
	struct force_key *key = find_key(left, signal, compare_keys);

	if (key)
		key->kept = true;
}

/* The one of this place that no signal keeps. */
static const struct force_key *find_renamed(const struct force_left *left,
                                            const struct force_signal *signal)
{
	const struct force_key *end = left->keys + left->force.row_count, *found = NULL;
	const struct force_key *place = find_key(left, signal, compare_places), *key = place;

	while (key && key > left->keys && !compare_places(key - 1, place))
		key--;
	for (; key && key < end && !compare_places(key, place); key++) {
		if (key->kept)
			continue;
		if (found)
			return NULL;
		found = key;
	}
	return found;
}

bool force_find(const struct force_left *left, const struct force_signal *signal,
                struct force_command *command, char *text, size_t room)
{
	const struct force_key *key = find_key(left, signal, compare_keys);
	const struct force_row *r;

	if (!key)
		key = find_renamed(left, signal);
	if (!key)
		return false;
	r = row_at(&left->force, key->row);
	if (r->slot[r->seq & 1].len > room)
		return false;
	force_get(&left->force, key->row, command, text);
	return true;
}

bool force_find_controller(const struct force_left *left, uint32_t index,
                           struct force_controller *controller)
{
	if (index >= left->force.controller_count)
		return false;
	*controller = newest_controller(&left->force, index)->controller;
	controller->who.name[OWS_NAME - 1] = controller->who.person[OWS_NAME - 1] = '\0';
	return controller->who.serial != 0;
}
