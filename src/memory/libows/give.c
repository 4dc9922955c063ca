/* SPDX-License-Identifier: MIT */
/* The memory in which a program commands: mapped, checked, and its texts written. */
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include "src/memory/libows/give.h"

#define SEALS (F_SEAL_SEAL | F_SEAL_SHRINK | F_SEAL_GROW)

static bool header_right(const struct ows_controller_header *h, const struct ows_welcome *welcome)
{
	return h->magic == OWS_CONTROLLER_MAGIC && h->major == OWS_LAYOUT_MAJOR &&
	       h->size == welcome->size && h->generation == welcome->generation &&
	       h->start_id == welcome->start_id &&
	       h->slot_size >= sizeof(struct ows_command_slot) && h->slot_size % 8 == 0 &&
	       h->slot_count != 0 && h->text_cap <= 0xffff && h->text_cap % 4 == 0 &&
	       h->dirty_words == h->slot_count / 32 + (h->slot_count % 32 != 0) &&
	       area_inside(h->size, h->slot_off, h->slot_count, h->slot_size) &&
	       area_inside(h->size, h->dirty_off, h->dirty_words, 4) &&
	       area_inside(h->size, h->place_off, h->slot_count, 4) &&
	       area_inside(h->size, h->person_off, OWS_PERSONS, OWS_NAME) &&
	       area_inside(h->size, h->shelf_off, 1, sizeof(struct ows_command_shelf)) &&
	       area_inside(h->size, h->text_off, 0, 1);
}

int give_map(int fd, const struct ows_welcome *welcome, struct give *give)
{
	struct stat st;
	int seals = fcntl(fd, F_GET_SEALS);
	void *base;

	*give = (struct give){0};
	/* Without these seals an access could raise SIGBUS */
	if (seals < 0 || (seals & SEALS) != SEALS || fstat(fd, &st) < 0 ||
	    st.st_size != (off_t)welcome->size || welcome->size < sizeof(give->header))
		return -EPROTO;
	base = mmap(NULL, welcome->size, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
	if (base == MAP_FAILED)
		return -errno;
	words_load(&give->header, base, sizeof(give->header) / 4);
	if (!header_right(&give->header, welcome)) {
		munmap(base, welcome->size);
		*give = (struct give){0};
		return -EPROTO;
	}
	give->header.serial = welcome->serial;
	give->base = base;
	return 0;
}

void give_unmap(struct give *give)
{
	if (give->base != NULL)
		munmap(give->base, give->header.size);
	*give = (struct give){0};
}

struct ows_command_text *give_text(const struct give *give, uint32_t record)
{
	const uint32_t *places = (const void *)(give->base + give->header.place_off);
	uint32_t place = word_get(&places[record]);
	size_t each = sizeof(struct ows_command_text) + give->header.text_cap;

	if (place >= (give->header.size - give->header.text_off) / each)
		return NULL;
	return (void *)(give->base + give->header.text_off + place * each);
}

void give_store_text(struct ows_command_text *to, const char *text, size_t len)
{
	word_set(&to->len, (uint32_t)len);
	words_store_text((char *)(to + 1), text, len);
	word_set(&to->check, ows_check_bytes(text, len));
}

void give_store_name(char *to, const char *text, size_t size)
{
	char whole[OWS_TEXT] = "";

	memcpy(whole, text, strnlen(text, size - 1));
	words_store(to, whole, size / 4);
}
