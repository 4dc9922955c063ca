/* SPDX-License-Identifier: MIT */
/* Tests of the image: its layout, and states that are whole wherever a write breaks off. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/memory/shm/entries.h"
#include "src/memory/shm/image.h"
#include "src/memory/shm/reader.h"
#include "src/memory/shm/shelves.h"
#include "src/public/ows.h"

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
	TEST_ASSERT_EQUAL(1, image.areas[OWS_AREA_RECORDS - 1].count);
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
	entry = image.names;
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
	static const uint32_t devices[] = {1};
	static const struct image_plan plan = {.signals = signals,
	                                       .signal_count = 2,
	                                       .targets = targets,
	                                       .target_count = 1,
	                                       .counters = counters,
	                                       .counter_count = 1,
	                                       .devices = devices,
	                                       .device_count = 1,
	                                       .log_lines = 2,
	                                       .period_ns = 1};
	const struct ows_area_entry *area;

	build(&plan);
	area = image.areas;
	TEST_ASSERT_EQUAL(256, image.header->area_off);
	TEST_ASSERT_EQUAL(OWS_AREAS - 1, image.header->area_count);
	TEST_ASSERT_GREATER_OR_EQUAL(256 + 16 * (OWS_AREAS - 1), area[0].off);
	for (uint32_t i = 0; i < OWS_AREAS - 1; i++) {
		TEST_ASSERT_EQUAL(i + 1, area[i].kind);
		TEST_ASSERT_EQUAL(0, area[i].off % 64);
		if (i > 0)
			TEST_ASSERT_GREATER_OR_EQUAL(area[i - 1].off +
			                                     area[i - 1].size * area[i - 1].count,
			                             area[i].off);
	}
	TEST_ASSERT_EQUAL(3, area[OWS_AREA_RECORDS - 1].count);
	TEST_ASSERT_EQUAL(1, area[OWS_AREA_COUNTERS - 1].count);
	TEST_ASSERT_EQUAL(OWS_JOURNAL, area[OWS_AREA_ALARMS - 1].count);
	TEST_ASSERT_EQUAL(2 * 4 + 2 * 12, area[OWS_AREA_TEXTS - 1].count);
	TEST_ASSERT_EQUAL(area[OWS_AREA_TEXTS - 1].off, image.records[1].text_off);
	TEST_ASSERT_EQUAL(image.records[1].text_off + 8, image.records[2].text_off);
	area += OWS_AREA_POOL - 1;
	TEST_ASSERT_EQUAL('\0', image.base[area->off + area->count - 1]);
	TEST_ASSERT_EQUAL(image.infos[2].path_off + 3, area->off + area->count);
	area += OWS_AREA_DEVICES - OWS_AREA_POOL;
	TEST_ASSERT_EQUAL(1, area->count);
	TEST_ASSERT_GREATER_OR_EQUAL(area->off + area->size * area->count, image.header->size);
}

static const char *text_at(uint32_t off)
{
	return off ? image.base + off : NULL;
}

static void test_what_people_say_of_a_signal_is_in_its_info(void)
{
	static const struct image_meta meta = {
		.unit = "\xc2\xb0"
			"C",
		.description = "flow of boiler 1",
		.family = "DS18B20",
		.device = "28.0123456789AB",
		.calibrated = "2026-11-22",
		.points = "0:0 10:10.5",
		.group = "Heating",
		.decimals = 1,
		.scale = 2,
		.offset = -3,
		.min = -10,
		.max = 99,
		.limit_hh = 90,
		.limit_h = 80,
		.limit_l = NAN,
		.limit_ll = 5,
		.filter_s = 4,
		.deadband = 0.5,
	};
	static const struct image_signal signals[] = {
		{.name = "a",
	         .path = "/p",
	         .type = OWS_DOUBLE,
	         .starts_last = true,
	         .confirm = true,
	         .meta = &meta},
		{.name = "b", .path = "/p", .type = OWS_DOUBLE},
	};
	static const struct image_plan plan = {
		.signals = signals, .signal_count = 2, .served = "owserver:/s"};
	const struct ows_info_entry *info;

	build(&plan);
	info = &image.infos[1];
	TEST_ASSERT_EQUAL_STRING(meta.unit, text_at(info->unit_off));
	TEST_ASSERT_EQUAL_STRING(meta.description, text_at(info->description_off));
	TEST_ASSERT_EQUAL_STRING(meta.family, text_at(info->family_off));
	TEST_ASSERT_EQUAL_STRING(meta.device, text_at(info->device_off));
	TEST_ASSERT_EQUAL_STRING(meta.calibrated, text_at(info->calibrated_off));
	TEST_ASSERT_EQUAL_STRING(meta.points, text_at(info->points_off));
	TEST_ASSERT_EQUAL_STRING(meta.group, text_at(info->group_off));
	TEST_ASSERT_EQUAL_STRING("owserver:/s", text_at(image.header->served_off));
	TEST_ASSERT_EQUAL(1, info->decimals);
	TEST_ASSERT_EQUAL_HEX32(OWS_INFO_LAST | OWS_INFO_SCALED | OWS_INFO_CONFIRM, info->flags);
	TEST_ASSERT_EQUAL_MEMORY(&meta.scale, &info->scale, 10 * sizeof(double));
	info = &image.infos[2];
	TEST_ASSERT_NULL(text_at(info->unit_off));
	TEST_ASSERT_EQUAL_HEX32(UINT32_MAX, info->decimals);
	TEST_ASSERT_EQUAL_HEX32(0, info->flags);
	TEST_ASSERT_EQUAL_MEMORY(&image_no_meta.scale, &info->scale, 10 * sizeof(double));
}

static void test_changes_go_around_their_ring(void)
{
	uint32_t n = 0, size;

	build_two();
	size = image.change_count;
	TEST_ASSERT_EQUAL(0, size & (size - 1));
	for (; n < size + 3; n++)
		image_change(&image, n % 3);
	TEST_ASSERT_EQUAL(n, image.header->change_head);
	for (n = 3; n < size + 3; n++) {
		TEST_ASSERT_EQUAL(n, image.changes[n % size].number);
		TEST_ASSERT_EQUAL(n % 3, image.changes[n % size].record);
	}
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
		TEST_ASSERT_EQUAL_HEX32(ows_check((void *)&slot.attrs, 19), slot.attrs.check);
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

/* --- Shelves of an earlier owsd: as over a reload, by identity and then by name --------------- */

