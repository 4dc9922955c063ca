/* SPDX-License-Identifier: MIT */
/* The keys of an Item: what is wrong with them, in which words and at which place. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/config_case.h"

void setUp(void)
{
	config_case_begin();
}

void tearDown(void)
{
	config_case_end();
}

static void test_wrong_items_are_errors_with_what_was_expected(void)
{
#define TYPES \
	"is not a type; expected 1 bool, 2 byte, 3 short, 4 long, 5 word, 6 dword, 7 float, 8 " \
	"double, 10 large or 12 string in the last hexadecimal digit\n"
	static const struct line cases[] = {
		{"Path \"/a/b\" Type bool", "f:2:1: error: expected a Name in this Item\n"},
		{"Name \"x\" Type bool", "f:2:1: error: expected a Path in this Item\n"},
		{"Name x Path /a/b", "f:2:1: error: expected a Type or an IOType in this Item\n"},
		{"Name x Path /a/b Typ bool",
	         "f:3:18: warning: unknown key Typ in Item is ignored; is it Type?\n"
	         "f:3:18: error: expected a Type or an IOType in this Item: is Typ meant to be "
	         "Type?\n"},
		{"Name x Path /a/b IoTyp 0x11",
	         "f:3:18: warning: unknown key IoTyp in Item is ignored; is it IOType?\n"
	         "f:3:18: error: expected a Type or an IOType in this Item: is IoTyp meant to be "
	         "IOType?\n"},
		{"Nam x Path /a/b Type bool",
	         "f:3:1: warning: unknown key Nam in Item is ignored; is it Name?\n"
	         "f:3:1: error: expected a Name in this Item: is Nam meant to be Name?\n"},
		{"Name x Pfad y Paht /a/b Type bool",
	         "f:3:8: warning: unknown key Pfad in Item is ignored\n"
	         "f:3:15: warning: unknown key Paht in Item is ignored; is it Path?\n"
	         "f:3:15: error: expected a Path in this Item: is Paht meant to be Path?\n"},
		{"Name \"\" Path /a/b Type bool", "f:3:6: error: the name \"\" is empty\n"},
		{"Name \"a/b\" Path /a/b Type bool",
	         "f:3:6: error: the name \"a/b\" holds one of / \" # { }\n"},
		{"Name _DGNRESET Path /a/b Type bool",
	         "f:3:6: error: the name \"_DGNRESET\" is the name of a driver signal\n"},
		{"Name x Path \"/a//b\" Type bool",
	         "f:3:13: error: the path \"/a//b\" has an empty component\n"},
		{"Name x Path \"/a/../b\" Type bool",
	         "f:3:13: error: the path \"/a/../b\" has a component \".\" or \"..\"\n"},
		{"Name x Path \"/uncached\" Type bool",
	         "f:3:13: error: the path \"/uncached\" has no property\n"},
		{"Name x Path \"/28.551DDF030000\" Type bool",
	         "f:3:13: error: the path \"/28.551DDF030000\" has no property after the device\n"},
		{"Name x Path \"/28.551DDF030000.00/t\" Type bool",
	         "f:3:13: error: the path \"/28.551DDF030000.00/t\" has a device id with a wrong "
	         "checksum\n"},
		{"Name x Path /a/b IOType 0x0019", "f:3:25: error: IOType 0x0019: 9 " TYPES},
		{"Name x Path /a/b IOType 0x10", "f:3:25: error: IOType 0x10: 0 " TYPES},
		{"Name x Path /a/b IOType double",
	         "f:3:25: error: IOType \"double\": expected a whole number such as 0x0018\n"},
		{"Name x Path /a/b Type integer",
	         "f:3:23: error: Type \"integer\": expected bool, byte, short, long, word, dword, "
	         "float, double, large or string\n"},
		{"Name x Path /a/b Type byte IO both",
	         "f:3:31: error: IO \"both\": expected input or output\n"},
		{"Name x Path /a/b Type byte Readable maybe",
	         "f:3:37: error: Readable \"maybe\": expected on or off\n"},
		{"Name x Path /a/b IOType 0x0018\nType float",
	         "f:4:6: error: Type float contradicts IOType 0x0018 in line 3, which says double\n"},
		{"Name x Path /a/b IOType 0x0018\nIO output",
	         "f:4:4: error: IO output contradicts IOType 0x0018 in line 3, which says input\n"},
		{"Name x Path /uncached/a/b Type bool Uncached off",
	         "f:3:46: error: Uncached off contradicts Path, which begins with /uncached\n"},
		{"Name x Path /a/b Type byte InitValue \"256\"",
	         "f:3:38: error: InitValue \"256\": the type byte cannot hold it\n"},
		{"Name x Path /a/b Type byte InitValue \"1.5\"",
	         "f:3:38: error: InitValue \"1.5\": expected a whole number (type byte)\n"},
		{"Name x Path /a/b Type byte IO output SafeValue \"\"",
	         "f:3:48: error: SafeValue \"\": expected a whole number (type byte)\n"},
		{"Name x Path /a/b Type byte InitValue \"x\"",
	         "f:3:38: error: InitValue \"x\": expected a whole number (type byte)\n"},
		{"Name x Path /a/b Type double InitValue \"4,7\"",
	         "f:3:40: error: InitValue \"4,7\": expected a number with a decimal point (type "
	         "double)\n"},
		{"Name x Path /a/b Type bool IO output SafeValue \"aus\"",
	         "f:3:48: error: SafeValue \"aus\": expected 0, 1, on, off, yes, no, true or false "
	         "(type bool)\n"},
		{"Name x Path /a/b Type bool Start last",
	         "f:3:34: error: Start \"last\": expected an output, and this is an input\n"},
		{"Name x Path /a/b Type bool Writable on Start last",
	         "f:3:46: error: Start \"last\": expected an output, and this is an input\n"},
		{"Name x Path /a/b Type bool IO output Start first",
	         "f:3:44: error: Start \"first\": expected init or last\n"},
		{"Name x Path /a/b Type bool IO output Start \"\"",
	         "f:3:44: error: Start \"\": expected init or last\n"},
		{"Name x Path /a/b Type double Calibrated \"\"",
	         "f:3:41: error: Calibrated \"\": expected a date such as \"2026-11-22\"\n"},
		{"Name x Path /a/b Type bool IO output SafeValue 0 SafeDelay -1",
	         "f:3:60: error: SafeDelay \"-1\": expected seconds from 0 to 86400\n"},
		{"Name x Path /a/b Type bool PerFactor 0",
	         "f:3:38: error: PerFactor \"0\": expected a whole number from 1 to 1000000\n"},
		{"Name x Path /a/b Type bool StaleAfter -1",
	         "f:3:39: error: StaleAfter \"-1\": expected seconds from 0 to 31536000\n"},
		{"Name x Path /simultaneous/temperature Type bool PorAlarm \"\" LatchAlarm \"l\" Alarm on",
	         "f:3:82: error: Alarm on: expected a device in the path "
	         "\"/simultaneous/temperature\"\n"},
		{"Name x Path /a/b Type bool }\nItem { Name x Path /a/c Type bool",
	         "f:4:13: error: the name \"x\" is given twice, first in line 3: give one of them another Name\n"},
	};

	expect_errors(cases, COUNT(cases), parse_item);
}

static void test_three_items_of_one_name_all_name_the_first(void)
{
	parse_driver("Item { Name x Path a/b Type bool }\nItem { Name y Path a/b Type bool }\n"
	             "Item { Name x Path a/b Type bool }\nItem { Name x Path a/b Type bool }");
	TEST_ASSERT_EQUAL_STRING(
		"f:4:13: error: the name \"x\" is given twice, first in line 2: give one of them another Name\n"
		"f:5:13: error: the name \"x\" is given twice, first in line 2: give one of them another Name\n",
		said);
}

static void test_items_that_can_be_understood_are_only_warned_about(void)
{
	static const struct line cases[] = {
		{"Name x Path /a/b IOType 0x4218",
	         "f:3:25: warning: IOType 0x4218 has the unknown bits 0x4200, which are ignored\n"},
		{"Name x Path /alarm/a/b Type bool",
	         "f:3:13: warning: the path \"/alarm/a/b\" is entered without /alarm, which is "
	         "dropped; alarms are chosen by Alarm on\n"},
		{ITEM "Initvalue \"3\"",
	         "f:3:28: warning: unknown key Initvalue in Item is ignored; is it InitValue?\n"},
		{ITEM "Portion \"portion\"",
	         "f:3:28: warning: unknown key Portion in Item is ignored\n"},
		{ITEM "SafeValue 3",
	         "f:3:28: warning: SafeValue does nothing: this input is not Writable\n"},
		{ITEM "SafeValue 3 Writable on", ""},
	};

	expect_warnings(cases, COUNT(cases), parse_item);
}

/* Whether that is so shows when the line is right. */
static void test_no_key_does_nothing_because_another_was_refused(void)
{
	static const char *const items[] = {
		"Name x Path /a/b IOType 0x0021x SafeValue 1",
		"Name x Path /a/b Type bool IO outpt SafeValue 1 Confirm on",
		"Name x Path /a/b Type byte IO output SafeValue 300 SafeDelay 2",
		"Name x Path /a/b Type double LimitH high Hysteresis 1",
		"Name x Path /a/b Type bool Alarm onn LatchAlarm latch",
		"Name x Path /a/b Type double IO output Scale x Filter 3",
	};

	for (size_t i = 0; i < COUNT(items); i++) {
		parse_item(items[i]);
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(said, "error: "), items[i]);
		TEST_ASSERT_NULL_MESSAGE(strstr(said, "does nothing"), said);
	}
}

