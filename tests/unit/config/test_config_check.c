/* SPDX-License-Identifier: MIT */
/* What --check says of ids, properties and directions by the tables of the families. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/chips/find.h"
#include "hal/chips/format.h"
#include "src/config/check/check.h"
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

static int check(const char *keys)
{
	int err = parse_item(keys);

	if (!err)
		config_check_items(config, NULL, &report);
	return err;
}

#define AT "f:2: warning: \"x\""
#define PATH_AT "f:3:13: warning: \"x\""
#define VALUE_AT(column) "f:3:" #column ": warning: \"x\""
static void test_what_cannot_be_meant_is_named_with_its_remedy(void)
{
	static const struct line cases[] = {
		{"Name x Path /28-000003df1d55/temperature Type double", PATH_AT
	         ": 28-000003df1d55 is the kernel's spelling of a device: write 28.551DDF030000\n"},
		{"Name x Path /sys/bus/w1/devices/28-000003df1d55/w1_slave Type double", PATH_AT
	         ": 28-000003df1d55 is the kernel's spelling of a device: write 28.551DDF030000\n"},
		{"Name x Path /28.551DDF03000/temperature Type double", PATH_AT
	         ": 28.551DDF03000 has 11 digits after its family and counts as an alias; an id "
	         "has 12: owsctl scan shows them\n"},
		{"Name x Path /28.00A1/temperature Type double", PATH_AT
	         ": 28.00A1 has 4 digits after its family and counts as an alias; an id has 12: "
	         "owsctl scan shows them\n"},
		{"Name x Path /28.0000000000ZZ/temperature Type double", PATH_AT
	         ": 28.0000000000ZZ counts as an alias; an id has no digit 'Z', only 0 to 9 and A "
	         "to F\n"},
		{"Name x Path /28.551DDF030000/temprature12 Type double",
	         PATH_AT ": a DS18B20 has no temprature12; did you mean temperature12?\n"},
		{"Name x Path /29.B89115000000/PIO.8 Type bool",
	         PATH_AT ": a DS2408 has no PIO.8; did you mean PIO.BYTE, or PIO.0 to PIO.7?\n"},
		{"Name x Path /29.B89115000000/latch Type byte", PATH_AT
	         ": a DS2408 has no latch; did you mean latch.BYTE, or latch.0 to latch.7?\n"},
		{"Name x Path /28.551DDF030000/pressure Type double",
	         PATH_AT ": owsd knows no pressure of a DS18B20: check its spelling\n"},
		{"Name x Path /28.551DDF030000/temperature Type double IO output",
	         PATH_AT " is an output, but temperature cannot be written: write IO input\n"},
		{"Name x Path /28.551DDF030000/temperature Type double Writable on",
	         PATH_AT " is Writable, but temperature cannot be written: write Writable off\n"},
		{"Name x Path /28.551DDF030000/temperature Type string",
	         AT " is a number, and a string shows it as text: write Type double\n"},
		{"Name x Path /28.551DDF030000/type Type double",
	         AT " is a text or a list, and no double: write Type string\n"},
		{"Name x Path /29.B89115000000/sensed.ALL Type byte",
	         AT " is a text or a list, and no byte: write Type string\n"},
		{"Name x Path /simultaneous/temperature Type bool", PATH_AT
	         ": /simultaneous/temperature begins conversions and shows no value: write IO "
	         "output, or the Path of a device\n"},
		{"Name x Path /28.551DDF030000/temperature Type double Unit V",
	         AT ": Unit \"V\" is shown beside a value in °C: write °C, °F, K, or Scale too\n"},
		{"Name x Path /room/temperature Type double Unit \"degrees\"",
	         AT ": Unit \"degrees\" is shown beside a value in °C: write °C, °F, K, or Scale "
	            "too\n"},
		{"Name x Path /1D.551DDF030000/counter.A Type double Unit m3",
	         AT ": Unit \"m3\": other programs know it as m³\n"},
		{"Name x Path /28.551DDF030000/temperature Type double Unit F Scale 1.8 Offset 32",
	         AT ": Unit \"F\": other programs know it as °F\n"},
		{"Name x Path /29.B89115000000/sensed.BYTE Type byte Alarm on LatchAlarm \"latch.BYT\" "
	         "PorAlarm \"porr\" SetAlarm \"set_alarm=\" ResetLatch \"sensed.BYTE=0\"",
	         VALUE_AT(72) ": LatchAlarm: a DS2408 has no latch.BYT; did you mean latch.BYTE?\n" VALUE_AT(93) ": PorAlarm: a DS2408 has no porr; did you mean por?\n" VALUE_AT(
			 109) ": SetAlarm \"set_alarm=\" has nothing behind the '=', and nothing is written; expected property=value\n" VALUE_AT(133) ": ResetLatch: sensed.BYTE cannot be written, so the alarm cannot be served\n"},
		{"Name x Path /29.B89115000000/sensed.BYTE Type byte Alarm on LatchAlarm latch "
	         "PorAlarm pro SetAlarm \"set_alarm=133333333\"",
	         VALUE_AT(72) ": LatchAlarm: a DS2408 has no latch; did you mean latch.BYTE, or "
	                      "latch.0 to latch.7?\n" VALUE_AT(
				      87) ": PorAlarm: a DS2408 has no pro; did you mean por?\n"},
		{"Name x Path /29.B89115000000/sensed.BYTE Type byte Alarm on LatchAlarm latch.BYTE "
	         "PorAlarm por SetAlarm set_alarm=133333333 ResetLatch latch.BYTE=0 StaleAfter 20",
	         AT " is stale before it is read again, each 60 s unless its alarm comes: write "
	            "StaleAfter 90 or more, or PerFactor 100\n"},
		{"Name x Path /28.551DDF030000/temperature Type double PerFactor 300 StaleAfter 20",
	         AT " is stale before it is read again, each 30 s: write StaleAfter 45 or more, or "
	            "PerFactor 100\n"},
		{"Name x Path /28.551DDF030000/temperature Type double PerFactor 2 StaleAfter 0.2",
	         AT
	         " is stale before it is read again, each 0.2 s: write StaleAfter 0.3 or more, or "
	         "PerFactor 1\n"},
		{"Name x Path /29.B89115000000/PIO.0 Type bool IO output StaleAfter 5",
	         AT " is stale before it is read back, each 10 s: write StaleAfter 15 or more, or "
	            "ReadBack 2.5\n"},
	};

	expect_warnings(cases, COUNT(cases), check);
}

/* The alarm of a DS2408 but for the strings that a case gives; these begin at column 73. */
#define SWITCHES "Name x Path /29.B89115000000/sensed.BYTE Type byte Alarm on PorAlarm "
#define ARMED "por SetAlarm set_alarm=133333333 "
static void test_a_string_of_an_alarm_that_does_not_fit_its_purpose_is_named(void)
{
#define RESET "ResetLatch latch.BYTE=0"
	static const struct line cases[] = {
		{SWITCHES ARMED RESET " LatchAlarm PIO.BYTE",
	         "f:3:138: warning: \"x\": LatchAlarm: PIO.BYTE is no latch of a DS2408: write latch.BYTE, or latch.0 to latch.7\n"},
		{SWITCHES ARMED RESET " LatchAlarm set_alarm",
	         "f:3:138: warning: \"x\": LatchAlarm: set_alarm is no latch of a DS2408: write latch.BYTE, or latch.0 to latch.7\n"},
		{SWITCHES ARMED RESET " LatchAlarm latch",
	         "f:3:138: warning: \"x\": LatchAlarm: a DS2408 has no latch; did you mean latch.BYTE, or latch.0 to latch.7?\n"},
		{SWITCHES "strobe SetAlarm \"\" LatchAlarm latch.BYTE " RESET,
	         "f:3:70: warning: \"x\": PorAlarm: strobe does not show a restart of a DS2408: write por\n"},
		{SWITCHES "por LatchAlarm latch.BYTE " RESET " SetAlarm abc",
	         "f:3:129: warning: SetAlarm \"abc\" has no '=': nothing is written, and the alarm cannot be armed after a restart of its device; expected property=value\nf:3:129: warning: \"x\": SetAlarm: owsd knows no abc of a DS2408: check its spelling\n"},
		{SWITCHES "por LatchAlarm latch.BYTE " RESET " SetAlarm set_alarm=abc",
	         "f:3:129: warning: \"x\": SetAlarm \"set_alarm=abc\": set_alarm of a DS2408 has 9 digits\n"},
		{SWITCHES "por LatchAlarm latch.BYTE " RESET " SetAlarm set_alarm=13333333",
	         "f:3:129: warning: \"x\": SetAlarm \"set_alarm=13333333\": set_alarm of a DS2408 has 9 digits\n"},
		{SWITCHES "por LatchAlarm latch.BYTE " RESET " SetAlarm set_alarm=1333333333",
	         "f:3:129: warning: \"x\": SetAlarm \"set_alarm=1333333333\": set_alarm of a DS2408 has 9 digits\n"},
		{SWITCHES "por LatchAlarm latch.BYTE " RESET " SetAlarm set_alarm=943333333",
	         "f:3:129: warning: \"x\": SetAlarm \"set_alarm=943333333\": set_alarm of a DS2408 does not take this value\n"},
		{SWITCHES ARMED "LatchAlarm latch.BYTE ResetLatch latch.BYTE=O",
	         "f:3:136: warning: \"x\": ResetLatch \"latch.BYTE=O\": latch.BYTE of a DS2408 does not take this value\n"},
		{SWITCHES ARMED "LatchAlarm latch.BYTE ResetLatch /latch.BYTE=0",
	         "f:3:136: warning: \"x\": ResetLatch \"/latch.BYTE=0\" is a property of the device: write it without the / before it\n"},
		{SWITCHES ARMED "LatchAlarm latch.BYTE ResetLatch latch.BYTE=",
	         "f:3:136: warning: \"x\": ResetLatch \"latch.BYTE=\" has nothing behind the '=', and nothing is written; expected property=value\n"},
		{SWITCHES ARMED "LatchAlarm latch.BYTE ResetLatch latch.BYTE=256",
	         "f:3:136: warning: \"x\": ResetLatch \"latch.BYTE=256\": latch.BYTE of a DS2408 does not take this value\n"},
		{SWITCHES ARMED "LatchAlarm latch.BYTE ResetLatch por=0",
	         "f:3:136: warning: \"x\": ResetLatch: por clears no latch of a DS2408: write latch.BYTE, or latch.0 to latch.7\n"},
		{SWITCHES ARMED "LatchAlarm latch.BYTE ResetLatch \"\"",
	         "f:3:136: warning: \"x\": ResetLatch is empty, and latch.BYTE stays set: the alarm comes once; write ResetLatch with latch.BYTE=0\n"},
		{SWITCHES ARMED "LatchAlarm latch.BYTE",
	         "f:3:114: warning: \"x\": ResetLatch is not defined, and latch.BYTE stays set: the alarm comes once; write ResetLatch with latch.BYTE=0\n"},
		{"Name x Path /7E.000000000005/EDS0065/humidity Type double Alarm on PorAlarm \"\" "
	         "LatchAlarm EDS0065/alarm/humidity_hi SetAlarm EDS0065/set_alarm/humidity_hi=1 "
	         "ResetLatch EDS0065/alarm/humidity_hi=0",
	         "f:3:169: warning: \"x\": ResetLatch: EDS0065/alarm/humidity_hi cannot be written, so the alarm cannot be served\n"},
		{"Name x Path /7E.000000000005/EDS0065/humidity Type double Alarm on PorAlarm \"\" "
	         "LatchAlarm EDS0065/alarm/humidity_hi SetAlarm EDS0065/set_alarm/humidity_hi=1 ",
	         "f:3:91: warning: \"x\": ResetLatch is not defined, and EDS0065/alarm/humidity_hi stays set: the alarm comes once; write ResetLatch with EDS0065/alarm/clear\n"},
	};

	expect_warnings(cases, COUNT(cases), check);
}

