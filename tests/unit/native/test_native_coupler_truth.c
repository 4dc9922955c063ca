/* SPDX-License-Identifier: MIT */
/*
 * Behind a branch too each lost command and each bit that is turned over leaves the truth or an
 * error: never the value of a device of another branch, nor an older one.
 */
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/sim/branch.h"
#include "tests/unit/aid/native_scene.h"

#define STRIDE 7

static struct trouble trouble;
static struct sim_slave *outer, *inner, *deep, *other, *memory;

void setUp(void)
{
	native_begin();
	wire_init(&host, 1, 1);
	wire_net.trouble = &trouble;
	trouble_none(&trouble);
	outer = wire_add(0, "DS2409", 1);
	inner = wire_add(0, "DS2409", 2);
	deep = wire_add(0, "DS18B20", 3);
	other = wire_add(0, "DS18B20", 4);
	memory = wire_add(0, "DS2433", 5);
	sim_branch_put(inner, outer, SIM_MAIN);
	sim_branch_put(deep, inner, SIM_AUX);
	sim_branch_put(other, outer, SIM_AUX);
	sim_branch_put(memory, outer, SIM_AUX);
	wire_set(deep, "temperature", 20);
	wire_set(other, "temperature", 30);
	start();
	TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(deep, "temperature"), NULL));
	TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(other, "temperature"), NULL));
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(memory, "pages/page.3"), "as it was before"));
	wire_set(deep, "temperature", 40);
	host_run(&host, bus, host.now + 100 * HOST_MS);
}

void tearDown(void)
{
	native_end();
	wire_net.trouble = NULL;
}

struct deed {
	enum bus_op op;
	struct sim_slave **slave;
	const char *property, *text;
};

static uint32_t do_with(const struct deed *deed, enum trouble_kind kind, uint32_t at, uint8_t mask)
{
	trouble_none(&trouble);
	trouble.kind = kind;
	trouble.at = at;
	trouble.mask = mask;
	uint32_t id = ask(deed->op, BUS_INPUT, true, of(*deed->slave, deed->property), deed->text);

	answer_to(id);
	trouble.kind = TROUBLE_NONE;
	return id;
}

static unsigned errors;

static void try(const struct deed *deed, enum trouble_kind kind, uint32_t at, uint8_t mask)
{
	char says[60];

	snprintf(says, sizeof(says), "%s: kind %d at %u", deed->property, kind, (unsigned)at);
	tearDown();
	setUp();
	uint32_t id = do_with(deed, kind, at, mask);
	errors += answer_to(id)->err != 0;
	if (answer_to(id)->err)
		return;
	if (deed->op == BUS_WRITE) {
		id = ask(BUS_READ, BUS_INPUT, true, of(*deed->slave, deed->property), NULL);
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer_to(id)->err, says);
	}
	TEST_ASSERT_EQUAL_MEMORY_MESSAGE(deed->text, (char *)data[id], strlen(deed->text), says);
}

static void try_each(const struct deed *deed)
{
	do_with(deed, TROUBLE_NONE, 0, 0);
	uint32_t slots = trouble.slots, resets = trouble.resets, n = 0;

	errors = 0;
	for (uint32_t at = 0; at < slots; at += STRIDE, n++)
		try(deed, TROUBLE_TURN, at, 1);
	for (uint32_t at = 0; at < slots; at += 8 * STRIDE, n += 2) {
		try(deed, TROUBLE_DEAF, at, 0);
		try(deed, TROUBLE_TURN, at, 0x55);
	}
	for (uint32_t at = 0; at < resets; at++, n += 2) {
		try(deed, TROUBLE_ABSENT, at, 0);
		try(deed, TROUBLE_FALSE, at, 0);
	}
	TEST_ASSERT_LESS_THAN_UINT_MESSAGE(n / 10, errors, "most are repeated with success");
}

static void test_a_temperature_is_that_of_the_device_that_was_asked(void)
{
	try_each(&(struct deed){BUS_READ, &deep, "temperature", "          40"});
}

static void test_a_write_reaches_the_device_that_was_asked(void)
{
	try_each(&(struct deed){BUS_WRITE, &memory, "pages/page.3", "and how it is behind"});
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_temperature_is_that_of_the_device_that_was_asked);
	RUN_TEST(test_a_write_reaches_the_device_that_was_asked);
	return UNITY_END();
}