static void test_the_bits_of_io_type_and_the_keys_that_override_them(void)
{
	static const struct {
		const char *keys;
		enum ows_type type;
		bool output, readable, writable, fresh, alarm;
	} cases[] = {
		{"IOType 0x0012", OWS_BYTE, false, true, false, false, false},
		{"IOType 0x0022", OWS_BYTE, true, false, true, false, false},
		{"IOType 0x0032", OWS_BYTE, true, true, true, false, false},
		{"IOType 0x0118", OWS_DOUBLE, false, true, false, true, false},
		{"IOType 0x0008", OWS_DOUBLE, false, true, false, false, false},
		{"IOType 24", OWS_DOUBLE, false, true, false, false, false},
		{"IOType 0x001A", OWS_LARGE, false, true, false, false, false},
		{"IOType 0x001c", OWS_STRING, false, true, false, false, false},
		{"IOType 0x0118 Uncached off", OWS_DOUBLE, false, true, false, false, false},
		{"IOType 0x0018 Uncached on", OWS_DOUBLE, false, true, false, true, false},
		{"IOType 0x0018 Readable off Writable on", OWS_DOUBLE, false, false, true, false,
	         false},
		{"IOType 0x0022 Readable yes Writable no", OWS_BYTE, true, true, false, false,
	         false},
		{"IOType 0x0018 Type double IO input", OWS_DOUBLE, false, true, false, false,
	         false},
		{"Type word", OWS_WORD, false, true, false, false, false},
		{"Type word IO output", OWS_WORD, true, false, true, false, false},
		{"Type word Alarm on PorAlarm \"\" LatchAlarm l", OWS_WORD, false, true, false,
	         false, true},
	};

	for (size_t i = 0; i < COUNT(cases); i++) {
		char text[256];

		snprintf(text, sizeof(text), "Name x Path a/b %s", cases[i].keys);
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, parse_item(text), said);
		TEST_ASSERT_EQUAL_STRING_MESSAGE("", said, cases[i].keys);
		TEST_ASSERT_EQUAL_INT_MESSAGE(cases[i].type, config->items[0].type, cases[i].keys);
		TEST_ASSERT_EQUAL_MESSAGE(cases[i].output, config->items[0].output, cases[i].keys);
		TEST_ASSERT_EQUAL_MESSAGE(cases[i].readable, config->items[0].readable,
		                          cases[i].keys);
		TEST_ASSERT_EQUAL_MESSAGE(cases[i].writable, config->items[0].writable,
		                          cases[i].keys);
		TEST_ASSERT_EQUAL_MESSAGE(cases[i].fresh, config->items[0].fresh, cases[i].keys);
		TEST_ASSERT_EQUAL_MESSAGE(cases[i].alarm, config->items[0].alarm, cases[i].keys);
	}
}