/* Those of docs/alarms.md, a level, a device that owsd does not know. */
static void test_alarms_that_fit_are_not_mentioned(void)
{
	static const struct line cases[] = {
		{SWITCHES ARMED "LatchAlarm latch.BYTE ResetLatch latch.BYTE=0", ""},
		{SWITCHES ARMED "LatchAlarm latch.ALL ResetLatch latch.ALL=0,0,0,0,0,0,0,0", ""},
		{SWITCHES ARMED "LatchAlarm latch.3 ResetLatch latch.3=off", ""},
		{SWITCHES ARMED "LatchAlarm sensed.BYTE ResetLatch \"\"", ""},
		{SWITCHES ARMED "LatchAlarm present", ""},
		{SWITCHES "\"\" SetAlarm \"\" LatchAlarm latch.BYTE ResetLatch latch.BYTE=0", ""},
		{"Name x Path /12.000000000002/sensed.A Type bool Alarm on LatchAlarm latch.A "
	         "PorAlarm \"\" SetAlarm set_alarm=111 ResetLatch latch.A=0",
	         ""},
		{"Name x Path /7E.000000000005/EDS0065/humidity Type double Alarm on PorAlarm \"\" "
	         "LatchAlarm EDS0065/alarm/humidity_hi SetAlarm EDS0065/set_alarm/humidity_hi=1 "
	         "ResetLatch EDS0065/alarm/clear=1",
	         ""},
		{"Name x Path /20.000000000003/volt.A Type double Alarm on PorAlarm \"\" LatchAlarm "
	         "alarm/high.A SetAlarm set_alarm/high.A=1 ResetLatch alarm/high.A=0",
	         ""},
		{"Name x Path /20.000000000003/volt.A Type double Alarm on PorAlarm \"\" LatchAlarm "
	         "alarm/high.A SetAlarm set_alarm/high.A=1",
	         ""},
		{"Name x Path /28.000000000004/temperature Type double Alarm on PorAlarm \"\" "
	         "LatchAlarm present SetAlarm temphigh=30 ResetLatch \"\"",
	         ""},
		{"Name x Path /21.000000000001/mission/temphigh Type bool Alarm on PorAlarm \"\" "
	         "LatchAlarm mission/temphigh SetAlarm set_alarm/temphigh=1 "
	         "ResetLatch mission/temphigh=0",
	         ""},
		{"Name x Path /04.000000000001/auto Type bool Alarm on PorAlarm \"\" LatchAlarm alarm "
	         "SetAlarm set_alarm=110 ResetLatch \"\"",
	         ""},
		{"Name x Path /05.000000000006/sensed Type bool Alarm on LatchAlarm present PorAlarm "
	         "\"\" SetAlarm \"\" ResetLatch \"\"",
	         ""},
		{"Name x Path /board/sensed.BYTE Type byte Alarm on LatchAlarm PIO.BYTE PorAlarm por "
	         "SetAlarm set_alarm=abc ResetLatch por=0",
	         ""},
	};

	expect_warnings(cases, COUNT(cases), check);
}

