/* SPDX-License-Identifier: MIT */
/*
 * How a handle becomes a controller, and gets the memory that belongs to the present image: after a
 * reload by the same connection, after a restart by another one with the token of before.
 */
#include <errno.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "src/memory/libows/alive.h"
#include "src/memory/libows/command.h"
#include "src/memory/libows/handle.h"
#include "src/memory/libows/meet.h"

/* --- Persons for whom a program commands ----------------------------------------------------- */

static bool is_marked(const struct give *give, uint32_t record)
{
	return word_get(give_dirty(give, record)) & 1u << record % 32;
}

/* The persons of commands that owsd has not looked at yet, a bit for each. */
static uint32_t in_use(const struct give *give)
{
	const struct ows_command_shelf *shelf = give_shelf(give);
	uint32_t used = 0;

	for (uint32_t i = 0; i < give->header.slot_count; i++) {
		const struct ows_command_slot *slot = give_slot(give, i);
		uint32_t person = word_get(&slot->person);

		if (person != 0 && person <= OWS_PERSONS &&
		    (is_marked(give, i) || word_get(&slot->taken) != word_get(&slot->stamp)))
			used |= 1u << (person - 1);
	}
	if (word_get(&shelf->count) != word_get(&shelf->done) && word_get(&shelf->person) != 0)
		used |= 1u << (word_get(&shelf->person) - 1) % OWS_PERSONS;
	return used;
}

/* The slot of a person, -1: there is none. */
static int person_find(const struct give *give, const char name[OWS_NAME])
{
	for (uint32_t i = 0; i < OWS_PERSONS; i++)
		if (memcmp(give_person(give, i), name, OWS_NAME) == 0)
			return (int)i;
	return -1;
}

/* The slot where the next person is entered, -1: owsd has still to look at the commands of all. */
static int next_slot(struct ows *h)
{
	static const char no_name[OWS_NAME];
	int slot = person_find(&h->give, no_name);
	uint32_t used;

	if (slot >= 0)
		return slot;
	used = in_use(&h->give);
	for (uint32_t i = 0; i < OWS_PERSONS; i++) {
		uint32_t next = (h->next_person + i) % OWS_PERSONS;

		if (!(used & 1u << next)) {
			h->next_person = next + 1;
			return (int)next;
		}
	}
	return -1;
}

/* Enter the handle's person into its memory. Returns 0, or -EBUSY: all slots are in use. */
static int person_enter(struct ows *h)
{
	int slot;

	h->person = 0;
	if (h->person_name[0] == '\0')
		return 0;
	slot = person_find(&h->give, h->person_name);
	if (slot < 0) {
		slot = next_slot(h);
		if (slot < 0)
			return -EBUSY;
		give_store_name(give_person(&h->give, (uint32_t)slot), h->person_name, OWS_NAME);
	}
	h->person = (uint32_t)slot + 1;
	return 0;
}

int ows_for(struct ows *h, const char *person)
{
	char before[OWS_NAME];
	uint32_t slot_before = h->person;
	size_t len = person ? strlen(person) : 0;
	int err;

	if (h->mode != OWS_CONTROL)
		return -EACCES;
	if (handle_is_forked(h))
		return -EPERM;
	if (len >= OWS_NAME)
		return -ERANGE;
	memcpy(before, h->person_name, sizeof(before));
	memset(h->person_name, 0, sizeof(h->person_name));
	memcpy(h->person_name, person ? person : "", len);
	err = person_enter(h);
	if (err) {
		memcpy(h->person_name, before, sizeof(before));
		h->person = slot_before;
	}
	return err;
}

/* --- The memory of a controller -------------------------------------------------------------- */

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

static bool fits_image(const struct give *give, const struct ows_map *map)
{
	return give->base != NULL && give_is_live(give) && give->header.slot_count == map->count &&
	       give->header.generation == map->image->generation &&
	       give->header.start_id == map->image->start_id;
}

/* Connect; owsd no longer looks at the memory of the connection before. */
static int connect_again(struct ows *h, const struct ows_map *map)
{
	char name[SEGMENT_FILE];
	struct shm_dir dir;
	int err;

	if (h->give.base != NULL)
		word_set(&give_header(&h->give)->state, OWS_STATE_STOPPED);
	give_unmap(&h->next);
	h->joined_ns = map->image->start_ns;
	err = dir_open(h->dir, &dir);
	if (err)
		return err;
	err = join_begin(&h->join, dir.fd, segment_file(h->instance, "control", name), h->program,
	                 h->mode == OWS_CONTROL ? OWS_HELLO_COMMAND : 0);
	dir_close(&dir);
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

/*
 * A welcome after a reload takes milliseconds. It is lost if owsd-porter is killed that moment: end
 * the connection, so that the next call connects as the same controller.
 */
static void give_up_lost(struct ows *h)
{
	int64_t now_ns = ows_now();

	if (!h->awaited_ns)
		h->awaited_ns = now_ns;
	if (handle_age(now_ns, h->awaited_ns) < ALIVE_LEAST_NS)
		return;
	h->awaited_ns = 0;
	join_end(&h->join);
}

int meet(struct ows *h, const struct ows_map *map, int64_t until_ns)
{
	/* An owsd that was killed with a thread stuck in the kernel hangs up on nobody */
	bool connected = h->join.connection < 0 || h->joined_ns != map->image->start_ns;
	int err = h->mine == NULL ? make_mine(h) : 0;

	if (!err && connected)
		err = connect_again(h, map);
	while (!err) {
		bool has = fits_image(&h->next, map) || (!h->join.new &&fits_image(&h->give, map));
		struct ows_welcome welcome;
		int memory;

		/* Take all that have come, so that the last one stays */
		err = join_receive(&h->join, has ? 0 : until_ns, &welcome, &memory);
		if (err == -EAGAIN && has) {
			h->awaited_ns = 0;
			return 0;
		}
		if (!err)
			err = take_memory(h, map, &welcome, memory);
		else if (err == -ENOTCONN && !connected) {
			connected = true;
			err = connect_again(h, map);
		}
	}
	if (err == -EAGAIN && !h->join.new)
		give_up_lost(h);
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
		h->person = 0; /* cannot be: the slots are those of before, or all are free */
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
	join_leave(&h->join);
	give_unmap(&h->next);
	give_unmap(&h->give);
	if (h->mine != NULL)
		munmap(h->mine, (size_t)sysconf(_SC_PAGESIZE));
	h->mine = NULL;
}
