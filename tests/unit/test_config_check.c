/* SPDX-License-Identifier: MIT */
/* What is wrong with a configuration, and in which words and at which place it is said. */
#include "src/config/config.h"

#include "unity.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

static struct config_report report;
static struct config *config;
static char said[8192];

static void note(void *ctx, bool is_error, const char *message)
{
	size_t used = strlen(said);

	(void)ctx;
	TEST_ASSERT_NOT_NULL(strstr(message, is_error ? "error: " : "warning: "));
	snprintf(said + used, sizeof(said) - used, "%s\n", message);
}

static void forget(void)
{
	config_free(config);
	config = NULL;
	report = (struct config_report){.line = note};
	said[0] = '\0';
}

void setUp(void)
{
	config = NULL;
	forget();
}

void tearDown(void)
{
	forget();
}

static int parse(const char *text)
{
	forget();
	return config_parse("f", text, strlen(text), &report, &config);
}

static int parse_driver(const char *keys)
{
	char text[4096];

	snprintf(text, sizeof(text), "OwsDrv {\n%s\n}\n", keys);
	return parse(text);
}

static int parse_item(const char *keys)
{
	char text[2048];

	snprintf(text, sizeof(text), "Item {\n%s\n}", keys);
	return parse_driver(text);
}

struct line {
	const char *keys, *said;
};

static void expect_errors(const struct line *cases, size_t count, int (*by)(const char *))
{
	for (size_t i = 0; i < count; i++) {
		TEST_ASSERT_EQUAL_INT_MESSAGE(-EINVAL, by(cases[i].keys), cases[i].keys);
		TEST_ASSERT_NULL_MESSAGE(config, cases[i].keys);
		TEST_ASSERT_EQUAL_STRING_MESSAGE(cases[i].said, said, cases[i].keys);
	}
}

static void expect_warnings(const struct line *cases, size_t count, int (*by)(const char *))
{
	for (size_t i = 0; i < count; i++) {
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, by(cases[i].keys), said);
		TEST_ASSERT_EQUAL_STRING_MESSAGE(cases[i].said, said, cases[i].keys);
	}
}
#define COUNT(a) (sizeof(a) / sizeof((a)[0]))

static void test_defaults_are_those_of_the_manual(void)
{
	TEST_ASSERT_EQUAL_INT(0, parse("OwsDrv { }"));
	TEST_ASSERT_EQUAL_STRING("", said);
	TEST_ASSERT_EQUAL_UINT(5, config->max_cons_alarms);
	TEST_ASSERT_EQUAL_UINT(3, config->max_retries);
	TEST_ASSERT_EQUAL_INT64(20000000000, config->timeout_ns);
	TEST_ASSERT_EQUAL_INT64(100000000, config->period_ns);
	TEST_ASSERT_EQUAL_INT64(50000000, config->alarm_period_ns);
	TEST_ASSERT_EQUAL_UINT(1, config->target_count);
	TEST_ASSERT_EQUAL_STRING("localhost:4304", config->targets[0].text);
	TEST_ASSERT_EQUAL_UINT(0, config->item_count);
}

static void test_a_file_of_something_else_is_refused(void)
{
	static const struct line cases[] = {
		{"", "f:1:1: error: expected OwsDrv {\n"},
		{"# nothing\n", "f:1:1: error: expected OwsDrv {\n"},
		{"MbmDrv {\n}\n", "f:1:1: error: expected OwsDrv {, found the block MbmDrv: is it the "
	                          "file of another driver?\n"},
		{"Period 1\nOwsDrv { }", "f:1:1: error: expected OwsDrv {, found Period\n"},
		{"OwsDrv 1", "f:1:8: error: expected { behind OwsDrv\n"},
		{"OwsDrv { }\nOwsDrv { }", "f:2:1: error: OwsDrv stands twice, first in line 1\n"},
		{"OwsDrv {", "f:1:9: error: expected '}' to end OwsDrv of line 1\n"},
	};

	expect_errors(cases, COUNT(cases), parse);
}