static int check_on_own_bus(const char *keys)
{
	char text[600];
	int err;

	snprintf(text, sizeof(text), "TargetName i2c:auto Item {\n%s }", keys);
	err = parse_driver(text);
	if (!err)
		config_check_items(config, NULL, &report);
	return err;
}

/* Of an own bus the age is that of the measurement, which its cache gives again for 2 s. */
static void test_the_age_that_a_cache_leaves_is_reckoned_with(void)
{
#define T "Name x Path /28.551DDF030000/temperature Type double "
#define RELAY "Name x Path /29.B89115000000/PIO.3 Type bool IO output Readable on PerFactor 300 "
	static const struct line own[] = {
		{T "PerFactor 10 StaleAfter 1.5",
	         AT " is stale before it is read again, each 3 s: write StaleAfter 4.5 or more, or "
	            "Uncached on\n"},
		{T "PerFactor 10 StaleAfter 0.5",
	         AT " is stale before it is read again, each 3 s: write StaleAfter 4.5 or more, or "
	            "PerFactor 1 and Uncached on\n"},
		{T "PerFactor 10 StaleAfter 1.5 Uncached on", ""},
		{T "PerFactor 10 StaleAfter 3.5", ""},
		{T "PerFactor 30 StaleAfter 3.5", ""},
		{RELAY "ReadBack 10 StaleAfter 20",
	         AT " is stale before it is read again, each 30 s: write StaleAfter 45 or more, or "
	            "PerFactor 100\n"},
	};
	static const struct line other[] = {{T "PerFactor 10 StaleAfter 1.5", ""}};

	expect_warnings(own, COUNT(own), check_on_own_bus);
	expect_warnings(other, COUNT(other), check);
}