static void test_paths_lose_their_flags_and_gain_a_slash(void)
{
	static const struct {
		const char *path, *normalised;
		bool fresh;
	} cases[] = {
		{"28.551ddf030000/temperature", "/28.551ddf030000/temperature", false},
		{"uncached/bus.0/x/y", "/bus.0/x/y", true},
		{"/bus.12/uncached/x/y/z.ALL", "/bus.12/x/y/z.ALL", true},
		{"/simultaneous/temperature", "/simultaneous/temperature", false},
		{"/uncached/system/process/pid", "/system/process/pid", true},
		{"/1F.010203040506/main/28.551DDF030000/t",
	         "/1F.010203040506/main/28.551DDF030000/t", false},
	};

	for (size_t i = 0; i < COUNT(cases); i++) {
		char text[256];

		snprintf(text, sizeof(text), "Name x Type double Path \"%s\"", cases[i].path);
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, parse_item(text), said);
		TEST_ASSERT_EQUAL_STRING(cases[i].normalised, config->items[0].path);
		TEST_ASSERT_EQUAL_MESSAGE(cases[i].fresh, config->items[0].fresh, cases[i].path);
	}
}

static void test_start_values_are_typed_and_an_empty_one_is_none(void)
{
	TEST_ASSERT_EQUAL_INT(0, parse_item("Name x Path a/b Type bool IO output InitValue \"on\" "
	                                    "SafeValue \"off\" PerFactor 7 StaleAfter 2.5"));
	TEST_ASSERT_TRUE(config->items[0].has_init);
	TEST_ASSERT_TRUE(config->items[0].has_safe);
	TEST_ASSERT_EQUAL_INT64(1, config->items[0].init_value);
	TEST_ASSERT_EQUAL_INT64(0, config->items[0].safe_value);
	TEST_ASSERT_EQUAL_STRING("on", config->items[0].init_text);
	TEST_ASSERT_EQUAL_UINT32(7, config->items[0].per_factor);
	TEST_ASSERT_EQUAL_INT64(2500000000, config->items[0].stale_after_ns);
	parse_item("Name x Path a/b Type byte IO output InitValue \"\"");
	TEST_ASSERT_FALSE(config->items[0].has_init);
	TEST_ASSERT_EQUAL_STRING("", config->items[0].init_text);
	parse_item("Name x Path a/b Type string IO output InitValue \" a b \" SafeValue \"\"");
	TEST_ASSERT_TRUE(config->items[0].has_init);
	TEST_ASSERT_TRUE(config->items[0].has_safe);
	TEST_ASSERT_EQUAL_STRING(" a b ", config->items[0].init_text);
	TEST_ASSERT_EQUAL_STRING("", config->items[0].safe_text);
}

