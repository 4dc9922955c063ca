/* SPDX-License-Identifier: MIT */
/* The alarm machine, fact by fact; test_table_3_1.c lays it beside the manual. */
#include <stdio.h>

#include "unity.h"

#include "src/daemon/engine/alarm/alarm_fsm.h"

void setUp(void)
{
}
void tearDown(void)
{
}

#define STAYS (-2)

static int next_of(enum alarm_state state, uint32_t facts)
{
	const struct alarm_row *row = alarm_next(state, facts);

	return row ? (int)row->next : STAYS;
}

static void test_every_row_can_be_reached(void)
{
	for (size_t k = 0; k < alarm_table_rows; k++)
		TEST_ASSERT_EQUAL_PTR_MESSAGE(&alarm_table[k],
		                              alarm_next(alarm_table[k].state, alarm_table[k].all),
		                              alarm_table[k].text);
}

static void test_no_state_is_left_without_a_reason(void)
{
	for (int state = NOT_USED; state <= ALARM_BYPASS; state++)
		TEST_ASSERT_EQUAL_INT(STAYS, next_of((enum alarm_state)state, 0));
}

/* Every (state, single fact) pair, written down: what is not here stays. */
static void test_every_state_on_every_single_fact(void)
{
	static const struct {
		enum alarm_state state;
		uint32_t fact;
		enum alarm_state next;
	} leaves[] = {
		{NOT_USED, FACT_ITEMS, INIT},
		{INIT, FACT_MAX_CONS, ALARM_BYPASS},
		{INIT, FACT_STARTED, ALARM_DIR},
		{ALARM_DIR, FACT_DONE, ALARM_PROCESS},
		{ALARM_DIR, FACT_FAILED, ALARM_BYPASS},
		{ALARM_PROCESS, FACT_MAX_CONS, ALARM_BYPASS},
		{ALARM_PROCESS, FACT_NEXT_ITEM, ALARM_POR_READ},
		{ALARM_PROCESS, FACT_CYCLE_END, ALARM_BYPASS},
		{ALARM_POR_READ, FACT_ND, ALARM_PROCESS},
		{ALARM_POR_READ, FACT_EMPTY, ALARM_LATCH},
		{ALARM_POR_READ, FACT_KNOWN, ALARM_LATCH},
		{ALARM_POR_READ, FACT_STARTED, ALARM_POR_READ_WAIT},
		{ALARM_POR_READ_WAIT, FACT_FAILED, ALARM_PROCESS},
		{ALARM_POR_READ_WAIT, FACT_DONE, ALARM_LATCH},
		{ALARM_SET, FACT_ND, ALARM_PROCESS},
		{ALARM_SET, FACT_EMPTY, ALARM_POR_RESET},
		{ALARM_SET, FACT_KNOWN, ALARM_POR_RESET},
		{ALARM_SET, FACT_STARTED, ALARM_SET_WAIT},
		{ALARM_SET_WAIT, FACT_FAILED, ALARM_PROCESS},
		{ALARM_SET_WAIT, FACT_DONE, ALARM_POR_RESET},
		{ALARM_INIT_WRITE_WAIT, FACT_DONE, ALARM_POR_RESET},
		{ALARM_INIT_WRITE_WAIT, FACT_FAILED, ALARM_SET_WAIT},
		{ALARM_POR_RESET, FACT_ND, ALARM_PROCESS},
		{ALARM_POR_RESET, FACT_EMPTY, ALARM_LATCH},
		{ALARM_POR_RESET, FACT_KNOWN, ALARM_LATCH},
		{ALARM_POR_RESET, FACT_STARTED, ALARM_POR_RESET_WAIT},
		{ALARM_POR_RESET_WAIT, FACT_FAILED, ALARM_PROCESS},
		{ALARM_POR_RESET_WAIT, FACT_DONE, ALARM_LATCH},
		{ALARM_LATCH, FACT_ND, ALARM_PROCESS},
		{ALARM_LATCH, FACT_EMPTY, ALARM_PROCESS},
		{ALARM_LATCH, FACT_KNOWN, ALARM_PROCESS},
		{ALARM_LATCH, FACT_STARTED, ALARM_LATCH_WAIT},
		{ALARM_LATCH_WAIT, FACT_FAILED, ALARM_PROCESS},
		{ALARM_LATCH_WAIT, FACT_DONE, ALARM_PROCESS},
		{ALARM_SENSED, FACT_ND, ALARM_PROCESS},
		{ALARM_SENSED, FACT_EMPTY, ALARM_LATCH_RESET},
		{ALARM_SENSED, FACT_STARTED, ALARM_SENSED_WAIT},
		{ALARM_SENSED_WAIT, FACT_FAILED, ALARM_PROCESS},
		{ALARM_SENSED_WAIT, FACT_DONE, ALARM_LATCH_RESET},
		{ALARM_LATCH_RESET, FACT_ND, ALARM_PROCESS},
		{ALARM_LATCH_RESET, FACT_EMPTY, SENSED},
		{ALARM_LATCH_RESET, FACT_KNOWN, SENSED},
		{ALARM_LATCH_RESET, FACT_STARTED, ALARM_LATCH_RESET_WAIT},
		{ALARM_LATCH_RESET_WAIT, FACT_FAILED, ALARM_PROCESS},
		{ALARM_LATCH_RESET_WAIT, FACT_DONE, SENSED},
		{SENSED, FACT_ND, ALARM_PROCESS},
		{SENSED, FACT_EMPTY, ALARM_PROCESS},
		{SENSED, FACT_STARTED, SENSED_WAIT},
		{SENSED_WAIT, FACT_FAILED, ALARM_PROCESS},
		{SENSED_WAIT, FACT_DONE, ALARM_PROCESS},
		{ALARM_BYPASS, FACT_PASSED, INIT},
	};

	for (int state = NOT_USED; state <= ALARM_BYPASS; state++)
		for (unsigned bit = 0; bit < 16; bit++) {
			int expected = STAYS;
			char message[64];

			for (size_t i = 0; i < sizeof(leaves) / sizeof(leaves[0]); i++)
				if ((int)leaves[i].state == state && leaves[i].fact == 1u << bit)
					expected = (int)leaves[i].next;
			snprintf(message, sizeof(message), "%s, fact %u",
			         alarm_state_name((enum alarm_state)state), bit);
			TEST_ASSERT_EQUAL_INT_MESSAGE(
				expected, next_of((enum alarm_state)state, 1u << bit), message);
		}
}

