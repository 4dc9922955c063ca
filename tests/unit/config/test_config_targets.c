/* SPDX-License-Identifier: MIT */
/* Targets, the bars and commas between them, the Bus of each, and those that are refused. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "hal/bus/backends.h"
#include "src/config/check/own.h"
#include "src/config/check/targets.h"
#include "src/config/read/buses.h"
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

static void test_the_scheme_of_each_backend_is_no_host(void)
{
	static const char *const targets[] = {
#define BACKEND(name, automatic) #name ":x",
#include "hal/bus/schemes.h"
#undef BACKEND
		"sim:x", "replay:x"};
	char text[TARGET_CANONICAL];

	for (size_t i = 0; i < sizeof(targets) / sizeof(targets[0]); i++) {
		target_canonical(targets[i], text);
		TEST_ASSERT_EQUAL_STRING(
			strncmp(targets[i], "owserver", 8) ? targets[i] : "owserver:x:4304", text);
	}
}

static void test_only_buses_of_owsd_s_own_have_a_cache(void)
{
	static const char *const own[] = {"i2c:/dev/i2c-1", "w1:netlink",
	                                  "w1:netlink/w1_bus_master1"};
	static const char *const others[] = {
		"localhost", "owserver:i2c:4304", "w1", "i2chost:4304", "w1:w1_bus_master1",
		"null:",     "gpio:gpiochip0"};

	for (size_t i = 0; i < sizeof(own) / sizeof(own[0]); i++)
		TEST_ASSERT_TRUE_MESSAGE(bus_caches(own[i]), own[i]);
	for (size_t i = 0; i < sizeof(others) / sizeof(others[0]); i++)
		TEST_ASSERT_FALSE_MESSAGE(bus_caches(others[i]), others[i]);
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
	const char *way;

	TEST_ASSERT_EQUAL_INT(0, parse_driver("TargetName \"sim:a, auto | far:4304\""));
	TEST_ASSERT_EQUAL_UINT(5, config->target_count);
	for (unsigned i = 1, row = 0; (way = config_auto_way(&row)); i++)
		TEST_ASSERT_EQUAL_STRING(way, config->targets[i].text);
	TEST_ASSERT_EQUAL_STRING("localhost:4304", config->targets[1].text);
	TEST_ASSERT_EQUAL_INT(CONFIG_COMMA, config->targets[1].relation);
	for (int i = 2; i < 5; i++)
		TEST_ASSERT_EQUAL_INT(CONFIG_BAR, config->targets[i].relation);
	TEST_ASSERT_EQUAL_INT(0, parse_driver("TargetName \"auto\""));
	TEST_ASSERT_EQUAL_INT(CONFIG_FIRST, config->targets[0].relation);
	TEST_ASSERT_EQUAL_UINT(3, config->target_count);
	TEST_ASSERT_EQUAL_INT(-EINVAL, parse_driver("TargetName \"auto, w1\""));
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(said, "the target \"w1\" is given twice"), said);
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
		{"4304", "localhost"},
		{"4304", "127.0.0.1:4304"},
		{"4304", "[::1]"},
		{"0.0.0.0:4310", "localhost:4310"},
		{"[::]:4310", "owserver:localhost:4310"},
		{"192.168.1.5:4304", "192.168.1.5"},
	};
	static const char *const good[][2] = {
		{"4305", "localhost"}, {"192.168.1.5:4304", "localhost"},
		{"4304", "far:4304"},  {"0.0.0.0:4304", "192.168.1.6"},
		{"4304", "null:"},     {"0.0.0.0:4310", "[::1]:4310"},
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

static void test_more_than_sixty_four_targets_are_refused(void)
{
	char line[400] = "TargetName \"h1";

	for (int i = 2; i <= CONFIG_TARGETS_MAX; i++)
		snprintf(line + strlen(line), sizeof(line) - strlen(line), ",h%d", i);
	TEST_ASSERT_EQUAL_INT(-EINVAL, parse_driver(strcat(line, "|one.more\"")));
	TEST_ASSERT_EQUAL_STRING("f:2:12: error: \"one.more\" is one too many: owsd serves at most "
	                         "64 targets, ways after a bar and those of auto counted\n",
	                         said);
	strcpy(strrchr(line, '|'), "\"");
	TEST_ASSERT_EQUAL_INT(0, parse_driver(line));
	TEST_ASSERT_EQUAL_UINT(64, config->target_count);
}

static void test_targets_of_the_command_line_replace_those_of_the_file(void)
{
	static const char *const good[] = {"a | b", "c"}, *const bad[] = {"a", "a,,b"};
	static const char *const twice[] = {"a", "a:4304"};

	parse_driver("TargetName \"x\"");
	TEST_ASSERT_EQUAL_INT(-EINVAL, config_set_targets(config, bad, 2, &report));
	TEST_ASSERT_EQUAL_STRING("x", config->targets[0].text);
	TEST_ASSERT_EQUAL_UINT(1, config->target_count);
	TEST_ASSERT_EQUAL_INT(0, config_set_targets(config, good, 2, &report));
	TEST_ASSERT_EQUAL_UINT(3, config->target_count);
	TEST_ASSERT_EQUAL_STRING("b", config->targets[1].text);
	TEST_ASSERT_EQUAL_INT(CONFIG_BAR, config->targets[1].relation);
	TEST_ASSERT_EQUAL_INT(CONFIG_COMMA, config->targets[2].relation);
	TEST_ASSERT_EQUAL_INT(0, config_set_targets(config, twice, 2, &report));
	said[0] = '\0';
	TEST_ASSERT_EQUAL_INT(-EINVAL, config_check_targets(config, &report));
	TEST_ASSERT_EQUAL_STRING(
		"error: the target \"a:4304\" is given twice; the first is \"a\"\n", said);
}

/* Load `folder`/x.rio, whose target and file of sensors are `name`, from another directory. */
static int load_with(const char *folder, const char *name)
{
	char file[64];
	FILE *out;

	snprintf(file, sizeof(file), "%s/x.rio", folder);
	out = fopen(file, "w");
	TEST_ASSERT_NOT_NULL(out);
	fprintf(out,
	        "OwsDrv { TargetName \"a | sim:%s:0x18\"\n"
	        "Bus { Target \"sim:%s:0x18\" Sensors \"%s\" } }\n",
	        name, name, name);
	fclose(out);
	config_free(config);
	return config_load(file, &report, &config);
}

