/* SPDX-License-Identifier: MIT */
/* The thread that stores the last commands, and what it shares with the engine. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/bus/time.h"
#include "src/host/last.h"
#include "src/host/last_file.h"
#include "src/host/own_thread.h"
#include "src/libows/ows.h"
#include "src/shm/futex.h"
#include "src/shm/word.h"

#define STACK (128 * 1024)
#define APART_NS NS_PER_S
#define NO_ENTRY UINT32_MAX

/* What the engine puts; seq is odd while it does. */
struct last_cell {
	uint32_t seq, ticket, known;
	uint32_t len;
	int64_t value;
	char *text;
};

struct last {
	struct engine_last seam;
	struct last_setup setup;
	char where[LAST_WHERE];
	struct last_cell *cells;
	struct last_entry *entries; /* the thread's copy, of the same signals */
	uint32_t count;
	uint32_t *entry_of; /* of each row; NO_ENTRY */
	char *texts;
	/* shared with the thread */
	uint32_t tickets; /* given; futex word */
	uint32_t stored;
	int error;
	uint64_t failures;
	/* the thread */
	struct own_thread thread;
	bool logged; /* the log has the failure that lasts */
};

/* --- The engine's side ------------------------------------------------------------------------ */

static uint32_t put(void *ctx, uint32_t row, int64_t value, const char *text, uint32_t len)
{
	struct last *l = ctx;
	struct last_cell *c = &l->cells[l->entry_of[row]];

	if (c->known && c->len == len &&
	    (c->text ? memcmp(c->text, text, len) == 0 : c->value == value))
		return c->ticket;
	c->ticket = l->tickets + 1 ? l->tickets + 1 : 1;
	__atomic_store_n(&c->seq, c->seq + 1, __ATOMIC_RELAXED);
	word_fence(__ATOMIC_RELEASE);
	words_store(&c->value, &value, 2);
	word_set(&c->len, len);
	if (c->text)
		words_store(c->text, text, (len + 3) / 4);
	word_set(&c->known, 1);
	__atomic_store_n(&c->seq, c->seq + 1, __ATOMIC_RELEASE);
	__atomic_store_n(&l->tickets, c->ticket, __ATOMIC_RELEASE);
	segment_wake(&l->tickets, 1);
	return c->ticket;
}

static uint32_t stored(void *ctx)
{
	return __atomic_load_n(&((struct last *)ctx)->stored, __ATOMIC_ACQUIRE);
}

static int error(void *ctx)
{
	return __atomic_load_n(&((struct last *)ctx)->error, __ATOMIC_RELAXED);
}

static bool find(void *ctx, uint32_t row, int64_t *value, char *text, size_t room, uint32_t *len)
{
	const struct last *l = ctx;
	const struct last_cell *c = &l->cells[l->entry_of[row]];

	if (!c->known || c->len > room)
		return false;
	*value = c->value;
	*len = c->len;
	if (c->text)
		memcpy(text, c->text, c->len);
	return true;
}

/* --- The thread ------------------------------------------------------------------------------- */

static void copy_cell(const struct last_cell *c, struct last_entry *e)
{
	uint32_t seq;

	do {
		seq = __atomic_load_n(&c->seq, __ATOMIC_ACQUIRE);
		words_load(&e->value, &c->value, 2);
		e->len = word_get(&c->len);
		e->known = word_get(&c->known);
		if (e->text)
			words_load(e->text, c->text, VALUE_STRING_MAX / 4);
		word_fence(__ATOMIC_ACQUIRE);
	} while (seq & 1 || __atomic_load_n(&c->seq, __ATOMIC_RELAXED) != seq);
}

static int store(struct last *l)
{
	int directory = last_directory(l->where), err = directory < 0 ? directory : 0;

	for (uint32_t i = 0; i < l->count; i++)
		copy_cell(&l->cells[i], &l->entries[i]);
	if (!err)
		err = last_write(directory, l->setup.instance, l->entries, l->count);
	if (directory >= 0)
		close(directory);
	return err;
}

/* Store all up to this ticket, and let the engine know how it went. */
static void store_up_to(struct last *l, uint32_t ticket)
{
	int err = store(l);

	__atomic_store_n(&l->error, err, __ATOMIC_RELAXED);
	if (!err) {
		__atomic_store_n(&l->stored, ticket, __ATOMIC_RELEASE);
		if (l->logged)
			log_notice(l->setup.log, "the last commands are stored again in %s",
			           l->where);
		l->logged = false;
	} else {
		__atomic_fetch_add(&l->failures, 1, __ATOMIC_RELAXED);
		if (!l->logged)
			log_err(l->setup.log,
			        "the last commands of outputs with Start \"last\" cannot be stored "
			        "in %s: %s: owsd tries again every second, and says of none of "
			        "them that it is applied",
			        l->where, strerror(-err));
		l->logged = true;
	}
	l->setup.ring(l->setup.ring_ctx);
}

