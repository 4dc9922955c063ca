/* SPDX-License-Identifier: MIT */
/* owsctl modbus-map on a file of places, beside the memory of an instance. */
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/verbs.h"
#include "tests/unit/aid/caught.h"
#include "tests/unit/aid/folder.h"
#include "tests/unit/aid/instance.h"

static const struct instance_signal signals[] = {
	{"room1", "/28.1/temperature", OWS_DOUBLE, false, 0},
	{"relay", "/29.1/PIO.0", OWS_BOOL, true, 0},
};
static struct instance in;

/* The verb with the places of a file. */
static int map_of(const char *lines, const char *more)
{
	char path[300], words[500];
	FILE *file;

	snprintf(path, sizeof(path), "%s/map", folder_dir()->path);
	file = fopen(path, "we");
	TEST_ASSERT_NOT_NULL(file);
	fputs(lines, file);
	fclose(file);
	snprintf(words, sizeof(words), "modbus-map -d %s %s", folder_dir()->path, more);
	return run(verb_modbus_map, words);
}

void setUp(void)
{
	instance_start(&in, "modbusmap", signals, 2);
	caught_begin(in.name);
}

void tearDown(void)
{
	instance_end(&in);
	caught_end();
}

#define LINES "# a comment\n1 /29.1/PIO.0\n7 /28.1/temperature\n2 /28.\"2\"/gone\n"

static void test_the_table_has_the_addresses_of_each_place(void)
{
	TEST_ASSERT_EQUAL(CTL_DONE, map_of(LINES, ""));
	TEST_ASSERT_EQUAL_STRING(
		"PLACE  RECORD  FLOAT32  FLOAT64  NAME   TYPE    IO      UNIT  IDENTITY\n"
		"    1      16    46002    56004  relay  bool    output        /29.1/PIO.0\n"
		"    2      32    46004    56008                               /28.\"2\"/gone\n"
		"    7     112    46014    56028  room1  double  input         /28.1/temperature\n",
		out);
}

static void test_programs_get_csv_json_and_the_file_itself(void)
{
	TEST_ASSERT_EQUAL(CTL_DONE, map_of(LINES, "--csv"));
	TEST_ASSERT_EQUAL_STRING(
		"place,record,float32,float64,name,type,io,unit,identity\n"
		"\"1\",\"16\",\"46002\",\"56004\",\"relay\",\"bool\",\"output\",\"\",\"/29.1/PIO.0\"\n"
		"\"2\",\"32\",\"46004\",\"56008\",\"\",\"\",\"\",\"\",\"/28.\"\"2\"\"/gone\"\n"
		"\"7\",\"112\",\"46014\",\"56028\",\"room1\",\"double\",\"input\",\"\","
		"\"/28.1/temperature\"\n",
		out);
	TEST_ASSERT_EQUAL(CTL_DONE, map_of("7 /28.1/temperature\n", "--json"));
	TEST_ASSERT_NOT_NULL(strstr(out, "\"record\":112"));
	TEST_ASSERT_NOT_NULL(strstr(out, "\"unit\":null"));
	TEST_ASSERT_EQUAL(CTL_DONE, map_of(LINES, "--keep"));
	TEST_ASSERT_EQUAL_STRING("1 /29.1/PIO.0\n2 /28.\"2\"/gone\n7 /28.1/temperature\n", out);
}

static void test_what_is_no_map_is_said_with_its_line(void)
{
	TEST_ASSERT_EQUAL(CTL_FAILED, map_of("1 /a\nx\n", ""));
	TEST_ASSERT_NOT_NULL(strstr(err, "map:2: no place and identity"));
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_modbus_map, "modbus-map -d /nowhere"));
	TEST_ASSERT_NOT_NULL(strstr(err, "there is no /nowhere/map"));
	TEST_ASSERT_EQUAL(CTL_USAGE, map_of("", "--json --csv"));
	TEST_ASSERT_EQUAL(CTL_USAGE, map_of("", "room1"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_table_has_the_addresses_of_each_place);
	RUN_TEST(test_programs_get_csv_json_and_the_file_itself);
	RUN_TEST(test_what_is_no_map_is_said_with_its_line);
	return UNITY_END();
}
