/* SPDX-License-Identifier: MIT */
/* Tests of the command segment, and of commands carried to a new one. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "unity.h"

#include "src/libows/ows.h"
#include "src/shm/carry.h"
#include "src/shm/commands.h"

#define COUNT 40
#define CAP 32

static struct command_signal signals[COUNT];
static char names[COUNT][16];
static struct commands to, from;
static uint64_t seed, random_state;

static uint32_t random_word(void)
{
	random_state ^= random_state << 13;
	random_state ^= random_state >> 7;
	random_state ^= random_state << 17;
	return (uint32_t)(random_state >> 16);
}

static void build(struct commands *commands, uint32_t count, uint32_t generation)
{
	struct command_plan plan = {
		.signals = signals,
		.signal_count = count,
		.text_cap = CAP,
		.generation = generation,
		.start_id = generation,
	};
	size_t size = commands_size(&plan);
	void *memory = aligned_alloc(64, size);

	TEST_ASSERT_NOT_NULL(memory);
	memset(memory, 0, size);
	TEST_ASSERT_EQUAL(0, commands_build(&plan, memory, commands));
	TEST_ASSERT_EQUAL(size, commands->size);
}

static void drop(struct commands *commands)
{
	commands_forget(commands);
	free(commands->base);
	commands->base = NULL;
}

void setUp(void)
{
	for (int i = 0; i < COUNT; i++) {
		snprintf(names[i], sizeof(names[i]), "signal%d", i);
		signals[i] = (struct command_signal){names[i], "/29.1/PIO.0", OWS_BOOL};
		if (i % 4 == 3)
			signals[i].type = OWS_STRING;
	}
	build(&from, COUNT, 1);
	build(&to, COUNT, 2);
}

void tearDown(void)
{
	drop(&from);
	drop(&to);
}

static struct ows_command_slot *slot(struct commands *commands, uint32_t i)
{
	return (void *)(commands->base + commands->slot_off + i * sizeof(struct ows_command_slot));
}

static struct ows_command_text *text_of(struct commands *commands, uint32_t i)
{
	return (void *)(commands->base + commands->text_off[i]);
}

static void command(struct commands *commands, uint32_t i, int64_t value)
{
	slot(commands, i)->value = (uint64_t)value;
	slot(commands, i)->stamp++;
}

static void command_text(struct commands *commands, uint32_t i, const char *text)
{
	struct ows_command_text *t = text_of(commands, i);

	t->len = (uint32_t)strlen(text);
	memcpy(t + 1, text, t->len);
	t->check = ows_check_bytes(text, t->len);
	slot(commands, i)->stamp++;
}

static void test_numbers_out_of_their_range_count_as_nothing(void)
{
	struct command c;

	*slot(&to, 1) = (struct ows_command_slot){.value = 7,
	                                          .stamp = 1,
	                                          .client = 33,
	                                          .read_enable = 3,
	                                          .write_enable = 0xffffffffu};
	commands_load(&to, 1, &c);
	TEST_ASSERT_EQUAL(0, c.client);
	TEST_ASSERT_EQUAL(0, c.read_enable);
	TEST_ASSERT_EQUAL(0, c.write_enable);
	slot(&to, 1)->client = 32;
	slot(&to, 1)->read_enable = 2;
	commands_load(&to, 1, &c);
	TEST_ASSERT_EQUAL(32, c.client);
	TEST_ASSERT_EQUAL(2, c.read_enable);
}

static void test_marks_are_found_in_order_and_once(void)
{
	uint32_t *dirty = (void *)(to.base + to.dirty_off);

	dirty[0] = 1u | 1u << 31;
	dirty[1] = 1u << 3;
	TEST_ASSERT_EQUAL(0, commands_next_dirty(&to, 0));
	TEST_ASSERT_EQUAL(31, commands_next_dirty(&to, 1));
	TEST_ASSERT_EQUAL(35, commands_next_dirty(&to, 32));
	TEST_ASSERT_EQUAL(-1, commands_next_dirty(&to, 0));
	dirty[0] = 1u << 2;
	TEST_ASSERT_EQUAL(-1, commands_next_dirty(&to, 3));
	TEST_ASSERT_EQUAL(2, commands_next_dirty(&to, 2));
}

static void test_marks_of_slots_that_do_not_exist_are_nothing(void)
{
	uint32_t *dirty = (void *)(to.base + to.dirty_off);
	int n = 0;

	dirty[0] = dirty[1] = 0xffffffffu;
	for (int i = commands_next_dirty(&to, 0); i >= 0; i = commands_next_dirty(&to, 0)) {
		TEST_ASSERT_LESS_THAN(COUNT + 1, i);
		TEST_ASSERT_LESS_THAN(100, ++n);
	}
	TEST_ASSERT_EQUAL(COUNT + 1, n);
}

static void test_a_text_with_a_wrong_length_or_check_is_refused(void)
{
	char text[CAP + 1];

	command_text(&to, 4, "hello");
	TEST_ASSERT_EQUAL(5, commands_text(&to, 4, text));
	text_of(&to, 4)->check++;
	TEST_ASSERT_EQUAL(-EBADMSG, commands_text(&to, 4, text));
	text_of(&to, 4)->len = CAP + 1;
	TEST_ASSERT_EQUAL(-EBADMSG, commands_text(&to, 4, text));
	text_of(&to, 4)->claim = 1;
	TEST_ASSERT_EQUAL(-EBUSY, commands_text(&to, 4, text));
}

static void test_an_overwritten_header_is_mended(void)
{
	char before[256];

	commands_state(&to, OWS_STATE_LIVE);
	memcpy(before, to.base, sizeof(before));
	TEST_ASSERT_FALSE(commands_repair(&to, true));
	memset(to.base, 0xee, 128);
	TEST_ASSERT_TRUE(commands_repair(&to, false));
	TEST_ASSERT_EQUAL_MEMORY(before, to.base, 128);
	memset(to.base + to.entry_off, 0xee, to.keep_size - to.entry_off);
	TEST_ASSERT_FALSE(commands_repair(&to, false));
	TEST_ASSERT_TRUE(commands_repair(&to, true));
	TEST_ASSERT_EQUAL_MEMORY(to.keep, to.base, 128);
	TEST_ASSERT_EQUAL_MEMORY(to.keep + 256, to.base + 256, to.keep_size - 256);
}

static void test_commands_are_carried_by_name_type_and_path(void)
{
	struct command c;

	command(&from, 1, 1);
	command(&from, 2, 1);
	command(&from, 3, 1);
	signals[0].name = "renamed";
	signals[1].path = "/29.2/PIO.0";
	drop(&to);
	build(&to, COUNT, 2);
	TEST_ASSERT_EQUAL(1, commands_carry(&to, from.base, from.size, false));
	commands_load(&to, 1, &c);
	TEST_ASSERT_EQUAL(0, c.stamp);
	commands_load(&to, 2, &c);
	TEST_ASSERT_EQUAL(0, c.stamp);
	commands_load(&to, 3, &c);
	TEST_ASSERT_EQUAL(1, c.stamp);
	TEST_ASSERT_EQUAL_INT64(1, c.value);
}

static void test_a_changed_order_commands_the_same_signals(void)
{
	struct command c;
	struct command_signal turned[COUNT];

	for (uint32_t i = 1; i <= COUNT; i++)
		if (signals[i - 1].type != OWS_STRING)
			command(&from, i, 100 + i);
	for (int i = 0; i < COUNT; i++)
		turned[i] = signals[COUNT - 1 - i];
	memcpy(signals, turned, sizeof(signals));
	drop(&to);
	build(&to, COUNT, 2);
	TEST_ASSERT_EQUAL(COUNT * 3 / 4, commands_carry(&to, from.base, from.size, false));
	for (uint32_t i = 1; i <= COUNT; i++) {
		commands_load(&to, i, &c);
		TEST_ASSERT_EQUAL_INT64(signals[i - 1].type == OWS_STRING ? 0 : 101 + COUNT - i,
		                        c.value);
	}
}

static void test_enables_are_kept_over_a_reload_but_not_a_restart(void)
{
	struct command c;

	slot(&from, 1)->read_enable = 1;
	slot(&from, 1)->write_enable = 77;
	commands_carry(&to, from.base, from.size, false);
	commands_load(&to, 1, &c);
	TEST_ASSERT_EQUAL(1, c.read_enable);
	TEST_ASSERT_EQUAL(0, c.write_enable);
	drop(&to);
	build(&to, COUNT, 3);
	commands_carry(&to, from.base, from.size, true);
	commands_load(&to, 1, &c);
	TEST_ASSERT_EQUAL(0, c.read_enable);
}

static void test_texts_are_carried_if_they_are_whole(void)
{
	char text[CAP + 1];
	struct command c;

	command_text(&from, 4, "whole");
	command_text(&from, 8, "torn");
	text_of(&from, 8)->len = 3;
	command_text(&from, 12, "claimed");
	text_of(&from, 12)->claim = 9;
	TEST_ASSERT_EQUAL(1, commands_carry(&to, from.base, from.size, true));
	TEST_ASSERT_EQUAL(5, commands_text(&to, 4, text));
	TEST_ASSERT_EQUAL_STRING("whole", text);
	commands_load(&to, 8, &c);
	TEST_ASSERT_EQUAL(0, c.stamp);
}

static void test_no_command_segment_carries_nothing(void)
{
	/* room for more slots than there can be */
	const size_t size = 0x10010 * 48 + 65536;
	char rubbish[1024] = {0}, *large = calloc(1, size);
	struct ows_command_header *h = (void *)large;

	TEST_ASSERT_NOT_NULL(large);
	memcpy(large, from.base, sizeof(*h));
	h->entry_off = h->slot_off + 0x10010 * 32;
	TEST_ASSERT_EQUAL(-EPROTO, commands_carry(&to, rubbish, sizeof(rubbish), true));
	TEST_ASSERT_EQUAL(-EPROTO, commands_carry(&to, from.base, 100, true));
	TEST_ASSERT_EQUAL(-EPROTO, commands_carry(&to, from.base, from.size / 2, true));
	h->slot_count = 0x10001;
	TEST_ASSERT_EQUAL(-EPROTO, commands_carry(&to, large, size, true));
	h->slot_count = 0x10000;
	TEST_ASSERT_EQUAL(0, commands_carry(&to, large, size, true));
	free(large);
	((struct ows_command_header *)(void *)from.base)->major++;
	TEST_ASSERT_EQUAL(-EPROTO, commands_carry(&to, from.base, from.size, true));
}

