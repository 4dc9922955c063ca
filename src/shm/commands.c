/* SPDX-License-Identifier: MIT */
/* The command segment as owsd lays it out, reads it, and repairs what consumers overwrote. */
#include <assert.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "src/libows/ows.h"
#include "src/shm/commands.h"
#include "src/shm/word.h"

#define COMMANDS_MAX 0x7fffffffu
#define CONSTANT_HEADER offsetof(struct ows_command_header, bell)

/* The offsets of the areas of the segment, in their order. */
struct command_areas {
	uint64_t entry, pool, pool_end, dirty, client, slot, ack, text, end;
	uint32_t dirty_words;
};

static uint64_t align64(uint64_t offset)
{
	return (offset + 63) & ~(uint64_t)63;
}

static bool has_text(const struct command_signal *signal)
{
	return signal->type == OWS_STRING;
}

static void find_areas(const struct command_plan *plan, struct command_areas *a)
{
	uint64_t slots = (uint64_t)plan->signal_count + 1, pool = 1, texts = 0;

	for (uint32_t i = 0; i < plan->signal_count; i++) {
		pool += strlen(plan->signals[i].name) + 1 + strlen(plan->signals[i].path) + 1;
		texts += has_text(&plan->signals[i]) ? 1 : 0;
	}
	a->dirty_words = (uint32_t)((slots + 31) / 32);
	a->entry = sizeof(struct ows_command_header);
	a->pool = a->entry + slots * sizeof(struct ows_command_entry);
	a->pool_end = a->pool + pool;
	a->dirty = align64(a->pool_end);
	a->client = align64(a->dirty + 4 * (uint64_t)a->dirty_words);
	a->slot = a->client + OWS_CLIENTS * sizeof(struct ows_client);
	a->ack = a->slot + slots * sizeof(struct ows_command_slot);
	a->text = align64(a->ack + 4 * slots);
	a->end = align64(a->text + texts * (sizeof(struct ows_command_text) + plan->text_cap));
}

size_t commands_size(const struct command_plan *plan)
{
	struct command_areas a;

	find_areas(plan, &a);
	return a.end <= COMMANDS_MAX ? (size_t)a.end : 0;
}

static void fill_header(const struct command_plan *plan, const struct command_areas *a,
                        struct ows_command_header *h)
{
	*h = (struct ows_command_header){
		.magic = OWS_COMMAND_MAGIC,
		.major = OWS_LAYOUT_MAJOR,
		.minor = OWS_LAYOUT_MINOR,
		.size = (uint32_t)a->end,
		.generation = plan->generation,
		.state = OWS_STATE_BUILDING,
		.pid = plan->pid,
		.start_id = plan->start_id,
		.slot_off = (uint32_t)a->slot,
		.slot_size = sizeof(struct ows_command_slot),
		.slot_count = plan->signal_count + 1,
		.entry_off = (uint32_t)a->entry,
		.entry_size = sizeof(struct ows_command_entry),
		.dirty_off = (uint32_t)a->dirty,
		.dirty_words = a->dirty_words,
		.client_off = (uint32_t)a->client,
		.client_size = sizeof(struct ows_client),
		.pool_off = (uint32_t)a->pool,
		.pool_size = (uint32_t)(a->pool_end - a->pool),
		.text_off = (uint32_t)a->text,
		.text_size = (uint32_t)(a->end - a->text),
		.text_cap = plan->text_cap,
		.ack_off = (uint32_t)a->ack,
	};
}

static uint32_t add_string(char *base, uint32_t *pool, const char *text)
{
	size_t n = strlen(text) + 1;
	uint32_t off = *pool;

	memcpy(base + off, text, n);
	*pool += (uint32_t)n;
	return off;
}

int commands_build(const struct command_plan *plan, void *memory, struct commands *commands)
{
	struct command_areas a;
	struct ows_command_entry *entries;
	uint32_t pool, text;

	assert(plan->text_cap % 4 == 0);
	find_areas(plan, &a);
	assert(a.end <= COMMANDS_MAX);
	*commands = (struct commands){
		.base = memory,
		.size = (uint32_t)a.end,
		.slot_off = (uint32_t)a.slot,
		.slot_count = plan->signal_count + 1,
		.entry_off = (uint32_t)a.entry,
		.dirty_off = (uint32_t)a.dirty,
		.dirty_words = a.dirty_words,
		.client_off = (uint32_t)a.client,
		.ack_off = (uint32_t)a.ack,
		.text_cap = plan->text_cap,
		.keep_size = (uint32_t)a.pool_end,
	};
	commands->text_off = calloc(commands->slot_count, sizeof(*commands->text_off));
	commands->keep = malloc(commands->keep_size);
	if (commands->text_off == NULL || commands->keep == NULL) {
		commands_forget(commands);
		return -ENOMEM;
	}
	fill_header(plan, &a, memory);
	entries = (void *)(commands->base + a.entry);
	pool = (uint32_t)a.pool;
	text = (uint32_t)a.text;
	entries[0].name_off = entries[0].path_off = add_string(commands->base, &pool, "");
	for (uint32_t i = 0; i < plan->signal_count; i++) {
		const struct command_signal *s = &plan->signals[i];
		struct ows_command_entry *e = &entries[i + 1];

		e->name_off = add_string(commands->base, &pool, s->name);
		e->path_off = add_string(commands->base, &pool, s->path);
		e->type = s->type;
		if (!has_text(s))
			continue;
		e->text_off = commands->text_off[i + 1] = text;
		text += (uint32_t)sizeof(struct ows_command_text) + plan->text_cap;
	}
	memcpy(commands->keep, commands->base, commands->keep_size);
	return 0;
}