static void test_two_facts_together_follow_the_upper_row(void)
{
	TEST_ASSERT_EQUAL_INT(ALARM_SET, next_of(ALARM_POR_READ_WAIT, FACT_DONE | FACT_NON_ZERO));
	TEST_ASSERT_EQUAL_INT(ALARM_SENSED, next_of(ALARM_LATCH_WAIT, FACT_DONE | FACT_NON_ZERO));
	TEST_ASSERT_EQUAL_INT(ALARM_SET_WAIT,
	                      next_of(ALARM_INIT_WRITE_WAIT, FACT_DONE | FACT_INIT_POS));
	TEST_ASSERT_EQUAL_INT(ALARM_INIT_WRITE_WAIT,
	                      next_of(ALARM_SET_WAIT, FACT_DONE | FACT_INIT_OUTPUT));
	TEST_ASSERT_EQUAL_INT(ALARM_PROCESS, next_of(ALARM_BYPASS, FACT_PASSED | FACT_POS));
	TEST_ASSERT_EQUAL_INT(ALARM_PROCESS, next_of(ALARM_SET, FACT_ND | FACT_EMPTY));
	TEST_ASSERT_EQUAL_INT(ALARM_BYPASS, next_of(ALARM_PROCESS, FACT_MAX_CONS | FACT_NEXT_ITEM));
	TEST_ASSERT_EQUAL_INT(ALARM_SET, next_of(ALARM_POR_READ, FACT_KNOWN | FACT_NON_ZERO));
	TEST_ASSERT_EQUAL_INT(ALARM_SENSED, next_of(ALARM_LATCH, FACT_KNOWN | FACT_NON_ZERO));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_every_row_can_be_reached);
	RUN_TEST(test_no_state_is_left_without_a_reason);
	RUN_TEST(test_every_state_on_every_single_fact);
	RUN_TEST(test_two_facts_together_follow_the_upper_row);
	return UNITY_END();
}
