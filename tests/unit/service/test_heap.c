/* SPDX-License-Identifier: MIT */
/* What is freed goes back to the system, whichever thread had it. */
#include <pthread.h>
#include <stdlib.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <string.h>

#include "unity.h"

#include "src/ground/service/resident.h"

#define LARGE (1 << 20)

void setUp(void)
{
}

void tearDown(void)
{
}

#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 33) && !defined(__SANITIZE_ADDRESS__) && \
	!defined(__SANITIZE_THREAD__)

static void test_a_large_block_is_given_back_also_after_larger_ones(void)
{
	void *volatile small = malloc(1); /* the heap begins */
	struct mallinfo2 before = mallinfo2();

	for (int i = 0; i < 3; i++) {
		char *block = malloc(LARGE);

		TEST_ASSERT_NOT_NULL(block);
		memset(block, 1, LARGE);
		TEST_ASSERT_EQUAL(before.hblks + 1, mallinfo2().hblks);
		free(block);
		TEST_ASSERT_EQUAL(before.hblkhd, mallinfo2().hblkhd);
	}
	TEST_ASSERT_EQUAL(before.arena, mallinfo2().arena);
	free(small);
}

static void *allocate(void *size)
{
	return malloc(*(const size_t *)size);
}

static void test_a_thread_has_no_heap_of_its_own(void)
{
	struct mallinfo2 before = mallinfo2();
	size_t size = 1000;
	pthread_t thread;
	void *block;

	TEST_ASSERT_EQUAL(0, pthread_create(&thread, NULL, allocate, &size));
	TEST_ASSERT_EQUAL(0, pthread_join(thread, &block));
	TEST_ASSERT_NOT_NULL(block);
	TEST_ASSERT_LESS_THAN_size_t(before.arena + 64 * 1024, mallinfo2().arena);
	free(block);
}

#else

static void test_a_large_block_is_given_back_also_after_larger_ones(void)
{
	TEST_IGNORE_MESSAGE("this malloc is not glibc's, or does not say what it keeps");
}

static void test_a_thread_has_no_heap_of_its_own(void)
{
	TEST_IGNORE_MESSAGE("this malloc is not glibc's, or does not say what it keeps");
}

#endif

int main(void)
{
	heap_give_back();
	UNITY_BEGIN();
	RUN_TEST(test_a_large_block_is_given_back_also_after_larger_ones);
	RUN_TEST(test_a_thread_has_no_heap_of_its_own);
	return UNITY_END();
}