static void test_wrong_driver_values_are_errors_with_what_was_expected(void)
{
	static const struct line cases[] = {
		{"Timeout abc", "f:2:9: error: Timeout \"abc\": expected seconds from 0.001 to 86400\n"},
		{"Timeout 0", "f:2:9: error: Timeout \"0\": expected seconds from 0.001 to 86400\n"},
		{"Timeout -1", "f:2:9: error: Timeout \"-1\": expected seconds from 0.001 to 86400\n"},
		{"Period 61", "f:2:8: error: Period \"61\": expected seconds from 0.001 to 60\n"},
		{"Period 0,1", "f:2:8: error: Period \"0,1\": expected seconds from 0.001 to 60\n"},
		{"MaxRetries 101", "f:2:12: error: MaxRetries \"101\": expected a whole number from 0 "
	                           "to 100\n"},
		{"MaxRetries 1.5", "f:2:12: error: MaxRetries \"1.5\": expected a whole number from 0 "
	                           "to 100\n"},
		{"MaxConsAlarms 1001", "f:2:15: error: MaxConsAlarms \"1001\": expected a whole number "
	                               "from 0 to 1000\n"},
		{"Timeout 1\nAlarmPeriod 2", "f:3:13: error: AlarmPeriod \"2\": expected no more than "
	                                     "Timeout, which is 1 s\n"},
		{"Timeout 1\nTimeout 2", "f:3:1: error: Timeout stands twice, first in line 2\n"},
		{"Timeout [ 1 ]", "f:2:9: error: Timeout: expected one value\n"},
		{"Timeout { }", "f:2:9: error: Timeout: expected one value\n"},
		{"Item 5", "f:2:6: error: Item: expected a block in { }\n"},
		{"TargetName \"a, ,b\"", "f:2:12: error: expected a target beside ',' or '|'\n"},
		{"TargetName \"a|\"", "f:2:12: error: expected a target beside ',' or '|'\n"},
		{"TargetName \"w1, i2c:/dev/i2c-1 | w1\"",
	         "f:2:12: error: the target \"w1\" stands twice; the first is \"w1\"\n"},
		{"TargetName \"localhost, LOCALHOST:4304\"",
	         "f:2:12: error: the target \"LOCALHOST:4304\" stands twice; the first is "
	         "\"localhost\"\n"},
		{"TargetName \"owserver:w1:4304, owserver:w1\"",
	         "f:2:12: error: the target \"owserver:w1\" stands twice; the first is "
	         "\"owserver:w1:4304\"\n"},
		{"TargetName \"[::1] | [::1]:4304\"",
	         "f:2:12: error: the target \"[::1]:4304\" stands twice; the first is \"[::1]\"\n"},
		{"Bus { }", "f:2:1: error: expected a Target in this Bus\n"},
		{"Bus { Target \"\" }", "f:2:1: error: expected a Target in this Bus\n"},
		{"Bus { Target w1 }\nBus { Target \"w1\" }",
	         "f:3:14: error: there is a Bus for \"w1\" already\n"},
		{"Bus { Target \"i2c:/dev/i2c-1\" PowerOffMs 0 }",
	         "f:2:42: error: PowerOffMs \"0\": expected a whole number from 1 to 60000\n"},
	};

	expect_errors(cases, COUNT(cases), parse_driver);
}

static void test_a_target_finds_its_bus_however_it_is_spelt(void)
{
	const struct config_bus *bus;

	parse_driver("TargetName \"LocalHost | i2c:/dev/i2c-1\" AlarmLine \"gpiochip0/5\"\n"
	             "Bus { Target \"i2c:/dev/i2c-1\" SleepLine \"c/3\" PowerLine \"c/2\" }\n"
	             "Bus { Target \"localhost:4304\" }");
	TEST_ASSERT_NOT_NULL(config);
	bus = config_bus(config, "i2c:/dev/i2c-1");
	TEST_ASSERT_EQUAL_PTR(&config->buses[0], bus);
	TEST_ASSERT_EQUAL_UINT(2, bus->option_count);
	TEST_ASSERT_EQUAL_STRING("PowerLine", bus->options[0].key);
	TEST_ASSERT_EQUAL_STRING("c/2", bus->options[0].text);
	TEST_ASSERT_EQUAL_INT(3, bus->options[0].line);
	TEST_ASSERT_EQUAL_STRING("SleepLine", bus->options[1].key);
	TEST_ASSERT_EQUAL_PTR(&config->buses[1], config_bus(config, "LocalHost"));
	TEST_ASSERT_EQUAL_UINT(0, config->buses[1].option_count);
	TEST_ASSERT_NULL(config_bus(config, "i2c:/dev/i2c-2"));
	TEST_ASSERT_EQUAL_STRING("gpiochip0/5", config->alarm_line);
	TEST_ASSERT_NULL(config->heartbeat_line);
}

