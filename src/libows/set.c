/* SPDX-License-Identifier: MIT */
/* Sets outputs and attributes: the checks, the slot of the command segment, the bell. */
#include <errno.h>
#include <string.h>

#include "src/libows/handle.h"
#include "src/libows/orphan.h"
#include "src/libows/set.h"
#include "src/shm/futex.h"
#include "src/shm/word.h"
#include "src/signal/value.h"

#define ON 2
#define OFF 1

static struct ows_command_slot *slot_of(const struct ows *h, const struct ows_id *id)
{
	return &h->map.slots[id->record];
}

static void mark(const struct ows *h, const struct ows_id *id)
{
	__atomic_fetch_or(&h->map.dirty[id->record / 32], 1u << id->record % 32, __ATOMIC_RELEASE);
}

/* Does an owsd read this segment? Not if owsd has stopped or the segment was replaced. */
static bool is_live(const struct ows *h)
{
	return word_get(&h->map.command->state) == OWS_STATE_LIVE;
}

static int command_state(struct ows *h)
{
	return is_live(h) ? handle_orphan(h, ows_now()) : -ESTALE;
}

/*
 * Wake the engine unless it is awake, and return whether owsd still reads this segment. The fence
 * orders the sets before both loads; the engine clears its awake flag, and owsd marks the segment
 * retired, before they look for sets.
 */
static int ring_engine(struct ows *h)
{
	struct ows_command_header *command = h->map.command;

	__atomic_fetch_add(&command->bell, 1, __ATOMIC_SEQ_CST);
	word_fence(__ATOMIC_SEQ_CST);
	if (word_get(&command->awake) == 0)
		segment_wake(&command->bell, 1);
	return command_state(h);
}

/*
 * This program's client number for a slot; 0 without a place, or if owsd has dropped the program.
 */
static uint32_t giver(const struct ows *h)
{
	if (h->client < 0 || word_get(&h->map.clients[h->client].pid) != h->pid)
		return 0;
	return (uint32_t)h->client + 1;
}

static uint32_t stamp_it(const struct ows *h, const struct ows_id *id)
{
	struct ows_command_slot *slot = slot_of(h, id);
	uint32_t stamp;

	word_set(&slot->client, giver(h));
	stamp = __atomic_add_fetch(&slot->stamp, 1, __ATOMIC_RELEASE);
	if (stamp == 0) /* 0 means never commanded: count past it */
		stamp = __atomic_add_fetch(&slot->stamp, 1, __ATOMIC_RELEASE);
	mark(h, id);
	return stamp;
}

/* Does the signal take sets? An output always, an input with Writable while _WriteEnable is on. */
static bool takes_sets(const struct ows *h, const struct ows_id *id, const struct ows_record *r)
{
	uint32_t seq = __atomic_load_n(&r->seq, __ATOMIC_ACQUIRE);

	if (r->flags & OWS_RECORD_OUTPUT || word_get(&slot_of(h, id)->write_enable) == ON)
		return true;
	return word_get(&r->slot[seq >> 1 & 1].attrs.flags) & OWS_ATTR_WRITE_ENABLE;
}

static bool is_of_writing(enum attribute attribute)
{
	return attribute == ATTR_VALUE || attribute == ATTR_WRITE_ENABLE ||
	       attribute == ATTR_WRITE_ONE_SHOT;
}

/* Errors for the program that sets; owsd itself ignores every set that is refused here. */
static int check_set(const struct ows *h, const struct ows_id *e)
{
	const struct ows_record *r = map_record(&h->map, (uint32_t)e->record);

	if (h->map.command == NULL || !attribute_table[e->attribute].writable)
		return -EACCES;
	if (r->flags & OWS_RECORD_NO_SET && is_of_writing((enum attribute)e->attribute))
		return -EROFS;
	if (e->attribute == ATTR_VALUE && !takes_sets(h, e, r))
		return -EACCES;
	return is_live(h) ? 0 : -ESTALE;
}

static int check_id(const struct ows *h, int id, const struct ows_id **e)
{
	if ((unsigned)id >= h->id_count || h->ids[id].record < 0)
		return -ENOENT;
	*e = &h->ids[id];
	return check_set(h, *e);
}

static enum ows_type type_of(const struct ows *h, const struct ows_id *id)
{
	return id->attribute == ATTR_VALUE
	               ? (enum ows_type)map_record(&h->map, (uint32_t)id->record)->type
	               : attribute_table[id->attribute].type;
}

/* Count a flag's edge: it acts when this handle sets it from off to on. */
static void count_edge(const struct ows *h, const struct ows_id *id, bool *level, uint32_t *counter,
                       bool on)
{
	if (on && !*level) {
		__atomic_fetch_add(counter, 1, __ATOMIC_RELEASE);
		mark(h, id);
	}
	*level = on;
}

static void set_flag(const struct ows *h, const struct ows_id *id, bool on)
{
	struct ows_command_slot *slot = slot_of(h, id);

	if (id->attribute == ATTR_READ_ENABLE || id->attribute == ATTR_WRITE_ENABLE) {
		word_set(id->attribute == ATTR_READ_ENABLE ? &slot->read_enable
		                                           : &slot->write_enable,
		         on ? ON : OFF);
		mark(h, id);
	} else if (id->attribute == ATTR_WRITE_ONE_SHOT) {
		count_edge(h, id, &h->memories[id->memory].shot_level, &slot->one_shot, on);
	} else {
		count_edge(h, id, &h->memories[id->memory].reset_level, &slot->dgn_reset, on);
	}
}

