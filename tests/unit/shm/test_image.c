/* SPDX-License-Identifier: MIT */
/* Tests of the image: its layout, and states that are whole wherever a write breaks off. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/libows/ows.h"
#include "src/shm/image.h"
#include "src/shm/reader.h"

static void *memory;
static struct image image;

void setUp(void)
{
	memory = NULL;
}

void tearDown(void)
{
	free(memory);
}

static void build(const struct image_plan *plan)
{
	size_t size = image_size(plan);

	TEST_ASSERT_NOT_EQUAL(0, size);
	TEST_ASSERT_EQUAL(0, size % 64);
	memory = aligned_alloc(64, size);
	TEST_ASSERT_NOT_NULL(memory);
	memset(memory, 0, size);
	image_build(plan, memory, &image);
	TEST_ASSERT_EQUAL(size, image.header->size);
}

static void build_two(void)
{
	static const struct image_signal signals[] = {
		{.name = "n", .path = "/28.1/t", .type = OWS_DOUBLE},
		{.name = "s", .path = "/23.1/m", .type = OWS_STRING, .text_cap = 8},
	};
	static const struct image_plan plan = {.signals = signals, .signal_count = 2};

	build(&plan);
}

static void test_an_image_without_signals_has_owsd_in_it(void)
{
	static const struct image_plan plan = {0};

	build(&plan);
	TEST_ASSERT_EQUAL(1, image.header->record_count);
	TEST_ASSERT_EQUAL(OWS_LARGE, image.records[0].type);
	TEST_ASSERT_EQUAL(OWS_STATE_BUILDING, image.header->state);
}

static void test_an_image_beyond_two_gigabytes_is_refused(void)
{
	static char huge[1] = "";
	struct image_signal *signals = calloc(60000, sizeof(*signals));
	struct image_plan plan = {.signals = signals, .signal_count = 60000};

	TEST_ASSERT_NOT_NULL(signals);
	for (int i = 0; i < 60000; i++)
		signals[i] = (struct image_signal){.name = huge, .path = huge, .text_cap = 65532};
	TEST_ASSERT_EQUAL(0, image_size(&plan));
	free(signals);
}

static void test_names_are_sorted_by_bytes_shorter_first(void)
{
	enum { N = 300 };
	static char names[N][8];
	static struct image_signal signals[N];
	struct image_plan plan = {.signals = signals, .signal_count = N};
	const struct ows_name_entry *entry;
	unsigned seen = 0;

	for (unsigned i = 0; i < N; i++) {
		snprintf(names[i], sizeof(names[i]), "%x", i * 7919 % 4096);
		if (i % 50 == 0)
			snprintf(names[i], sizeof(names[i]), "\xc3\xa9%u", i);
		signals[i] = (struct image_signal){
			.name = names[i], .path = "/p", .type = OWS_BYTE};
	}
	build(&plan);
	entry = (const void *)(image.base + image.header->name_off);
	for (unsigned i = 0; i <= N; i++) {
		seen += entry[i].record;
		if (i > 0)
			TEST_ASSERT_LESS_THAN(0, strcmp(image.base + entry[i - 1].name_off,
			                                image.base + entry[i].name_off));
		if (entry[i].record > 0)
			TEST_ASSERT_EQUAL_STRING(names[entry[i].record - 1],
			                         image.base + entry[i].name_off);
	}
	TEST_ASSERT_EQUAL(N * (N + 1) / 2, seen);
}

static void test_areas_do_not_overlap(void)
{
	static const struct image_signal signals[] = {
		{.name = "a", .path = "/p", .type = OWS_STRING, .text_cap = 4},
		{.name = "b", .path = "/p", .type = OWS_STRING, .text_cap = 12},
	};
	static const char *const targets[] = {"t"};
	static const struct image_counter counters[] = {{"c", 0}};
	static const struct image_plan plan = {signals, 2,        targets, 1,
	                                       NULL,    counters, 1,       .period_ns = 1};
	const struct ows_image_header *h;

	build(&plan);
	h = image.header;
	TEST_ASSERT_EQUAL(256, h->record_off);
	TEST_ASSERT_EQUAL(h->record_off + 3 * 256, h->info_off);
	TEST_ASSERT_EQUAL(h->info_off + 3 * 64, h->name_off);
	TEST_ASSERT_GREATER_OR_EQUAL(h->name_off + 3 * 8, h->target_off);
	TEST_ASSERT_GREATER_OR_EQUAL(h->target_off + 128, h->counter_off);
	TEST_ASSERT_GREATER_OR_EQUAL(h->counter_off + 64, h->alarm_off);
	TEST_ASSERT_EQUAL(OWS_ALARMS, h->alarm_count);
	TEST_ASSERT_GREATER_OR_EQUAL(h->alarm_off + OWS_ALARMS * 64, h->text_off);
	TEST_ASSERT_EQUAL(2 * 4 + 2 * 12, h->text_size);
	TEST_ASSERT_EQUAL(image.records[1].text_off + 8, image.records[2].text_off);
	TEST_ASSERT_GREATER_OR_EQUAL(h->text_off + h->text_size, h->pool_off);
	TEST_ASSERT_EQUAL(h->size, h->pool_off + h->pool_size);
	TEST_ASSERT_EQUAL('\0', image.base[h->size - 1]);
}

static void test_each_state_goes_to_the_other_slot(void)
{
	struct ows_sample sample = {0};
	struct ows_attrs attrs = {0};
	struct ows_slot slot;

	build_two();
	for (uint32_t n = 1; n < 6; n++) {
		sample.value = n;
		attrs.transactions = n;
		image_publish(&image, 1, &sample, &attrs, NULL);
		TEST_ASSERT_EQUAL(2 * n, image.records[1].seq);
		TEST_ASSERT_EQUAL_INT64(n, image.records[1].slot[n & 1].sample.value);
		TEST_ASSERT_TRUE(reader_slot(&image.records[1], &slot));
		TEST_ASSERT_EQUAL_INT64(n, slot.sample.value);
		TEST_ASSERT_EQUAL_UINT64(n, slot.attrs.transactions);
		TEST_ASSERT_EQUAL_HEX32(ows_check((void *)&slot.sample, 11), slot.sample.check);
		TEST_ASSERT_EQUAL_HEX32(ows_check((void *)&slot.attrs, 17), slot.attrs.check);
	}
}

static void test_the_sequence_word_wraps(void)
{
	struct ows_sample sample = {0};
	struct ows_attrs attrs = {0};

	build_two();
	image.records[1].seq = 0xfffffffcu;
	for (int64_t n = 1; n < 6; n++) {
		struct ows_sample got;

		sample.value = n;
		image_publish(&image, 1, &sample, &attrs, NULL);
		TEST_ASSERT_TRUE(reader_sample(&image.records[1], &got));
		TEST_ASSERT_EQUAL_INT64(n, got.value);
	}
	TEST_ASSERT_EQUAL(6, image.records[1].seq);
}

/* The state of memory at any point of a write, as a kill would leave it. */
static void test_a_write_broken_off_anywhere_leaves_the_older_state_whole(void)
{
	struct ows_sample sample = {.value = 1}, got;
	struct ows_attrs attrs = {0};
	struct ows_record *r;

	build_two();
	r = &image.records[1];
	image_publish(&image, 1, &sample, &attrs, NULL);
	r->seq = 3;
	for (size_t i = 0; i < sizeof(r->slot[0]) / 4; i++) {
		((uint32_t *)(void *)&r->slot[0])[i] = 0xdeadbeefu;
		TEST_ASSERT_TRUE(reader_sample(r, &got));
		TEST_ASSERT_EQUAL_INT64(1, got.value);
		TEST_ASSERT_EQUAL_HEX32(ows_check((void *)&got, 11), got.check);
	}
}

