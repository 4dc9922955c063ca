/* SPDX-License-Identifier: MIT */
/* Tests of the Mqtt block. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/config/edit/print.h"
#include "src/config/read/load.h"
#include "tests/unit/aid/config_case.h"

void setUp(void)
{
	config_case_begin();
}

void tearDown(void)
{
	config_case_end();
}

static void expect_way(unsigned number, const char *host, unsigned port, bool tls)
{
	const struct config_mqtt_way *way = &config->mqtt.ways[number];

	TEST_ASSERT_EQUAL_STRING(host, way->host);
	TEST_ASSERT_EQUAL_UINT(port, way->port);
	TEST_ASSERT_EQUAL(tls, way->tls);
}

static void test_without_the_block_the_broker_of_this_machine_gets_values_and_commands_nothing(void)
{
	TEST_ASSERT_EQUAL_INT(0, parse_item(ITEM));
	TEST_ASSERT_FALSE(config->mqtt.given);
	TEST_ASSERT_EQUAL_UINT(1, config->mqtt.way_count);
	expect_way(0, "localhost", 1883, false);
	TEST_ASSERT_EQUAL_STRING("owsd", config->mqtt.topic);
	TEST_ASSERT_EQUAL_STRING("homeassistant", config->mqtt.profile);
	TEST_ASSERT_EQUAL_STRING("homeassistant", config->mqtt.discovery);
	TEST_ASSERT_TRUE(config->mqtt.mqtt5);
	TEST_ASSERT_FALSE(config->mqtt.write);
	TEST_ASSERT_NULL(config->mqtt.user);
	TEST_ASSERT_NULL(config->mqtt.node);
}

static void test_several_ways_stand_in_their_order(void)
{
	TEST_ASSERT_EQUAL_INT(
		0, parse_driver("Mqtt { Broker \"mqtts://a.example | mqtt://10.0.0.7:1884|"
	                        "mqtts://[fd00::1]:99\" }"));
	TEST_ASSERT_EQUAL_UINT(3, config->mqtt.way_count);
	expect_way(0, "a.example", 8883, true);
	expect_way(1, "10.0.0.7", 1884, false);
	expect_way(2, "fd00::1", 99, true);
}

static void test_what_is_printed_is_what_was_read(void)
{
	static const char keys[] =
		"Mqtt { Broker \"mqtts://b:1\" User u PasswordFile \"pw\" CaFile \"/ca\" "
		"CertFile \"/cert\" KeyFile \"key\" Protocol 3.1.1 Node pi7 Topic \"site/ows\" "
		"Profile plain Discovery \"ha\" PrimaryHost scada Write on Rename on }";
	char *first, *second;
	size_t len;

	for (int turn = 0; turn < 2; turn++) {
		FILE *out = open_memstream(turn ? &second : &first, &len);

		TEST_ASSERT_NOT_NULL(out);
		TEST_ASSERT_EQUAL_INT(0, turn ? parse(first) : parse_driver(keys));
		config_print(config, out);
		TEST_ASSERT_EQUAL_INT(0, fclose(out));
		TEST_ASSERT_EQUAL_STRING("pi7", config->mqtt.node);
		TEST_ASSERT_EQUAL_STRING("site/ows", config->mqtt.topic);
		TEST_ASSERT_EQUAL_STRING("scada", config->mqtt.primary_host);
		TEST_ASSERT_EQUAL_STRING("key", config->mqtt.key_file);
		TEST_ASSERT_FALSE(config->mqtt.mqtt5);
		TEST_ASSERT_TRUE(config->mqtt.write && config->mqtt.rename);
		config_free(config);
		config = NULL;
	}
	TEST_ASSERT_EQUAL_STRING(first, second);
	free(first);
	free(second);
}

static void test_what_cannot_be_is_an_error_at_its_place(void)
{
#define L64 "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef"
#define LONG L64 L64 L64 L64
#define WAY "expected mqtt://HOST:PORT or mqtts://HOST:PORT\n"
	static const struct line blocks[] = {
		{"Mqtt { Broker \"localhost:1883\" }",
	         "f:2:15: error: Broker \"localhost:1883\": " WAY},
		{"Mqtt { Broker \"mqtt://\" }", "f:2:15: error: Broker \"mqtt://\": " WAY},
		{"Mqtt { Broker \"mqtt://a:0\" }", "f:2:15: error: Broker \"mqtt://a:0\": " WAY},
		{"Mqtt { Broker \"mqtt://a:65536\" }",
	         "f:2:15: error: Broker \"mqtt://a:65536\": " WAY},
		{"Mqtt { Broker \"mqtt://a:1x\" }", "f:2:15: error: Broker \"mqtt://a:1x\": " WAY},
		{"Mqtt { Broker \"mqtt://[::1\" }", "f:2:15: error: Broker \"mqtt://[::1\": " WAY},
		{"Mqtt { Broker \"mqtt://a/b\" }", "f:2:15: error: Broker \"mqtt://a/b\": " WAY},
		{"Mqtt { Broker \"mqtt://a |\" }", "f:2:15: error: Broker \"\": " WAY},
		{"Mqtt { Broker \"mqtt://u:secret@a\" }",
	         "f:2:15: error: Broker: no password stands in it: User and PasswordFile are keys "
	         "of their own\n"},
		{"Mqtt { Broker \"mqtt://a?password=secret\" }", "f:2:15: error: Broker: " WAY},
		{"Mqtt { PasswordFile \"../p\" User u }",
	         "f:2:21: error: PasswordFile \"../p\": expected a path from the root, or the name "
	         "of a credential\n"},
		{"Mqtt { PasswordFile \"secret?\" User u }",
	         "f:2:21: error: PasswordFile: expected a path from the root, or the name of a "
	         "credential\n"},
		{"Mqtt { Broker \"mqtt://u:secret@" LONG "\" }",
	         "f:2:15: error: Broker: expected at most 255 bytes\n"
	         "f:2:15: error: Broker: no password stands in it: User and PasswordFile are keys "
	         "of their own\n"},
		{"Mqtt { Broker \"mqtts://a\" KeyFile k }",
	         "f:2:27: error: KeyFile without CertFile: CertFile and KeyFile belong together\n"},
		{"Mqtt { Protocol 4 }", "f:2:17: error: Protocol \"4\": expected 5 or 3.1.1\n"},
		{"Mqtt { Node \"a/b\" }", "f:2:13: error: Node \"a/b\": expected letters, digits, "
	                                  "'-', '_' and '.', at most 63\n"},
		{"Mqtt { Topic \"a/#\" }",
	         "f:2:14: error: Topic \"a/#\": expected letters, digits, "
	         "'-', '_', '.' and '/' between them, at most 63\n"},
		{"Mqtt { Topic \"/a\" }", "f:2:14: error: Topic \"/a\": expected letters, digits, "
	                                  "'-', '_', '.' and '/' between them, at most 63\n"},
		{"Mqtt { Profile homie4 }",
	         "f:2:16: error: Profile \"homie4\": expected one of homeassistant plain "
	         "sparkplug homie5 wirenboard\n"},
#ifdef OWSD_PROTOBUFC
		{"Mqtt { Profile sparkplug Topic a/b }",
	         "f:2:32: error: Topic \"a/b\": the group of Sparkplug has no '/'\n"},
		{"Mqtt { Profile sparkplug Topic STATE }",
	         "f:2:32: error: Topic \"STATE\": Sparkplug keeps this name for hosts; take "
	         "another one\n"},
#else
		{"Mqtt { Profile sparkplug }",
	         "f:2:16: error: Profile \"sparkplug\": owsd was built without libprotobuf-c\n"},
#endif
		{"Mqtt { Write maybe }", "f:2:14: error: Write \"maybe\": expected on or off\n"},
	};

	expect_errors(blocks, COUNT(blocks), parse_driver);
}

static void test_a_password_in_the_clear_and_idle_keys_are_warnings(void)
{
	static const struct line blocks[] = {
		{"Mqtt { Broker \"mqtt://a.example\" User u PasswordFile p }",
	         "f:2:41: warning: the password goes to a.example in the clear: mqtts:// hides it\n"},
		{"Mqtt { CaFile \"/ca\" }", "f:2:8: warning: no way of Broker is mqtts://: the "
	                                    "certificates are not used\n"},
		{"Mqtt { PrimaryHost scada }", "f:2:8: warning: PrimaryHost is of the profile "
	                                       "sparkplug alone: it is not used\n"},
		{"Mqtt { User u PasswordFile p }", ""},
		{"Mqtt { PasswordFile p }", ""},
	};

	expect_warnings(blocks, COUNT(blocks), parse_driver);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(
		test_without_the_block_the_broker_of_this_machine_gets_values_and_commands_nothing);
	RUN_TEST(test_several_ways_stand_in_their_order);
	RUN_TEST(test_what_is_printed_is_what_was_read);
	RUN_TEST(test_what_cannot_be_is_an_error_at_its_place);
	RUN_TEST(test_a_password_in_the_clear_and_idle_keys_are_warnings);
	return UNITY_END();
}
