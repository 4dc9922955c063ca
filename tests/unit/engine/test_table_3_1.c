/* SPDX-License-Identifier: MIT */
/*
 * The machine beside Table 3.1 of the manual (the same in 2.50.11, 3.0.1 and 3.0.2 but for the
 * words of row 2, where the newest stands). Below: the manual's rows as data, then where ours
 * depart from them, each by a ruling of docs/semantics.md. What differs and is not there fails, and
 * so does a departure that is no more, a row of one without its row of the other, and a ruling
 * without rows.
 */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/daemon/engine/alarm/alarm_fsm.h"

void setUp(void)
{
}
void tearDown(void)
{
}

#define COMBINATIONS 0x10000u
#define COUNT(a) (sizeof(a) / sizeof((a)[0]))

/* A condition holds when all of "all", none of "none" and, if any are named, one of "any" hold. */
struct condition {
	uint32_t all, none, any;
};

/* What section 3.2 says of a state itself, and so of all its rows: what is waited for in it. */
struct manual_state {
	int number;
	const char *name;
	uint32_t waits;
};

static const struct manual_state states[] = {
	{-1, "NOT_USED", 0},
	{0, "INIT", 0},
	{1, "ALARM_DIR", 0},
	{2, "ALARM_PROCESS", 0},
	{3, "ALARM_POR_READ", 0},
	{4, "ALARM_POR_READ_WAIT", FACT_DONE},
	{5, "ALARM_SET", 0},
	{6, "ALARM_SET_WAIT", FACT_DONE},
	{7, "ALARM_INIT_WRITE_WAIT", FACT_DONE},
	{8, "ALARM_POR_RESET", 0},
	{9, "ALARM_POR_RESET_WAIT", FACT_DONE},
	{10, "ALARM_LATCH", 0},
	{11, "ALARM_LATCH_WAIT", FACT_DONE},
	{12, "ALARM_SENSED", 0},
	{13, "ALARM_SENSED_WAIT", FACT_DONE},
	{14, "ALARM_LATCH_RESET", 0},
	{15, "ALARM_LATCH_RESET_WAIT", FACT_DONE},
	{16, "SENSED", 0},
	{17, "SENSED_WAIT", FACT_DONE},
	{18, "ALARM_BYPASS", FACT_PASSED}, /* "to perform one write or read of another signal" */
};

/* The rows as printed, top to bottom; the words are ours, the facts are what the words say. */
struct manual_row {
	int number;
	const char *words;
	struct condition says;
	const char *next;
};

static const struct manual_row manual[] = {
	{-1, "an alarm is configured", {FACT_ITEMS}, "INIT"},
	{0, "reading of the directory begins", {FACT_STARTED}, "ALARM_DIR"},
	{1, "the directory was read to its end", {FACT_DONE}, "ALARM_PROCESS"},
	{2, "as many in a row as allowed", {FACT_MAX_CONS}, "ALARM_BYPASS"},
	{2, "fewer in a row than allowed", {.none = FACT_MAX_CONS}, "ALARM_POR_READ"},
	{2, "end of the cycle, no position", {FACT_CYCLE_END}, "ALARM_BYPASS"},
	{3, "no sAlarmPor", {FACT_ND}, "ALARM_PROCESS"},
	{3, "sAlarmPor empty", {FACT_EMPTY}, "ALARM_LATCH"},
	{3, "reading succeeded", {FACT_DONE}, "ALARM_POR_READ_WAIT"},
	{4, "por not 0", {FACT_NON_ZERO}, "ALARM_SET"},
	{4, "por 0", {.none = FACT_NON_ZERO}, "ALARM_LATCH"},
	{5, "no sSet or no sSetVal", {FACT_ND}, "ALARM_PROCESS"},
	{5, "sSet or sSetVal empty", {FACT_EMPTY}, "ALARM_POR_RESET"},
	{5, "no output position; writing succeeded", {FACT_DONE}, "ALARM_SET_WAIT"},
	{6, "an output to be written was found", {FACT_INIT_OUTPUT}, "ALARM_INIT_WRITE_WAIT"},
	{6, "no more, no output position", {.none = FACT_INIT_OUTPUT}, "ALARM_POR_RESET"},
	{7, "no output position", {.none = FACT_INIT_POS}, "ALARM_POR_RESET"},
	{7, "else", {0}, "ALARM_SET_WAIT"},
	{8, "no sAlarmPor", {FACT_ND}, "ALARM_PROCESS"},
	{8, "sAlarmPor empty", {FACT_EMPTY}, "ALARM_LATCH"},
	{8, "writing succeeded", {FACT_DONE}, "ALARM_POR_RESET_WAIT"},
	{9, "the request is over", {FACT_DONE}, "ALARM_LATCH"},
	{10, "no sLatch, or empty", {.any = FACT_ND | FACT_EMPTY}, "ALARM_PROCESS"},
	{10, "reading succeeded", {FACT_DONE}, "ALARM_LATCH_WAIT"},
	{11, "latch not 0", {FACT_NON_ZERO}, "ALARM_SENSED"},
	{11, "else", {0}, "ALARM_PROCESS"},
	{12, "no sSensed", {FACT_ND}, "ALARM_PROCESS"},
	{12, "sSensed empty", {FACT_EMPTY}, "ALARM_LATCH_RESET"},
	{12, "reading succeeded", {FACT_DONE}, "ALARM_SENSED_WAIT"},
	{13, "the request is over", {FACT_DONE}, "ALARM_LATCH_RESET"},
	{14, "no sLatchRes or no sLatchResVal", {FACT_ND}, "ALARM_PROCESS"},
	{14, "sLatchRes or sLatchResVal empty", {FACT_EMPTY}, "SENSED"},
	{14, "writing succeeded", {FACT_DONE}, "ALARM_LATCH_RESET_WAIT"},
	{15, "the request is over", {FACT_DONE}, "SENSED"},
	{16, "no sSensed, or empty", {.any = FACT_ND | FACT_EMPTY}, "ALARM_PROCESS"},
	{16, "reading succeeded", {FACT_DONE}, "SENSED_WAIT"},
	{17, "the request is over", {FACT_DONE}, "ALARM_PROCESS"},
	{18, "a position is kept", {FACT_POS}, "ALARM_PROCESS"},
	{18, "else from the beginning", {0}, "INIT"},
};

