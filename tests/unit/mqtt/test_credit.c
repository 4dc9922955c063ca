/* SPDX-License-Identifier: MIT */
/* Tests of how many commands of a topic may come. */
#include "unity.h"

#include "hal/base/time.h"
#include "src/faces/mqtt/credit.h"

#define START (100 * NS_PER_S)
#define A_SECOND 50
#define BURST 100

static const struct credit_rate rate = {NS_PER_S / A_SECOND, BURST};
static struct credit credit;

void setUp(void)
{
	credit = (struct credit){0};
}

void tearDown(void)
{
}

static int spend(int tries, int64_t now_ns)
{
	int spent = 0;

	while (tries--)
		spent += credit_spend(&credit, &rate, now_ns);
	return spent;
}

static void test_a_burst_may_come_and_no_more(void)
{
	TEST_ASSERT_EQUAL_INT(BURST, spend(1000, START));
	TEST_ASSERT_FALSE(credit_spend(&credit, &rate, START + NS_PER_S / A_SECOND - 1));
	TEST_ASSERT_TRUE(credit_spend(&credit, &rate, START + NS_PER_S / A_SECOND));
}

static void test_time_brings_it_back_up_to_a_burst(void)
{
	spend(1000, START);
	TEST_ASSERT_EQUAL_INT(A_SECOND, spend(1000, START + NS_PER_S));
	TEST_ASSERT_EQUAL_INT(BURST, spend(1000, START + 3600 * NS_PER_S));
}

static void test_a_flood_gets_what_a_second_has(void)
{
	int spent = 0;

	spend(1000, START);
	for (int ms = 1; ms <= 10000; ms++)
		spent += spend(5, START + ms * NS_PER_MS);
	TEST_ASSERT_EQUAL_INT(10 * A_SECOND, spent);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_burst_may_come_and_no_more);
	RUN_TEST(test_time_brings_it_back_up_to_a_burst);
	RUN_TEST(test_a_flood_gets_what_a_second_has);
	return UNITY_END();
}