static void test_what_an_output_begins_with_and_how_long_it_waits(void)
{
	parse_item("Name x Path a/b Type bool IO output");
	TEST_ASSERT_FALSE(config->items[0].starts_last);
	TEST_ASSERT_FALSE(config->items[0].has_safe_delay);
	parse_item("Name x Path a/b Type bool IO output Start init");
	TEST_ASSERT_FALSE(config->items[0].starts_last);
	parse_item("Name x Path a/b Type bool IO output Start last SafeValue 0 SafeDelay 0");
	TEST_ASSERT_TRUE(config->items[0].starts_last);
	TEST_ASSERT_TRUE(config->items[0].has_safe_delay);
	TEST_ASSERT_EQUAL_INT64(0, config->items[0].safe_delay_ns);
	TEST_ASSERT_FALSE(config->items[0].confirm);
	parse_item("Name x Path a/b Type bool IO output Confirm on");
	TEST_ASSERT_TRUE(config->items[0].confirm);
	parse_item("Name x Path a/b Type bool Confirm on");
	TEST_ASSERT_EQUAL_STRING("f:3:27: warning: Confirm does nothing: nobody sets this input\n",
	                         said);
	parse_item("Name x Path a/b Type bool IO output SafeDelay 2.5");
	TEST_ASSERT_EQUAL_INT64(2500000000, config->items[0].safe_delay_ns);
	TEST_ASSERT_EQUAL_STRING("f:3:37: warning: SafeDelay does nothing without SafeValue\n",
	                         said);
}

