/* SPDX-License-Identifier: MIT */
/*
 * No trouble on the wire makes a false value of a thermometer or a switch good (visit_truth.h), nor
 * of two thermometers that convert at once. Each family has a chip that is visited.
 */
#include <string.h>

#include "hal/chips/find.h"
#include "unity.h"

#include "tests/unit/aid/visit_truth.h"

void setUp(void)
{
}

void tearDown(void)
{
	if (bus)
		visit_end();
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
static void look_at_neighbour(const char *chip)
{
	struct visit visit = {.chip = chip, .property = "temperature"};
	struct trouble what = {.kind = TROUBLE_NONE, .mask = 1};
	uint32_t slots = 0;

	do {
		native_begin();
		wire_init(&host, 1, 1);
		wire_net.trouble = &trouble;
		struct sim_slave *fed = wire_add(0, "DS18B20", 1), *supplied = wire_add(0, chip, 2);

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

static void test_no_trouble_makes_a_neighbour_of_one_fed_by_the_wire_say_what_is_not_true(void)
{
	look_at_neighbour("DS18B20");
	look_at_neighbour("MAX31825");
	look_at_neighbour("MAX31850");
}

/* Families may share a table. */
static void test_each_family_that_has_properties_has_a_chip_that_is_visited(void)
{
#define NAME(name, chip, parasite) chip,
	static const char *const chips[] = {VISIT_ALL(NAME)};
	const struct family *family;

	for (unsigned n = 0; (family = family_nth(n)); n++) {
		bool visited_once = true;

		for (unsigned i = 0; i < family->count; i++)
			visited_once &= family->properties[i].offline;
		for (unsigned i = 0; i < sizeof(chips) / sizeof(chips[0]); i++)
			visited_once |= family_of(sim_family_find(chips[i], 0)->code)->properties ==
			                family->properties;
		TEST_ASSERT_TRUE_MESSAGE(visited_once, family->type);
	}
}

#define LOOKS(name, chip, parasite) \
	static void test_no_trouble_makes_a_##name##_say_what_is_not_true(void) \
	{ \
		visit_truth(chip, parasite); \
	}

VISIT_CHIPS(LOOKS)

#define RUN(name, chip, parasite) RUN_TEST(test_no_trouble_makes_a_##name##_say_what_is_not_true);

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_family_that_has_properties_has_a_chip_that_is_visited);
	VISIT_CHIPS(RUN)
	RUN_TEST(test_no_trouble_makes_a_neighbour_of_one_fed_by_the_wire_say_what_is_not_true);
	return UNITY_END();
}
