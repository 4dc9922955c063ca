/* SPDX-License-Identifier: MIT */
/* The memory in which a program commands: mapped, checked, and its texts written. */
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include "src/memory/libows/give.h"

#define SEALS (F_SEAL_SEAL | F_SEAL_SHRINK | F_SEAL_GROW)

static int check_memory(const struct ows_welcome *welcome, struct give *give)
{
	struct ows_controller_header h = {0};

	words_load(&h, give->base, sizeof(h) / 4);
	if (h.magic != OWS_CONTROLLER_MAGIC || h.major != OWS_LAYOUT_MAJOR ||
	    h.size != give->size || h.generation != welcome->generation ||
	    h.start_id != welcome->start_id || h.slot_size < sizeof(struct ows_command_slot) ||
	    h.slot_size % 8 != 0 || h.slot_count == 0 || h.text_cap > 0xffff ||
	    h.text_cap % 4 != 0 || h.dirty_words != h.slot_count / 32 + (h.slot_count % 32 != 0))
		return -EPROTO;
	if (!area_inside(give->size, h.slot_off, h.slot_count, h.slot_size) ||
	    !area_inside(give->size, h.dirty_off, h.dirty_words, 4) ||
	    !area_inside(give->size, h.place_off, h.slot_count, 4) ||
	    !area_inside(give->size, h.person_off, OWS_PERSONS, OWS_NAME) ||
	    !area_inside(give->size, h.shelf_off, 1, sizeof(struct ows_command_shelf)) ||
	    !area_inside(give->size, h.text_off, 0, 1))
		return -EPROTO;
	give->generation = h.generation;
	give->start_id = h.start_id;
	give->serial = welcome->serial;
	give->slot_off = h.slot_off;
	give->slot_size = h.slot_size;
	give->slot_count = h.slot_count;
	give->dirty_off = h.dirty_off;
	give->text_off = h.text_off;
	give->text_cap = h.text_cap;
	give->place_off = h.place_off;
	give->person_off = h.person_off;
	give->shelf_off = h.shelf_off;
	return 0;
}

int give_map(int fd, const struct ows_welcome *welcome, struct give *give)
{
	struct stat st;
	int seals = fcntl(fd, F_GET_SEALS), err;
	void *base;

	*give = (struct give){0};
	/* Without these seals an access could raise SIGBUS */
	if (seals < 0 || (seals & SEALS) != SEALS || fstat(fd, &st) < 0 ||
	    st.st_size != (off_t)welcome->size ||
	    welcome->size < sizeof(struct ows_controller_header))
		return -EPROTO;
	base = mmap(NULL, welcome->size, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
	if (base == MAP_FAILED)
		return -errno;
	give->base = base;
	give->size = welcome->size;
	err = check_memory(welcome, give);
	if (err)
		give_unmap(give);
	return err;
}

void give_unmap(struct give *give)
{
	if (give->base != NULL)
		munmap(give->base, give->size);
	*give = (struct give){0};
}

struct ows_command_text *give_text(const struct give *give, uint32_t record)
{
	const uint32_t *places = (const void *)(give->base + give->place_off);
	uint32_t place = word_get(&places[record]);
	size_t each = sizeof(struct ows_command_text) + give->text_cap;

	if (place >= (give->size - give->text_off) / each)
		return NULL;
	return (void *)(give->base + give->text_off + place * each);
}

static void store_bytes(char *to, const char *text, size_t len)
{
	for (size_t i = 0; i < len; i += 4) {
		uint32_t word = 0;

		memcpy(&word, text + i, len - i < 4 ? len - i : 4);
		words_store(to + i, &word, 1);
	}
}

void give_store_text(struct ows_command_text *to, const char *text, size_t len)
{
	word_set(&to->len, (uint32_t)len);
	store_bytes((char *)(to + 1), text, len);
	word_set(&to->check, ows_check_bytes(text, len));
}

void give_store_name(char *to, const char *text, size_t size)
{
	size_t len = strnlen(text, size - 1), whole = (len + 3) / 4 * 4;
	const uint32_t nothing = 0;

	store_bytes(to, text, len);
	for (size_t i = whole; i < size; i += 4)
		words_store(to + i, &nothing, 1);
}
