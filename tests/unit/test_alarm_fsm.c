/* SPDX-License-Identifier: MIT */
/* The machine beside Table 3.1 of the manual, state by state. */
#include "src/engine/alarm_fsm.h"

#include "unity.h"

#include <stdio.h>
#include <string.h>

void setUp(void) {}
void tearDown(void) {}

#define STAYS (-2)

static int next_of(enum alarm_state state, uint32_t facts)
{
	const struct alarm_row *row = alarm_next(state, facts);

	return row ? (int)row->next : STAYS;
}

/* Table 3.1 as printed: number, state, and where each of its rows leads, top to bottom. */
static const struct {
	int number;
	const char *name;
	int next[4];
	unsigned rows;
} manual[] = {
	{ -1, "NOT_USED", { INIT }, 1 },
	{ 0, "INIT", { ALARM_DIR }, 1 },
	{ 1, "ALARM_DIR", { ALARM_PROCESS }, 1 },
	{ 2, "ALARM_PROCESS", { ALARM_BYPASS, ALARM_POR_READ, ALARM_BYPASS }, 3 },
	{ 3, "ALARM_POR_READ", { ALARM_PROCESS, ALARM_LATCH, ALARM_POR_READ_WAIT }, 3 },
	{ 4, "ALARM_POR_READ_WAIT", { ALARM_SET, ALARM_LATCH }, 2 },
	{ 5, "ALARM_SET", { ALARM_PROCESS, ALARM_POR_RESET, ALARM_SET_WAIT }, 3 },
	{ 6, "ALARM_SET_WAIT", { ALARM_INIT_WRITE_WAIT, ALARM_POR_RESET }, 2 },
	{ 7, "ALARM_INIT_WRITE_WAIT", { ALARM_POR_RESET, ALARM_SET_WAIT }, 2 },
	{ 8, "ALARM_POR_RESET", { ALARM_PROCESS, ALARM_LATCH, ALARM_POR_RESET_WAIT }, 3 },
	{ 9, "ALARM_POR_RESET_WAIT", { ALARM_LATCH }, 1 },
	/* "not defined or empty" is one row there and two here */
	{ 10, "ALARM_LATCH", { ALARM_PROCESS, ALARM_PROCESS, ALARM_LATCH_WAIT }, 3 },
	{ 11, "ALARM_LATCH_WAIT", { ALARM_SENSED, ALARM_PROCESS }, 2 },
	{ 12, "ALARM_SENSED", { ALARM_PROCESS, ALARM_LATCH_RESET, ALARM_SENSED_WAIT }, 3 },
	{ 13, "ALARM_SENSED_WAIT", { ALARM_LATCH_RESET }, 1 },
	{ 14, "ALARM_LATCH_RESET", { ALARM_PROCESS, SENSED, ALARM_LATCH_RESET_WAIT }, 3 },
	{ 15, "ALARM_LATCH_RESET_WAIT", { SENSED }, 1 },
	{ 16, "SENSED", { ALARM_PROCESS, ALARM_PROCESS, SENSED_WAIT }, 3 },
	{ 17, "SENSED_WAIT", { ALARM_PROCESS }, 1 },
	{ 18, "ALARM_BYPASS", { ALARM_PROCESS, INIT }, 2 },
};

static void test_states_have_the_manuals_numbers_and_names(void)
{
	TEST_ASSERT_EQUAL_size_t(ALARM_STATES, sizeof(manual) / sizeof(manual[0]));
	for (unsigned i = 0; i < ALARM_STATES; i++)
		TEST_ASSERT_EQUAL_STRING(manual[i].name,
		                         alarm_state_name((enum alarm_state)manual[i].number));
}