/* Rows of which a ruling reads the words otherwise: the condition that stands in their place. */
static const struct {
	const char *ruling;
	int number, row; /* the how manieth of its state */
	struct condition reads;
} readings[] = {
	{"T1", 3, 3, {FACT_STARTED}},  {"T1", 5, 3, {FACT_STARTED}},
	{"T1", 8, 3, {FACT_STARTED}},  {"T1", 10, 2, {FACT_STARTED}},
	{"T1", 12, 3, {FACT_STARTED}}, {"T1", 14, 3, {FACT_STARTED}},
	{"T1", 16, 2, {FACT_STARTED}}, {"T2", 2, 2, {FACT_NEXT_ITEM}},
};

/* Rows that only we have. */
static const struct {
	const char *ruling;
	int number;
	uint32_t all, none;
	const char *next;
} added[] = {
	{"T3", 1, FACT_FAILED, 0, "ALARM_BYPASS"},
	{"T3", 4, FACT_FAILED, 0, "ALARM_PROCESS"},
	{"T3", 6, FACT_FAILED, 0, "ALARM_PROCESS"},
	{"T3", 7, FACT_FAILED, 0, "ALARM_SET_WAIT"},
	{"T3", 9, FACT_FAILED, 0, "ALARM_PROCESS"},
	{"T3", 11, FACT_FAILED, 0, "ALARM_PROCESS"},
	{"T3", 13, FACT_FAILED, 0, "ALARM_PROCESS"},
	{"T3", 15, FACT_FAILED, 0, "ALARM_PROCESS"},
	{"T3", 17, FACT_FAILED, 0, "ALARM_PROCESS"},
	{"T4", 3, FACT_KNOWN | FACT_NON_ZERO, 0, "ALARM_SET"},
	{"T4", 3, FACT_KNOWN, 0, "ALARM_LATCH"},
	{"T4", 5, FACT_KNOWN, 0, "ALARM_POR_RESET"},
	{"T4", 8, FACT_KNOWN, 0, "ALARM_LATCH"},
	{"T4", 10, FACT_KNOWN | FACT_NON_ZERO, 0, "ALARM_SENSED"},
	{"T4", 10, FACT_KNOWN, 0, "ALARM_PROCESS"},
	{"T4", 14, FACT_KNOWN, 0, "SENSED"},
	{"T5", 0, FACT_MAX_CONS, 0, "ALARM_BYPASS"},
};

static bool is_added(const struct alarm_row *row, size_t i)
{
	return (int)row->state == added[i].number && row->all == added[i].all &&
	       row->none == added[i].none &&
	       strcmp(alarm_state_name(row->next), added[i].next) == 0;
}

