/* SPDX-License-Identifier: MIT */
/* Tests of the Modbus block. */
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/config/read/modbus.h"
#include "tests/unit/aid/config_case.h"

#define LISTEN "Listen \"127.0.0.1:502\" "

void setUp(void)
{
	config_case_begin();
}

void tearDown(void)
{
	config_case_end();
}

static void test_the_block_has_defaults_but_for_the_address(void)
{
	TEST_ASSERT_EQUAL_INT(0, parse_driver("Modbus { " LISTEN "}"));
	TEST_ASSERT_TRUE(config->modbus.given);
	TEST_ASSERT_EQUAL_UINT(1, config->modbus.address_count);
	TEST_ASSERT_EQUAL_UINT(502, config->modbus.addresses[0].port);
	TEST_ASSERT_EQUAL_STRING("big", config->modbus.word_order);
	TEST_ASSERT_EQUAL_STRING("nan", config->modbus.bad_value);
	TEST_ASSERT_EQUAL_UINT(0, config->modbus.unit);
	TEST_ASSERT_EQUAL_UINT(1, config->modbus.decimals);
	TEST_ASSERT_EQUAL_UINT(64, config->modbus.clients);
	TEST_ASSERT_NULL(config->modbus.map);
}

static void test_without_the_block_nothing_is_served(void)
{
	TEST_ASSERT_EQUAL_INT(0, parse_driver(""));
	TEST_ASSERT_FALSE(config->modbus.given);
	TEST_ASSERT_EQUAL_UINT(0, config->modbus.address_count);
	TEST_ASSERT_EQUAL_STRING("nan", config->modbus.bad_value);
}

static void test_what_cannot_be_is_refused_with_a_reason(void)
{
	static const struct line cases[] = {
		{"Modbus { }", "f:2:1: error: Modbus without Listen: write it, as Listen "
	                       "\"127.0.0.1:502\"\n"},
		{"Modbus { " LISTEN "WordOrder mixed }",
	         "f:2:43: error: WordOrder \"mixed\": expected big or little\n"},
		{"Modbus { " LISTEN "BadValue 0 }",
	         "f:2:42: error: BadValue \"0\": expected nan or exception\n"},
		{"Modbus { " LISTEN "UnitId 248 }",
	         "f:2:40: error: UnitId \"248\": expected a whole number from 0 to 247\n"},
		{"Modbus { " LISTEN "Allow \"pump\" }",
	         "f:2:39: error: Allow \"pump\": expected a pattern of signals, then addresses, as "
	         "pump* 192.168.1.10\n"},
		{"Modbus { " LISTEN "Allow \"a 10.0.0.1, b here\" }",
	         "f:2:39: error: Allow \"b here\": expected an address or a range such as "
	         "192.168.1.0/24\n"},
		{"Modbus { " LISTEN "Map \"here\" }",
	         "f:2:37: error: Map \"here\": expected a path from the root, at most 255 bytes\n"},
	};

	expect_errors(cases, COUNT(cases), parse_driver);
	TEST_ASSERT_EQUAL_INT(
		0, parse_driver("Modbus { " LISTEN "WordOrder little BadValue exception }"));
}

static bool allows(const char *name, const char *address)
{
	struct listen_address from[2];
	char text[64];
	const char *why;

	snprintf(text, sizeof(text), "%s:1", address);
	TEST_ASSERT_EQUAL_INT_MESSAGE(1, listen_parse(text, strlen(text), from, &why), text);
	return modbus_allows(config->modbus.allow, name, from);
}

static void test_allow_says_which_signals_from_where(void)
{
	TEST_ASSERT_EQUAL_INT(0, parse_driver("Modbus { " LISTEN
	                                      "Allow \"pump* 10.0.0.5  10.1.0.0/16 ,light "
	                                      "fd00::/8\" Write on }"));
	TEST_ASSERT_TRUE(config->modbus.write);
	TEST_ASSERT_EQUAL_INT64(10000000000, config->modbus.beat_ns);
	TEST_ASSERT_TRUE(allows("pump1", "10.0.0.5"));
	TEST_ASSERT_TRUE(allows("pump", "10.1.2.3"));
	TEST_ASSERT_FALSE(allows("pump1", "10.0.0.6"));
	TEST_ASSERT_FALSE(allows("pump1", "[fd00::1]"));
	TEST_ASSERT_TRUE(allows("light", "[fd00::1]"));
	TEST_ASSERT_FALSE(allows("light", "10.0.0.5"));
	TEST_ASSERT_FALSE(allows("lights", "[fd00::1]"));
	TEST_ASSERT_FALSE(modbus_allows(NULL, "pump1", config->modbus.addresses));
}

static void test_writing_is_off_and_nobody_may_write_without_allow(void)
{
	static const struct line cases[] = {
		{"Modbus { " LISTEN "Write on }",
	         "f:2:33: warning: Write without Allow: no client may command anything\n"},
	};

	TEST_ASSERT_EQUAL_INT(0, parse_driver("Modbus { " LISTEN "}"));
	TEST_ASSERT_FALSE(config->modbus.write);
	expect_warnings(cases, COUNT(cases), parse_driver);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_block_has_defaults_but_for_the_address);
	RUN_TEST(test_without_the_block_nothing_is_served);
	RUN_TEST(test_what_cannot_be_is_refused_with_a_reason);
	RUN_TEST(test_allow_says_which_signals_from_where);
	RUN_TEST(test_writing_is_off_and_nobody_may_write_without_allow);
	return UNITY_END();
}
