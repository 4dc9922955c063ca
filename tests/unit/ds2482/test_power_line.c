/* SPDX-License-Identifier: MIT */
/* GPIO lines beside the chips: the supply of the wire, the sleep pin. On a chip that is played. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "hal/sim/event.h"
#include "hal/sim/net.h"
#include "tests/unit/aid/fake_gpio.h"
#include "tests/unit/aid/one_bus.h"
#include "tests/unit/aid/plant.h"

#define POWER 2
#define SLPZ 3

static struct sim_net *net;
static int64_t off_ns, dark_ns;
static unsigned cycles;
static bool low_is_on, is_broken; /* a chip that no supply brings back */
static char why[200];

static const char scenario[] = "chip DS2482-800 0x18\n"
			       "DS18B20 28.A0B1C2000028 temperature 20\n"
			       "channel 5\n"
			       "DS18B20 28.A0B1C2010028 temperature 30\n";

static void driven(unsigned line, bool high)
{
	if (line == SLPZ)
		net->chip[0].asleep = !high;
	if (line != POWER)
		return;
	if (high == low_is_on) {
		off_ns = host.now;
		return;
	}
	if (!off_ns)
		return;
	dark_ns = host.now - off_ns;
	cycles++;
	if (!is_broken)
		net->chip[0].stuck = SIM_FREE;
	sim_chip_power_on(&net->chip[0], net->time);
}

void setUp(void)
{
	fake_gpio_begin();
	fake_gpio.driven = driven;
	off_ns = dark_ns = 0;
	cycles = 0;
	low_is_on = is_broken = false;
	simulate(scenario);
	net = plant_net(bus);
}

void tearDown(void)
{
	one_bus_end();
	fake_gpio_end();
}

static void option(const char *key, const char *text)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, bus_option(bus, key, text, why, sizeof(why)), why);
}

static int read_temperature(const char *path)
{
	char text[64];
	struct bus_req req = {.id = 1,
	                      .op = BUS_READ,
	                      .prio = BUS_INPUT,
	                      .fresh = true,
	                      .path = path,
	                      .data = (uint8_t *)text,
	                      .len = sizeof(text),
	                      .deadline_ns = host.now + 20 * HOST_S};

	host.answers = 0;
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req));
	TEST_ASSERT_TRUE(host_run_answers(&host, bus, 1, host.now + 21 * HOST_S));
	return host.answer[0].err;
}

static void read_both(void)
{
	TEST_ASSERT_EQUAL_INT(0, read_temperature("/28.A0B1C2000028/temperature"));
	TEST_ASSERT_EQUAL_INT(0, read_temperature("/28.A0B1C2010028/temperature"));
}

static void test_a_chip_that_nothing_else_helps_has_its_supply_cycled(void)
{
	option("PowerLine", "gpiochip0/2");
	host_run(&host, bus, host.now + 2 * HOST_S);
	read_both();
	TEST_ASSERT_TRUE(fake_gpio.line[POWER].high);
	net->chip[0].stuck = SIM_STUCK_FAST;
	host_run(&host, bus, host.now + 10 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, cycles);
	TEST_ASSERT_TRUE(fake_gpio.line[POWER].high);
	TEST_ASSERT_EQUAL_INT64(500 * HOST_MS, dark_ns);
	TEST_ASSERT_EQUAL_UINT64(1, counted("recover_power_cycle"));
	TEST_ASSERT_EQUAL_UINT64(0, counted("recover_reopen"));
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
	read_both();
}

static void test_all_devices_count_as_restarted_after_it(void)
{
	option("PowerLine", "gpiochip0/2");
	host_run(&host, bus, host.now + 2 * HOST_S);
	read_both();
	net->chip[0].stuck = SIM_STUCK_FAST;
	host_run(&host, bus, host.now + 10 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, cycles);
	TEST_ASSERT_EQUAL_UINT(2, host_events(&host, BUS_POR));
}

static void test_where_it_does_not_help_no_device_has_restarted(void)
{
	option("PowerLine", "gpiochip0/2");
	host_run(&host, bus, host.now + 2 * HOST_S);
	read_both();
	is_broken = true;
	net->chip[0].stuck = SIM_STUCK_FAST;
	host_run(&host, bus, host.now + 10 * HOST_S);
	TEST_ASSERT_EQUAL_UINT64(1, counted("recover_power_cycle"));
	TEST_ASSERT_EQUAL_UINT64(1, counted("recover_reopen"));
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_DOWN));
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_POR));
}