static void test_an_integer_for_what_has_decimals_is_warned_about(void)
{
	static const char *const fit[] = {
		"Type double Path /28.551DDF030000/temperature",
		"Type long Path /boiler/pio",
		"Type float Path /26.0CBEEA010000/VDD",
		"Type large Path /1D.0CBEEA010000/counters.A",
		"Type string Path /28.551DDF030000/temperature",
		"Type long Path /28.551DDF030000/templow",
	};
	char text[128];

	TEST_ASSERT_EQUAL_INT(0, parse_item("Name x Type long Path /28.551DDF030000/temperature"));
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(said, "has decimals, and a long has none: write Type "
	                                          "double or float"),
	                             said);
	for (size_t i = 0; i < COUNT(fit); i++) {
		snprintf(text, sizeof(text), "Name x %s", fit[i]);
		TEST_ASSERT_EQUAL_INT(0, parse_item(text));
		TEST_ASSERT_EQUAL_STRING_MESSAGE("", said, fit[i]);
	}
}

static void test_a_start_value_longer_than_a_string_is_an_error(void)
{
	char keys[1200] = "Name a\nPath /28.000000000001/x\nType string\nInitValue \"";
	size_t begin = strlen(keys);

	memset(keys + begin, 'x', 1024);
	strcpy(keys + begin + 1024, "\"");
	TEST_ASSERT_EQUAL_INT(0, parse_item(keys));
	TEST_ASSERT_EQUAL_size_t(1024, strlen(config->items[0].init_text));
	strcpy(keys + begin + 1024, "x\"");
	TEST_ASSERT_EQUAL_INT(-EINVAL, parse_item(keys));
	TEST_ASSERT_NOT_NULL(strstr(said, "1024"));
}

static void test_a_part_of_an_alarm_that_is_not_understood_is_an_error(void)
{
#define PART(key, by) \
	"f:3:28: error: unknown key " key " in Item looks like part of an alarm, which would be " \
	"off: write " by " in its place\n"
	static const struct line cases[] = {
		{ITEM "Latch \"latch.BYTE\"", PART("Latch", "LatchAlarm")},
		{ITEM "AlarmPOR \"por\"", PART("AlarmPOR", "PorAlarm")},
		{ITEM "AlarmPor \"x\"", PART("AlarmPor", "PorAlarm")},
		{ITEM "Foo \"set_alarm=133333333\"", PART("Foo", "SetAlarm")},
		{ITEM "Foo \"latch.BYTE=0\"", PART("Foo", "ResetLatch")},
		{ITEM "AlarmOn 1", PART("AlarmOn", "Alarm")},
		{ITEM "AlarmText \"x\"",
	         PART("AlarmText", "Alarm, LatchAlarm, PorAlarm, SetAlarm or ResetLatch")},
	};

	expect_errors(cases, COUNT(cases), parse_item);
}

static void test_a_forgotten_brace_is_named(void)
{
	parse_item(ITEM "\nItem { Name y }");
	TEST_ASSERT_NOT_NULL(strstr(
		said, "unknown key Item in Item is ignored; is a '}' missing before line 4?\n"));
}

