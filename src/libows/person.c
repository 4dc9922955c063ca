/* SPDX-License-Identifier: MIT */
/* For whom a program commands: the names of persons in the controller's memory. */
#include <errno.h>
#include <string.h>

#include "src/libows/command.h"
#include "src/libows/handle.h"
#include "src/libows/person.h"

static bool is_marked(const struct give *give, uint32_t record)
{
	return word_get(give_dirty(give, record)) & 1u << record % 32;
}

/* The persons of commands that owsd has not looked at yet, a bit for each. */
static uint32_t in_use(const struct give *give)
{
	const struct ows_command_shelf *shelf = give_shelf(give);
	uint32_t used = 0;

	for (uint32_t i = 0; i < give->slot_count; i++) {
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

/* The place of a person, -1: of none. */
static int person_find(const struct give *give, const char name[OWS_NAME])
{
	for (uint32_t i = 0; i < OWS_PERSONS; i++)
		if (memcmp(give_person(give, i), name, OWS_NAME) == 0)
			return (int)i;
	return -1;
}

/* The place of the person who is replaced next, -1: owsd has still to look at all. */
static int next_place(struct ows *h)
{
	static const char nobody[OWS_NAME];
	int place = person_find(&h->give, nobody);
	uint32_t used;

	if (place >= 0)
		return place;
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

int person_enter(struct ows *h)
{
	int place;

	h->person = 0;
	if (h->person_name[0] == '\0')
		return 0;
	place = person_find(&h->give, h->person_name);
	if (place < 0) {
		place = next_place(h);
		if (place < 0)
			return -EBUSY;
		give_store_name(give_person(&h->give, (uint32_t)place), h->person_name, OWS_NAME);
	}
	h->person = (uint32_t)place + 1;
	return 0;
}

int ows_for(struct ows *h, const char *person)
{
	char before[OWS_NAME];
	uint32_t place_before = h->person;
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
		h->person = place_before;
	}
	return err;
}