static const struct image_signal plant[] = {
	{.name = "hall", .path = "/28.1/t", .type = OWS_DOUBLE},
	{.name = "yard", .path = "/28.2/t", .type = OWS_DOUBLE, .identity = "north"},
	{.name = "room", .path = "/28.3/t", .type = OWS_DOUBLE},
};

/* What is shelved once these follow the plant, of which all are: records, in order; 0: none. */
static void expect_shelves(const struct image_signal *after, uint32_t count,
                           const uint32_t expected[3])
{
	const struct image_plan before_plan = {.signals = plant, .signal_count = 3},
				plan = {.signals = after, .signal_count = count};
	struct ows_shelf_entry entry = {.until_ns = 1};
	void *before;
	size_t size;

	build(&before_plan);
	before = memory;
	size = image.header->size;
	for (uint32_t i = 0; i < 3; i++) {
		entry.record = i + 1;
		image_shelf(&image, i, &entry);
	}
	build(&plan);
	shelves_carry(&image, before, size, NULL);
	for (uint32_t i = 0; i < 3; i++)
		TEST_ASSERT_EQUAL_UINT32(expected[i], image.shelves[i].record);
	free(before);
	free(memory);
	memory = NULL;
}

static void test_a_shelf_follows_its_signal_over_a_restart(void)
{
	static const struct image_signal others[] = {
		/* another name, a name that was another's, another path */
		{.name = "attic", .path = "/28.1/t", .type = OWS_DOUBLE},
		{.name = "hall", .path = "/28.7/t", .type = OWS_DOUBLE, .identity = "north"},
		{.name = "room", .path = "/28.9/t", .type = OWS_DOUBLE},
	};
	static const struct image_signal taken[] = {
		{.name = "room", .path = "/28.1/t", .type = OWS_DOUBLE},
		{.name = "yard", .path = "/28.2/t", .type = OWS_DOUBLE},
	};

	expect_shelves(plant, 3, (const uint32_t[]){1, 2, 3});
	expect_shelves(others, 3, (const uint32_t[]){1, 2, 3});
	/* room is another signal now, and yard has the identity of none */
	expect_shelves(taken, 2, (const uint32_t[]){1, 2, 0});
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_image_without_signals_has_owsd_in_it);
	RUN_TEST(test_an_image_beyond_two_gigabytes_is_refused);
	RUN_TEST(test_names_are_sorted_by_bytes_shorter_first);
	RUN_TEST(test_areas_do_not_overlap);
	RUN_TEST(test_what_people_say_of_a_signal_is_in_its_info);
	RUN_TEST(test_changes_go_around_their_ring);
	RUN_TEST(test_each_state_goes_to_the_other_slot);
	RUN_TEST(test_the_sequence_word_wraps);
	RUN_TEST(test_a_write_broken_off_anywhere_leaves_the_older_state_whole);
	RUN_TEST(test_texts_of_two_states_stand_apart);
	RUN_TEST(test_check_words_are_those_of_the_documentation);
	RUN_TEST(test_retiring_rubbish_touches_nothing);
	RUN_TEST(test_a_shelf_follows_its_signal_over_a_restart);
	return UNITY_END();
}