static int64_t read_back_of(const char *path, const char *rest)
{
	char text[200];

	snprintf(text, sizeof(text), "Name x Path \"%s\" IO output %s", path, rest);
	parse_item(text);
	return config->items[0].read_back_ns / 1000000;
}

static void test_an_output_that_reads_as_written_is_read_back(void)
{
	TEST_ASSERT_EQUAL_INT64(10000, read_back_of("/29.000000000001/PIO.0", "Type bool"));
	TEST_ASSERT_EQUAL_INT64(10000, read_back_of("/3A.000000000001/PIO.BYTE", "Type byte"));
	TEST_ASSERT_EQUAL_INT64(500,
	                        read_back_of("/29.000000000001/PIO.0", "Type bool ReadBack 0.5"));
	TEST_ASSERT_EQUAL_INT64(0, read_back_of("/29.000000000001/PIO.0", "Type bool ReadBack 0"));
	/* its pin may be held by others; it is cleared by a write; nobody knows the chip */
	TEST_ASSERT_EQUAL_INT64(0, read_back_of("/42.000000000001/PIO.A", "Type bool"));
	TEST_ASSERT_EQUAL_INT64(0, read_back_of("/29.000000000001/latch.BYTE", "Type byte"));
	TEST_ASSERT_EQUAL_INT64(0, read_back_of("/lamp/PIO.A", "Type bool"));
	TEST_ASSERT_EQUAL_INT64(5000, read_back_of("/lamp/PIO.A", "Type bool ReadBack 5"));
	TEST_ASSERT_EQUAL_STRING("", said);
	TEST_ASSERT_EQUAL_INT64(
		0, read_back_of("/28.000000000001/temphigh", "Type double ReadBack 5"));
	TEST_ASSERT_NOT_NULL(
		strstr(said, "ReadBack does nothing: it need not read as it was written\n"));
	/* the pin is no proof, however often it is asked for; what holds is named */
	TEST_ASSERT_EQUAL_INT64(
		0, read_back_of("/42.000000000001/PIO.A", "Type bool ReadBack 1 Restore on"));
	TEST_ASSERT_NOT_NULL(strstr(
		said,
		"ReadBack does nothing: it need not read as it was written; write the Path of latch\n"));
	TEST_ASSERT_NOT_NULL(strstr(said, "Restore does nothing: the item is not read back"));
	TEST_ASSERT_EQUAL_INT64(
		0, read_back_of("/29.000000000001/latch.BYTE", "Type byte ReadBack 1"));
	TEST_ASSERT_NOT_NULL(strstr(said, "ReadBack does nothing"));
	parse_item("Name x Path a/b Type bool ReadBack 5 Restore on");
	TEST_ASSERT_NOT_NULL(strstr(said, "ReadBack does nothing: this is an input"));
	TEST_ASSERT_NOT_NULL(strstr(said, "Restore does nothing: the item is not read back"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_wrong_items_are_errors_with_what_was_expected);
	RUN_TEST(test_three_items_of_one_name_all_name_the_first);
	RUN_TEST(test_items_that_can_be_understood_are_only_warned_about);
	RUN_TEST(test_no_key_does_nothing_because_another_was_refused);
	RUN_TEST(test_the_bits_of_io_type_and_the_keys_that_override_them);
	RUN_TEST(test_paths_lose_their_flags_and_gain_a_slash);
	RUN_TEST(test_start_values_are_typed_and_an_empty_one_is_none);
	RUN_TEST(test_what_an_output_begins_with_and_how_long_it_waits);
	RUN_TEST(test_an_integer_for_what_has_decimals_is_warned_about);
	RUN_TEST(test_a_start_value_longer_than_a_string_is_an_error);
	RUN_TEST(test_a_part_of_an_alarm_that_is_not_understood_is_an_error);
	RUN_TEST(test_a_forgotten_brace_is_named);
	RUN_TEST(test_an_output_that_reads_as_written_is_read_back);
	return UNITY_END();
}
