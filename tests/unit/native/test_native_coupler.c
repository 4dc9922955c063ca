/* SPDX-License-Identifier: MIT */
/* Devices behind the branches of couplers are found, listed, read, written, and in alarm. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/sim/branch.h"
#include "hal/sim/families.h"
#include "hal/wire/coupler.h"
#include "tests/unit/aid/native_scene.h"
#include "tests/unit/aid/parts.h"

static struct sim_slave *coupler, *inner, *trunk, *on_main, *on_aux, *deep, *relay;

/* coupler: main (on_main, inner: aux (deep)), aux (on_aux, relay); trunk; a second wire. */
static void plant(void)
{
	wire_init(&host, 2, 2);
	trunk = wire_add(0, "DS18B20", 1);
	coupler = wire_add(0, "DS2409", 2);
	inner = wire_add(0, "DS2409", 3);
	on_main = wire_add(0, "DS18B20", 4);
	on_aux = wire_add(0, "DS18B20", 5);
	deep = wire_add(0, "DS18B20", 6);
	relay = wire_add(0, "DS2413", 7);
	wire_add(1, "DS2401", 8);
	sim_branch_put(on_main, coupler, SIM_MAIN);
	sim_branch_put(inner, coupler, SIM_MAIN);
	sim_branch_put(on_aux, coupler, SIM_AUX);
	sim_branch_put(relay, coupler, SIM_AUX);
	sim_branch_put(deep, inner, SIM_AUX);
	wire_set(trunk, "temperature", 10);
	wire_set(on_main, "temperature", 20);
	wire_set(on_aux, "temperature", 30);
	wire_set(deep, "temperature", 40);
}

void setUp(void)
{
	native_begin();
	plant();
}

void tearDown(void)
{
	native_end();
}

/* The bus is up and knows the devices. */
static void begin(void)
{
	start();
	TEST_ASSERT_EQUAL_INT(0, result(BUS_PROBE, name_of(deep), NULL));
	host.events = 0;
}

static const char *list(bool fresh, const char *what)
{
	uint32_t id = ask(BUS_DIR, BUS_INPUT, fresh, what, NULL);

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer_to(id)->err, what);
	return (char *)data[id];
}

/* "/1F.x/main/28.y/temperature" and the like, made of slaves and words. */
static const char *way(const struct sim_slave *first, const char *word,
                       const struct sim_slave *second, const char *rest)
{
	static char text[160];

	snprintf(text, sizeof(text), "%s/%s%s/%s", name_of(first), word, name_of(second), rest);
	return text;
}

static const char *deep_way(const char *rest)
{
	static char text[160];

	snprintf(text, sizeof(text), "%s/main%s/aux%s/%s", name_of(coupler), name_of(inner),
	         name_of(deep), rest);
	return text;
}

static bool has_line(const char *text, const char *line)
{
	size_t n = strlen(line);

	while (text && *text) {
		if (strncmp(text, line, n) == 0 && text[n] == '\n')
			return true;
		text = strchr(text, '\n');
		text += text != NULL;
	}
	return false;
}

static void test_a_branch_is_a_directory_of_what_is_behind_it(void)
{
	begin();
	for (int fresh = 0; fresh < 2; fresh++) {
		TEST_ASSERT_EQUAL_STRING("/1F.02005DDF0300/main/28.04005DDF0300\n"
		                         "/1F.02005DDF0300/main/1F.03005DDF0300\n",
		                         list(fresh, "/1F.02005DDF0300/main"));
		TEST_ASSERT_EQUAL_STRING(
			"/1F.02005DDF0300/main/1F.03005DDF0300/aux/28.06005DDF0300\n",
			list(fresh, "/1F.02005DDF0300/main/1F.03005DDF0300/aux"));
		TEST_ASSERT_EQUAL_STRING("",
		                         list(fresh, "/1F.02005DDF0300/main/1F.03005DDF0300/main"));
		TEST_ASSERT_FALSE(has_line(list(fresh, "/"), "/28.04005DDF0300"));
		TEST_ASSERT_TRUE(has_line(list(fresh, "/"), "/28.01005DDF0300"));
		TEST_ASSERT_TRUE(has_line(list(fresh, "/bus.0"), "/bus.0/1F.02005DDF0300"));
		TEST_ASSERT_FALSE(has_line(list(fresh, "/bus.0"), "/bus.0/28.05005DDF0300"));
	}
	TEST_ASSERT_TRUE(has_line(list(false, "/1F.02005DDF0300"), "/1F.02005DDF0300/main"));
	TEST_ASSERT_TRUE(has_line(list(false, "/1F.02005DDF0300/main/28.04005DDF0300"),
	                          way(coupler, "main", on_main, "temperature")));
	TEST_ASSERT_FALSE(has_line(list(false, "/"), "/bus.2"));
}