static void test_without_our_rulings_the_table_is_the_manuals_row_by_row(void)
{
	for (unsigned i = 0; i < ALARM_STATES; i++) {
		unsigned row = 0;

		for (size_t k = 0; k < alarm_table_rows; k++) {
			if ((int)alarm_table[k].state != manual[i].number ||
			    strncmp(alarm_table[k].text, "ruling: ", 8) == 0)
				continue;
			TEST_ASSERT_LESS_THAN_MESSAGE(manual[i].rows, row, manual[i].name);
			TEST_ASSERT_EQUAL_INT_MESSAGE(manual[i].next[row], alarm_table[k].next,
			                              manual[i].name);
			row++;
		}
		TEST_ASSERT_EQUAL_UINT_MESSAGE(manual[i].rows, row, manual[i].name);
	}
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
		{ NOT_USED, FACT_ITEMS, INIT },
		{ INIT, FACT_STARTED, ALARM_DIR },
		{ ALARM_DIR, FACT_DONE, ALARM_PROCESS },
		{ ALARM_DIR, FACT_FAILED, ALARM_BYPASS },
		{ ALARM_PROCESS, FACT_MAX_CONS, ALARM_BYPASS },
		{ ALARM_PROCESS, FACT_NEXT_ITEM, ALARM_POR_READ },
		{ ALARM_PROCESS, FACT_CYCLE_END, ALARM_BYPASS },
		{ ALARM_POR_READ, FACT_ND, ALARM_PROCESS },
		{ ALARM_POR_READ, FACT_EMPTY, ALARM_LATCH },
		{ ALARM_POR_READ, FACT_KNOWN, ALARM_LATCH },
		{ ALARM_POR_READ, FACT_STARTED, ALARM_POR_READ_WAIT },
		{ ALARM_POR_READ_WAIT, FACT_FAILED, ALARM_PROCESS },
		{ ALARM_POR_READ_WAIT, FACT_DONE, ALARM_LATCH },
		{ ALARM_SET, FACT_ND, ALARM_PROCESS },
		{ ALARM_SET, FACT_EMPTY, ALARM_POR_RESET },
		{ ALARM_SET, FACT_KNOWN, ALARM_POR_RESET },
		{ ALARM_SET, FACT_STARTED, ALARM_SET_WAIT },
		{ ALARM_SET_WAIT, FACT_FAILED, ALARM_PROCESS },
		{ ALARM_SET_WAIT, FACT_DONE, ALARM_POR_RESET },
		{ ALARM_INIT_WRITE_WAIT, FACT_DONE, ALARM_POR_RESET },
		{ ALARM_INIT_WRITE_WAIT, FACT_FAILED, ALARM_SET_WAIT },
		{ ALARM_POR_RESET, FACT_ND, ALARM_PROCESS },
		{ ALARM_POR_RESET, FACT_EMPTY, ALARM_LATCH },
		{ ALARM_POR_RESET, FACT_KNOWN, ALARM_LATCH },
		{ ALARM_POR_RESET, FACT_STARTED, ALARM_POR_RESET_WAIT },
		{ ALARM_POR_RESET_WAIT, FACT_FAILED, ALARM_PROCESS },
		{ ALARM_POR_RESET_WAIT, FACT_DONE, ALARM_LATCH },
		{ ALARM_LATCH, FACT_ND, ALARM_PROCESS },
		{ ALARM_LATCH, FACT_EMPTY, ALARM_PROCESS },
		{ ALARM_LATCH, FACT_KNOWN, ALARM_PROCESS },
		{ ALARM_LATCH, FACT_STARTED, ALARM_LATCH_WAIT },
		{ ALARM_LATCH_WAIT, FACT_FAILED, ALARM_PROCESS },
		{ ALARM_LATCH_WAIT, FACT_DONE, ALARM_PROCESS },
		{ ALARM_SENSED, FACT_ND, ALARM_PROCESS },
		{ ALARM_SENSED, FACT_EMPTY, ALARM_LATCH_RESET },
		{ ALARM_SENSED, FACT_STARTED, ALARM_SENSED_WAIT },
		{ ALARM_SENSED_WAIT, FACT_FAILED, ALARM_PROCESS },
		{ ALARM_SENSED_WAIT, FACT_DONE, ALARM_LATCH_RESET },
		{ ALARM_LATCH_RESET, FACT_ND, ALARM_PROCESS },
		{ ALARM_LATCH_RESET, FACT_EMPTY, SENSED },
		{ ALARM_LATCH_RESET, FACT_KNOWN, SENSED },
		{ ALARM_LATCH_RESET, FACT_STARTED, ALARM_LATCH_RESET_WAIT },
		{ ALARM_LATCH_RESET_WAIT, FACT_FAILED, ALARM_PROCESS },
		{ ALARM_LATCH_RESET_WAIT, FACT_DONE, SENSED },
		{ SENSED, FACT_ND, ALARM_PROCESS },
		{ SENSED, FACT_EMPTY, ALARM_PROCESS },
		{ SENSED, FACT_STARTED, SENSED_WAIT },
		{ SENSED_WAIT, FACT_FAILED, ALARM_PROCESS },
		{ SENSED_WAIT, FACT_DONE, ALARM_PROCESS },
		{ ALARM_BYPASS, FACT_PASSED, INIT },
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
	RUN_TEST(test_states_have_the_manuals_numbers_and_names);
	RUN_TEST(test_without_our_rulings_the_table_is_the_manuals_row_by_row);
	RUN_TEST(test_every_row_can_be_reached);
	RUN_TEST(test_no_state_is_left_without_a_reason);
	RUN_TEST(test_every_state_on_every_single_fact);
	RUN_TEST(test_two_facts_together_follow_the_upper_row);
	return UNITY_END();
}