static void test_what_can_be_understood_is_only_warned_about(void)
{
	static const struct line cases[] = {
		{"MaxConsAlarms 0", "f:2:15: warning: MaxConsAlarms 0 counts as 1\n"},
		{"MaxRequests 2", "f:2:13: warning: MaxRequests 2 counts as 1\n"},
		{"Version 2.00", "f:2:9: warning: Version 2.00: only 1.00 is known\n"},
		{"ItemCount 1", "f:2:11: warning: ItemCount is 1, but there are 0 items\n"},
		{"TargetName \"\"", "f:2:12: warning: TargetName is empty: localhost:4304 is taken\n"},
		{"TimeOut 3", "f:2:1: warning: unknown key TimeOut in OwsDrv is ignored; is it Timeout?\n"},
		{"TargetNam x", "f:2:1: warning: unknown key TargetNam in OwsDrv is ignored; is it "
	                        "TargetName?\n"},
		{"Elephant x", "f:2:1: warning: unknown key Elephant in OwsDrv is ignored\n"},
		{"Extra { A 1 }", "f:2:1: warning: unknown key Extra in OwsDrv is ignored\n"},
		{"Bus { Target \"w1\" Colour red }",
	         "f:2:19: warning: unknown key Colour in Bus is ignored\n"},
		{"Version 1.0", ""},
		{"Timeout 0.01", ""},
		{"MaxRequests 1 MaxRetries 0x0A", ""},
		{"Timeout \"7.5\"", ""},
	};

	expect_warnings(cases, COUNT(cases), parse_driver);
	TEST_ASSERT_EQUAL_INT64(7500000000, config->timeout_ns);
	parse_driver("MaxConsAlarms 0");
	TEST_ASSERT_EQUAL_UINT(1, config->max_cons_alarms);
	parse_driver("Timeout 0.01");
	TEST_ASSERT_EQUAL_INT64(10000000, config->alarm_period_ns);
	parse_driver("TargetName \" \"");
	TEST_ASSERT_EQUAL_STRING("localhost:4304", config->targets[0].text);
}

static void test_a_comma_separates_two_wires_and_a_bar_two_ways(void)
{
	TEST_ASSERT_EQUAL_INT(
		0, parse_driver("TargetName \" localhost:4304|i2c:/dev/i2c-1 | w1 , [::1]:4304\""));
	TEST_ASSERT_EQUAL_STRING("", said);
	TEST_ASSERT_EQUAL_UINT(4, config->target_count);
	TEST_ASSERT_EQUAL_STRING("localhost:4304", config->targets[0].text);
	TEST_ASSERT_EQUAL_STRING("i2c:/dev/i2c-1", config->targets[1].text);
	TEST_ASSERT_EQUAL_STRING("w1", config->targets[2].text);
	TEST_ASSERT_EQUAL_STRING("[::1]:4304", config->targets[3].text);
	TEST_ASSERT_EQUAL_INT(CONFIG_FIRST, config->targets[0].relation);
	TEST_ASSERT_EQUAL_INT(CONFIG_BAR, config->targets[1].relation);
	TEST_ASSERT_EQUAL_INT(CONFIG_BAR, config->targets[2].relation);
	TEST_ASSERT_EQUAL_INT(CONFIG_COMMA, config->targets[3].relation);
}

