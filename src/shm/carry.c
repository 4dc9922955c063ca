/* SPDX-License-Identifier: MIT */
/*
 * Carries commands from an older segment into a new one. Every number of the old segment is read
 * once into a variable and checked there: a consumer may still be writing rubbish into the segment.
 */
#include <errno.h>
#include <string.h>

#include "src/libows/ows.h"
#include "src/shm/carry.h"
#include "src/shm/commands.h"
#include "src/shm/word.h"

/*
 * More slots than any configuration has; bounds the search, which may try each for each new slot.
 */
#define SLOTS_MAX 65536

struct old_segment {
	const char *base;
	uint32_t size;
	uint32_t slot_off, entry_off, count, text_cap, client_off;
};

/* Does an area of count times size bytes at off lie inside the segment, aligned for its words? */
static bool area_inside(const struct old_segment *old, uint32_t off, uint64_t count, uint64_t size)
{
	return off % 8 == 0 && off <= old->size && count * size <= old->size - off;
}

static int open_old(const void *memory, size_t size, struct old_segment *old)
{
	struct ows_command_header h;

	if (size < sizeof(h) || size > 0x7fffffffu)
		return -EPROTO;
	words_load(&h, memory, sizeof(h) / 4);
	if (h.magic != OWS_COMMAND_MAGIC || h.major != OWS_LAYOUT_MAJOR ||
	    h.slot_size != sizeof(struct ows_command_slot) ||
	    h.entry_size != sizeof(struct ows_command_entry) ||
	    h.client_size != sizeof(struct ows_client) || h.slot_count > SLOTS_MAX)
		return -EPROTO;
	*old = (struct old_segment){
		.base = memory,
		.size = (uint32_t)size,
		.slot_off = h.slot_off,
		.entry_off = h.entry_off,
		.count = h.slot_count,
		.text_cap = h.text_cap,
		.client_off = h.client_off,
	};
	if (!area_inside(old, h.slot_off, h.slot_count, sizeof(struct ows_command_slot)) ||
	    !area_inside(old, h.entry_off, h.slot_count, sizeof(struct ows_command_entry)) ||
	    !area_inside(old, h.client_off, OWS_CLIENTS, sizeof(struct ows_client)))
		return -EPROTO;
	return 0;
}

static bool same_string(const struct old_segment *old, uint32_t off, const char *text)
{
	size_t n = strlen(text) + 1;

	return off < old->size && n <= old->size - off && memcmp(old->base + off, text, n) == 0;
}

static struct ows_command_entry old_entry(const struct old_segment *old, uint32_t i)
{
	struct ows_command_entry e;

	words_load(&e, old->base + old->entry_off + (size_t)i * sizeof(e), sizeof(e) / 4);
	return e;
}

/* Find a signal's slot, from a guess on, since most files change little; returns the slot or 0. */
static uint32_t find_old(const struct old_segment *old, uint32_t guess, const char *name,
                         const char *path, uint32_t type, struct ows_command_entry *entry)
{
	for (uint32_t n = 1; n < old->count; n++) {
		if (guess == 0 || guess >= old->count)
			guess = 1;
		*entry = old_entry(old, guess);
		if (entry->type == type && same_string(old, entry->name_off, name) &&
		    same_string(old, entry->path_off, path))
			return guess;
		guess++;
	}
	return 0;
}

static bool carry_text(struct commands *to, uint32_t slot, const struct old_segment *old,
                       uint32_t off)
{
	struct ows_command_text head, *t = (void *)(to->base + to->text_off[slot]);
	const char *from;
	char *text;

	if (off == 0 || off % 4 != 0 || off > old->size || sizeof(head) > old->size - off)
		return false;
	words_load(&head, old->base + off, sizeof(head) / 4);
	off += (uint32_t)sizeof(head);
	if (head.claim != 0 || head.len > old->text_cap || head.len > to->text_cap ||
	    head.len > old->size - off)
		return false;
	from = old->base + off;
	text = (char *)(t + 1);
	memcpy(text, from, head.len);
	if (ows_check_bytes(text, head.len) != head.check) {
		memset(text, 0, head.len);
		return false;
	}
	t->len = head.len;
	t->check = head.check;
	return true;
}

