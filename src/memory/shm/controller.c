/* SPDX-License-Identifier: MIT */
/* The memory of a controller as owsd lays it out, reads it, and answers in it. */
#include <assert.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "src/memory/shm/controller.h"
#include "src/memory/shm/word.h"
#include "src/public/ows.h"

#define CONTROLLER_MAX 0x7fffffffu

static uint64_t align64(uint64_t offset)
{
	return (offset + 63) & ~(uint64_t)63;
}

int controller_layout_make(struct controller_layout *layout, const struct controller_plan *plan)
{
	uint64_t slots = (uint64_t)plan->signal_count + 1, words = (slots + 31) / 32;
	uint64_t dirty, place, person, shelf, text, end;
	uint32_t texts = 0;

	assert(plan->text_cap % 4 == 0);
	*layout = (struct controller_layout){0};
	for (uint32_t i = 0; i < plan->signal_count; i++)
		texts += plan->types[i] == OWS_STRING;
	dirty = align64(sizeof(struct ows_controller_header) +
	                slots * sizeof(struct ows_command_slot));
	place = align64(dirty + 4 * words);
	person = align64(place + 4 * slots);
	shelf = align64(person + (uint64_t)OWS_PERSONS * OWS_NAME);
	text = align64(shelf + sizeof(struct ows_command_shelf));
	end = align64(text + (uint64_t)texts * (sizeof(struct ows_command_text) + plan->text_cap));
	if (end > CONTROLLER_MAX)
		return -EFBIG;
	layout->places = malloc(slots * sizeof(*layout->places));
	if (!layout->places)
		return -ENOMEM;
	layout->header = (struct ows_controller_header){
		.magic = OWS_CONTROLLER_MAGIC,
		.major = OWS_LAYOUT_MAJOR,
		.minor = OWS_LAYOUT_MINOR,
		.size = (uint32_t)end,
		.generation = plan->generation,
		.start_id = plan->start_id,
		.slot_off = sizeof(struct ows_controller_header),
		.slot_size = sizeof(struct ows_command_slot),
		.slot_count = (uint32_t)slots,
		.text_off = (uint32_t)text,
		.text_cap = plan->text_cap,
		.place_off = (uint32_t)place,
		.dirty_off = (uint32_t)dirty,
		.dirty_words = (uint32_t)words,
		.person_off = (uint32_t)person,
		.shelf_off = (uint32_t)shelf,
		.state = OWS_STATE_BUILDING,
	};
	layout->places[0] = CONTROLLER_NO_TEXT;
	texts = 0;
	for (uint32_t i = 0; i < plan->signal_count; i++)
		layout->places[i + 1] = plan->types[i] == OWS_STRING ? texts++ : CONTROLLER_NO_TEXT;
	return 0;
}

void controller_layout_free(struct controller_layout *layout)
{
	free(layout->places);
	*layout = (struct controller_layout){0};
}

static struct ows_controller_header *header_of(const struct controller_memory *memory)
{
	return (void *)memory->base;
}

static struct ows_command_slot *slot_at(const struct controller_memory *memory, uint32_t record)
{
	assert(record < memory->layout->header.slot_count);
	return (void *)(memory->base + memory->layout->header.slot_off +
	                (size_t)record * sizeof(struct ows_command_slot));
}

static struct ows_command_text *text_at(const struct controller_memory *memory, uint32_t record)
{
	const struct controller_layout *l = memory->layout;

	assert(record < l->header.slot_count && l->places[record] != CONTROLLER_NO_TEXT);
	return (void *)(memory->base + l->header.text_off +
	                (size_t)l->places[record] *
	                        (sizeof(struct ows_command_text) + l->header.text_cap));
}

static char *person_at(const struct controller_memory *memory, uint32_t index)
{
	return memory->base + memory->layout->header.person_off + (size_t)index * OWS_NAME;
}

static struct ows_command_shelf *shelf_of(const struct controller_memory *memory)
{
	return (void *)(memory->base + memory->layout->header.shelf_off);
}

void controller_build(const struct controller_memory *memory, uint32_t serial)
{
	const struct controller_layout *l = memory->layout;

	*header_of(memory) = l->header;
	header_of(memory)->serial = serial;
	memcpy(memory->base + l->header.place_off, l->places,
	       l->header.slot_count * sizeof(*l->places));
}

void controller_allow(const struct controller_memory *memory, uint32_t record, bool allowed)
{
	word_set(&slot_at(memory, record)->allowed, allowed);
}

void controller_state(const struct controller_memory *memory, enum ows_state state)
{
	__atomic_store_n(&header_of(memory)->state, (uint32_t)state, __ATOMIC_SEQ_CST);
	word_fence(__ATOMIC_SEQ_CST);
}

/* --- Commands --------------------------------------------------------------------------------- */

/* What owsd has seen of the edges of a slot stands in the slot: the low halves of the counters. */
struct edges {
	uint32_t read_enable, write_enable, one_shot, dgn_reset, acknowledged;
	uint32_t read_once; /* dgn_reset with its halves changed over */
};

/*
 * Each request of the controller that is no command counts a word up. owsd notes the counts in the
 * slot itself, so that a reload takes them along with it.
 */