static void test_auto_is_a_bar_of_three_ways(void)
{
	TEST_ASSERT_EQUAL_INT(0, parse_driver("TargetName \"sim:a, auto | far:4304\""));
	TEST_ASSERT_EQUAL_UINT(5, config->target_count);
	TEST_ASSERT_EQUAL_STRING("localhost:4304", config->targets[1].text);
	TEST_ASSERT_EQUAL_STRING("i2c:auto", config->targets[2].text);
	TEST_ASSERT_EQUAL_STRING("w1", config->targets[3].text);
	TEST_ASSERT_EQUAL_INT(CONFIG_COMMA, config->targets[1].relation);
	for (int i = 2; i < 5; i++)
		TEST_ASSERT_EQUAL_INT(CONFIG_BAR, config->targets[i].relation);
	TEST_ASSERT_EQUAL_INT(0, parse_driver("TargetName \"auto\""));
	TEST_ASSERT_EQUAL_INT(CONFIG_FIRST, config->targets[0].relation);
	TEST_ASSERT_EQUAL_UINT(3, config->target_count);
	TEST_ASSERT_EQUAL_INT(-EINVAL, parse_driver("TargetName \"auto, w1\""));
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(said, "the target \"w1\" stands twice"), said);
}

static int own(const char *listen, const char *target)
{
	char keys[300];

	snprintf(keys, sizeof(keys), "Listen \"%s\"\nTargetName \"%s\"", listen, target);
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, parse_driver(keys), said);
	said[0] = '\0';
	return config_check_own(config, &report);
}

static void test_a_target_that_leads_back_to_owsd_is_refused(void)
{
	static const char *const back[][2] = {
		{"4304", "localhost"}, {"4304", "127.0.0.1:4304"}, {"4304", "[::1]"},
		{"0.0.0.0:4310", "localhost:4310"}, {"[::]:4310", "owserver:localhost:4310"},
		{"192.168.1.5:4304", "192.168.1.5"},
	};
	static const char *const good[][2] = {
		{"4305", "localhost"}, {"192.168.1.5:4304", "localhost"}, {"4304", "far:4304"},
		{"0.0.0.0:4304", "192.168.1.6"}, {"4304", "null:"}, {"0.0.0.0:4310", "[::1]:4310"},
	};

	for (size_t i = 0; i < sizeof(back) / sizeof(back[0]); i++) {
		TEST_ASSERT_EQUAL_INT_MESSAGE(-EINVAL, own(back[i][0], back[i][1]), back[i][1]);
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(said, "is where this owsd listens"), said);
	}
	for (size_t i = 0; i < sizeof(good) / sizeof(good[0]); i++)
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, own(good[i][0], good[i][1]), said);
}

static void test_auto_leaves_out_what_leads_back_to_owsd(void)
{
	TEST_ASSERT_EQUAL_INT(0, own("4304", "auto, far"));
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(said, "warning: auto looks for no owserver"), said);
	TEST_ASSERT_EQUAL_UINT(3, config->target_count);
	TEST_ASSERT_EQUAL_STRING("i2c:auto", config->targets[0].text);
	TEST_ASSERT_EQUAL_INT(CONFIG_FIRST, config->targets[0].relation);
	TEST_ASSERT_EQUAL_INT(CONFIG_BAR, config->targets[1].relation);
	TEST_ASSERT_EQUAL_INT(CONFIG_COMMA, config->targets[2].relation);
	TEST_ASSERT_EQUAL_UINT(0, config->targets[1].group);
	TEST_ASSERT_EQUAL_UINT(1, config->targets[2].group);
}

static void test_more_than_sixteen_targets_are_refused(void)
{
	char line[200] = "TargetName \"h1";

	for (int i = 2; i <= CONFIG_TARGETS_MAX; i++)
		snprintf(line + strlen(line), sizeof(line) - strlen(line), ",h%d", i);
	TEST_ASSERT_EQUAL_INT(-EINVAL, parse_driver(strcat(line, "|one.more\"")));
	TEST_ASSERT_EQUAL_STRING("f:2:12: error: \"one.more\" is one too many: owsd serves at most "
	                         "16 targets, ways behind a bar and the 3 of auto counted\n", said);
	strcpy(strrchr(line, '|'), "\"");
	TEST_ASSERT_EQUAL_INT(0, parse_driver(line));
	TEST_ASSERT_EQUAL_UINT(16, config->target_count);
}