static void test_each_device_is_read_by_its_way_and_by_its_id(void)
{
	begin();
	expect(true, of(trunk, "temperature"), "          10");
	expect(true, way(coupler, "main", on_main, "temperature"), "          20");
	expect(true, way(coupler, "aux", on_aux, "temperature"), "          30");
	expect(true, deep_way("temperature"), "          40");
	expect(true, of(on_main, "temperature"), "          20");
	expect(true, of(deep, "temperature"), "          40");
	expect(false, way(coupler, "main", on_main, "present"), "1");
}

static void test_a_way_that_does_not_lead_to_the_device_is_none(void)
{
	begin();
	TEST_ASSERT_EQUAL_INT(-ENODEV,
	                      result(BUS_READ, way(coupler, "aux", on_main, "temperature"), NULL));
	TEST_ASSERT_EQUAL_INT(
		-ENODEV,
		result(BUS_READ, "/bus.1/1F.02005DDF0300/main/28.04005DDF0300/temperature", NULL));
	TEST_ASSERT_EQUAL_INT(-ENODEV,
	                      result(BUS_READ, "/bus.0/28.04005DDF0300/temperature", NULL));
	TEST_ASSERT_EQUAL_INT(-ENODEV,
	                      result(BUS_READ, way(coupler, "main", trunk, "temperature"), NULL));
	TEST_ASSERT_EQUAL_INT(-EISDIR, result(BUS_READ, "/1F.02005DDF0300/main", NULL));
	TEST_ASSERT_EQUAL_INT(-ENODEV, result(BUS_DIR, "/1F.09005DDF0300/main", NULL));
}

static void test_all_thermometers_convert_branch_by_branch(void)
{
	uint32_t id[4];

	begin();
	for (int round = 0; round < 4; round++) {
		int64_t begun = host.now;

		wire_set(deep, "temperature", 41 + round);
		id[0] = ask(BUS_READ, BUS_INPUT, true, of(trunk, "temperature"), NULL);
		id[1] = ask(BUS_READ, BUS_INPUT, true, of(on_main, "temperature"), NULL);
		id[2] = ask(BUS_READ, BUS_INPUT, true, of(on_aux, "temperature"), NULL);
		id[3] = ask(BUS_READ, BUS_INPUT, true, of(deep, "temperature"), NULL);
		for (int i = 0; i < 4; i++)
			TEST_ASSERT_EQUAL_INT(0, answer_to(id[i])->err);
		TEST_ASSERT_EQUAL_STRING("          20", (char *)data[id[1]]);
		TEST_ASSERT_EQUAL_CHAR("1234"[round], data[id[3]][11]);
		TEST_ASSERT_LESS_THAN_INT64(2000 * HOST_MS, host.now - begun);
		forget();
		host_run(&host, bus, host.now + 3 * HOST_S);
	}
}

static void test_an_output_behind_a_branch_is_switched(void)
{
	begin();
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, way(coupler, "aux", relay, "PIO.A"), "1"));
	expect(true, way(coupler, "aux", relay, "PIO.BYTE"), "           1");
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(relay, "PIO.A"), "0"));
	expect(true, of(relay, "PIO.BYTE"), "           0");
}

static void test_an_alarm_behind_a_branch_is_listed_with_its_way(void)
{
	begin();
	const struct sim_slave *all[] = {trunk, on_main, on_aux, deep};

	for (int i = 0; i < 4; i++) {
		const char *high = all[i] == deep ? "35" : "50";

		TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(all[i], "templow"), "0"));
		TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(all[i], "temphigh"), high));
	}
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, "/simultaneous/temperature", "1"));
	host_run(&host, bus, host.now + HOST_S);
	for (int i = 0; i < 20; i++)
		TEST_ASSERT_EQUAL_STRING(
			"/alarm/1F.02005DDF0300/main/1F.03005DDF0300/aux/28.06005DDF0300\n",
			list(true, "/alarm"));
	TEST_ASSERT_EQUAL_STRING(
		"/alarm/1F.02005DDF0300/main/1F.03005DDF0300/aux/28.06005DDF0300\n",
		list(true, "/alarm/1F.02005DDF0300/main/1F.03005DDF0300/aux"));
	TEST_ASSERT_EQUAL_STRING("", list(true, "/alarm/29"));
}

