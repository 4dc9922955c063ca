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

/* Entries of the image with 16 bytes more each, and a field more behind the header's. */
static uint32_t move(char *to, uint32_t at, uint32_t *off, uint32_t *size, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		memcpy(to + at + i * (*size + 16), image_memory + *off + i * *size, *size);
		memset(to + at + i * (*size + 16) + *size, 0xa5, 16);
	}
	*off = at;
	*size += 16;
	return at + count * *size;
}

static void show_larger_entries(uint16_t minor)
{
	static _Alignas(64) char larger[2 * SIZE_MAX_];
	struct ows_image_header *h = (void *)larger;
	uint32_t at = ((const struct ows_image_header *)(const void *)image_memory)->size;

	memcpy(larger, image_memory, at);
	memset(larger + h->record_off, 0x5a, h->text_off - h->record_off);
	memcpy(larger + h->name_off, image_memory + h->name_off, h->record_count * 8);
	h->minor = minor;
	at = move(larger, at, &h->record_off, &h->record_size, h->record_count);
	at = move(larger, at, &h->info_off, &h->info_size, h->record_count);
	at = move(larger, at, &h->target_off, &h->target_size, h->target_count);
	at = move(larger, at, &h->counter_off, &h->counter_size, h->counter_count);
	at = move(larger, at, &h->alarm_off, &h->alarm_size, h->alarm_count);
	h->size = at;
	show("image", larger, at);
}

static void test_readers_take_a_later_minor_version_with_larger_entries(void)
{
	struct ows *h;

	show_larger_entries(OWS_LAYOUT_MINOR + 1);
	TEST_ASSERT_EQUAL(0, ows_open(instance, OWS_CONTROL, &h));
	check_all(h);
	ows_close(h);
	TEST_ASSERT_EQUAL_STRING(
		"-21.0625 " LONG_TEXT " /23.000000000002/memory i2c:/dev/i2c-1 30.5\n",
		python("s = ows.Ows(sys.argv[1], control=True)\n"
	               "print(s.get(\"room.temperature\").value, s.get(\"label\").value,"
	               " s.info(\"empty\").path, list(s.targets())[1].name, list(s.alarms())[1].before)\n"));
}

static void test_readers_refuse_entries_that_are_too_small_or_not_aligned(void)
{
	struct ows_image_header *header = (void *)image_memory;
	uint32_t *const sizes[] = {&header->record_size, &header->info_size, &header->target_size,
	                           &header->counter_size, &header->alarm_size};
	struct ows *h;

	for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
		uint32_t size = *sizes[i];

		*sizes[i] = size - 8;
		show("image", image_memory, header->size);
		TEST_ASSERT_EQUAL(-EPROTO, ows_open(instance, OWS_READ, &h));
		*sizes[i] = size + 4;
		show("image", image_memory, header->size);
		TEST_ASSERT_EQUAL(-EPROTO, ows_open(instance, OWS_READ, &h));
		*sizes[i] = size;
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
	((struct ows_image_header *)(void *)image_memory)->major--;
	show("image", image_memory, ((struct ows_image_header *)(void *)image_memory)->size);
	((struct ows_command_header *)(void *)command_memory)->major++;
	show("command", command_memory,
	     ((struct ows_command_header *)(void *)command_memory)->size);
	TEST_ASSERT_EQUAL(-EPROTO, ows_open(instance, OWS_CONTROL, &h));
	TEST_ASSERT_EQUAL_STRING("71\n", python("try: ows.Ows(sys.argv[1], control=True)\n"
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