static void test_what_may_be_meant_is_not_mentioned(void)
{
	static const struct line cases[] = {
		{"Name x Path /kitchen/temprature Type double", ""},
		{"Name x Path /28.kitchen/temperature Type double", ""},
		{"Name x Path /simultaneous/temperature Type bool IO output", ""},
		{"Name x Path /28.551DDF030000/temperature Type double Unit °F", ""},
		{"Name x Path /28.551DDF030000/temperature Type double Unit K Offset 273.15", ""},
		{"Name x Path /ab.cdef/temperature Type double", ""},
		{"Name x Path /28551DDF030000/temperature12 Type double", ""},
		{"Name x Path /29.B89115000000/PIO.3 Type bool IO output", ""},
		{"Name x Path /29.B89115000000/PIO.ALL Type string IO output", ""},
		{"Name x Path /3A.B89115000000/PIO.B Type bool IO output", ""},
		{"Name x Path /bus.1/1F.551DDF030000/main/28.551DDF030000/temperature Type double",
	         ""},
		{"Name x Path /statistics/errors/CRC8_errors Type double", ""},
		{"Name x Path /gpio/17 Type bool IO output", ""},
		{"Name x Path /28.551DDF030000/temperature Type double StaleAfter 0.15", ""},
		{"Name x Path /29.B89115000000/sensed.BYTE Type byte Alarm on LatchAlarm latch.BYTE "
	         "PorAlarm por SetAlarm set_alarm=133333333 ResetLatch latch.BYTE=0 StaleAfter 20 "
	         "PerFactor 50",
	         ""},
		{"Name x Path /29.B89115000000/PIO.3 Type bool IO output PerFactor 300 StaleAfter 1 "
	         "ReadBack 0",
	         ""},
	};

	expect_warnings(cases, COUNT(cases), check);
}