static bool is_on(const struct sim_slave *slave)
{
	return slave->branches[SIM_MAIN].on || slave->branches[SIM_AUX].on;
}

static void test_nothing_is_on_while_nobody_asks(void)
{
	begin();
	expect(true, deep_way("temperature"), "          40");
	host_run(&host, bus, host.now + HOST_S / 4);
	TEST_ASSERT_FALSE(is_on(coupler));
	TEST_ASSERT_FALSE(is_on(inner));
}

static void test_a_branch_that_another_program_left_on_is_switched_off(void)
{
	coupler->branches[SIM_AUX].on = true;
	inner->branches[SIM_AUX].on = true;
	begin();
	expect(true, way(coupler, "aux", on_aux, "temperature"), "          30");
	expect(true, deep_way("temperature"), "          40");
	TEST_ASSERT_FALSE(has_line(list(true, "/"), "/28.05005DDF0300"));
}

/* A wire with a coupler alone, that has no error of its own. */
static int bare_error;
static unsigned bare_offs;
static uint8_t bare_last;

static int bare_run(struct link *link, const struct link_part *part)
{
	(void)link;
	if (part->reset && bare_error)
		return bare_error;
	if (part->out_n)
		bare_last = part->out[part->out_n - 1];
	bare_offs += part->out_n && bare_last == 0x66;
	if (part->in_n)
		memset(part->in, bare_last == 0x66 ? 0x66 : 0, part->in_n);
	return 0;
}

static void test_a_coupler_that_a_short_kept_from_being_told_is_told_after_it(void)
{
	static const struct link_ops ops = {.name = "bare", .run = bare_run};
	static const uint8_t rom[8] = {COUPLER_FAMILY};
	struct link bare = {.ops = &ops};
	struct trunk on_bare = {0};
	struct coupler_seen seen = {0};
	struct coupler only;
	struct link *link = &on_bare.link;

	bare_offs = 0;
	trunk_set(&on_bare, &bare);
	coupler_add(&on_bare, NULL, &only, rom, &seen);
	bare_error = -ECOMM;
	for (unsigned i = 0; i < 3; i++)
		TEST_ASSERT_EQUAL_INT(-ECOMM, part_reset(link));
	bare_error = 0;
	for (unsigned i = 0; i < 3; i++)
		TEST_ASSERT_EQUAL_INT(1, part_reset(link));
	TEST_ASSERT_EQUAL_UINT(1, bare_offs);
}

static void test_a_short_branch_is_not_switched_on(void)
{
	begin();
	wire_set(coupler, "aux", 0);
	host.events = 0;
	TEST_ASSERT_EQUAL_INT(-ECOMM,
	                      result(BUS_READ, way(coupler, "aux", on_aux, "temperature"), NULL));
	host_run(&host, bus, host.now + 60 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_LOST));
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_NOTE));
	TEST_ASSERT_EQUAL_STRING("1F.02005DDF0300/aux is short", host.event[0].text);
	expect(true, of(trunk, "temperature"), "          10");
	expect(true, deep_way("temperature"), "          40");
	expect(true, "/1F.02005DDF0300/sensed.BYTE", "           1");
	wire_set(coupler, "aux", 1);
	host_run(&host, bus, host.now + 10 * HOST_S);
	expect(true, way(coupler, "aux", on_aux, "temperature"), "          30");
}

static void test_a_branch_that_becomes_short_while_it_is_on_loses_no_device(void)
{
	on_aux->parasite = true;
	begin();
	uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(on_aux, "temperature"), NULL);
	host_run(&host, bus, host.now + 300 * HOST_MS);
	TEST_ASSERT_TRUE(is_on(coupler));
	wire_set(coupler, "aux", 0);
	TEST_ASSERT_EQUAL_INT(-ECOMM, answer_to(id)->err);
	TEST_ASSERT_EQUAL_INT(-ECOMM, result(BUS_READ, of(trunk, "temperature"), NULL));
	host_run(&host, bus, host.now + 60 * HOST_S);
	wire_set(coupler, "aux", 1);
	expect(true, of(trunk, "temperature"), "          10");
	expect(true, deep_way("temperature"), "          40");
	expect(true, of(on_aux, "temperature"), "          30");
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_LOST));
}

