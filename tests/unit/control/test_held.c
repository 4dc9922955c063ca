/* SPDX-License-Identifier: MIT */
/* Memories that owsd is done with: no controller joins whose memories could find no place then. */
#include <sys/mman.h>

#include "unity.h"

#include "src/memory/control/held.h"

#define SIZE 4096
#define SOMEBODY 54321

static struct control control;

void setUp(void)
{
	control = (struct control){.now_ns = 1};
}

void tearDown(void)
{
}

/* Returns whether owsd keeps the memory until it is empty. */
static bool free_one(uid_t uid)
{
	char *base = mmap(NULL, SIZE, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
	struct control_grant grant = {.memory.base = base, .size = SIZE, .memfd = -1, .own = -1};
	unsigned before = control.held_count;

	TEST_ASSERT_TRUE(base != MAP_FAILED);
	held_free(&control, uid, &grant, false);
	return control.held_count == before + 1;
}

/* All seats, each with the memory before a reload and that after it. */
static void test_while_there_is_room_the_memories_of_all_places_are_kept(void)
{
	while (!held_full(&control))
		TEST_ASSERT_TRUE(free_one(SOMEBODY));
	control.held_count--; /* the last who was let in */
	TEST_ASSERT_FALSE(held_full(&control));
	for (unsigned i = 0; i < 2 * OWS_CONTROLLERS; i++)
		TEST_ASSERT_TRUE(free_one(SOMEBODY));
	TEST_ASSERT_EQUAL_UINT(CONTROL_HELD_ALL, control.held_count);
}

static void test_beyond_all_places_none_is_kept_and_none_overwritten(void)
{
	control.held_count = CONTROL_HELD_ALL - 1;
	TEST_ASSERT_TRUE(free_one(SOMEBODY));
	TEST_ASSERT_FALSE(free_one(SOMEBODY));
	TEST_ASSERT_EQUAL_UINT(CONTROL_HELD_ALL, control.held_count);
}

static void test_what_is_held_counts_for_its_user_alone(void)
{
	size_t bytes;

	for (unsigned i = 0; i < 3; i++)
		free_one(SOMEBODY);
	free_one(SOMEBODY + 1);
	TEST_ASSERT_EQUAL_UINT(3, held_of(&control, SOMEBODY, &bytes));
	TEST_ASSERT_EQUAL_size_t(3 * SIZE, bytes);
	TEST_ASSERT_EQUAL_UINT(1, held_of(&control, SOMEBODY + 1, &bytes));
	TEST_ASSERT_EQUAL_UINT(0, held_of(&control, SOMEBODY + 2, &bytes));
	TEST_ASSERT_EQUAL_size_t(0, bytes);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_while_there_is_room_the_memories_of_all_places_are_kept);
	RUN_TEST(test_beyond_all_places_none_is_kept_and_none_overwritten);
	RUN_TEST(test_what_is_held_counts_for_its_user_alone);
	return UNITY_END();
}