/* Set a number, without the ring. */
static void put_number(const struct ows *h, const struct ows_id *id, int64_t value, uint32_t *stamp)
{
	uint32_t got = 0;

	if (id->attribute == ATTR_VALUE) {
		__atomic_store_n((shm_double_word *)&slot_of(h, id)->value, (uint64_t)value,
		                 __ATOMIC_RELAXED);
		got = stamp_it(h, id);
	} else {
		set_flag(h, id, value != 0);
	}
	if (stamp != NULL)
		*stamp = got;
}

int ows_set(struct ows *h, int id, double number, uint32_t *stamp)
{
	const struct ows_id *e;
	int64_t value;
	int err = check_id(h, id, &e);

	if (!err)
		err = value_set_double(type_of(h, e), number, &value);
	if (err)
		return err;
	put_number(h, e, value, stamp);
	return ring_engine(h);
}

int ows_set_integer(struct ows *h, int id, int64_t number, uint32_t *stamp)
{
	const struct ows_id *e;
	int64_t value;
	int err = check_id(h, id, &e);

	if (!err)
		err = value_set_integer(type_of(h, e), number, &value);
	if (err)
		return err;
	put_number(h, e, value, stamp);
	return ring_engine(h);
}

int ows_set_many(struct ows *h, const int *ids, const double *values, int n)
{
	const struct ows_id *e;
	int done, err = 0, rung;
	int64_t value;

	for (done = 0; done < n; done++) {
		err = check_id(h, ids[done], &e);
		if (!err)
			err = value_set_double(type_of(h, e), values[done], &value);
		if (err)
			break;
		put_number(h, e, value, NULL);
	}
	if (done == 0)
		return err;
	rung = ring_engine(h);
	return rung ? rung : done;
}

static void store_text(char *to, const char *text, size_t len)
{
	for (size_t i = 0; i < len; i += 4) {
		uint32_t word = 0;

		memcpy(&word, text + i, len - i < 4 ? len - i : 4);
		words_store(to + i, &word, 1);
	}
}

static int set_string(struct ows *h, const struct ows_id *id, const char *text, uint32_t *stamp)
{
	size_t len = strlen(text), size = h->map.command_size;
	uint32_t off = word_get(&h->map.entries[id->record].text_off), free_claim = 0, mine, got;
	struct ows_command_text *t;

	if (len > h->map.text_cap)
		return -ERANGE;
	/* Another consumer may have overwritten the offset: check it */
	if (off == 0 || off % 4 != 0 || off > size || sizeof(*t) + h->map.text_cap > size - off)
		return -EPROTO;
	t = (void *)(h->map.command_base + off);
	mine = h->pid;
	if (!__atomic_compare_exchange_n(&t->claim, &free_claim, mine, false, __ATOMIC_ACQUIRE,
	                                 __ATOMIC_RELAXED))
		return -EBUSY;
	word_set(&t->len, (uint32_t)len);
	store_text((char *)(t + 1), text, len);
	word_set(&t->check, ows_check_bytes(text, len));
	/* Release the claim, unless owsd has taken it away because it lasted too long */
	__atomic_compare_exchange_n(&t->claim, &mine, 0, false, __ATOMIC_RELEASE, __ATOMIC_RELAXED);
	got = stamp_it(h, id);
	if (stamp != NULL)
		*stamp = got;
	return ring_engine(h);
}

int handle_set_text(struct ows *h, const struct ows_id *e, const char *text, uint32_t *stamp)
{
	int64_t value;
	int err = check_set(h, e);

	if (err)
		return err;
	if (type_of(h, e) == OWS_STRING)
		return set_string(h, e, text, stamp);
	err = value_parse(type_of(h, e), text, &value);
	if (err)
		return err;
	put_number(h, e, value, stamp);
	return ring_engine(h);
}

int ows_set_text(struct ows *h, int id, const char *text, uint32_t *stamp)
{
	const struct ows_id *e;
	int err = check_id(h, id, &e);

	return err ? err : handle_set_text(h, e, text, stamp);
}

int ows_acknowledge(struct ows *h, int id)
{
	const struct ows_id *e;

	if ((unsigned)id >= h->id_count || h->ids[id].record <= 0)
		return -ENOENT;
	e = &h->ids[id];
	if (h->map.command == NULL)
		return -EACCES;
	if (h->map.acks == NULL)
		return -EOPNOTSUPP;
	if (!is_live(h))
		return -ESTALE;
	__atomic_fetch_add(&h->map.acks[e->record], 1, __ATOMIC_RELEASE);
	mark(h, e);
	return ring_engine(h);
}

static int take_client(struct ows *h)
{
	for (int i = 0; i < OWS_CLIENTS; i++) {
		uint32_t none = 0;

		if (__atomic_compare_exchange_n(&h->map.clients[i].pid, &none, h->pid, false,
		                                __ATOMIC_ACQ_REL, __ATOMIC_RELAXED)) {
			h->client = i;
			return 0;
		}
	}
	return -ENOSPC;
}

int ows_beat(struct ows *h, uint32_t period_ms)
{
	struct ows_client *client;
	int err;

	if (h->map.command == NULL)
		return -EACCES;
	if (period_ms == 0)
		return -EINVAL;
	/* owsd drops a client that was silent for too long */
	if (h->client >= 0 && word_get(&h->map.clients[h->client].pid) != h->pid)
		h->client = -1;
	if (h->client < 0) {
		err = take_client(h);
		if (err)
			return err;
	}
	client = &h->map.clients[h->client];
	word_set(&client->period_ms, period_ms);
	__atomic_fetch_add(&client->beat, 1, __ATOMIC_RELEASE);
	return command_state(h);
}
