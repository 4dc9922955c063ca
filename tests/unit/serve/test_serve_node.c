/* SPDX-License-Identifier: MIT */
/* Tests of the meaning of clients' paths. */
#include <stdlib.h>
#include <string.h>
#include <unity.h>

#include "src/daemon/serve/node.h"

static struct node node;

void setUp(void)
{
}

void tearDown(void)
{
}

static void parse(const char *path)
{
	node_parse(path, strlen(path), &node);
}

static void test_a_device_has_one_name_however_it_is_written(void)
{
	static const char *const paths[] = {
		"/28.551DDF030000/temperature",          "28.551DDF030000/temperature",
		"/28551DDF030000/temperature",           "/28.551ddf030000/temperature",
		"/uncached/28.551DDF030000/temperature", "/bus.1/28.551DDF030000/temperature",
		"/alarm/28.551DDF030000/temperature",
	};

	for (size_t i = 0; i < sizeof(paths) / sizeof(paths[0]); i++) {
		parse(paths[i]);
		TEST_ASSERT_EQUAL_INT(NODE_TARGET, node.kind);
		TEST_ASSERT_EQUAL_STRING("/28.551DDF030000/temperature", node.path);
		TEST_ASSERT_TRUE(node.has_rom);
		TEST_ASSERT_EQUAL_CHAR('t', node.type);
		TEST_ASSERT_EQUAL_UINT(16, node.device_len);
		TEST_ASSERT_EQUAL_INT(i == 4, node.fresh);
		TEST_ASSERT_EQUAL_INT(i == 5 ? 1 : -1, node.bus);
	}
}

static void test_properties_have_the_type_and_life_of_their_family(void)
{
	static const struct {
		const char *path;
		char type, life;
	} cases[] = {
		{"/28.551DDF030000/power", 'y', 'v'},
		{"/28.551DDF030000/type", 'a', 'f'},
		{"/28.551DDF030000/errata", 'D', 'f'},
		{"/29.551DDF030000/PIO.3", 'y', 's'},
		{"/29.551DDF030000/PIO.BYTE", 'u', 's'},
		{"/29.551DDF030000/PIO.ALL", 'y', 's'},
		{"/28.551DDF030000/nonsense", 0, 0},
		{"/7E.551DDF030000/temperature", 0, 0}, /* a family that is not known here */
		{"/settings/timeout/volatile", 'u', 'f'},
		{"/boiler/temperature", 0, 0},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		parse(cases[i].path);
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(cases[i].type, node.type, cases[i].path);
		if (cases[i].type)
			TEST_ASSERT_EQUAL_HEX8_MESSAGE(cases[i].life, node.life, cases[i].path);
	}
}

static void test_the_bytes_of_a_memory_are_known(void)
{
	static const struct {
		const char *path;
		uint32_t bytes;
	} cases[] = {
		{"/0C.551DDF030000/memory", 8192},
		{"/37.551DDF030000/pages/page.3", 64},
		{"/37.551DDF030000/pages/page.ALL", 32704},
		{"/28.551DDF030000/temperature", 0},
		{"/28.551DDF030000/type", 0},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		parse(cases[i].path);
		TEST_ASSERT_EQUAL_UINT32_MESSAGE(cases[i].bytes, node.bytes, cases[i].path);
	}
}

static void test_directories_of_all_targets_are_told_from_those_of_one(void)
{
	static const struct {
		const char *path;
		bool devices, root, every;
		const char *asked;
	} cases[] = {
		{"", true, true, true, "/"},
		{"/", true, true, true, "/"},
		{"/uncached", true, true, true, "/"},
		{"/alarm", true, false, true, "/alarm"},
		{"/bus.0", true, false, false, "/"},
		{"/bus.0/alarm", true, false, false, "/alarm"},
		{"/bus.0/interface", false, false, false, "/interface"},
		{"/structure/28", false, false, true, "/structure/28"},
		{"/28.551DDF030000", false, false, false, "/28.551DDF030000"},
		{"/28.551DDF030000/", false, false, false, "/28.551DDF030000"},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		parse(cases[i].path);
		TEST_ASSERT_EQUAL_INT_MESSAGE(NODE_TARGET, node.kind, cases[i].path);
		TEST_ASSERT_EQUAL_INT_MESSAGE(cases[i].devices, node.devices, cases[i].path);
		TEST_ASSERT_EQUAL_INT_MESSAGE(cases[i].root, node.root, cases[i].path);
		TEST_ASSERT_EQUAL_INT_MESSAGE(cases[i].every, node.every, cases[i].path);
		TEST_ASSERT_EQUAL_STRING(cases[i].asked, node.path);
	}
}