static int check_pair(const char *keys)
{
	const char *second = strchr(keys, ';') + 1;
	char text[600];
	int err;

	snprintf(text, sizeof(text),
	         "Item {\nName a Type byte %s%.*s }\nItem {\nName b Type byte %s%s }",
	         strncmp(keys, "IO", 2) ? "IO output " : "", (int)strcspn(keys, ";"), keys,
	         strncmp(second, "IO", 2) ? "IO output " : "", second);
	err = parse_driver(text);
	if (!err)
		config_check_items(config, NULL, &report);
	return err;
}

static void test_two_outputs_of_the_same_bits_are_named(void)
{
#define FIGHT \
	"f:4: warning: \"b\" and \"a\" in line 2 set the same bits, and Restore on undoes what the " \
	"other commands: write Restore off, or keep one of them\n"
#define SHARE \
	"f:4: warning: \"b\" and \"a\" in line 2 set the same bits, and the last command counts for " \
	"both: keep one of them\n"
#define ALIAS "ReadBack 5 Path /lamp/PIO.A"
	static const struct line cases[] = {
		{"Path /29.B89115000000/PIO.BYTE Restore on;Path /29.B89115000000/PIO.3", FIGHT},
		{"Path /29.B89115000000/PIO.3;Path /bus.0/29b89115000000/PIO.BYTE Restore on",
	         FIGHT},
		{"Path /29.B89115000000/PIO.3 Restore on;Path /29.B89115000000/PIO.3", FIGHT},
		{"Path /29.B89115000000/PIO.ALL;Path /29.B89115000000/PIO.3 Restore on",
	         "f:2: warning: \"a\" is a text or a list, and no byte: write Type string\n" FIGHT},
		{"Path /42.B89115000000/latch.A Restore on;Path /42.B89115000000/PIO.A", FIGHT},
		{"Path /05.B89115000000/PIO Restore on;Path /05.B89115000000/PIO", FIGHT},
		{ALIAS " Restore on;Path /lamp/PIO.BYTE", FIGHT},
		{"Path /29.B89115000000/PIO.BYTE Restore on;IO input Writable on Path "
	         "/29.B89115000000/PIO.3",
	         FIGHT},
		{"IO input Writable on Path /29.B89115000000/PIO.3;Path /29.B89115000000/PIO.BYTE "
	         "Restore on",
	         FIGHT},
		{"Path /29.B89115000000/PIO.BYTE Restore on;IO input Path /29.B89115000000/PIO.3",
	         ""},
		{"Path /29.B89115000000/PIO.BYTE;Path /29.B89115000000/PIO.3", SHARE},
		{"Path /29.B89115000000/PIO.3 InitValue 1;Path /29.B89115000000/PIO.3 InitValue 0",
	         SHARE},
		{"Path /lamp/PIO.A;Path /lamp/PIO.A", SHARE},
		{"Path /29.B89115000000/PIO.2;Path /29.B89115000000/PIO.3", ""},
		{"Path /29.B89115000000/PIO.2 Restore on;Path /29.B89115000000/PIO.3 Restore on",
	         ""},
		{"Path /29.B89115000000/PIO.3 Restore on;Path /29.000000000001/PIO.3 Restore on",
	         ""},
		{"Path /29.B89115000000/PIO.3 Restore on;Path /29.B89115000000/latch.BYTE", ""},
		{"Path /42.B89115000000/latch.A Restore on;Path /42.B89115000000/PIO.B", ""},
		{ALIAS " Restore on;Path /lamp/latch.A", ""},
	};

	expect_warnings(cases, COUNT(cases), check_pair);
}