/*
 * The giver of a command as carried: none if its place is free, since another program may take it.
 */
static uint32_t carry_giver(const struct commands *to, uint32_t client)
{
	const struct ows_client *clients = (const void *)(to->base + to->client_off);

	if (client == OWS_CLIENT_SAFE)
		return client;
	return client != 0 && client <= OWS_CLIENTS && clients[client - 1].pid != 0 ? client : 0;
}

/* Carry a slot; call carry_clients() before. */
static bool carry_slot(struct commands *to, uint32_t slot, const struct old_segment *old,
                       uint32_t from, uint32_t text_off, bool restart)
{
	const struct ows_command_slot *there = (const void *)(old->base + old->slot_off);
	struct ows_command_slot was, *s;

	there += from;
	words_load(&was, there, sizeof(was) / 4);
	/*
	 * A program may be setting the slot: read the stamp before the value, and the value in one
	 * load
	 */
	was.stamp = __atomic_load_n(&there->stamp, __ATOMIC_ACQUIRE);
	was.value = __atomic_load_n((const shm_double_word *)&there->value, __ATOMIC_RELAXED);
	s = (void *)(to->base + to->slot_off + (size_t)slot * sizeof(*s));
	s->one_shot = was.one_shot;
	s->dgn_reset = was.dgn_reset;
	if (!restart) {
		s->read_enable = was.read_enable <= 2 ? was.read_enable : 0;
		s->write_enable = was.write_enable <= 2 ? was.write_enable : 0;
	}
	if (was.stamp == 0)
		return false;
	if (to->text_off[slot] != 0 && !carry_text(to, slot, old, text_off))
		return false;
	s->value = was.value;
	s->stamp = was.stamp;
	s->client = carry_giver(to, was.client);
	return true;
}

static void carry_clients(struct commands *to, const struct old_segment *old)
{
	struct ows_client was, *clients = (void *)(to->base + to->client_off);

	for (uint32_t i = 0; i < OWS_CLIENTS; i++) {
		words_load(&was, old->base + old->client_off + i * sizeof(was), sizeof(was) / 4);
		clients[i].pid = was.pid;
		clients[i].beat = was.beat;
		clients[i].period_ms = was.period_ms;
	}
}

int commands_carry(struct commands *to, const void *memory, size_t size, bool restart)
{
	const struct ows_command_entry *entries = (const void *)(to->keep + to->entry_off);
	struct old_segment old;
	uint32_t guess = 1;
	int carried = 0, err = open_old(memory, size, &old);

	if (err)
		return err;
	carry_clients(to, &old);
	if (old.count > 0)
		carry_slot(to, 0, &old, 0, 0, restart);
	for (uint32_t i = 1; i < to->slot_count; i++) {
		const struct ows_command_entry *e = &entries[i];
		struct ows_command_entry was;
		uint32_t found = find_old(&old, guess, to->keep + e->name_off,
		                          to->keep + e->path_off, e->type, &was);

		if (found == 0)
			continue;
		guess = found + 1;
		if (carry_slot(to, i, &old, found, was.text_off, restart))
			carried++;
	}
	return carried;
}

static uint32_t *ack_at(const struct commands *commands, uint32_t slot)
{
	return (uint32_t *)(void *)(commands->base + commands->ack_off) + slot;
}

void commands_carry_rows(struct commands *to, const struct commands *from, const uint32_t *rows)
{
	const struct old_segment old = {
		.base = from->base,
		.size = from->size,
		.slot_off = from->slot_off,
		.entry_off = from->entry_off,
		.count = from->slot_count,
		.text_cap = from->text_cap,
		.client_off = from->client_off,
	};

	carry_clients(to, &old);
	carry_slot(to, 0, &old, 0, 0, false);
	for (uint32_t i = 1; i < to->slot_count; i++) {
		uint32_t slot = rows[i - 1] + 1;

		if (rows[i - 1] == UINT32_MAX)
			continue;
		carry_slot(to, i, &old, slot, from->text_off[slot], false);
		*ack_at(to, i) = __atomic_load_n(ack_at(from, slot), __ATOMIC_RELAXED);
	}
}