static void test_how_long_it_is_off_and_which_way_round_can_be_said(void)
{
	low_is_on = true;
	option("PowerLine", "/dev/gpiochip0/2,active-low,open-drain");
	option("PowerOffMs", "1500");
	host_run(&host, bus, host.now + 2 * HOST_S);
	TEST_ASSERT_FALSE(fake_gpio.line[POWER].high);
	TEST_ASSERT_EQUAL_UINT8(GPIO_OPEN_DRAIN, fake_gpio.line[POWER].setup.drive);
	read_both();
	net->chip[0].stuck = SIM_STUCK_FAST;
	host_run(&host, bus, host.now + 10 * HOST_S);
	TEST_ASSERT_FALSE(fake_gpio.line[POWER].high);
	TEST_ASSERT_EQUAL_UINT(1, cycles);
	TEST_ASSERT_EQUAL_INT64(1500 * HOST_MS, dark_ns);
}

static void test_the_supply_stays_on_when_the_adapter_is_lost(void)
{
	option("PowerLine", "gpiochip0/2");
	host_run(&host, bus, host.now + 2 * HOST_S);
	TEST_ASSERT_EQUAL_INT(
		0, sim_scenario_event(net, "remove adapter for 10s", host.now, why, sizeof(why)));
	host_run(&host, bus, host.now + 9 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_DOWN));
	TEST_ASSERT_TRUE(fake_gpio.line[POWER].held);
	host_run(&host, bus, host.now + 12 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(2, host_events(&host, BUS_UP));
	TEST_ASSERT_EQUAL_UINT(1, fake_gpio.line[POWER].requests);
	TEST_ASSERT_EQUAL_UINT(0, cycles);
	read_both();
}

static void test_without_its_line_the_target_is_down_and_says_why(void)
{
	strcpy(fake_gpio.line[POWER].consumer, "regulator");
	option("PowerLine", "gpiochip0/2");
	host_run(&host, bus, host.now + 3 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host.events);
	TEST_ASSERT_EQUAL_UINT8(BUS_DOWN, host.event[0].news);
	TEST_ASSERT_EQUAL_INT(-EBUSY, host.event[0].err);
	TEST_ASSERT_EQUAL_STRING("line 2 of fake is in use by \"regulator\"", host.event[0].text);
	fake_gpio.line[POWER].consumer[0] = '\0';
	host_run(&host, bus, host.now + 6 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_UP));
	read_both();
}

static void test_the_chips_sleep_while_the_target_is_suspended(void)
{
	option("SleepLine", "gpiochip0/3");
	net->chip[0].asleep = true;
	host_run(&host, bus, host.now + 2 * HOST_S);
	TEST_ASSERT_TRUE(fake_gpio.line[SLPZ].high);
	read_both();
	bus_suspend(bus, true);
	TEST_ASSERT_FALSE(fake_gpio.line[SLPZ].high);
	bus_suspend(bus, false);
	host_run(&host, bus, host.now + 2 * HOST_S);
	read_both();
	bus_destroy(bus);
	bus = NULL;
	TEST_ASSERT_FALSE(fake_gpio.line[SLPZ].high);
}

static void test_options_that_cannot_be_are_refused_with_a_reason(void)
{
	static const struct {
		const char *key, *text, *why;
	} bad[] = {
		{"PowerLine", "22", "\"22\": expected CHIP/LINE, as gpiochip0/22"},
		{"SleepLine", "gpiochip0/2,low",
	         "\"low\": expected active-low, pull-up, pull-down, open-drain or open-source"},
		{"PowerOffMs", "0", "\"0\": expected milliseconds from 1 to 60000"},
		{"PowerOffMs", "1s", "\"1s\": expected milliseconds from 1 to 60000"},
	};

	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
		TEST_ASSERT_EQUAL_INT(-EINVAL,
		                      bus_option(bus, bad[i].key, bad[i].text, why, sizeof(why)));
		TEST_ASSERT_EQUAL_STRING(bad[i].why, why);
	}
	TEST_ASSERT_EQUAL_INT(-ENOENT, bus_option(bus, "ActiveLow", "2", why, sizeof(why)));
	TEST_ASSERT_EQUAL_STRING("a target of scheme sim has no option ActiveLow", why);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_chip_that_nothing_else_helps_has_its_supply_cycled);
	RUN_TEST(test_all_devices_count_as_restarted_after_it);
	RUN_TEST(test_where_it_does_not_help_no_device_has_restarted);
	RUN_TEST(test_how_long_it_is_off_and_which_way_round_can_be_said);
	RUN_TEST(test_the_supply_stays_on_when_the_adapter_is_lost);
	RUN_TEST(test_without_its_line_the_target_is_down_and_says_why);
	RUN_TEST(test_the_chips_sleep_while_the_target_is_suspended);
	RUN_TEST(test_options_that_cannot_be_are_refused_with_a_reason);
	return UNITY_END();
}