static void test_a_master_that_was_away_still_has_the_branches(void)
{
	begin();
	expect(true, deep_way("temperature"), "          40");
	wire_net.fault = -ENODEV;
	wire_net.fault_count = 2;
	(void)result(BUS_READ, of(trunk, "temperature"), NULL);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_DOWN));
	coupler->branches[SIM_AUX].on = true;
	host_run(&host, bus, host.now + 2 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_UP));
	expect(true, deep_way("temperature"), "          40");
	TEST_ASSERT_FALSE(has_line(list(true, "/"), "/28.05005DDF0300"));
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_LOST));
}

static void answer_wrong(struct sim_slave *slave)
{
	static const uint8_t wrong[] = {0x31, 0x9c};

	sim_send(slave, wrong, sizeof(wrong));
}

static void break_it(struct sim_slave *slave)
{
	static const struct sim_function functions[] = {
		{.code = 0x5A, .takes = 1, .start = answer_wrong},
		{.code = 0x66, .start = answer_wrong},
		{.code = 0xCC, .takes = 1, .start = answer_wrong},
		{.code = 0x33, .takes = 1, .start = answer_wrong},
		{0},
	};
	static struct sim_family broken;

	broken = sim_ds2409;
	broken.functions = functions;
	slave->family = &broken;
}

/* Each of its answers is wrong, from the start or from some moment on: the others go on. */
static void test_a_fault_of_a_coupler_is_that_of_what_is_behind_it(void)
{
	for (unsigned late = 0; late < 2; late++) {
		native_end();
		native_begin();
		plant();
		struct sim_slave *beside = wire_add(0, "DS2409", 9),
				 *on_beside = wire_add(0, "DS18B20", 10);
		sim_branch_put(on_beside, beside, SIM_MAIN);
		wire_set(on_beside, "temperature", 50);
		if (!late)
			break_it(coupler);
		start();
		expect(true, of(trunk, "temperature"), "          10");
		expect(true, of(on_beside, "temperature"), "          50");
		if (late)
			expect(true, of(deep, "temperature"), "          40");
		break_it(coupler);
		for (unsigned i = 0; i < 5; i++) {
			TEST_ASSERT_TRUE(result(BUS_READ, of(on_aux, "temperature"), NULL) < 0);
			/* A branch that was on may stay so: then it is part of the wire. */
			if (result(BUS_READ, of(on_main, "temperature"), NULL) == 0) {
				TEST_ASSERT_TRUE(late);
				expect(true, of(on_main, "temperature"), "          20");
			}
			expect(true, of(trunk, "temperature"), "          10");
			expect(true, of(on_beside, "temperature"), "          50");
			TEST_ASSERT_TRUE(has_line(list(true, "/"), name_of(trunk)));
		}
		TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_UP));
		TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
		coupler->family = &sim_ds2409;
		host_run(&host, bus, host.now + 20 * HOST_S);
		expect(true, of(on_main, "temperature"), "          20");
		expect(true, of(deep, "temperature"), "          40");
		expect(true, of(on_aux, "temperature"), "          30");
	}
}