/* The ruling that adds our row, or NULL. */
static const char *added_by(const struct alarm_row *row)
{
	for (size_t i = 0; i < COUNT(added); i++)
		if (is_added(row, i))
			return added[i].ruling;
	return NULL;
}

/* Of the manual's row m: the reading that a ruling gives it, or -1. */
static int reading_of(size_t m)
{
	int row = 1;

	for (size_t i = m; i > 0 && manual[i - 1].number == manual[m].number; i--)
		row++;
	for (size_t i = 0; i < COUNT(readings); i++)
		if (readings[i].number == manual[m].number && readings[i].row == row)
			return (int)i;
	return -1;
}

static bool holds(const struct condition *c, uint32_t facts)
{
	return (facts & c->all) == c->all && !(facts & c->none) && (!c->any || (facts & c->any));
}

/*
 * The manual's machine, as ruled but for the reading "without" (-1: all of them): the row that the
 * facts lead to, -1 if the state is kept.
 */
static int manual_next(int number, uint32_t facts, int without)
{
	uint32_t waits = states[number + 1].waits;

	for (size_t m = 0; m < COUNT(manual); m++) {
		int reading = reading_of(m);
		const struct condition *c = &manual[m].says;

		if (manual[m].number != number || (facts & waits) != waits)
			continue;
		if (reading >= 0 && reading != without)
			c = &readings[reading].reads;
		if (holds(c, facts))
			return (int)m;
	}
	return -1;
}

static void test_states_have_the_manuals_numbers_and_names(void)
{
	TEST_ASSERT_EQUAL_size_t(ALARM_STATES, COUNT(states));
	for (unsigned i = 0; i < ALARM_STATES; i++) {
		TEST_ASSERT_EQUAL_INT((int)i - 1, states[i].number);
		TEST_ASSERT_EQUAL_STRING(states[i].name,
		                         alarm_state_name((enum alarm_state)states[i].number));
	}
}

/* Whatever is true at once: where the manual's row leads, ours does; and each row is beside one. */
static void test_every_row_is_beside_its_row_of_the_manual(void)
{
	static int beside[256];
	static unsigned ours_beside[COUNT(manual)];
	int last = -1;
	char message[256];

	TEST_ASSERT_LESS_OR_EQUAL_size_t(COUNT(beside), alarm_table_rows);
	for (size_t k = 0; k < alarm_table_rows; k++)
		beside[k] = -1;
	for (int number = -1; number < (int)COUNT(states) - 1; number++)
		for (uint32_t facts = 0; facts < COMBINATIONS; facts++) {
			const struct alarm_row *row = alarm_next((enum alarm_state)number, facts);
			int m = manual_next(number, facts, -1);

			if (row && added_by(row))
				continue;
			snprintf(message, sizeof(message),
			         "%s, facts %#x: the manual \"%s\", ours \"%s\"",
			         states[number + 1].name, (unsigned)facts,
			         m < 0 ? "stays" : manual[m].words, row ? row->text : "stays");
			TEST_ASSERT_EQUAL_INT_MESSAGE(m >= 0, row != NULL, message);
			if (!row)
				continue;
			TEST_ASSERT_EQUAL_STRING_MESSAGE(manual[m].next,
			                                 alarm_state_name(row->next), message);
			if (beside[row - alarm_table] < 0)
				beside[row - alarm_table] = m;
			TEST_ASSERT_EQUAL_INT_MESSAGE(beside[row - alarm_table], m, message);
		}
	for (size_t k = 0; k < alarm_table_rows; k++) {
		snprintf(message, sizeof(message), "%s, \"%s\"",
		         alarm_state_name(alarm_table[k].state), alarm_table[k].text);
		if (added_by(&alarm_table[k]))
			continue;
		TEST_ASSERT_GREATER_OR_EQUAL_INT_MESSAGE(0, beside[k], message);
		TEST_ASSERT_GREATER_OR_EQUAL_INT_MESSAGE(last, beside[k], message);
		last = beside[k];
		ours_beside[last]++;
	}
	for (size_t m = 0; m < COUNT(manual); m++)
		/* "not defined or empty" is one row there and two here */
		TEST_ASSERT_EQUAL_UINT_MESSAGE(manual[m].says.any ? 2 : 1, ours_beside[m],
		                               manual[m].words);
}

