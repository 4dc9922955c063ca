/* SPDX-License-Identifier: MIT */
/* What all that commands has in common, and the beat, the acknowledgement and the shelving. */
#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/memory/libows/alive.h"
#include "src/memory/libows/command.h"
#include "src/memory/libows/handle.h"

/* owsd takes a request in its next period; an owsd that takes longer hangs. */
#define SHELF_PATIENCE_NS (2 * NS_PER_S)

int command_allowed(const struct ows *h, uint32_t record)
{
	if (h->mode != OWS_CONTROL || h->give.base == NULL)
		return -EACCES;
	if (word_get(&give_slot(&h->give, record)->allowed) != 0)
		return 0;
	return give_is_live(&h->give) ? -EACCES : -ESTALE;
}

int command_ready(struct ows *h)
{
	if (h->mode != OWS_CONTROL || h->give.base == NULL)
		return -EACCES;
	if (handle_is_forked(h))
		return -EPERM;
	if (!give_is_live(&h->give) || !handle_alive(h, ows_now()))
		return -ESTALE;
	return handle_state(h);
}

int command_ring(struct ows *h)
{
	const uint64_t one = 1;
	int saved = errno;

	__atomic_store_n(&give_header(&h->give)->marked, 1, __ATOMIC_RELEASE);
	/*
	 * Orders the sets before both loads. The engine clears `awake`, and owsd marks the memory
	 * retired, before they look for sets.
	 */
	word_fence(__ATOMIC_SEQ_CST);
	if (word_get(&h->map.image->awake) == 0 &&
	    write(h->join.bell, &one, sizeof(one)) != sizeof(one))
		errno = saved; /* it has rung already */
	return give_is_live(&h->give) ? 0 : -ESTALE;
}

int ows_beat(struct ows *h, uint32_t period_ms)
{
	struct ows_controller_header *header = give_header(&h->give);
	int err = command_ready(h);

	if (err)
		return err;
	if (period_ms == 0)
		return -EINVAL;
	if (period_ms > OWS_BEAT_MOST_MS)
		return -ERANGE;
	word_set(&header->period_ms, period_ms);
	__atomic_fetch_add(&header->beat, 1, __ATOMIC_RELEASE);
	if (h->period_ms == period_ms)
		return 0;
	h->period_ms = period_ms;
	return command_ring(h); /* owsd is to know the promise at once */
}

/* The id of a signal that may be commanded. */
static int check_signal(struct ows *h, int id, uint32_t *record)
{
	int err;

	*record = handle_record(h, id);
	if (!*record)
		return -ENOENT;
	err = command_allowed(h, *record);
	return err ? err : command_ready(h);
}

int ows_acknowledge(struct ows *h, int id)
{
	struct ows_command_slot *slot;
	uint32_t record;
	int err = check_signal(h, id, &record);

	if (err)
		return err;
	slot = give_slot(&h->give, record);
	word_set(&slot->person, h->person);
	__atomic_fetch_add(&slot->acknowledged, 1, __ATOMIC_RELEASE);
	give_mark(&h->give, record);
	return command_ring(h);
}

/* Wait until owsd has acted on the request of that count; returns what owsd answered. */
static int await_shelf(struct ows *h, const struct ows_command_shelf *shelf, uint32_t count)
{
	int64_t until_ns = ows_now() + SHELF_PATIENCE_NS;
	int err;

	while (__atomic_load_n(&shelf->done, __ATOMIC_ACQUIRE) != count) {
		if (ows_now() >= until_ns)
			return -ETIMEDOUT;
		clock_pause(NS_PER_MS);
		if (!give_is_live(&h->give))
			return -ESTALE;
	}
	err = (int)word_get((const uint32_t *)&shelf->err);
	return err <= 0 ? err : -EPROTO;
}

int ows_shelve(struct ows *h, int id, uint32_t seconds, const char *why)
{
	struct ows_command_shelf *shelf;
	uint32_t record, count;
	int err = check_signal(h, id, &record), saved = errno;

	if (err)
		return err;
	if (why == NULL)
		why = "";
	if (strlen(why) >= OWS_TEXT)
		return -ERANGE;
	shelf = give_shelf(&h->give);
	count = word_get(&shelf->count);
	if (__atomic_load_n(&shelf->done, __ATOMIC_ACQUIRE) != count)
		return -EBUSY;
	word_set(&shelf->record, record);
	word_set(&shelf->seconds, seconds);
	word_set(&shelf->person, h->person);
	give_store_name(shelf->why, why, OWS_TEXT);
	__atomic_store_n(&shelf->count, count + 1, __ATOMIC_RELEASE);
	err = command_ring(h);
	if (!err)
		err = await_shelf(h, shelf, count + 1);
	errno = saved;
	return err;
}