static void test_texts_of_two_states_stand_apart(void)
{
	struct ows_sample sample = {.len = 8}, got;
	struct ows_attrs attrs = {0};
	char text[9];

	build_two();
	image_publish(&image, 2, &sample, &attrs, "12345678");
	TEST_ASSERT_TRUE(reader_text(image.base, &image.records[2], &got, text, sizeof(text)));
	TEST_ASSERT_EQUAL_STRING("12345678", text);
	sample.len = 3;
	image_publish(&image, 2, &sample, &attrs, "abc");
	TEST_ASSERT_TRUE(reader_text(image.base, &image.records[2], &got, text, sizeof(text)));
	TEST_ASSERT_EQUAL_STRING("abc", text);
	TEST_ASSERT_EQUAL_MEMORY("12345678", image.base + image.records[2].text_off + 8, 8);
}

static void test_check_words_are_those_of_the_documentation(void)
{
	static const uint32_t words[] = {1, 2, 3};

	TEST_ASSERT_EQUAL_HEX32(0x2e68fe0d, ows_check(words, 3));
	TEST_ASSERT_EQUAL_HEX32(0xe1147a2b, ows_check_bytes("owsd", 4));
}

static void test_retiring_rubbish_touches_nothing(void)
{
	char rubbish[512];

	memset(rubbish, 0x55, sizeof(rubbish));
	image_retire(rubbish, sizeof(rubbish));
	for (size_t i = 0; i < sizeof(rubbish); i++)
		TEST_ASSERT_EQUAL_HEX8(0x55, rubbish[i]);
	build_two();
	image_retire(memory, 16);
	TEST_ASSERT_EQUAL(OWS_STATE_BUILDING, image.header->state);
	image_retire(memory, image.header->size);
	TEST_ASSERT_EQUAL(OWS_STATE_RETIRED, image.header->state);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_image_without_signals_has_owsd_in_it);
	RUN_TEST(test_an_image_beyond_two_gigabytes_is_refused);
	RUN_TEST(test_names_are_sorted_by_bytes_shorter_first);
	RUN_TEST(test_areas_do_not_overlap);
	RUN_TEST(test_each_state_goes_to_the_other_slot);
	RUN_TEST(test_the_sequence_word_wraps);
	RUN_TEST(test_a_write_broken_off_anywhere_leaves_the_older_state_whole);
	RUN_TEST(test_texts_of_two_states_stand_apart);
	RUN_TEST(test_check_words_are_those_of_the_documentation);
	RUN_TEST(test_retiring_rubbish_touches_nothing);
	return UNITY_END();
}
