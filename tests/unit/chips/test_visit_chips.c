/* SPDX-License-Identifier: MIT */
/*
 * No trouble, restart or noise makes a thermometer or a switch say what is not true, and no trouble
 * two thermometers that convert at once. Each family has a chip that is visited.
 */
#include <string.h>

#include "hal/chips/find.h"
#include "unity.h"

#include "tests/unit/aid/visit_group.h"

static const struct visit writes[] = {
	{.chip = "DS18B20", .property = "temphigh", .write = "33"},
	{.chip = "DS18B20", .property = "templow", .write = "-7", .parasite = true},
	{.chip = "DS18B20", .property = "tempres", .write = "10"},
	{.chip = "DS18S20", .property = "temphigh", .write = "33"},
	{.chip = "DS28EA00", .property = "latch.BYTE", .write = "1"},
	{.chip = "DS2405", .property = "PIO", .write = "1"},
	{.chip = "DS2405", .property = "PIO", .write = "0", .turned = true},
	{.chip = "DS2406", .property = "PIO.BYTE", .write = "2"},
	{.chip = "DS2406", .property = "PIO.A", .write = "1"},
	{.chip = "DS2406", .property = "set_alarm", .write = "121"},
	{.chip = "DS2406", .property = "latch.BYTE", .write = "0"},
	{.chip = "DS2408", .property = "PIO.BYTE", .write = "165"},
	{.chip = "DS2408", .property = "PIO.3", .write = "1"},
	{.chip = "DS2408", .property = "latch.BYTE", .write = "0"},
	{.chip = "DS2408", .property = "set_alarm", .write = "133333333"},
	{.chip = "DS2408", .property = "strobe", .write = "1"},
	{.chip = "DS2408", .property = "por", .write = "0"},
	{.chip = "DS2413", .property = "PIO.BYTE", .write = "2"},
	{.chip = "DS2450", .property = "PIO.B", .write = "0"},
	{.chip = "DS2450", .property = "set_alarm/high.C", .write = "0"},
	{.chip = "DS2450", .property = "set_alarm/unset", .write = "1"},
	{.chip = "DS2450", .property = "set_alarm/volthigh.D", .write = "3"},
	{.chip = "DS2450", .property = "power", .write = "1"},
	{.chip = "DS2450", .property = "pages/page.2", .write = "abcdefgh"},
	{0},
};

VISIT_GROUP(VISIT_CHIPS)

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

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_family_that_has_properties_has_a_chip_that_is_visited);
	VISIT_RUN(VISIT_CHIPS)
	RUN_TEST(test_no_trouble_makes_a_neighbour_of_one_fed_by_the_wire_say_what_is_not_true);
	return UNITY_END();
}