void commands_forget(struct commands *commands)
{
	free(commands->text_off);
	free(commands->keep);
	commands->text_off = NULL;
	commands->keep = NULL;
}

static struct ows_command_slot *slot_at(const struct commands *commands, uint32_t slot)
{
	assert(slot < commands->slot_count);
	return (void *)(commands->base + commands->slot_off +
	                (size_t)slot * sizeof(struct ows_command_slot));
}

static struct ows_command_text *text_at(const struct commands *commands, uint32_t slot)
{
	assert(slot < commands->slot_count && commands->text_off[slot] != 0);
	return (void *)(commands->base + commands->text_off[slot]);
}

static struct ows_command_header *header_of(const struct commands *commands)
{
	return (void *)commands->base;
}

static uint8_t checked_enable(uint32_t word)
{
	return word <= 2 ? (uint8_t)word : 0;
}

void commands_load(const struct commands *commands, uint32_t slot, struct command *command)
{
	struct ows_command_slot *s = slot_at(commands, slot);
	const uint32_t *acks = (const void *)(commands->base + commands->ack_off);
	uint32_t client;

	/*
	 * Consumers store the value before they count the stamp: the value read here is at least as
	 * new.
	 */
	command->stamp = __atomic_load_n(&s->stamp, __ATOMIC_ACQUIRE);
	command->value = (int64_t)__atomic_load_n((shm_double_word *)&s->value, __ATOMIC_RELAXED);
	client = word_get(&s->client);
	command->client = client <= OWS_CLIENTS ? client : 0;
	command->safe = client == OWS_CLIENT_SAFE;
	command->read_enable = checked_enable(word_get(&s->read_enable));
	command->write_enable = checked_enable(word_get(&s->write_enable));
	command->one_shot = word_get(&s->one_shot);
	command->dgn_reset = word_get(&s->dgn_reset);
	command->acknowledged = word_get(&acks[slot]);
}

int commands_text(const struct commands *commands, uint32_t slot, char *text)
{
	struct ows_command_text *t = text_at(commands, slot);
	const char *from = (const char *)(t + 1);
	uint32_t len, check, word;

	if (__atomic_load_n(&t->claim, __ATOMIC_ACQUIRE) != 0)
		return -EBUSY;
	len = word_get(&t->len);
	check = word_get(&t->check);
	if (len > commands->text_cap)
		return -EBADMSG;
	for (uint32_t i = 0; i < len; i += 4) {
		words_load(&word, from + i, 1);
		memcpy(text + i, &word, len - i < 4 ? len - i : 4);
	}
	text[len] = '\0';
	return check == ows_check_bytes(text, len) ? (int)len : -EBADMSG;
}

static int put_command(struct commands *commands, uint32_t slot, uint32_t client, int64_t value,
                       const char *text, uint32_t len)
{
	struct ows_command_slot *s = slot_at(commands, slot);
	struct ows_command_text *t;
	uint32_t free_claim = 0;

	word_set(&s->client, client);
	if (!text) {
		/* One store: between two, a consumer could store a value of its own */
		__atomic_store_n((shm_double_word *)&s->value, (uint64_t)value, __ATOMIC_RELAXED);
		return 0;
	}
	t = text_at(commands, slot);
	if (!__atomic_compare_exchange_n(&t->claim, &free_claim, UINT32_MAX, false,
	                                 __ATOMIC_ACQUIRE, __ATOMIC_RELAXED))
		return -EBUSY;
	if (len > commands->text_cap)
		len = commands->text_cap;
	for (uint32_t i = 0; i < len; i += 4) {
		uint32_t word = 0;

		memcpy(&word, text + i, len - i < 4 ? len - i : 4);
		words_store((char *)(t + 1) + i, &word, 1);
	}
	word_set(&t->len, len);
	word_set(&t->check, ows_check_bytes(text, len));
	__atomic_store_n(&t->claim, 0, __ATOMIC_RELEASE);
	return 0;
}