/* Copies into memory of exactly the size, so that the address sanitizer sees every step outside. */
static void rubbish_round(void)
{
	uint32_t size = from.size, *words;
	char *copy, text[CAP + 1];
	int carried;

	if (random_word() % 4 == 0)
		size = random_word() % from.size & ~3u;
	copy = aligned_alloc(64, (size + 63u) & ~63u);
	TEST_ASSERT_NOT_NULL(copy);
	memcpy(copy, from.base, size);
	words = (void *)copy;
	for (uint32_t n = random_word() % 20; n > 0 && size > 0; n--) {
		uint32_t area = random_word() % 3 == 0 ? size : 2048, at;

		at = random_word() % (area < size ? area : size) / 4;
		words[at] = random_word() % 2 ? random_word() : random_word() % (2 * size);
		if (random_word() % 2)
			words[0] = OWS_COMMAND_MAGIC;
	}
	carried = commands_carry(&to, copy, size, random_word() % 2);
	TEST_ASSERT_TRUE(carried == -EPROTO || (carried >= 0 && carried <= COUNT));
	commands_retire(copy, size);
	for (uint32_t i = 1; i <= COUNT; i++) {
		struct command c;

		commands_load(&to, i, &c);
		TEST_ASSERT_LESS_OR_EQUAL(OWS_CLIENTS, c.client);
		TEST_ASSERT_LESS_OR_EQUAL(2, c.read_enable);
		if (to.text_off[i] != 0)
			TEST_ASSERT_LESS_OR_EQUAL(CAP, commands_text(&to, i, text));
	}
	free(copy);
}