static void load_edges(struct ows_command_slot *s, struct edges *now)
{
	now->read_enable = word_get(&s->read_enable);
	now->write_enable = word_get(&s->write_enable);
	now->one_shot = word_get(&s->one_shot);
	now->dgn_reset = word_get(&s->dgn_reset);
	now->acknowledged = word_get(&s->acknowledged);
	now->read_once = now->dgn_reset >> 16 | now->dgn_reset << 16;
}

static void store_seen(struct ows_command_slot *s, const struct edges *seen)
{
	word_set(&s->spare0[0], (seen->read_enable & 0xffff) | seen->write_enable << 16);
	word_set(&s->spare0[1], (seen->one_shot & 0xffff) | seen->dgn_reset << 16);
	word_set(&s->spare0[2], (seen->acknowledged & 0xffff) | seen->read_once << 16);
}

/* A counter that is 0 was never counted. */
static bool is_edge(uint32_t now, uint32_t seen)
{
	return now != 0 && ((now ^ seen) & 0xffff) != 0;
}

static uint8_t enable_of(uint32_t now, uint32_t seen)
{
	return is_edge(now, seen) && (now & 3) != 3 ? now & 3 : 0;
}

void controller_load(const struct controller_memory *memory, uint32_t record,
                     struct controller_command *command)
{
	struct ows_command_slot *s = slot_at(memory, record);
	uint32_t enables, counts, others;
	struct edges now;

	/* The controller stores the value before the stamp: the value read here is at least as
	 * new. */
	command->stamp = __atomic_load_n(&s->stamp, __ATOMIC_ACQUIRE);
	command->value = (int64_t)__atomic_load_n((shm_double_word *)&s->value, __ATOMIC_RELAXED);
	command->fresh = command->stamp != 0 && command->stamp != word_get(&s->taken);
	command->person = word_get(&s->person);
	if (command->person > OWS_PERSONS)
		command->person = 0;
	load_edges(s, &now);
	enables = word_get(&s->spare0[0]);
	counts = word_get(&s->spare0[1]);
	others = word_get(&s->spare0[2]);
	command->read_enable = enable_of(now.read_enable, enables);
	command->write_enable = enable_of(now.write_enable, enables >> 16);
	command->one_shot = is_edge(now.one_shot, counts);
	command->dgn_reset = is_edge(now.dgn_reset, counts >> 16);
	command->acknowledged = is_edge(now.acknowledged, others);
	command->read_once = is_edge(now.read_once, others >> 16);
	store_seen(s, &now);
}

int controller_text(const struct controller_memory *memory, uint32_t record, char *text)
{
	const struct ows_command_text *t = text_at(memory, record);
	uint32_t len = word_get(&t->len), check = word_get(&t->check);

	if (len > memory->layout->header.text_cap)
		return -EBADMSG;
	words_load_text(text, (const char *)(t + 1), len);
	text[len] = '\0';
	return check == ows_check_bytes(text, len) ? (int)len : -EBADMSG;
}

/*
 * Copy a text that ends before size, with '?' for control characters, and fill up with NUL. A
 * quote would end those in which a line of the log has the text.
 */
static void clean_text(char *to, const char *from, size_t size)
{
	size_t n = 0;

	while (n < size - 1 && from[n] != '\0') {
		unsigned char c = (unsigned char)from[n];

		to[n++] = c < 0x20 || c == 0x7f ? '?' : c == '"' ? '\'' : (char)c;
	}
	memset(to + n, 0, size - n);
}

void controller_clean_name(char name[OWS_NAME], const char *from)
{
	clean_text(name, from, OWS_NAME);
}

void controller_person(const struct controller_memory *memory, uint32_t person, char name[OWS_NAME])
{
	char copy[OWS_NAME] = "";

	assert(person <= OWS_PERSONS);
	if (person != 0)
		words_load(copy, person_at(memory, person - 1), OWS_NAME / 4);
	clean_text(name, copy, OWS_NAME);
}

bool controller_is_marked(const struct controller_memory *memory)
{
	return word_get(&header_of(memory)->marked) != 0;
}

bool controller_marked(const struct controller_memory *memory)
{
	return controller_is_marked(memory) &&
	       __atomic_exchange_n(&header_of(memory)->marked, 0, __ATOMIC_ACQUIRE) != 0;
}

int controller_next_dirty(const struct controller_memory *memory, uint32_t from)
{
	const struct controller_layout *l = memory->layout;
	uint32_t *words = (void *)(memory->base + l->header.dirty_off);

	for (uint32_t w = from / 32; w < l->header.dirty_words; w++) {
		uint32_t bits = word_get(&words[w]), record;

		if (w == from / 32)
			bits &= 0xffffffffu << from % 32;
		if (bits == 0)
			continue;
		record = w * 32 + (uint32_t)__builtin_ctz(bits);
		if (record >= l->header.slot_count)
			return -1;
		__atomic_fetch_and(&words[w], ~(1u << record % 32), __ATOMIC_ACQUIRE);
		return (int)record;
	}
	return -1;
}

