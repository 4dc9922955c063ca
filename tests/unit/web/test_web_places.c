/* SPDX-License-Identifier: MIT */
/* Tests of the addresses of Modbus that the page shows. */
#include <stdio.h>

#include "unity.h"

#include "src/faces/web/show.h"
#include "tests/unit/aid/folder.h"

static char path[300], fresh[310];

void setUp(void)
{
	snprintf(path, sizeof(path), "%s/map", folder_dir()->path);
	snprintf(fresh, sizeof(fresh), "%s.new", path);
}

void tearDown(void)
{
	remove(path);
}

/* As owsd-modbus does: another file in place of the one. */
static void replace(const char *lines)
{
	FILE *file = fopen(fresh, "we");

	TEST_ASSERT_NOT_NULL(file);
	fputs(lines, file);
	fclose(file);
	TEST_ASSERT_EQUAL_INT(0, rename(fresh, path));
}

static void test_a_signal_has_the_register_of_its_place_in_the_map_of_now(void)
{
	TEST_ASSERT_NULL(places_at(path));
	replace("# places\n7 /28.1/temperature\n");
	TEST_ASSERT_EQUAL_INT(112, places_register(places_at(path), "/28.1/temperature"));
	TEST_ASSERT_EQUAL_INT(-1, places_register(places_at(path), "/28.2/temperature"));
	replace("7 /28.1/temperature\n8 /28.2/temperature\n");
	TEST_ASSERT_EQUAL_INT(128, places_register(places_at(path), "/28.2/temperature"));
	/* a damaged one gives no address, until it is repaired */
	replace("7\n");
	TEST_ASSERT_NULL(places_at(path));
	TEST_ASSERT_NULL(places_at(path));
	replace("9 /28.1/temperature\n");
	TEST_ASSERT_EQUAL_INT(144, places_register(places_at(path), "/28.1/temperature"));
}

static void test_without_a_map_no_signal_has_one(void)
{
	TEST_ASSERT_NULL(places_of("no-instance-has-this-name"));
	TEST_ASSERT_EQUAL_INT(-1, places_register(NULL, "/28.1/temperature"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_signal_has_the_register_of_its_place_in_the_map_of_now);
	RUN_TEST(test_without_a_map_no_signal_has_one);
	return UNITY_END();
}