static void test_targets_of_the_command_line_replace_those_of_the_file(void)
{
	static const char *const good[] = {"a | b", "c"}, *const bad[] = {"a", "a:4304"};

	parse_driver("TargetName \"x\"");
	TEST_ASSERT_EQUAL_INT(-EINVAL, config_set_targets(config, bad, 2, &report));
	TEST_ASSERT_EQUAL_STRING("error: the target \"a:4304\" stands twice; the first is \"a\"\n",
	                         said);
	TEST_ASSERT_EQUAL_STRING("x", config->targets[0].text);
	TEST_ASSERT_EQUAL_UINT(1, config->target_count);
	TEST_ASSERT_EQUAL_INT(0, config_set_targets(config, good, 2, &report));
	TEST_ASSERT_EQUAL_UINT(3, config->target_count);
	TEST_ASSERT_EQUAL_STRING("b", config->targets[1].text);
	TEST_ASSERT_EQUAL_INT(CONFIG_BAR, config->targets[1].relation);
	TEST_ASSERT_EQUAL_INT(CONFIG_COMMA, config->targets[2].relation);
}

static void test_wrong_items_are_errors_with_what_was_expected(void)
{
#define TYPES                                                                                      \
	"is no type; expected 1 bool, 2 byte, 3 short, 4 long, 5 word, 6 dword, 7 float, 8 "       \
	"double, 10 large or 12 string in the last hexadecimal digit\n"
	static const struct line cases[] = {
		{"Path \"/a/b\" Type bool", "f:2:1: error: expected a Name in this Item\n"},
		{"Name \"x\" Type bool", "f:2:1: error: expected a Path in this Item\n"},
		{"Name x Path /a/b", "f:2:1: error: expected a Type or an IOType in this Item\n"},
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
	         "f:3:13: error: the path \"/28.551DDF030000\" has no property behind the device\n"},
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
		{"Name x Path /a/b Type bool PerFactor 0",
	         "f:3:38: error: PerFactor \"0\": expected a whole number from 1 to 1000000\n"},
		{"Name x Path /a/b Type bool StaleAfter -1",
	         "f:3:39: error: StaleAfter \"-1\": expected seconds from 0 to 31536000\n"},
		{"Name x Path /simultaneous/temperature Type bool PorAlarm \"\" LatchAlarm \"l\" Alarm on",
	         "f:3:82: error: Alarm on: expected a device in the path "
	         "\"/simultaneous/temperature\"\n"},
		{"Name x Path /a/b Type bool }\nItem { Name x Path /a/c Type bool",
	         "f:4:13: error: the name \"x\" stands twice, first in line 3\n"},
	};

	expect_errors(cases, COUNT(cases), parse_item);
}

static void test_wrong_limits_are_errors_with_what_was_expected(void)
{
#define NUMBER "Name x Path /a/b Type double\n"
	static const struct line cases[] = {
		{NUMBER "LimitH hot", "f:4:8: error: LimitH \"hot\": expected a number\n"},
		{NUMBER "LimitH nan", "f:4:8: error: LimitH \"nan\": expected a number\n"},
		{NUMBER "LimitL 1 LimitH 1",
	         "f:4:17: error: LimitH \"1\": expected more than LimitL, which is 1 in line 4\n"},
		{NUMBER "LimitHH 5\nLimitLL 7",
	         "f:4:9: error: LimitHH \"5\": expected more than LimitLL, which is 7 in line 5\n"},
		{NUMBER "LimitH 3 LimitHH 2 LimitL 4 LimitLL 5",
	         "f:4:27: error: LimitL \"4\": expected more than LimitLL, which is 5 in line 4\n"
	         "f:4:8: error: LimitH \"3\": expected more than LimitL, which is 4 in line 4\n"
	         "f:4:18: error: LimitHH \"2\": expected more than LimitH, which is 3 in line 4\n"},
		{NUMBER "LimitH 3 Hysteresis -0.1",
	         "f:4:21: error: Hysteresis \"-0.1\": expected a number, not negative\n"},
		{NUMBER "LimitL 1 LimitH 3 Hysteresis 2",
	         "f:4:30: error: Hysteresis \"2\": expected less than the 2 between LimitL and "
	         "LimitH\n"},
		{NUMBER "LimitLL 1 LimitHH 3 Hysteresis 2.5",
	         "f:4:32: error: Hysteresis \"2.5\": expected less than the 2 between LimitLL and "
	         "LimitHH\n"},
		{NUMBER "LimitH 3 OnDelay -1",
	         "f:4:18: error: OnDelay \"-1\": expected seconds from 0 to 86400\n"},
		{NUMBER "LimitH 3 OffDelay 86401",
	         "f:4:19: error: OffDelay \"86401\": expected seconds from 0 to 86400\n"},
		{"Name x Path /a/b Type string\nLimitH 3",
	         "f:4:1: error: LimitH: a string has no limits\n"},
	};

	expect_errors(cases, COUNT(cases), parse_item);
}