static void test_signals_and_return_codes_are_served_here(void)
{
	parse("/signals");
	TEST_ASSERT_EQUAL_INT(NODE_SIGNALS, node.kind);
	parse("/uncached/signals/room1_Age");
	TEST_ASSERT_EQUAL_INT(NODE_SIGNAL, node.kind);
	TEST_ASSERT_EQUAL_STRING("room1_Age", node.name);
	parse("/bus.0/signals");
	TEST_ASSERT_EQUAL_INT(NODE_NONE, node.kind);
	parse("/settings/return_codes");
	TEST_ASSERT_EQUAL_INT(NODE_CODES, node.kind);
	parse("/settings/return_codes/text.ALL");
	TEST_ASSERT_EQUAL_INT(NODE_CODE, node.kind);
	TEST_ASSERT_EQUAL_INT(-1, node.code);
	parse("/settings/return_codes/text.42");
	TEST_ASSERT_EQUAL_INT(42, node.code);
	parse("/settings/return_codes/text.211");
	TEST_ASSERT_EQUAL_INT(NODE_NONE, node.kind);
	parse("/settings/return_codes/text.");
	TEST_ASSERT_EQUAL_INT(NODE_NONE, node.kind);
}

static void test_paths_that_cannot_be_are_nothing(void)
{
	static const char *const paths[] = {"/a//b", "/../x", "/28.551DDF030000.00/type", "/a\x01",
	                                    "/28.551DDF030000//type"};

	for (size_t i = 0; i < sizeof(paths) / sizeof(paths[0]); i++) {
		parse(paths[i]);
		TEST_ASSERT_EQUAL_INT_MESSAGE(NODE_NONE, node.kind, paths[i]);
	}
}

static bool is_directory(const char *directory, const char *name)
{
	parse(directory);
	return node_is_directory(&node, name, strlen(name));
}

static void test_entries_are_directories_or_not(void)
{
	TEST_ASSERT_TRUE(is_directory("/", "28.551DDF030000"));
	TEST_ASSERT_TRUE(is_directory("/", "signals"));
	TEST_ASSERT_TRUE(is_directory("/28.551DDF030000", "errata"));
	TEST_ASSERT_FALSE(is_directory("/28.551DDF030000", "temperature"));
	TEST_ASSERT_TRUE(is_directory("/7E.551DDF030000", "EDS0065"));
	TEST_ASSERT_FALSE(is_directory("/7E.551DDF030000", "memory"));
	TEST_ASSERT_TRUE(is_directory("/structure", "28"));
	TEST_ASSERT_TRUE(is_directory("/structure/28", "errata"));
	TEST_ASSERT_FALSE(is_directory("/structure/28", "temperature"));
	TEST_ASSERT_FALSE(is_directory("/simultaneous", "temperature"));
	TEST_ASSERT_TRUE(is_directory("/settings", "return_codes"));
	TEST_ASSERT_FALSE(is_directory("/settings/return_codes", "text.1"));
	TEST_ASSERT_FALSE(is_directory("/signals", "room1"));
}

static void test_random_paths_are_cut_to_what_fits(void)
{
	static const char letters[] = "/.28AF0_bus-signals\xc3\x01 ";
	char path[400];

	srandom(7);
	for (int round = 0; round < 20000; round++) {
		size_t len = (size_t)random() % sizeof(path);

		for (size_t i = 0; i < len; i++)
			path[i] = letters[(size_t)random() % (sizeof(letters) - 1)];
		node_parse(path, len, &node);
		TEST_ASSERT_NOT_NULL(memchr(node.path, '\0', sizeof(node.path)));
		if (node.kind == NODE_NONE)
			continue;
		TEST_ASSERT_EQUAL_CHAR('/', node.path[0]);
		TEST_ASSERT_TRUE(node.device_len <= strlen(node.path));
		if (node.kind == NODE_SIGNAL)
			TEST_ASSERT_TRUE(node.name >= node.path &&
			                 node.name <= node.path + strlen(node.path));
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_device_has_one_name_however_it_is_written);
	RUN_TEST(test_properties_have_the_type_and_life_of_their_family);
	RUN_TEST(test_the_bytes_of_a_memory_are_known);
	RUN_TEST(test_directories_of_all_targets_are_told_from_those_of_one);
	RUN_TEST(test_signals_and_return_codes_are_served_here);
	RUN_TEST(test_paths_that_cannot_be_are_nothing);
	RUN_TEST(test_entries_are_directories_or_not);
	RUN_TEST(test_random_paths_are_cut_to_what_fits);
	return UNITY_END();
}