static void test_every_row_that_only_we_have_is_there_once_and_marked(void)
{
	char message[64];

	for (size_t i = 0; i < COUNT(added); i++) {
		unsigned times = 0;

		snprintf(message, sizeof(message), "%s, state %d", added[i].ruling,
		         added[i].number);
		for (size_t k = 0; k < alarm_table_rows; k++)
			times += is_added(&alarm_table[k], i);
		TEST_ASSERT_EQUAL_UINT_MESSAGE(1, times, message);
		for (size_t m = 0; m < COUNT(manual); m++)
			TEST_ASSERT_FALSE_MESSAGE(manual[m].number == added[i].number &&
			                                  manual[m].says.all == added[i].all &&
			                                  manual[m].says.none == added[i].none &&
			                                  !manual[m].says.any,
			                          message);
	}
	for (size_t k = 0; k < alarm_table_rows; k++)
		TEST_ASSERT_EQUAL_INT_MESSAGE(strncmp(alarm_table[k].text, "ruling: ", 8) == 0,
		                              added_by(&alarm_table[k]) != NULL,
		                              alarm_table[k].text);
}

/* Without the reading the machine would go elsewhere: a ruling for nothing is none. */
static void test_every_reading_of_a_ruling_makes_a_difference(void)
{
	char message[64];

	for (size_t i = 0; i < COUNT(readings); i++) {
		unsigned differ = 0;

		for (uint32_t facts = 0; facts < COMBINATIONS; facts++) {
			enum alarm_state state = (enum alarm_state)readings[i].number;
			const struct alarm_row *row = alarm_next(state, facts);
			int m = manual_next(readings[i].number, facts, (int)i);

			if (row && added_by(row))
				continue;
			differ += (m >= 0) != (row != NULL) ||
			          (row && strcmp(manual[m].next, alarm_state_name(row->next)) != 0);
		}
		snprintf(message, sizeof(message), "%s, state %d", readings[i].ruling,
		         readings[i].number);
		TEST_ASSERT_NOT_EQUAL_UINT_MESSAGE(0, differ, message);
	}
}

/* Rows that a ruling changes, one bit for each state. */
static uint32_t rows_of(const char *ruling)
{
	uint32_t rows = 0;

	for (size_t i = 0; i < COUNT(readings); i++)
		if (strcmp(readings[i].ruling, ruling) == 0)
			rows |= 1u << readings[i].number;
	for (size_t i = 0; i < COUNT(added); i++)
		if (strcmp(added[i].ruling, ruling) == 0)
			rows |= 1u << added[i].number;
	return rows;
}

/* "| T1 | 3, 5, 8 | what |" of docs/semantics.md: all of them, with these rows, and no others. */
static void test_the_rulings_are_those_of_the_document(void)
{
	FILE *file = fopen("docs/semantics.md", "r");
	char line[1024], ruling[4] = "T";
	unsigned found = 0;

	TEST_ASSERT_NOT_NULL_MESSAGE(file,
	                             "docs/semantics.md: run this from the top of the source");
	while (fgets(line, sizeof(line), file)) {
		uint32_t rows = 0;
		char *at = line + 7, *end;

		if (strncmp(line, "| T", 3) != 0 || line[3] < '1' || line[3] > '9' ||
		    strncmp(line + 4, " | ", 3) != 0)
			continue;
		ruling[1] = line[3];
		for (;; at = end + 1) {
			rows |= 1u << strtoul(at, &end, 10);
			if (end == at || *end != ',')
				break;
		}
		TEST_ASSERT_EQUAL_HEX32_MESSAGE(rows_of(ruling), rows, ruling);
		found |= 1u << (line[3] - '0');
	}
	fclose(file);
	for (size_t i = 0; i < COUNT(readings); i++)
		TEST_ASSERT_TRUE_MESSAGE(found & 1u << (readings[i].ruling[1] - '0'),
		                         readings[i].ruling);
	for (size_t i = 0; i < COUNT(added); i++)
		TEST_ASSERT_TRUE_MESSAGE(found & 1u << (added[i].ruling[1] - '0'), added[i].ruling);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_states_have_the_manuals_numbers_and_names);
	RUN_TEST(test_every_row_is_beside_its_row_of_the_manual);
	RUN_TEST(test_every_row_that_only_we_have_is_there_once_and_marked);
	RUN_TEST(test_every_reading_of_a_ruling_makes_a_difference);
	RUN_TEST(test_the_rulings_are_those_of_the_document);
	return UNITY_END();
}
