/* SPDX-License-Identifier: MIT */
/* What today's readers do with the layouts of releases to come, made of the recorded one. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/recorded_readers.h"
#include "tests/unit/aid/recording.h"

void setUp(void)
{
	recording_begin();
}

void tearDown(void)
{
	recording_end();
}

static struct ows_area_entry *areas_of(char *memory)
{
	return (void *)(memory + ((const struct ows_image_header *)(void *)memory)->area_off);
}

/* The area with 16 bytes more in each entry, at another place; returns where it ends. */
static uint32_t move(char *to, uint32_t at, struct ows_area_entry *area)
{
	uint32_t size = area->size + 16;

	for (uint32_t i = 0; i < area->count; i++) {
		memcpy(to + at + i * size, image_memory + area->off + i * area->size, area->size);
		memset(to + at + i * size + area->size, 0xa5, 16);
	}
	memset(to + area->off, 0x5a, area->size * area->count);
	area->off = at;
	area->size = size;
	return at + area->count * size;
}

/* All entries larger, and the directory elsewhere, with an area of a kind to come in front. */
static void show_larger_entries(uint16_t minor)
{
	static _Alignas(64) char larger[2 * SIZE_MAX_];
	struct ows_image_header *h = (void *)larger;
	struct ows_area_entry *areas;
	uint32_t at = ((const struct ows_image_header *)(const void *)image_memory)->size;

	memcpy(larger, image_memory, at);
	areas = (void *)(larger + at);
	areas[0] = (struct ows_area_entry){OWS_AREAS, at, 12, 0x7fffffff};
	memcpy(&areas[1], areas_of(larger), h->area_count * sizeof(*areas));
	memset(larger + h->area_off, 0x5a, h->area_count * sizeof(*areas));
	h->minor = minor;
	h->area_off = at;
	h->area_count++;
	at += h->area_count * (uint32_t)sizeof(*areas);
	for (uint32_t i = 1; i < h->area_count; i++)
		if (areas[i].size != 1)
			at = move(larger, at, &areas[i]);
	h->size = at;
	show("image", larger, at);
}

static void test_readers_take_a_later_minor_version_with_larger_entries(void)
{
	struct ows *h;

	show_larger_entries(OWS_LAYOUT_MINOR + 1);
	TEST_ASSERT_EQUAL(0, ows_open(instance, OWS_READ, &h));
	check_all(h);
	ows_close(h);
	TEST_ASSERT_EQUAL_STRING(
		"-21.0625 " LONG_TEXT " /23.000000000002/memory i2c:/dev/i2c-1 30.5\n",
		python("s = ows.Ows(sys.argv[1])\n"
	               "print(s.get(\"room.temperature\").value, s.get(\"label\").value,"
	               " s.info(\"empty\").path, list(s.targets())[1].name, list(s.alarms())[1].before)\n"));
}

static void test_readers_refuse_entries_that_are_too_small_or_not_aligned(void)
{
	const struct ows_image_header *header = (const void *)image_memory;
	struct ows_area_entry *areas = areas_of(image_memory);
	struct ows *h;

	for (uint32_t i = 0; i < header->area_count; i++) {
		uint32_t size = areas[i].size;

		areas[i].size = size - (size == 1 ? 1 : 8);
		show("image", image_memory, header->size);
		TEST_ASSERT_EQUAL(-EPROTO, ows_open(instance, OWS_READ, &h));
		areas[i].size = size + 4;
		show("image", image_memory, header->size);
		TEST_ASSERT_EQUAL(-EPROTO, ows_open(instance, OWS_READ, &h));
		areas[i].size = size;
	}
}

static void test_readers_refuse_a_later_major_version(void)
{
	struct ows *h;

	((struct ows_image_header *)(void *)image_memory)->major++;
	show("image", image_memory, ((struct ows_image_header *)(void *)image_memory)->size);
	TEST_ASSERT_EQUAL(-EPROTO, ows_open(instance, OWS_READ, &h));
	TEST_ASSERT_EQUAL_STRING("71\n", python("try: ows.Ows(sys.argv[1])\n"
	                                        "except OSError as e: print(e.errno)\n"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_readers_take_a_later_minor_version_with_larger_entries);
	RUN_TEST(test_readers_refuse_entries_that_are_too_small_or_not_aligned);
	RUN_TEST(test_readers_refuse_a_later_major_version);
	return UNITY_END();
}