int commands_put(struct commands *commands, uint32_t slot, int64_t value, const char *text,
                 uint32_t len)
{
	return put_command(commands, slot, 0, value, text, len);
}

int commands_put_safe(struct commands *commands, uint32_t slot, int64_t value, const char *text,
                      uint32_t len)
{
	return put_command(commands, slot, OWS_CLIENT_SAFE, value, text, len);
}

void commands_stamp(struct commands *commands, uint32_t slot, uint32_t stamp)
{
	__atomic_store_n(&slot_at(commands, slot)->stamp, stamp, __ATOMIC_RELEASE);
}

void commands_unclaim(struct commands *commands, uint32_t slot)
{
	__atomic_store_n(&text_at(commands, slot)->claim, 0, __ATOMIC_RELEASE);
}

int commands_next_dirty(struct commands *commands, uint32_t from)
{
	uint32_t *words = (void *)(commands->base + commands->dirty_off);

	for (uint32_t w = from / 32; w < commands->dirty_words; w++) {
		uint32_t bits = word_get(&words[w]), slot;

		if (w == from / 32)
			bits &= 0xffffffffu << from % 32;
		if (bits == 0)
			continue;
		slot = w * 32 + (uint32_t)__builtin_ctz(bits);
		if (slot >= commands->slot_count)
			return -1;
		__atomic_fetch_and(&words[w], ~(1u << slot % 32), __ATOMIC_ACQUIRE);
		return (int)slot;
	}
	return -1;
}

static struct ows_client *client_at(const struct commands *commands, unsigned client)
{
	struct ows_client *clients = (void *)(commands->base + commands->client_off);

	assert(client < OWS_CLIENTS);
	return &clients[client];
}

void commands_client(const struct commands *commands, unsigned client, struct command_client *c)
{
	struct ows_client *from = client_at(commands, client);

	c->pid = __atomic_load_n(&from->pid, __ATOMIC_ACQUIRE);
	c->beat = word_get(&from->beat);
	c->period_ms = word_get(&from->period_ms);
}

void commands_drop_client(struct commands *commands, unsigned client)
{
	for (uint32_t i = 0; i < commands->slot_count; i++) {
		uint32_t its = client + 1;

		__atomic_compare_exchange_n(&slot_at(commands, i)->client, &its, 0, false,
		                            __ATOMIC_RELAXED, __ATOMIC_RELAXED);
	}
	__atomic_store_n(&client_at(commands, client)->pid, 0, __ATOMIC_RELEASE);
}

uint32_t *commands_bell(const struct commands *commands)
{
	return &header_of(commands)->bell;
}

void commands_awake(struct commands *commands, bool awake)
{
	__atomic_store_n(&header_of(commands)->awake, awake ? 1 : 0, __ATOMIC_SEQ_CST);
	/*
	 * A consumer that saw the old flag and did not wake owsd had marked its slot before: the
	 * look that follows finds the mark.
	 */
	word_fence(__ATOMIC_SEQ_CST);
}

void commands_state(struct commands *commands, enum ows_state state)
{
	struct ows_command_header *keep = (void *)commands->keep;

	word_set(&keep->state, (uint32_t)state);
	__atomic_store_n(&header_of(commands)->state, (uint32_t)state, __ATOMIC_SEQ_CST);
	word_fence(__ATOMIC_SEQ_CST);
}

void commands_retire(void *old, size_t old_size)
{
	struct ows_command_header *h = old;

	if (old_size < sizeof(*h) || word_get(&h->magic) != OWS_COMMAND_MAGIC)
		return;
	__atomic_store_n(&h->state, (uint32_t)OWS_STATE_RETIRED, __ATOMIC_SEQ_CST);
	word_fence(__ATOMIC_SEQ_CST);
}

static bool restore_words(char *to, const char *keep, size_t size)
{
	bool restored = false;

	for (size_t i = 0; i < size; i += 4) {
		uint32_t was, is = 0;
		size_t n = size - i < 4 ? size - i : 4;

		words_load(&was, to + i, 1);
		if (n == 4) {
			words_load(&is, keep + i, 1); /* the state may change meanwhile */
		} else {
			memcpy(&is, keep + i, n);
			memcpy((char *)&is + n, (const char *)&was + n, 4 - n);
		}
		if (was != is) {
			words_store(to + i, &is, 1);
			restored = true;
		}
	}
	return restored;
}

bool commands_repair(struct commands *commands, bool all)
{
	bool restored = restore_words(commands->base, commands->keep, CONSTANT_HEADER);

	if (all && restore_words(commands->base + commands->entry_off,
	                         commands->keep + commands->entry_off,
	                         commands->keep_size - commands->entry_off))
		restored = true;
	return restored;
}