static void *store_main(void *ctx)
{
	struct last *l = ctx;

	while (!own_thread_stops(&l->thread)) {
		uint32_t ticket = __atomic_load_n(&l->tickets, __ATOMIC_ACQUIRE);

		if (ticket == l->stored) {
			segment_wait(&l->tickets, ticket, APART_NS);
			continue;
		}
		store_up_to(l, ticket);
		segment_wait(&l->thread.stop, 0, APART_NS);
	}
	if (l->tickets != l->stored)
		store_up_to(l, l->tickets);
	own_thread_ends(&l->thread);
	return NULL;
}

/* --- Made and ended --------------------------------------------------------------------------- */

static int make_cells(struct last *l, const struct config *config)
{
	uint32_t strings = 0, n = 0;
	char *text;

	for (unsigned i = 0; i < config->item_count; i++) {
		l->count += config->items[i].starts_last;
		strings += config->items[i].starts_last && config->items[i].type == OWS_STRING;
	}
	l->entry_of = calloc((size_t)config->item_count + 1, sizeof(*l->entry_of));
	l->cells = calloc((size_t)l->count + 1, sizeof(*l->cells));
	l->entries = calloc((size_t)l->count + 1, sizeof(*l->entries));
	l->texts = text = calloc((size_t)2 * strings + 1, VALUE_STRING_MAX);
	if (!l->entry_of || !l->cells || !l->entries || !l->texts)
		return -ENOMEM;
	for (unsigned i = 0; i < config->item_count; i++) {
		l->entry_of[i] = config->items[i].starts_last ? n : NO_ENTRY;
		if (!config->items[i].starts_last)
			continue;
		l->entries[n].item = &config->items[i];
		if (config->items[i].type == OWS_STRING) {
			l->entries[n].text = text;
			l->cells[n].text = text + VALUE_STRING_MAX;
			text += 2 * VALUE_STRING_MAX;
		}
		n++;
	}
	return 0;
}

static void read_file(struct last *l)
{
	int directory = last_directory(l->where), err = directory < 0 ? directory : 0;

	if (!err)
		err = last_read(directory, l->setup.instance, l->entries, l->count);
	if (err)
		log_warning(l->setup.log,
		            "outputs with Start \"last\" begin with InitValue: %s/%s.last: %s",
		            l->where, l->setup.instance,
		            err == -EBADMSG ? "the file is damaged" : strerror(-err));
	if (directory >= 0)
		close(directory);
	for (uint32_t i = 0; i < l->count; i++) {
		struct last_cell *c = &l->cells[i];

		c->known = l->entries[i].known;
		c->value = l->entries[i].value;
		c->len = l->entries[i].len;
		if (c->text)
			memcpy(c->text, l->entries[i].text, c->len);
	}
}

int last_make(const struct last_setup *setup, struct last **last)
{
	struct last *l = calloc(1, sizeof(*l));
	int err = l ? make_cells(l, setup->config) : -ENOMEM;

	*last = NULL;
	if (err || !l->count) {
		last_free(l);
		return err;
	}
	l->setup = *setup;
	l->seam = (struct engine_last){l, put, stored, error, find};
	read_file(l);
	*last = l;
	return 0;
}

const struct engine_last *last_seam(const struct last *l)
{
	return l ? &l->seam : NULL;
}

int last_start(struct last *l)
{
	if (!l || l->thread.running || l->error == -EIO)
		return 0;
	return own_thread_start(&l->thread, "owsd-last", STACK, store_main, l);
}

bool last_stop(struct last *l, int64_t timeout_ns)
{
	return !l || own_thread_stop(&l->thread, &l->tickets, timeout_ns);
}

void last_give_up(struct last *l)
{
	if (l)
		l->error = -EIO;
}

uint64_t last_failures(const struct last *l)
{
	return l ? __atomic_load_n(&l->failures, __ATOMIC_RELAXED) : 0;
}

void last_free(struct last *l)
{
	if (!l)
		return;
	free(l->entry_of);
	free(l->cells);
	free(l->entries);
	free(l->texts);
	free(l);
}
