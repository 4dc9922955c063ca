/* SPDX-License-Identifier: MIT */
/* No trouble, no restart and no noise makes a battery monitor say what is not true. */
#include <errno.h>

#include "tests/unit/aid/visit_group.h"

static const struct visit writes[] = {
	{.chip = "DS2436", .property = "pages/page.0", .write = "abcdefgh", .stride = 5},
	{.chip = "DS2436", .property = "pages/page.1", .write = "abcdefgh", .stride = 3},
	{.chip = "DS2437", .property = "pages/page.4", .write = "abcdefgh", .stride = 3},
	{.chip = "DS2437", .property = "IAD", .write = "0", .stride = 3},
	{.chip = "DS2438", .property = "pages/page.4", .write = "abcdefgh", .stride = 3},
	{.chip = "DS2438", .property = "B1-R1-A/gain", .write = "12.34", .stride = 3},
	{.chip = "DS2438", .property = "IAD", .write = "0", .stride = 3},
	{.chip = "DS2720", .property = "ce", .write = "0"},
	{.chip = "DS2720", .property = "uv", .write = "0"},
	{.chip = "DS2720", .property = "psf", .write = "1"},
	{.chip = "DS2720", .property = "pages/page.1", .write = "wxyz"},
	{.chip = "DS2740", .property = "PIO", .write = "1"},
	{.chip = "DS2740", .property = "smod", .write = "1"},
	{.chip = "DS2740", .property = "volthours", .write = "0.1"},
	{0},
};

VISIT_GROUP(VISIT_BATTERIES)

static void test_a_true_zero_of_a_ds2438_is_read_but_not_one_of_its_supply(void)
{
	static const char *const properties[] = {"temperature", "VAD", "vis", "latesttemp"};
	struct visit visit = {.chip = "DS2438", .property = "VDD"};
	uint32_t id;

	for (unsigned i = 0; i < sizeof(properties) / sizeof(properties[0]); i++) {
		visit.property = properties[i];
		visit_begin(&visit);
		wire_set(visited, "temperature", 0);
		wire_set(visited, "vad", 0);
		wire_set(visited, "vsens", 0);
		sim_slave_brownout(visited, wire_time());
		id = visit_go(&visit, &(struct trouble){.kind = TROUBLE_NONE});
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer_to(id)->err, properties[i]);
		TEST_ASSERT_EQUAL_STRING("           0", (char *)data[id]);
		visit_end();
	}
	visit.property = "VDD";
	visit_begin(&visit);
	wire_set(visited, "vdd", 0);
	id = visit_go(&visit, &(struct trouble){.kind = TROUBLE_NONE});
	TEST_ASSERT_EQUAL_INT(-ENODATA, answer_to(id)->err);
	visit_end();
}

int main(void)
{
	UNITY_BEGIN();
	VISIT_RUN(VISIT_BATTERIES)
	RUN_TEST(test_a_true_zero_of_a_ds2438_is_read_but_not_one_of_its_supply);
	return UNITY_END();
}