static void test_a_relative_file_counts_from_the_folder_of_the_configuration(void)
{
	char folder[] = "/tmp/owsd-relative-XXXXXX", whole[64], target[80];
	const char *const here = "Makefile";
	uint64_t absent;

	TEST_ASSERT_NOT_NULL(mkdtemp(folder));
	/* in neither place, as at --check on another machine */
	TEST_ASSERT_EQUAL_INT(0, load_with(folder, "house.sim"));
	snprintf(whole, sizeof(whole), "%s/house.sim", folder);
	snprintf(target, sizeof(target), "sim:%s:0x18", whole);
	TEST_ASSERT_EQUAL_STRING("", said);
	TEST_ASSERT_EQUAL_STRING(target, config->targets[1].text);
	TEST_ASSERT_EQUAL_STRING(whole, config_bus(config, target)->options[0].text);
	/* the file that it names is not there */
	config_hash_files(config);
	absent = config_bus(config, target)->options[0].contents;
	/* in the working directory alone, as older files mean it */
	TEST_ASSERT_EQUAL_INT(0, access(here, F_OK));
	TEST_ASSERT_EQUAL_INT(0, load_with(folder, here));
	TEST_ASSERT_NOT_NULL(strstr(said, "x.rio:1:21: warning: Makefile:0x18 is taken from the "
	                                  "working directory; a relative path counts from the "
	                                  "folder of this file, /tmp/owsd-relative-"));
	TEST_ASSERT_NOT_NULL(strstr(said, "x.rio:2:42: warning: Makefile is taken"));
	TEST_ASSERT_EQUAL_STRING("sim:Makefile:0x18", config->targets[1].text);
	TEST_ASSERT_EQUAL_STRING(here, config_bus(config, "sim:Makefile:0x18")->options[0].text);
	config_hash_files(config);
	TEST_ASSERT_TRUE(absent != config_bus(config, "sim:Makefile:0x18")->options[0].contents);
	snprintf(whole, sizeof(whole), "%s/x.rio", folder);
	unlink(whole);
	rmdir(folder);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_target_finds_its_bus_however_it_is_spelt);
	RUN_TEST(test_the_scheme_of_each_backend_is_no_host);
	RUN_TEST(test_only_buses_of_owsd_s_own_have_a_cache);
	RUN_TEST(test_a_comma_separates_two_wires_and_a_bar_two_ways);
	RUN_TEST(test_auto_is_a_bar_of_three_ways);
	RUN_TEST(test_a_target_that_leads_back_to_owsd_is_refused);
	RUN_TEST(test_auto_leaves_out_what_leads_back_to_owsd);
	RUN_TEST(test_more_than_sixty_four_targets_are_refused);
	RUN_TEST(test_targets_of_the_command_line_replace_those_of_the_file);
	RUN_TEST(test_a_relative_file_counts_from_the_folder_of_the_configuration);
	return UNITY_END();
}
