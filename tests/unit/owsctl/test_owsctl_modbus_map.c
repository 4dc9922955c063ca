/* SPDX-License-Identifier: MIT */
/* owsctl modbus-map on a file of places, beside the memory of an instance. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/modbus_forms.h"
#include "src/tool/owsctl/verbs.h"
#include "tests/unit/aid/caught.h"
#include "tests/unit/aid/folder.h"
#include "tests/unit/aid/instance.h"

static const struct instance_signal signals[] = {
	{"room1", "/28.1/temperature", OWS_DOUBLE, false, 0},
	{"relay", "/29.1/PIO.0", OWS_BOOL, true, 0},
	{"tank", "/28.3/temperature", OWS_DOUBLE, false, 0},
	{"Tank", "/28.4/temperature", OWS_DOUBLE, false, 0},
};
#define SIGNALS (sizeof(signals) / sizeof(signals[0]))
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
	instance_start(&in, "modbusmap", signals, SIGNALS);
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
	TEST_ASSERT_EQUAL(CTL_DONE, map_of(LINES, "--as csv"));
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
	TEST_ASSERT_EQUAL(CTL_DONE, map_of(LINES, "--as map"));
	TEST_ASSERT_EQUAL_STRING("1 /29.1/PIO.0\n2 /28.\"2\"/gone\n7 /28.1/temperature\n", out);
}

/* Each form has the signals that there are, with the address that its program wants. */
static void test_each_program_gets_its_own_form(void)
{
	static const struct {
		const char *form, *head, *room, *relay;
	} cases[] = {
		{"plcopen", "<globalVars name=\"Owsd\" constant=\"true\">",
	         "\"room1\"><type><INT/></type><initialValue><simpleValue value=\"7\"/>",
	         "register 16: /29.1/PIO.0"},
		{"scl", "DATA_BLOCK \"Owsd\"", "\"room1\" : \"OwsdSignal\";   // MB_DATA_ADDR 112:",
	         "\"relay\" : \"OwsdSignal\";   // MB_DATA_ADDR 16:"},
		{"node-red", "\"tcpHost\":\"10.0.0.9\",\"tcpPort\":\"1502\"",
	         "{\"id\":\"0a5d000100000007\",\"type\":\"modbus-read\"", "\"adr\":\"16\""},
		{"openplc", "\"host\":\"10.0.0.9\",\"port\":1502,",
	         "{\"fc\":3,\"offset\":\"46014\",\"iec_location\":\"%ID7\"",
	         "{\"fc\":3,\"offset\":\"43001\",\"iec_location\":\"%IW1\""},
		{"mb2hal", "TOTAL_TRANSACTIONS=3\n\n[TRANSACTION_00]\n",
	         "[TRANSACTION_02]\nLINK_TYPE=tcp\nTCP_IP=10.0.0.9\nTCP_PORT=1502\n"
	         "MB_SLAVE_ID=1\nFIRST_ELEMENT=120\n",
	         "HAL_TX_NAME=relay\n"},
		{"mbpoll", "mbpoll -m tcp -p 1502 ", "-r 46014 -c 1 10.0.0.9 # room1", "# relay"},
	};
	char words[64];

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		snprintf(words, sizeof(words), "--as %s --host 10.0.0.9:1502", cases[i].form);
		TEST_ASSERT_EQUAL_MESSAGE(CTL_DONE, map_of(LINES, words), cases[i].form);
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(out, cases[i].head), out);
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(out, cases[i].room), out);
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(out, cases[i].relay), out);
		TEST_ASSERT_NULL_MESSAGE(strstr(out, "gone"), out);
		TEST_ASSERT_NULL_MESSAGE(strchr(out, '$'), out);
	}
}

static void test_a_host_is_a_name_or_an_address_with_a_port_or_without(void)
{
	static const struct {
		const char *given, *shown;
	} cases[] = {
		{"plant", "-p 502 -0"}, {"plant:1502", "-p 1502 -0"}, {"[::1]:1502", "-c 1 ::1 "},
		{"[::1]", "-c 1 ::1 "}, {"fd00::5", "-c 1 fd00::5 "},
	};
	static const char *const wrong[] = {"plant:0", "plant:", "plant:x",  ":502",
	                                    "a;b",     "[]:1",   "plant:+5", "plant:0502"};
	char words[64];

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		snprintf(words, sizeof(words), "--as mbpoll --host %s", cases[i].given);
		TEST_ASSERT_EQUAL_MESSAGE(CTL_DONE, map_of(LINES, words), words);
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(out, cases[i].shown), out);
	}
	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
		snprintf(words, sizeof(words), "--as mbpoll --host %s", wrong[i]);
		TEST_ASSERT_EQUAL_MESSAGE(CTL_USAGE, map_of(LINES, words), words);
	}
}

