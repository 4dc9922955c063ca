/* SPDX-License-Identifier: MIT */
/*
 * No trouble on the wire makes a false value good: each property of each chip is read with each
 * command lost, each bit turned over and each presence pulse lost in turn. The answer is the truth
 * or an error.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/chips/find.h"
#include "unity.h"

#include "tests/unit/aid/visit.h"

static char truth[4096];
static uint32_t truth_len;
static unsigned false_values;

void setUp(void)
{
}

void tearDown(void)
{
	if (bus)
		visit_end();
}

static bool is_true(const struct visit *visit, const struct bus_answer *answer)
{
	double more = answer->number - strtod(truth, NULL);

	if (visit->slack > 0)
		return more >= 0 && more <= visit->slack;
	return answer->len == truth_len && memcmp(data[answer->id], truth, truth_len) == 0;
}

static void one(const struct visit *visit, const struct trouble *what)
{
	char text[300];
	const struct bus_answer *answer = answer_to(visit_go(visit, what));

	if (answer->err || is_true(visit, answer))
		return;
	snprintf(text, sizeof(text), "%s: '%.40s' for '%.40s'", visit_says(visit, what),
	         (char *)data[answer->id], truth);
	TEST_MESSAGE(text);
	false_values++;
}

static void look(const struct visit *visit)
{
	visit_begin(visit);
	const struct bus_answer *answer = answer_to(
		visit_go(visit, &(struct trouble){.kind = TROUBLE_NONE}));

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer->err, visit->property);
	truth_len = answer->len;
	memcpy(truth, data[answer->id], truth_len);
	truth[truth_len] = '\0';
	visit_end();
	visit_each(visit, one);
}

static void look_untroubled_first(struct visit *visit, const struct property *property)
{
	(void)property;
	visit_begin(visit);
	int err = answer_to(visit_go(visit, &(struct trouble){.kind = TROUBLE_NONE}))->err;
	visit->stride = trouble.slots > 15000  ? 211
	                : trouble.slots > 4000 ? 13
	                : trouble.slots > 2500 ? 5
	                                       : 1;
	visit_end();
	if (!err)
		look(visit);
}

static void look_at(const char *chip, bool parasite)
{
	const struct sim_input *inputs = sim_family_find(chip, 0)->inputs;

	false_values = 0;
	visit_properties(chip, parasite, false, look_untroubled_first);
	if (inputs && inputs[0].pin)
		visit_properties(chip, parasite, true, look_untroubled_first);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(0, false_values, chip);
}

static uint32_t both(struct sim_slave *fed, struct sim_slave *supplied, const char *what)
{
	uint32_t id[] = {ask(BUS_READ, BUS_INPUT, true, of(fed, "temperature"), NULL),
	                 ask(BUS_READ, BUS_INPUT, true, of(supplied, "temperature"), NULL)};

	for (unsigned i = 0; i < 2 && what; i++)
		if (answer_to(id[i])->err == 0)
			TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(i ? 71.5 : 61.5, answer_to(id[i])->number,
			                                 what);
	answer_to(id[0]);
	answer_to(id[1]);
	return trouble.slots;
}

/* One Convert T with the strong pull-up serves both, and neither can show that it heard it. */
static void test_no_trouble_makes_a_neighbour_of_one_fed_by_the_wire_say_what_is_not_true(void)
{
	struct visit visit = {.chip = "both", .property = "temperature"};
	struct trouble what = {.kind = TROUBLE_NONE, .mask = 1};
	uint32_t slots = 0;

	do {
		native_begin();
		wire_init(&host, 1, 1);
		wire_net.trouble = &trouble;
		struct sim_slave *fed = wire_add(0, "DS18B20", 1),
				 *supplied = wire_add(0, "DS18B20", 2);

		fed->parasite = true;
		trouble_none(&trouble);
		start();
		both(fed, supplied, NULL);
		both(fed, supplied, NULL);
		wire_set(fed, "temperature", 61.5);
		wire_set(supplied, "temperature", 71.5);
		host_run(&host, bus, host.now + 100 * HOST_MS);
		trouble_none(&trouble);
		trouble.kind = what.kind;
		trouble.at = what.at;
		trouble.mask = what.mask;
		uint32_t n = both(fed, supplied, visit_says(&visit, &what));
		slots = what.kind == TROUBLE_NONE ? n : slots;
		visit_end();
		what.at += what.kind == TROUBLE_DEAF;
		what.kind = what.kind == TROUBLE_TURN ? TROUBLE_DEAF : TROUBLE_TURN;
	} while (what.at < slots);
}

#define LOOKS(name, chip, parasite) \
	static void test_no_trouble_makes_a_##name##_say_what_is_not_true(void) \
	{ \
		look_at(chip, parasite); \
	}

VISIT_CHIPS(LOOKS)

#define RUN(name, chip, parasite) RUN_TEST(test_no_trouble_makes_a_##name##_say_what_is_not_true);

int main(void)
{
	UNITY_BEGIN();
	VISIT_CHIPS(RUN)
	RUN_TEST(test_no_trouble_makes_a_neighbour_of_one_fed_by_the_wire_say_what_is_not_true);
	return UNITY_END();
}
