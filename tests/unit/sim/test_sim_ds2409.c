/* SPDX-License-Identifier: MIT */
/* DS2409: who is behind a branch hears the master only while that branch is on. */
#include <string.h>

#include "unity.h"

#include "hal/sim/branch.h"
#include "hal/sim/scenario.h"
#include "tests/unit/aid/hand.h"

static struct hand hand;
static struct sim_slave *coupler, *inner, *trunk, *on_main, *on_aux, *deep;

void setUp(void)
{
	hand_clear(&hand);
	coupler = hand_plug(&hand, &sim_ds2409, 1);
	inner = hand_plug(&hand, &sim_ds2409, 2);
	trunk = hand_plug(&hand, &sim_ds2401, 1);
	on_main = hand_plug(&hand, &sim_ds2401, 2);
	on_aux = hand_plug(&hand, &sim_ds18b20, 3);
	deep = hand_plug(&hand, &sim_ds2401, 4);
	sim_branch_put(on_main, coupler, SIM_MAIN);
	sim_branch_put(inner, coupler, SIM_MAIN);
	sim_branch_put(on_aux, coupler, SIM_AUX);
	sim_branch_put(deep, inner, SIM_AUX);
}

void tearDown(void)
{
	hand_clear(&hand);
}

static void command(const struct sim_slave *slave, uint8_t code)
{
	hand_match(&hand, slave);
	hand_write(&hand, &code, 1);
}

/* Returns the reset response. */
static uint8_t smart_on(const struct sim_slave *slave, uint8_t code)
{
	const uint8_t stimulus = 0xFF;
	uint8_t response;

	command(slave, code);
	hand_write(&hand, &stimulus, 1);
	response = hand_byte(&hand);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(code, hand_byte(&hand), "confirmation");
	return response;
}

static uint8_t status(uint8_t control)
{
	uint8_t info;

	command(coupler, 0x5A);
	hand_write(&hand, &control, 1);
	info = hand_byte(&hand);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(info, hand_byte(&hand), "confirmation");
	return info;
}

static bool is_found(const struct sim_slave *slave)
{
	uint8_t rom[16][8];
	unsigned n = hand_search(&hand, 0xF0, rom, 16);

	for (unsigned i = 0; i < n; i++) {
		if (memcmp(rom[i], slave->rom, 8) == 0)
			return true;
	}
	return false;
}

static void expect_found(bool main, bool aux, bool behind_inner)
{
	TEST_ASSERT_TRUE(is_found(trunk));
	TEST_ASSERT_TRUE(is_found(coupler));
	TEST_ASSERT_EQUAL(main, is_found(on_main));
	TEST_ASSERT_EQUAL(aux, is_found(on_aux));
	TEST_ASSERT_EQUAL(behind_inner, is_found(deep));
}

static void test_one_branch_at_most_is_on_the_wire(void)
{
	expect_found(false, false, false);
	TEST_ASSERT_EQUAL_HEX8(0x00, smart_on(coupler, 0x33));
	expect_found(false, true, false);
	TEST_ASSERT_EQUAL_HEX8(0x00, smart_on(coupler, 0xCC));
	expect_found(true, false, false);
	command(coupler, 0x66);
	TEST_ASSERT_EQUAL_HEX8(0x66, hand_byte(&hand));
	expect_found(false, false, false);
	command(coupler, 0xA5);
	TEST_ASSERT_EQUAL_HEX8(0xA5, hand_byte(&hand));
	expect_found(true, false, false);
	sim_slave_brownout(coupler, hand.now);
	expect_found(false, false, false);
}

static void test_a_coupler_behind_a_branch_has_branches_of_its_own(void)
{
	smart_on(coupler, 0xCC);
	TEST_ASSERT_EQUAL_HEX8(0xFF, smart_on(inner, 0xCC)); /* nobody is there */
	TEST_ASSERT_EQUAL_HEX8(0x00, smart_on(inner, 0x33));
	expect_found(true, false, true);
	command(coupler, 0x66);
	expect_found(false, false, false);
	smart_on(coupler, 0xCC);
	expect_found(true, false, true);
}

/* "Usage example", steps 16 to 21 */
static void test_after_smart_on_those_behind_the_branch_alone_take_a_rom_command(void)
{
	const uint8_t read_rom = 0x33;
	uint8_t rom[8];

	smart_on(coupler, 0x33);
	hand_write(&hand, &read_rom, 1);
	hand_read(&hand, rom, 8);
	TEST_ASSERT_EQUAL_HEX8_ARRAY(on_aux->rom, rom, 8);
}

static void test_a_short_of_a_branch_that_is_on_is_one_of_the_wire(void)
{
	coupler->input[SIM_AUX] = sim_constant(0);
	expect_found(false, false, false);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x27, status(0xFF), "its level is low, it has an event");
	TEST_ASSERT_EQUAL_HEX8(0x00, smart_on(coupler, 0x33));
	TEST_ASSERT_FALSE(hand_reset(&hand));
	TEST_ASSERT_FALSE(sim_wire_level(&hand.wire, hand.now));
	coupler->input[SIM_AUX] = sim_constant(1);
	expect_found(false, true, false);
}

