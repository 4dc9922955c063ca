/* SPDX-License-Identifier: MIT */
/* Tests of the places that signals keep. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "src/faces/modbus/map.h"

static struct map map;
static char folder[] = "/tmp/owsd-map-XXXXXX", path[64];

void setUp(void)
{
	memcpy(folder + sizeof(folder) - 7, "XXXXXX", 6);
	TEST_ASSERT_NOT_NULL(mkdtemp(folder));
	snprintf(path, sizeof(path), "%s/map", folder);
}

void tearDown(void)
{
	map_free(&map);
	unlink(path);
	rmdir(folder);
}

static int take(const char *text)
{
	char line[64];

	snprintf(line, sizeof(line), "%s", text);
	return map_take(&map, line);
}

static void test_each_identity_gets_the_next_place_and_keeps_it(void)
{
	TEST_ASSERT_EQUAL_INT(1, map_place(&map, "/28.1/temperature"));
	TEST_ASSERT_EQUAL_INT(2, map_place(&map, "/28.2/temperature"));
	TEST_ASSERT_EQUAL_INT(1, map_place(&map, "/28.1/temperature"));
	TEST_ASSERT_EQUAL_INT(MAP_NO_SIGNAL, map.places[2].signal);
	TEST_ASSERT_EQUAL_UINT(2, map.last);
}

static void test_another_map_gives_what_is_free_here(void)
{
	static struct map other;

	map_place(&map, "/28.1/temperature");
	map_place(&other, "/28.2/temperature");
	map_place(&other, "/28.3/temperature");
	map_place(&other, "/28.1/temperature");
	map_join(&map, &other);
	map_free(&other);
	TEST_ASSERT_EQUAL_INT(1, map_place(&map, "/28.1/temperature"));
	TEST_ASSERT_EQUAL_INT(2, map_place(&map, "/28.3/temperature"));
	TEST_ASSERT_EQUAL_INT(3, map_place(&map, "/28.2/temperature"));
}

static void test_a_file_gives_back_the_places_and_none_of_them_to_another(void)
{
	unsigned line;

	map_place(&map, "/28.1/temperature");
	map_place(&map, "/28.2/gone away");
	TEST_ASSERT_EQUAL_INT(0, map_write(&map, path));
	map_free(&map);
	TEST_ASSERT_EQUAL_INT(0, map_read(&map, path, &line));
	TEST_ASSERT_EQUAL_INT(3, map_place(&map, "/28.3/temperature"));
	TEST_ASSERT_EQUAL_INT(2, map_place(&map, "/28.2/gone away"));
	TEST_ASSERT_EQUAL_INT(1, map_place(&map, "/28.1/temperature"));
}

static void test_of_two_files_the_first_wins(void)
{
	TEST_ASSERT_EQUAL_INT(0, take("100 /a"));
	TEST_ASSERT_EQUAL_INT(0, take("1 /a"));
	TEST_ASSERT_EQUAL_INT(0, take("100 /b"));
	TEST_ASSERT_EQUAL_INT(100, map_place(&map, "/a"));
	TEST_ASSERT_EQUAL_INT(101, map_place(&map, "/b"));
	TEST_ASSERT_NULL(map.places[1].identity);
}

static void test_a_line_is_a_place_and_an_identity(void)
{
	static const char *const wrong[] = {
		"/a",          "0 /a",   "2048 /a", "-1 /a", "1/a",
		"1 a",         "1",      "x /a",    " 1 /a", "99999999999999999999 /a",
		"1 /a\033[2J", "1 /\177"};

	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++)
		TEST_ASSERT_EQUAL_INT_MESSAGE(-EINVAL, take(wrong[i]), wrong[i]);
	TEST_ASSERT_EQUAL_UINT(0, map.last);
	TEST_ASSERT_EQUAL_INT(0, take("# 1 /a"));
	TEST_ASSERT_EQUAL_INT(0, take(""));
	TEST_ASSERT_EQUAL_INT(0, take("2047\t/a b\r\n"));
	TEST_ASSERT_EQUAL_STRING("/a b", map.places[2047].identity);
	TEST_ASSERT_EQUAL_INT(-ENOSPC, map_place(&map, "/b"));
}

static void test_a_file_that_is_none_is_refused_with_its_line(void)
{
	FILE *out = fopen(path, "we");
	unsigned line;

	TEST_ASSERT_NOT_NULL(out);
	fputs("1 /a\nnonsense\n", out);
	fclose(out);
	TEST_ASSERT_EQUAL_INT(-EINVAL, map_read(&map, path, &line));
	TEST_ASSERT_EQUAL_UINT(2, line);
	unlink(path);
	TEST_ASSERT_EQUAL_INT(-ENOENT, map_read(&map, path, &line));
	out = fopen(path, "we");
	TEST_ASSERT_NOT_NULL(out);
	fprintf(out, "1 /%0600d\n", 0);
	fclose(out);
	TEST_ASSERT_EQUAL_INT(-EINVAL, map_read(&map, path, &line));
	/* one that has no writer: who opens it waits */
	unlink(path);
	TEST_ASSERT_EQUAL_INT(0, mkfifo(path, 0600));
	TEST_ASSERT_EQUAL_INT(-ENOTSUP, map_read(&map, path, &line));
}

static void test_the_service_keeps_it_in_its_state_directory(void)
{
	char at[MAP_PATH];

	setenv("STATE_DIRECTORY", folder, 1);
	TEST_ASSERT_EQUAL_INT(0, map_path("OWS", at));
	TEST_ASSERT_EQUAL_STRING(path, at);
	setenv("XDG_STATE_HOME", "/nowhere", 1);
	TEST_ASSERT_EQUAL_INT(0, map_path_found("OWS", at));
	TEST_ASSERT_EQUAL_STRING("/var/lib/owsd-modbus/OWS/map", at);
	unsetenv("STATE_DIRECTORY");
	TEST_ASSERT_EQUAL_INT(-ENOENT, map_write(&map, "/nowhere/map"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_identity_gets_the_next_place_and_keeps_it);
	RUN_TEST(test_another_map_gives_what_is_free_here);
	RUN_TEST(test_a_file_gives_back_the_places_and_none_of_them_to_another);
	RUN_TEST(test_of_two_files_the_first_wins);
	RUN_TEST(test_a_line_is_a_place_and_an_identity);
	RUN_TEST(test_a_file_that_is_none_is_refused_with_its_line);
	RUN_TEST(test_the_service_keeps_it_in_its_state_directory);
	return UNITY_END();
}