static void test_a_coupler_takes_what_is_behind_it_along(void)
{
	begin();
	sim_wire_plug(&wire_net.wire[0], coupler, false, host.now);
	host_run(&host, bus, host.now + 60 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(6, host_events(&host, BUS_LOST));
	TEST_ASSERT_EQUAL_INT(-ENODEV, result(BUS_READ, deep_way("temperature"), NULL));
	expect(true, of(trunk, "temperature"), "          10");
	host.events = 0;
	sim_wire_plug(&wire_net.wire[0], coupler, true, host.now);
	host_run(&host, bus, host.now + 60 * HOST_S);
	TEST_ASSERT_GREATER_OR_EQUAL_UINT(6, host_events(&host, BUS_FOUND));
	TEST_ASSERT_EQUAL_STRING("/1F.02005DDF0300/main/28.04005DDF0300\n"
	                         "/1F.02005DDF0300/main/1F.03005DDF0300\n",
	                         list(true, "/1F.02005DDF0300/main"));
	expect(true, deep_way("temperature"), "          40");
}

static void test_events_outlive_the_switching_of_the_bus(void)
{
	begin();
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, "/1F.02005DDF0300/clearevent", "1"));
	expect(true, "/1F.02005DDF0300/event.BYTE", "           0");
	sim_wire_plug(&wire_net.wire[0], on_aux, false, host.now);
	sim_wire_plug(&wire_net.wire[0], on_aux, true, host.now);
	expect(true, of(on_aux, "temperature"), "          30");
	expect(true, of(on_main, "temperature"), "          20");
	expect(true, "/1F.02005DDF0300/event.ALL", "0,1");
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, "/1F.02005DDF0300/clearevent", "1"));
	expect(true, "/1F.02005DDF0300/event.ALL", "0,0");
}

static void test_the_properties_of_a_coupler(void)
{
	static const char *const controls[] = {"0", "1", "2", "3"};

	begin();
	expect(true, "/1F.02005DDF0300/sensed.ALL", "1,1");
	expect(true, "/1F.02005DDF0300/branch.BYTE", "           0");
	for (int i = 3; i >= 0; i--) {
		TEST_ASSERT_EQUAL_INT(0,
		                      result(BUS_WRITE, "/1F.02005DDF0300/control", controls[i]));
		uint32_t id = ask(BUS_READ, BUS_INPUT, true, "/1F.02005DDF0300/control", NULL);
		answer_to(id);
		TEST_ASSERT_EQUAL_CHAR(controls[i][0], data[id][11]);
	}
	TEST_ASSERT_EQUAL_INT(-EINVAL, result(BUS_WRITE, "/1F.02005DDF0300/control", "4"));
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, "/1F.02005DDF0300/branch.BYTE", "0"));
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, result(BUS_WRITE, "/1F.02005DDF0300/branch.0", "1"));
}

static void test_a_discharge_restarts_what_the_branches_feed(void)
{
	deep->parasite = true;
	on_aux->parasite = true;
	begin();
	expect(true, of(on_aux, "temperature"), "          30");
	uint64_t before = on_aux->power_ons;
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, "/1F.02005DDF0300/discharge", "1"));
	TEST_ASSERT_GREATER_THAN_UINT64(before, on_aux->power_ons);
	expect(true, of(on_aux, "temperature"), "          30");
}

static void test_more_couplers_than_the_bus_takes_leave_the_rest_out(void)
{
	for (unsigned i = 0; i < 20; i++)
		wire_add(1, "DS2409", 100 + i);
	start();
	host_run(&host, bus, host.now + 10 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(6, host_events(&host, BUS_NOTE));
	expect(true, of(trunk, "temperature"), "          10");
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_branch_is_a_directory_of_what_is_behind_it);
	RUN_TEST(test_each_device_is_read_by_its_way_and_by_its_id);
	RUN_TEST(test_a_way_that_does_not_lead_to_the_device_is_none);
	RUN_TEST(test_all_thermometers_convert_branch_by_branch);
	RUN_TEST(test_an_output_behind_a_branch_is_switched);
	RUN_TEST(test_an_alarm_behind_a_branch_is_listed_with_its_way);
	RUN_TEST(test_nothing_is_on_while_nobody_asks);
	RUN_TEST(test_a_branch_that_another_program_left_on_is_switched_off);
	RUN_TEST(test_a_coupler_that_a_short_kept_from_being_told_is_told_after_it);
	RUN_TEST(test_a_short_branch_is_not_switched_on);
	RUN_TEST(test_a_branch_that_becomes_short_while_it_is_on_loses_no_device);
	RUN_TEST(test_a_master_that_was_away_still_has_the_branches);
	RUN_TEST(test_a_fault_of_a_coupler_is_that_of_what_is_behind_it);
	RUN_TEST(test_a_coupler_takes_what_is_behind_it_along);
	RUN_TEST(test_events_outlive_the_switching_of_the_bus);
	RUN_TEST(test_the_properties_of_a_coupler);
	RUN_TEST(test_a_discharge_restarts_what_the_branches_feed);
	RUN_TEST(test_more_couplers_than_the_bus_takes_leave_the_rest_out);
	return UNITY_END();
}
