/* SPDX-License-Identifier: MIT */
/* Tests of the queue of owsd-notify. */
#include "unity.h"

#include "src/faces/notify/queue.h"

static struct queue queue;

void setUp(void)
{
	queue = (struct queue){0};
}

void tearDown(void)
{
}

static void test_the_oldest_go_and_numbers_stay(void)
{
	for (int i = 0; i < QUEUE_ENTRIES + 3; i++)
		queue_add(&queue)->came_ns = i;
	TEST_ASSERT_EQUAL_UINT64(3, queue.first);
	TEST_ASSERT_EQUAL_UINT64(QUEUE_ENTRIES + 3, queue.end);
	TEST_ASSERT_NULL(queue_at(&queue, 2));
	TEST_ASSERT_EQUAL_INT64(3, queue_at(&queue, 3)->came_ns);
	TEST_ASSERT_EQUAL_INT64(QUEUE_ENTRIES + 2, queue_at(&queue, queue.end - 1)->came_ns);
	TEST_ASSERT_NULL(queue_at(&queue, queue.end));
}

static void test_the_oldest_of_the_journal_is_found(void)
{
	TEST_ASSERT_EQUAL_INT64(INT64_MAX, queue_oldest(&queue, 0, false));
	queue_add(&queue)->entered_ns = 5;
	queue_add(&queue);
	queue_add(&queue)->entered_ns = 9;
	queue_add(&queue)->entered_ns = 8;
	*queue_add(&queue) = (struct entry){.entered_ns = 4, .escalated = true};
	TEST_ASSERT_EQUAL_INT64(5, queue_oldest(&queue, 0, false));
	TEST_ASSERT_EQUAL_INT64(8, queue_oldest(&queue, 1, false));
	TEST_ASSERT_EQUAL_INT64(INT64_MAX, queue_oldest(&queue, 4, false));
	TEST_ASSERT_EQUAL_INT64(4, queue_oldest(&queue, 0, true));
	TEST_ASSERT_EQUAL_INT64(INT64_MAX, queue_oldest(&queue, 5, true));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_oldest_go_and_numbers_stay);
	RUN_TEST(test_the_oldest_of_the_journal_is_found);
	return UNITY_END();
}