/* A table of a family that this check contradicts would be found here. */
static void test_no_property_of_any_family_in_its_own_direction_is_complained_of(void)
{
	for (unsigned n = 0; family_nth(n); n++) {
		const struct property *property = NULL;

		while ((property = family_next(family_nth(n), NULL, property))) {
			bool letters = property->array.index == INDEX_LETTERS;
			char keys[160], first[8];

			if (property->type == PROPERTY_DIRECTORY || !property->access)
				continue;
			extension_print(property, letters ? EXTENSION_LETTERS : 0, first);
			snprintf(keys, sizeof(keys),
			         "Name x Path \"/%02X.000000000001/%s%s\" Type double%s",
			         family_nth(n)->code, property->name, first,
			         property->access & ACCESS_READ ? "" : " IO output");
			said_begin();
			TEST_ASSERT_EQUAL_INT(0, check(keys));
			TEST_ASSERT_NULL_MESSAGE(strstr(said, "cannot be written"), said);
			TEST_ASSERT_NULL_MESSAGE(strstr(said, "has no "), said);
			config_free(config);
			config = NULL;
		}
	}
}

static int parse_wrong(const char *text)
{
	config_case_begin();
	report.keeps_wrong = true;
	int err = config_parse("f", text, strlen(text), &report, &config);

	report.keeps_wrong = false;
	return err;
}

static void test_the_items_of_a_file_with_errors_are_checked_too(void)
{
	static const char *const unreadable[] = {
		"",
		"Items { }",
		"OwsDrv { Period 0\nItem { Name a Path /x/y PerFactor 0 StaleAfter 1 } }",
		"OwsDrv { Period x\nItem { Name a Path /x/y StaleAfter 1 } }",
		"OwsDrv { Item { Name a Path /x/y }",
		"OwsDrv { Item { Path } Item { } Item { Name a Path /x/y Type string Alarm on }",
		"OwsDrv { TargetName \"\" Bus { } Bus { Target x Sensors }\nItem { Name a } }",
		"OwsDrv { Mqtt { Broker } Web { Listen x } ControlAllow { } }",
	};

	TEST_ASSERT_EQUAL_INT(
		-EINVAL,
		parse_wrong("OwsDrv { Timeout x\n"
	                    "Item { Name a Path /28.000000000001/temperatur Type double }\n"
	                    "Item { Name b Path /28.000000000001/temperatur Type dubble }\n"
	                    "Item { Name c Path /28.000000000001/temperature Type double } }"));
	TEST_ASSERT_NOT_NULL(config);
	TEST_ASSERT_EQUAL_UINT(2, config->item_count);
	TEST_ASSERT_EQUAL_STRING("c", config->items[1].name);
	config_check_items(config, NULL, &report);
	TEST_ASSERT_EQUAL_UINT(2, report.errors);
	TEST_ASSERT_EQUAL_UINT(1, report.warnings);
	TEST_ASSERT_NOT_NULL_MESSAGE(
		strstr(said, "f:2:20: warning: \"a\": a DS18B20 has no temperatur"), said);
	for (unsigned i = 0; i < COUNT(unreadable); i++) {
		TEST_ASSERT_EQUAL_INT_MESSAGE(-EINVAL, parse_wrong(unreadable[i]), unreadable[i]);
		if (config)
			config_check_items(config, NULL, &report);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_what_cannot_be_meant_is_named_with_its_remedy);
	RUN_TEST(test_the_age_that_a_cache_leaves_is_reckoned_with);
	RUN_TEST(test_what_may_be_meant_is_not_mentioned);
	RUN_TEST(test_a_string_of_an_alarm_that_does_not_fit_its_purpose_is_named);
	RUN_TEST(test_alarms_that_fit_are_not_mentioned);
	RUN_TEST(test_two_outputs_of_the_same_bits_are_named);
	RUN_TEST(test_no_property_of_any_family_in_its_own_direction_is_complained_of);
	RUN_TEST(test_the_items_of_a_file_with_errors_are_checked_too);
	return UNITY_END();
}