/* Tables 1 and 2 */
static void test_the_status_has_outputs_levels_events_and_the_control_output(void)
{
	TEST_ASSERT_EQUAL_HEX8(0x0F, status(0xFF));
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x4F, status(0x40), "auto, auxiliary");
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0xCF, status(0xA0), "manual, on");
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0xCF, status(0x08), "is not to be written");
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x8F, status(0x20), "manual, off");
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x0F, status(0x00), "auto, main");
	smart_on(coupler, 0x33);
	TEST_ASSERT_EQUAL_HEX8(0x0B, status(0xFF));
	smart_on(coupler, 0xCC);
	TEST_ASSERT_EQUAL_HEX8(0x0E, status(0xFF));
}

static void test_an_arrival_behind_a_branch_that_is_off_is_an_event(void)
{
	TEST_ASSERT_FALSE(hand_in_alarm(&hand, coupler));
	sim_wire_plug(&hand.wire, on_main, false, hand.now);
	TEST_ASSERT_FALSE(hand_in_alarm(&hand, coupler));
	sim_wire_plug(&hand.wire, on_main, true, hand.now);
	TEST_ASSERT_TRUE(hand_in_alarm(&hand, coupler));
	TEST_ASSERT_EQUAL_HEX8(0x1F, status(0xFF));
	smart_on(coupler, 0xCC);
	TEST_ASSERT_EQUAL_HEX8(0x1E, status(0xFF));
	command(coupler, 0x66);
	TEST_ASSERT_EQUAL_HEX8(0x0F, status(0xFF));
	TEST_ASSERT_FALSE(hand_in_alarm(&hand, coupler));
}

static void test_a_discharge_restarts_what_the_branches_feed(void)
{
	on_aux->parasite = true;
	command(coupler, 0x99);
	TEST_ASSERT_EQUAL_HEX8(0x99, hand_byte(&hand));
	hand.now += 50 * HAND_MS;
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x0F, status(0xFF), "it is over");
	TEST_ASSERT_EQUAL_UINT64_MESSAGE(1, on_aux->power_ons, "too short");
	command(coupler, 0x99);
	hand.now += 100 * HAND_MS;
	command(coupler, 0x66);
	TEST_ASSERT_EQUAL_UINT64(2, on_aux->power_ons);
	TEST_ASSERT_EQUAL_UINT64(1, on_main->power_ons);
}

static void test_a_scenario_puts_devices_behind_branches(void)
{
	static const char text[] =
		"chip DS2482-800 0x18\nchannel 2\nDS2409 1F.000000000001 as hub\n"
		"branch hub main\nDS2409 1F.000000000002 as inner\n"
		"branch inner aux\nDS2401 01.000000000001 as key\n"
		"channel 2\nDS2401 01.000000000002 as free\n";
	struct sim_net net;
	char why[200] = "";

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, sim_scenario_parse("x", text, &net, why, sizeof(why)),
	                              why);
	TEST_ASSERT_EQUAL_size_t(4, net.chip[0].wire[2].count);
	TEST_ASSERT_EQUAL_PTR(&sim_net_slave(&net, "hub")->branches[SIM_MAIN],
	                      sim_net_slave(&net, "inner")->behind);
	TEST_ASSERT_EQUAL_PTR(&sim_net_slave(&net, "inner")->branches[SIM_AUX],
	                      sim_net_slave(&net, "key")->behind);
	TEST_ASSERT_NULL(sim_net_slave(&net, "free")->behind);
	sim_net_clear(&net);
}

static void test_a_scenario_refuses_a_branch_of_nothing(void)
{
	static const struct {
		const char *text, *why;
	} cases[] = {
		{"chip DS2483 0x18\nbranch hub main\n", "x:2:8: \"hub\": expected the name of a "
	                                                "DS2409 of the last chip"},
		{"chip DS2483 0x18\nDS2409 1F.000000000001 as hub\nbranch hub both\n",
	         "x:3:12: \"both\": expected main or aux"},
		{"chip DS2483 0x18\nDS2409 1F.000000000001 as hub\nchip DS2483 0x19\n"
	         "branch hub main\n",
	         "x:4:8: \"hub\": expected the name of a DS2409 of the last chip"},
	};

	for (unsigned i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct sim_net net;
		char why[200] = "";

		TEST_ASSERT_NOT_EQUAL(
			0, sim_scenario_parse("x", cases[i].text, &net, why, sizeof(why)));
		TEST_ASSERT_EQUAL_STRING(cases[i].why, why);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_one_branch_at_most_is_on_the_wire);
	RUN_TEST(test_a_coupler_behind_a_branch_has_branches_of_its_own);
	RUN_TEST(test_after_smart_on_those_behind_the_branch_alone_take_a_rom_command);
	RUN_TEST(test_a_short_of_a_branch_that_is_on_is_one_of_the_wire);
	RUN_TEST(test_the_status_has_outputs_levels_events_and_the_control_output);
	RUN_TEST(test_an_arrival_behind_a_branch_that_is_off_is_an_event);
	RUN_TEST(test_a_discharge_restarts_what_the_branches_feed);
	RUN_TEST(test_a_scenario_puts_devices_behind_branches);
	RUN_TEST(test_a_scenario_refuses_a_branch_of_nothing);
	return UNITY_END();
}