static void test_limits_make_limit_alarms(void)
{
	static const struct line cases[] = {
		{NUMBER "Hysteresis 1 OffDelay 2",
	         "f:4:1: warning: Hysteresis does nothing: this Item has no limit\n"
	         "f:4:14: warning: OffDelay does nothing: this Item has no limit\n"},
		{NUMBER "", ""},
	};
	const struct config_limits *limits;

	expect_warnings(cases, COUNT(cases), parse_item);
	TEST_ASSERT_FALSE(config->items[0].limits.any);
	TEST_ASSERT_EQUAL_INT(0, parse_item(NUMBER "LimitLL -10 LimitH 30.5 Hysteresis 0.5 OnDelay 2 "
	                                           "OffDelay 0.25"));
	limits = &config->items[0].limits;
	TEST_ASSERT_TRUE(limits->any);
	TEST_ASSERT_TRUE(limits->has[CONFIG_LIMIT_LL]);
	TEST_ASSERT_FALSE(limits->has[CONFIG_LIMIT_L]);
	TEST_ASSERT_TRUE(limits->has[CONFIG_LIMIT_H]);
	TEST_ASSERT_FALSE(limits->has[CONFIG_LIMIT_HH]);
	TEST_ASSERT_EQUAL_DOUBLE(-10, limits->limit[CONFIG_LIMIT_LL]);
	TEST_ASSERT_EQUAL_DOUBLE(30.5, limits->limit[CONFIG_LIMIT_H]);
	TEST_ASSERT_EQUAL_DOUBLE(0.5, limits->hysteresis);
	TEST_ASSERT_EQUAL_INT64(2000000000, limits->on_delay_ns);
	TEST_ASSERT_EQUAL_INT64(250000000, limits->off_delay_ns);
}

static void test_three_items_of_one_name_all_name_the_first(void)
{
	parse_driver("Item { Name x Path a/b Type bool }\nItem { Name y Path a/b Type bool }\n"
	             "Item { Name x Path a/b Type bool }\nItem { Name x Path a/b Type bool }");
	TEST_ASSERT_EQUAL_STRING("f:4:13: error: the name \"x\" stands twice, first in line 2\n"
	                         "f:5:13: error: the name \"x\" stands twice, first in line 2\n",
	                         said);
}

static void test_items_that_can_be_understood_are_only_warned_about(void)
{
#define ITEM "Name x Path /a/b Type byte "
#define ALARM_KEYS "the keys are Alarm, LatchAlarm, PorAlarm, SetAlarm, ResetLatch\n"
	static const struct line cases[] = {
		{"Name x Path /a/b IOType 0x4218",
	         "f:3:25: warning: IOType 0x4218 has the unknown bits 0x4200, which are ignored\n"},
		{"Name x Path /alarm/a/b Type bool",
	         "f:3:13: warning: the path \"/alarm/a/b\" is entered without /alarm, which is "
	         "dropped; alarms are chosen by Alarm on\n"},
		{ITEM "Initvalue \"3\"",
	         "f:3:28: warning: unknown key Initvalue in Item is ignored; is it InitValue?\n"},
		{ITEM "Latch \"latch.BYTE\"",
	         "f:3:28: warning: unknown key Latch in Item is ignored; \"latch.BYTE\" looks like "
	         "part of an alarm: " ALARM_KEYS},
		{ITEM "AlarmPOR \"por\"",
	         "f:3:28: warning: unknown key AlarmPOR in Item is ignored; \"por\" looks like part "
	         "of an alarm: " ALARM_KEYS},
		{ITEM "Foo \"set_alarm=133333333\"",
	         "f:3:28: warning: unknown key Foo in Item is ignored; \"set_alarm=133333333\" looks "
	         "like part of an alarm: " ALARM_KEYS},
		{ITEM "Portion \"portion\"", "f:3:28: warning: unknown key Portion in Item is ignored\n"},
		{ITEM "SafeValue 3",
	         "f:3:28: warning: SafeValue does nothing: this input is not Writable\n"},
		{ITEM "SafeValue 3 Writable on", ""},
	};

	expect_warnings(cases, COUNT(cases), parse_item);
}