/* Of each name an identifier of its own, and of each character what the file takes for it. */
static void test_names_that_a_program_would_not_take_become_others(void)
{
	static struct modbus_file file;
	const struct modbus_form *form = modbus_form_find("plcopen");
	const char *cells[MODBUS_CELL_COUNT] = {"7", "112", "46014", "56028"};
	static const struct {
		const char *name, *id;
	} cases[] = {
		{"room1", "\"room1\""},           {"room-1", "\"room_1_P7\""},
		{"1st", "\"S1st_P7\""},           {"_x", "\"S_x_P7\""},
		{"a..b", "\"a_b_P7\""},           {"a_b", "\"a_b\""},
		{"k\303\274che", "\"k_che_P7\""}, {"end-", "\"end_P7\""},
	};

	TEST_ASSERT_NULL(modbus_form_find("nothing"));
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		char *text = NULL;
		size_t len = 0;

		cells[MODBUS_CELL_name] = cases[i].name;
		cells[MODBUS_CELL_type] = cells[MODBUS_CELL_io] = "";
		cells[MODBUS_CELL_unit] = "<&>";
		cells[MODBUS_CELL_identity] = "/a";
		file = (struct modbus_file){.out = open_memstream(&text, &len), .instance = "O"};
		modbus_form_begin(&file, form);
		modbus_form_row(&file, form, cells);
		modbus_form_end(&file, form);
		fclose(file.out);
		TEST_ASSERT_EQUAL_UINT(1, file.written);
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(text, cases[i].id), text);
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(text, "/a &lt;&amp;&gt;"), text);
		free(text);
	}
}

/* With a longer one mb2hal would not start. */
static void test_an_identifier_is_no_longer_than_its_program_takes(void)
{
	static const struct {
		const char *name, *id;
	} cases[] = {
		{"a123456789b123456789c1234567", "HAL_TX_NAME=a123456789b123456789c1234567\n"},
		{"a123456789b123456789c12345678", "HAL_TX_NAME=a123456789b123456789c1_P2047\n"},
	};
	const struct modbus_form *form = modbus_form_find("mb2hal");
	const char *cells[MODBUS_CELL_COUNT] = {"2047", "1", "1", "1"};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		char *text = NULL;
		size_t len = 0;
		struct modbus_file file = {.out = open_memstream(&text, &len), .host = "a"};

		cells[MODBUS_CELL_name] = cases[i].name;
		cells[MODBUS_CELL_unit] = cells[MODBUS_CELL_identity] = "";
		file.port = "502";
		modbus_form_row(&file, form, cells);
		fclose(file.out);
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(text, cases[i].id), text);
		free(text);
	}
}

/* In the languages of IEC 61131-3 they would be one. */
static void test_names_that_differ_by_case_alone_become_two(void)
{
	TEST_ASSERT_EQUAL(CTL_DONE,
	                  map_of("3 /28.3/temperature\n4 /28.4/temperature\n", "--as scl"));
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(out, "\"tank_P3\" : "), out);
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(out, "\"Tank_P4\" : "), out);
}

static void test_what_is_no_map_is_said_with_its_line(void)
{
	TEST_ASSERT_EQUAL(CTL_FAILED, map_of("1 /a\nx\n", ""));
	TEST_ASSERT_NOT_NULL(strstr(err, "map:2: no place and identity"));
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_modbus_map, "modbus-map -d /nowhere"));
	TEST_ASSERT_NOT_NULL(strstr(err, "there is no /nowhere/map"));
	TEST_ASSERT_EQUAL(CTL_USAGE, map_of("", "--json --as csv"));
	TEST_ASSERT_EQUAL(CTL_USAGE, map_of("", "--as excel"));
	TEST_ASSERT_NOT_NULL(strstr(err, "csv map plcopen scl node-red openplc mb2hal mbpoll"));
	TEST_ASSERT_EQUAL(CTL_USAGE, map_of("", "room1"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_table_has_the_addresses_of_each_place);
	RUN_TEST(test_programs_get_csv_json_and_the_file_itself);
	RUN_TEST(test_each_program_gets_its_own_form);
	RUN_TEST(test_a_host_is_a_name_or_an_address_with_a_port_or_without);
	RUN_TEST(test_names_that_a_program_would_not_take_become_others);
	RUN_TEST(test_an_identifier_is_no_longer_than_its_program_takes);
	RUN_TEST(test_names_that_differ_by_case_alone_become_two);
	RUN_TEST(test_what_is_no_map_is_said_with_its_line);
	return UNITY_END();
}