static void test_rubbish_in_an_old_segment_harms_nothing(void)
{
	for (uint32_t i = 1; i <= COUNT; i++) {
		if (signals[i - 1].type == OWS_STRING)
			command_text(&from, i, "some text");
		else
			command(&from, i, 1);
	}
	for (int i = 0; i < 3000; i++)
		rubbish_round();
}

static void test_rubbish_in_the_present_segment_harms_nothing(void)
{
	char text[CAP + 1];
	struct command_client client;

	for (int round = 0; round < 300; round++) {
		for (uint32_t i = 0; i < to.size / 4; i++)
			((uint32_t *)(void *)to.base)[i] = random_word();
		for (int i = commands_next_dirty(&to, 0); i >= 0; i = commands_next_dirty(&to, 0)) {
			struct command c;

			TEST_ASSERT_LESS_OR_EQUAL(COUNT, i);
			commands_load(&to, (uint32_t)i, &c);
			TEST_ASSERT_LESS_OR_EQUAL(OWS_CLIENTS, c.client);
			if (to.text_off[i] != 0)
				TEST_ASSERT_LESS_OR_EQUAL(CAP,
				                          commands_text(&to, (uint32_t)i, text));
		}
		for (unsigned i = 0; i < OWS_CLIENTS; i++)
			commands_client(&to, i, &client);
		TEST_ASSERT_TRUE(commands_repair(&to, true));
		TEST_ASSERT_FALSE(commands_repair(&to, true));
	}
}

int main(int argc, char **argv)
{
	int failed;

	seed = argc > 1 ? strtoull(argv[1], NULL, 0) : (uint64_t)time(NULL) * 2654435761u | 1;
	random_state = seed;
	UNITY_BEGIN();
	RUN_TEST(test_numbers_out_of_their_range_count_as_nothing);
	RUN_TEST(test_marks_are_found_in_order_and_once);
	RUN_TEST(test_marks_of_slots_that_do_not_exist_are_nothing);
	RUN_TEST(test_a_text_with_a_wrong_length_or_check_is_refused);
	RUN_TEST(test_an_overwritten_header_is_mended);
	RUN_TEST(test_commands_are_carried_by_name_type_and_path);
	RUN_TEST(test_a_changed_order_commands_the_same_signals);
	RUN_TEST(test_enables_are_kept_over_a_reload_but_not_a_restart);
	RUN_TEST(test_texts_are_carried_if_they_are_whole);
	RUN_TEST(test_no_command_segment_carries_nothing);
	RUN_TEST(test_rubbish_in_an_old_segment_harms_nothing);
	RUN_TEST(test_rubbish_in_the_present_segment_harms_nothing);
	failed = UNITY_END();
	if (failed)
		printf("seed %llu\n", (unsigned long long)seed);
	return failed;
}