static void test_an_alarm_that_can_do_nothing_is_told_what_to_write(void)
{
#define NO_POR                                                                                     \
	"warning: this alarm can never do anything: PorAlarm is not defined; write PorAlarm "      \
	"\"por\", or PorAlarm \"\" if the device has no such property\n"
#define NO_LATCH(why)                                                                              \
	"warning: this alarm never reads anything: LatchAlarm is " why                             \
	"; write the device's latch such as LatchAlarm \"latch.BYTE\", or LatchAlarm \"present\" " \
	"if it has none\n"
	static const struct line cases[] = {
		{ITEM "Alarm on", "f:3:34: " NO_POR "f:3:34: " NO_LATCH("not defined")},
		{ITEM "Alarm on PorAlarm \"por\"", "f:3:34: " NO_LATCH("not defined")},
		{ITEM "Alarm on PorAlarm \"\" LatchAlarm \"\"", "f:3:34: " NO_LATCH("empty")},
		{ITEM "Alarm on LatchAlarm \"latch.BYTE\"", "f:3:34: " NO_POR},
		{ITEM "Alarm on PorAlarm \"\" LatchAlarm \"present\"", ""},
		{ITEM "Alarm off LatchAlarm \"\"", ""},
		{ITEM "Alarm on PorAlarm \"por\" LatchAlarm \"latch\" SetAlarm \"set_alarm\" ResetLatch \"\"",
	         "f:3:80: warning: SetAlarm \"set_alarm\" has no '=': nothing is written; expected "
	         "property=value\n"},
		{ITEM "Alarm on PorAlarm \"por\" LatchAlarm \"latch\" SetAlarm \"a=b\" ResetLatch \"latch=0\"",
	         ""},
	};

	expect_warnings(cases, COUNT(cases), parse_item);
	TEST_ASSERT_EQUAL_STRING("a=b", config->items[0].set_alarm);
	TEST_ASSERT_EQUAL_STRING("latch=0", config->items[0].reset_latch);
}

static void test_absent_alarm_strings_are_not_defined_and_empty_ones_are_empty(void)
{
	TEST_ASSERT_EQUAL_INT(0, parse_item(ITEM "LatchAlarm \"\" PorAlarm \"por\""));
	TEST_ASSERT_EQUAL_STRING("", config->items[0].latch_alarm);
	TEST_ASSERT_EQUAL_STRING("por", config->items[0].por_alarm);
	TEST_ASSERT_NULL(config->items[0].set_alarm);
	TEST_ASSERT_NULL(config->items[0].reset_latch);
	TEST_ASSERT_FALSE(config->items[0].alarm);
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
		{"IOType 0x0018 Readable off Writable on", OWS_DOUBLE, false, false, true, false, false},
		{"IOType 0x0022 Readable yes Writable no", OWS_BYTE, true, true, false, false, false},
		{"IOType 0x0018 Type double IO input", OWS_DOUBLE, false, true, false, false, false},
		{"Type word", OWS_WORD, false, true, false, false, false},
		{"Type word IO output", OWS_WORD, true, false, true, false, false},
		{"Type word Alarm on PorAlarm \"\" LatchAlarm l", OWS_WORD, false, true, false, false,
	         true},
	};

	for (size_t i = 0; i < COUNT(cases); i++) {
		char text[256];

		snprintf(text, sizeof(text), "Name x Path a/b %s", cases[i].keys);
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, parse_item(text), said);
		TEST_ASSERT_EQUAL_STRING_MESSAGE("", said, cases[i].keys);
		TEST_ASSERT_EQUAL_INT_MESSAGE(cases[i].type, config->items[0].type, cases[i].keys);
		TEST_ASSERT_EQUAL_MESSAGE(cases[i].output, config->items[0].output, cases[i].keys);
		TEST_ASSERT_EQUAL_MESSAGE(cases[i].readable, config->items[0].readable, cases[i].keys);
		TEST_ASSERT_EQUAL_MESSAGE(cases[i].writable, config->items[0].writable, cases[i].keys);
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
		{"/1F.010203040506/main/28.551DDF030000/t", "/1F.010203040506/main/28.551DDF030000/t",
	         false},
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