void controller_taken(const struct controller_memory *memory, uint32_t record, uint32_t stamp,
                      int err)
{
	struct ows_command_slot *s = slot_at(memory, record);

	__atomic_store_n(&s->err, err, __ATOMIC_RELAXED);
	__atomic_store_n(&s->taken, stamp, __ATOMIC_RELEASE);
}

void controller_applied(const struct controller_memory *memory, uint32_t record, uint32_t stamp)
{
	__atomic_store_n(&slot_at(memory, record)->applied, stamp, __ATOMIC_RELEASE);
}

void controller_beat(const struct controller_memory *memory, struct controller_beat *beat)
{
	const struct ows_controller_header *h = header_of(memory);

	beat->beat = __atomic_load_n(&h->beat, __ATOMIC_ACQUIRE);
	beat->period_ms = word_get(&h->period_ms);
	if (beat->period_ms > OWS_BEAT_MOST_MS)
		beat->period_ms = OWS_BEAT_MOST_MS;
	beat->goodbye = word_get(&h->goodbye) != 0;
}

bool controller_waits(const struct controller_memory *memory)
{
	uint32_t *waits = &header_of(memory)->waits;

	return word_get(waits) != 0 && __atomic_exchange_n(waits, 0, __ATOMIC_RELAXED) != 0;
}

/* --- Shelving --------------------------------------------------------------------------------- */

bool controller_shelf(const struct controller_memory *memory, struct controller_shelf *shelf)
{
	const struct ows_command_shelf *from = shelf_of(memory);
	char why[OWS_TEXT];

	shelf->count = __atomic_load_n(&from->count, __ATOMIC_ACQUIRE);
	shelf->record = word_get(&from->record);
	if (shelf->record >= memory->layout->header.slot_count)
		shelf->record = 0;
	shelf->seconds = word_get(&from->seconds);
	shelf->person = word_get(&from->person);
	if (shelf->person > OWS_PERSONS)
		shelf->person = 0;
	words_load(why, from->why, OWS_TEXT / 4);
	clean_text(shelf->why, why, OWS_TEXT);
	return shelf->count != 0 && shelf->count != word_get(&from->done);
}

void controller_shelf_done(const struct controller_memory *memory, uint32_t count, int err)
{
	struct ows_command_shelf *s = shelf_of(memory);

	__atomic_store_n(&s->err, err, __ATOMIC_RELAXED);
	__atomic_store_n(&s->done, count, __ATOMIC_RELEASE);
}

/* --- A reload --------------------------------------------------------------------------------- */

static void copy_text(const struct controller_memory *to, uint32_t record,
                      const struct controller_memory *from, uint32_t was)
{
	const struct ows_command_text *f = text_at(from, was);
	struct ows_command_text *t = text_at(to, record);
	uint32_t cap = to->layout->header.text_cap < from->layout->header.text_cap
	                       ? to->layout->header.text_cap
	                       : from->layout->header.text_cap;

	words_load(t, f, (sizeof(*t) + cap) / 4);
}

/* What the controller did after the last look is over: its call has returned -ESTALE. */
static void copy_slot(const struct controller_memory *to, uint32_t record,
                      const struct controller_memory *from, uint32_t was)
{
	struct ows_command_slot *f = slot_at(from, was), *t = slot_at(to, record), copy;
	struct edges seen;

	words_load(&copy, f, sizeof(copy) / 4);
	t->value = copy.value;
	t->stamp = copy.stamp;
	t->person = copy.person;
	t->read_enable = copy.read_enable;
	t->write_enable = copy.write_enable;
	t->one_shot = copy.one_shot;
	t->dgn_reset = copy.dgn_reset;
	t->acknowledged = copy.acknowledged;
	t->applied = copy.applied;
	t->err = copy.taken == copy.stamp ? copy.err : -ESTALE;
	t->taken = copy.stamp;
	load_edges(t, &seen);
	store_seen(t, &seen);
	if (to->layout->places[record] != CONTROLLER_NO_TEXT &&
	    from->layout->places[was] != CONTROLLER_NO_TEXT)
		copy_text(to, record, from, was);
}

void controller_copy(const struct controller_memory *to, const struct controller_memory *from,
                     const uint32_t *rows)
{
	struct ows_controller_header *t = header_of(to);
	const struct ows_controller_header *f = header_of(from);
	struct ows_command_shelf *shelf = shelf_of(to);

	copy_slot(to, 0, from, 0);
	for (uint32_t i = 1; i < to->layout->header.slot_count; i++)
		if (rows[i - 1] != UINT32_MAX)
			copy_slot(to, i, from, rows[i - 1] + 1);
	words_load(person_at(to, 0), person_at(from, 0), OWS_PERSONS * OWS_NAME / 4);
	words_load(shelf, shelf_of(from), sizeof(*shelf) / 4);
	if (shelf->done != shelf->count)
		shelf->err = -ESTALE;
	shelf->done = shelf->count;
	t->beat = word_get(&f->beat);
	t->period_ms = word_get(&f->period_ms);
	t->goodbye = word_get(&f->goodbye);
	t->waits = word_get(&f->waits);
}
