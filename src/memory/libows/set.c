/* SPDX-License-Identifier: MIT */
/* Sets outputs and attributes: the checks, the slot of the controller's memory, the bell. */
#include <errno.h>
#include <string.h>

#include "src/ground/signal/value.h"
#include "src/memory/libows/command.h"
#include "src/memory/libows/handle.h"
#include "src/memory/libows/set.h"

#define ON 2
#define OFF 1

static struct ows_command_slot *id_slot(const struct ows *h, const struct ows_id *id)
{
	return give_slot(&h->give, (uint32_t)id->record);
}

static void mark_id(const struct ows *h, const struct ows_id *id)
{
	give_mark(&h->give, (uint32_t)id->record);
}

/* Does the signal take sets? An output always, an input with Writable while _WriteEnable is on. */
static bool takes_sets(const struct ows *h, const struct ows_id *id, const struct ows_record *r)
{
	uint32_t seq = __atomic_load_n(&r->seq, __ATOMIC_ACQUIRE);

	if (r->flags & OWS_RECORD_OUTPUT || word_get(&id_slot(h, id)->write_enable) % 4 == ON)
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
	int err;

	if (h->mode != OWS_CONTROL || !attribute_table[e->attribute].writable)
		return -EACCES;
	if (r->flags & OWS_RECORD_NO_SET && is_of_writing((enum attribute)e->attribute))
		return -EROFS;
	err = command_allowed(h, (uint32_t)e->record);
	if (!err && e->attribute == ATTR_VALUE && !takes_sets(h, e, r))
		err = -EACCES;
	return err;
}

static enum ows_type id_type(const struct ows *h, const struct ows_id *id)
{
	return id->attribute == ATTR_VALUE
	               ? (enum ows_type)map_record(&h->map, (uint32_t)id->record)->type
	               : attribute_table[id->attribute].type;
}

/* Is the value within Min and Max? owsd checks it too; this tells the program at once. */
static int check_range(const struct ows *h, const struct ows_id *e, int64_t value)
{
	const struct ows_info_entry *info = map_info(&h->map, (uint32_t)e->record);
	double number;

	if (e->attribute != ATTR_VALUE)
		return 0;
	number = value_number(id_type(h, e), value);
	return number < info->min || number > info->max ? -ERANGE : 0; /* NaN: not set */
}

static int check_id(const struct ows *h, int id, const struct ows_id **e)
{
	if ((unsigned)id >= h->id_count || h->ids[id].record < 0)
		return -ENOENT;
	*e = &h->ids[id];
	return check_set(h, *e);
}

static uint32_t stamp_it(struct ows *h, const struct ows_id *id)
{
	h->stamp++;
	if (h->stamp == 0) /* 0 means never commanded: count past it */
		h->stamp++;
	__atomic_store_n(&id_slot(h, id)->stamp, h->stamp, __ATOMIC_RELEASE);
	return h->stamp;
}

/* Count a flag's edge: it acts when this handle sets it from off to on. */
static void count_edge(bool *level, uint32_t *counter, uint32_t step, bool on)
{
	if (on && !*level)
		__atomic_fetch_add(counter, step, __ATOMIC_RELEASE);
	*level = on;
}

static void set_enable(uint32_t *word, bool on)
{
	uint32_t count = word_get(word) / 4 + 1;

	__atomic_store_n(word, count * 4 + (on ? ON : OFF), __ATOMIC_RELEASE);
}

static void set_flag(const struct ows *h, const struct ows_id *id, bool on)
{
	struct ows_command_slot *slot = id_slot(h, id);

	if (id->attribute == ATTR_READ_ENABLE)
		set_enable(&slot->read_enable, on);
	else if (id->attribute == ATTR_WRITE_ENABLE)
		set_enable(&slot->write_enable, on);
	else if (id->attribute == ATTR_WRITE_ONE_SHOT)
		count_edge(&h->memories[id->memory].shot_level, &slot->one_shot, 1, on);
	else if (id->attribute == ATTR_READ_ONE_SHOT)
		count_edge(&h->memories[id->memory].read_level, &slot->dgn_reset, OWS_STEP_READ,
		           on);
	else
		count_edge(&h->memories[id->memory].reset_level, &slot->dgn_reset, 1, on);
}

