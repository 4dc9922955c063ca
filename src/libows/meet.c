/* SPDX-License-Identifier: MIT */
/*
 * How a handle becomes a controller, and gets the memory that belongs to the present image: after a
 * reload by the same connection, after a restart by another one with the token of before.
 */
#include <errno.h>
#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>

#include "src/libows/command.h"
#include "src/libows/handle.h"
#include "src/libows/map.h"
#include "src/libows/meet.h"
#include "src/libows/person.h"

/*
 * Make the page that is zero in a forked child, so that the child notices without a system call. A
 * kernel without such pages (before 4.14) leaves it as it is.
 */
static int make_mine(struct ows *h)
{
	size_t size = (size_t)sysconf(_SC_PAGESIZE);
	void *page;

	page = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
	if (page == MAP_FAILED)
		return -ENOMEM;
	madvise(page, size, MADV_WIPEONFORK);
	h->mine = page;
	word_set(h->mine, 1);
	return 0;
}

static bool fits(const struct give *give, const struct ows_map *map)
{
	return give->base != NULL && give_is_live(give) && give->slot_count == map->count &&
	       give->generation == map->image->generation && give->start_id == map->image->start_id;
}

/* Connect; nobody looks at the memory of the connection before. */
static int connect_again(struct ows *h)
{
	char name[SEGMENT_FILE];
	struct shm_place place;
	int err;

	if (h->give.base != NULL)
		word_set(&give_header(&h->give)->state, OWS_STATE_STOPPED);
	give_unmap(&h->next);
	err = place_open(h->place, &place);
	if (err)
		return err;
	err = join_begin(&h->join, place.fd, segment_file(h->instance, "control", name), h->program,
	                 h->mode == OWS_CONTROL ? OWS_HELLO_COMMAND : 0);
	place_close(&place);
	return err;
}

/* Map the memory of a welcome. One of a generation that has gone may be gone too. */
static int take_memory(struct ows *h, const struct ows_map *map, const struct ows_welcome *welcome,
                       int memory)
{
	struct give give;
	int err = give_map(memory, welcome, &give);

	close(memory);
	if (err)
		return welcome->start_id == map->image->start_id ? err : 0;
	give_unmap(&h->next);
	h->next = give;
	return 0;
}

int meet(struct ows *h, const struct ows_map *map, int64_t until_ns)
{
	bool connected = h->join.connection < 0;
	int err = h->mine == NULL ? make_mine(h) : 0;

	if (!err && connected)
		err = connect_again(h);
	while (!err) {
		bool has = fits(&h->next, map) || (!h->join.new &&fits(&h->give, map));
		struct ows_welcome welcome;
		int memory;

		/* Take all that have come, so that the last one stays */
		err = join_receive(&h->join, has ? 0 : until_ns, &welcome, &memory);
		if (err == -EAGAIN && has)
			return 0;
		if (!err)
			err = take_memory(h, map, &welcome, memory);
		else if (err == -ENOTCONN && !connected) {
			connected = true;
			err = connect_again(h);
		}
	}
	return err == -ENOTCONN ? -ENOENT : err;
}

void meet_take(struct ows *h)
{
	struct ows_controller_header *header;

	if (h->next.base == NULL)
		return;
	give_unmap(&h->give);
	h->give = h->next;
	h->next = (struct give){0};
	if (h->mode != OWS_CONTROL)
		return;
	if (person_enter(h))
		h->person = 0; /* cannot be: the places are those of before, or all are free */
	if (h->period_ms == 0)
		return;
	/* A controller that comes back beats at once, so that its commands stay in force */
	header = give_header(&h->give);
	word_set(&header->period_ms, h->period_ms);
	__atomic_fetch_add(&header->beat, 1, __ATOMIC_RELEASE);
	command_ring(h);
}

void meet_leave(struct ows *h)
{
	if (h->give.base != NULL && !handle_is_forked(h))
		__atomic_store_n(&give_header(&h->give)->goodbye, 1, __ATOMIC_RELEASE);
	join_end(&h->join);
	give_unmap(&h->next);
	give_unmap(&h->give);
	if (h->mine != NULL)
		munmap(h->mine, (size_t)sysconf(_SC_PAGESIZE));
	h->mine = NULL;
}
