/* SPDX-License-Identifier: MIT */
/* The thread that stores the last commands, and what it shares with the engine. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/daemon/host/last.h"
#include "src/daemon/host/last_file.h"
#include "src/daemon/host/own_thread.h"
#include "src/ground/signal/value.h"
#include "src/memory/shm/force.h"
#include "src/memory/shm/futex.h"

#define STACK (128 * 1024)
#define APART_NS NS_PER_S
struct last {
	struct engine_last seam;
	struct last_setup setup;
	char where[LAST_WHERE];
	struct force_signal *signals; /* with Start "last" */
	uint32_t *row_of;             /* in put and copy, of each row of the table */
	struct force put;             /* by the engine; the stamp of a command is its ticket */
	struct force copy;            /* the thread's, as it goes to the disk */
	size_t size;                  /* of each of them */
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

static uint32_t last_put(void *ctx, uint32_t row, int64_t value, const char *text, uint32_t len)
{
	struct last *l = ctx;
	struct force_command c;
	char now[VALUE_STRING_MAX];

	force_get(&l->put, l->row_of[row], &c, now);
	if (c.given && (text ? c.len == len && memcmp(now, text, len) == 0 : c.value == value))
		return c.stamp;
	c = (struct force_command){.value = value,
	                           .len = len,
	                           .stamp = l->tickets + 1 ? l->tickets + 1 : 1,
	                           .given = true,
	                           .controller = FORCE_NOBODY};
	force_put(&l->put, l->row_of[row], &c, text);
	__atomic_store_n(&l->tickets, c.stamp, __ATOMIC_RELEASE);
	segment_wake(&l->tickets, 1);
	return c.stamp;
}

static uint32_t last_stored(void *ctx)
{
	return __atomic_load_n(&((struct last *)ctx)->stored, __ATOMIC_ACQUIRE);
}

static int last_error(void *ctx)
{
	return __atomic_load_n(&((struct last *)ctx)->error, __ATOMIC_RELAXED);
}

static bool last_find(void *ctx, uint32_t row, int64_t *value, char *text, size_t room,
                      uint32_t *len)
{
	const struct last *l = ctx;
	struct force_command c;
	char kept[VALUE_STRING_MAX];

	force_get(&l->put, l->row_of[row], &c, kept);
	if (!c.given || c.len > room)
		return false;
	*value = c.value;
	*len = c.len;
	memcpy(text, kept, c.len);
	return true;
}

/* --- The thread ------------------------------------------------------------------------------- */

static int store_all(struct last *l)
{
	int directory = last_directory(l->where), err = directory < 0 ? directory : 0;

	for (uint32_t row = 0; row < l->put.row_count; row++) {
		struct force_command c;
		char text[VALUE_STRING_MAX];

		force_get(&l->put, row, &c, text);
		force_put(&l->copy, row, &c, text);
	}
	if (!err)
		err = last_write(directory, l->setup.instance, l->copy.base, l->size);
	if (directory >= 0)
		close(directory);
	return err;
}

/* Store all up to this ticket, and let the engine know how it went. */
static void store_up_to(struct last *l, uint32_t ticket)
{
	int err = store_all(l);

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

static int make_stored_rows(struct last *l, const struct config *config)
{
	struct force_plan plan = {.text_cap = VALUE_STRING_MAX, .stored = true};
	char *memory;

	l->signals = calloc((size_t)config->item_count + 1, sizeof(*l->signals));
	l->row_of = calloc((size_t)config->item_count + 1, sizeof(*l->row_of));
	if (!l->signals || !l->row_of)
		return -ENOMEM;
	for (unsigned i = 0; i < config->item_count; i++) {
		const struct config_item *item = &config->items[i];

		if (!item->starts_last)
			continue;
		l->row_of[i] = plan.signal_count;
		l->signals[plan.signal_count++] = (struct force_signal){item->name, item->path,
		                                                        (uint8_t)item->type};
	}
	plan.signals = l->signals;
	l->size = force_size(&plan);
	memory = l->size ? calloc(1, 2 * l->size + LAST_CHECK) : NULL;
	if (!memory)
		return -ENOMEM;
	force_build(&plan, memory, &l->put);
	force_build(&plan, memory + l->size, &l->copy);
	return 0;
}

static int take_left(struct last *l, const char *data, size_t size)
{
	const struct config *config = l->setup.config;
	struct force_left left;
	int err = force_open(data, size, 0, &left);

	for (unsigned i = 0; !err && i < config->item_count; i++)
		force_keep(&left,
		           &(struct force_signal){config->items[i].name, config->items[i].path,
		                                  (uint8_t)config->items[i].type});
	for (uint32_t row = 0; !err && row < l->put.row_count; row++) {
		struct force_command c;
		char text[VALUE_STRING_MAX];

		if (!force_find(&left, &l->signals[row], &c, text, sizeof(text)) || !c.given)
			continue;
		c.stamp = 0; /* it is on the disk */
		force_put(&l->put, row, &c, text);
	}
	force_close(&left);
	return err;
}

static void read_stored(struct last *l)
{
	int directory = last_directory(l->where), err = directory < 0 ? directory : 0;
	char *data = NULL;
	size_t size;

	if (!err)
		err = last_read(directory, l->setup.instance, &data, &size);
	if (!err && data)
		err = take_left(l, data, size);
	if (err)
		log_warning(l->setup.log,
		            "outputs with Start \"last\" begin with InitValue: %s/%s.last: %s",
		            l->where, l->setup.instance,
		            err == -EBADMSG || err == -EPROTO || err == -ESTALE
		                    ? "the file is damaged"
		                    : strerror(-err));
	free(data);
	if (directory >= 0)
		close(directory);
}

int last_make(const struct last_setup *setup, struct last **last)
{
	struct last *l = calloc(1, sizeof(*l));
	int err = l ? make_stored_rows(l, setup->config) : -ENOMEM;

	*last = NULL;
	if (err || !l->put.row_count) {
		last_free(l);
		return err;
	}
	l->setup = *setup;
	l->seam = (struct engine_last){l, last_put, last_stored, last_error, last_find};
	read_stored(l);
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
	free(l->signals);
	free(l->row_of);
	free(l->put.base);
	free(l);
}