/* Set a number, without the ring. */
static void store_number(struct ows *h, const struct ows_id *id, int64_t value, uint32_t *stamp)
{
	struct ows_command_slot *slot = id_slot(h, id);
	uint32_t got = 0;

	word_set(&slot->person, h->person);
	if (id->attribute == ATTR_VALUE) {
		__atomic_store_n((shm_double_word *)&slot->value, (uint64_t)value,
		                 __ATOMIC_RELAXED);
		got = stamp_it(h, id);
	} else {
		set_flag(h, id, value != 0);
	}
	mark_id(h, id);
	if (stamp != NULL)
		*stamp = got;
}

static int put_checked(struct ows *h, const struct ows_id *id, int64_t value, uint32_t *stamp)
{
	int err = check_range(h, id, value);

	if (!err)
		err = command_ready(h);
	if (err)
		return err;
	store_number(h, id, value, stamp);
	return command_ring(h);
}

int ows_set(struct ows *h, int id, double number, uint32_t *stamp)
{
	const struct ows_id *e;
	int64_t value;
	int err = check_id(h, id, &e);

	if (!err)
		err = value_set_double(id_type(h, e), number, &value);
	return err ? err : put_checked(h, e, value, stamp);
}

int ows_set_integer(struct ows *h, int id, int64_t number, uint32_t *stamp)
{
	const struct ows_id *e;
	int64_t value;
	int err = check_id(h, id, &e);

	if (!err)
		err = value_set_integer(id_type(h, e), number, &value);
	return err ? err : put_checked(h, e, value, stamp);
}

/* As set, or only whether each may be. */
static int many(struct ows *h, const int *ids, const double *values, int n, bool really)
{
	const struct ows_id *e;
	int64_t value;
	int err = 0;

	for (int i = 0; i < n && !err; i++) {
		err = check_id(h, ids[i], &e);
		if (!err)
			err = value_set_double(id_type(h, e), values[i], &value);
		if (!err)
			err = check_range(h, e, value);
		if (!err && really)
			store_number(h, e, value, NULL);
	}
	return err;
}

int ows_set_many(struct ows *h, const int *ids, const double *values, int n)
{
	int err = n > 0 ? command_ready(h) : 0;

	if (!err)
		err = many(h, ids, values, n, false);
	if (!err)
		err = many(h, ids, values, n, true);
	return err || n <= 0 ? err : command_ring(h);
}

static int set_string(struct ows *h, const struct ows_id *id, const char *text, uint32_t *stamp)
{
	struct ows_command_text *t;
	size_t len = strlen(text);
	uint32_t got;
	int err;

	if (len > h->give.header.text_cap)
		return -ERANGE;
	err = command_ready(h);
	if (err)
		return err;
	t = give_text(&h->give, (uint32_t)id->record);
	if (t == NULL)
		return -EPROTO;
	give_store_text(t, text, len);
	word_set(&id_slot(h, id)->person, h->person);
	got = stamp_it(h, id);
	mark_id(h, id);
	if (stamp != NULL)
		*stamp = got;
	return command_ring(h);
}

int handle_set_text(struct ows *h, const struct ows_id *e, const char *text, uint32_t *stamp)
{
	int64_t value;
	int err = check_set(h, e);

	if (err)
		return err;
	if (id_type(h, e) == OWS_STRING)
		return set_string(h, e, text, stamp);
	err = value_parse(id_type(h, e), text, &value);
	return err ? err : put_checked(h, e, value, stamp);
}

int ows_set_text(struct ows *h, int id, const char *text, uint32_t *stamp)
{
	const struct ows_id *e;
	int err = check_id(h, id, &e);

	return err ? err : handle_set_text(h, e, text, stamp);
}