static void test_all_errors_of_a_file_are_said_in_one_go(void)
{
	TEST_ASSERT_EQUAL_INT(-EINVAL, parse("OwsDrv {\n Timeout x\n Period 0\n Item { Name \"a b\"\n"
	                                     "Path \"//\" Type foo\n}\n Item {\nName \"q\n}\n}\n"));
	TEST_ASSERT_EQUAL_UINT(6, report.errors);
	TEST_ASSERT_NULL_MESSAGE(strstr(said, "expected a Path in this Item"),
	                         "where syntax failed nothing is known to be missing");
}

static void test_bytes_of_the_file_cannot_steer_the_terminal(void)
{
	parse_driver("Timeout \"\x1b[2J\"");
	TEST_ASSERT_NULL(strchr(said, '\x1b'));
	TEST_ASSERT_EQUAL_UINT(1, report.errors);
}

static void test_a_file_that_is_not_there_is_said(void)
{
	TEST_ASSERT_EQUAL_INT(-ENOENT, config_load("tests/unit/data/none.rio", &report, &config));
	TEST_ASSERT_EQUAL_UINT(1, report.errors);
	TEST_ASSERT_NULL(config);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_defaults_are_those_of_the_manual);
	RUN_TEST(test_a_file_of_something_else_is_refused);
	RUN_TEST(test_wrong_driver_values_are_errors_with_what_was_expected);
	RUN_TEST(test_a_target_finds_its_bus_however_it_is_spelt);
	RUN_TEST(test_what_can_be_understood_is_only_warned_about);
	RUN_TEST(test_a_comma_separates_two_wires_and_a_bar_two_ways);
	RUN_TEST(test_auto_is_a_bar_of_three_ways);
	RUN_TEST(test_a_target_that_leads_back_to_owsd_is_refused);
	RUN_TEST(test_auto_leaves_out_what_leads_back_to_owsd);
	RUN_TEST(test_more_than_sixteen_targets_are_refused);
	RUN_TEST(test_targets_of_the_command_line_replace_those_of_the_file);
	RUN_TEST(test_wrong_items_are_errors_with_what_was_expected);
	RUN_TEST(test_wrong_limits_are_errors_with_what_was_expected);
	RUN_TEST(test_limits_make_limit_alarms);
	RUN_TEST(test_three_items_of_one_name_all_name_the_first);
	RUN_TEST(test_items_that_can_be_understood_are_only_warned_about);
	RUN_TEST(test_an_alarm_that_can_do_nothing_is_told_what_to_write);
	RUN_TEST(test_absent_alarm_strings_are_not_defined_and_empty_ones_are_empty);
	RUN_TEST(test_the_bits_of_io_type_and_the_keys_that_override_them);
	RUN_TEST(test_paths_lose_their_flags_and_gain_a_slash);
	RUN_TEST(test_start_values_are_typed_and_an_empty_one_is_none);
	RUN_TEST(test_a_start_value_longer_than_a_string_is_an_error);
	RUN_TEST(test_all_errors_of_a_file_are_said_in_one_go);
	RUN_TEST(test_bytes_of_the_file_cannot_steer_the_terminal);
	RUN_TEST(test_a_file_that_is_not_there_is_said);
	return UNITY_END();
}
