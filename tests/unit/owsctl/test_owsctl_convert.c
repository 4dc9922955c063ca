/* SPDX-License-Identifier: MIT */
/* owsctl convert --mbdrv: what stands in the file for REXYGEN's Modbus driver. */
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/verbs.h"
#include "tests/unit/aid/caught.h"
#include "tests/unit/aid/folder.h"

static void write_file(const char *name, const char *text)
{
	char path[300];
	FILE *file;

	snprintf(path, sizeof(path), "%s/%s", folder_dir()->path, name);
	file = fopen(path, "we");
	TEST_ASSERT_NOT_NULL(file);
	fputs(text, file);
	fclose(file);
}

/* The verb for a configuration of these keys and items. */
static int converted(const char *keys, const char *items)
{
	const char *place = folder_dir()->path;
	char text[4000], words[700];

	snprintf(text, sizeof(text), "OwsDrv {\n  TargetName \"localhost\"\n%s\n%s}\n", keys,
	         items);
	write_file("plant.rio", text);
	snprintf(words, sizeof(words), "convert -d %s --mbdrv %s/plant.rio", place, place);
	return run(verb_convert, words);
}

void setUp(void)
{
	caught_begin("convert");
	write_file("map", "");
}

void tearDown(void)
{
	caught_end();
}

#define ITEM(name, path, type, io) \
	"  Item {\n    Name \"" name "\"\n    Path \"" path "\"\n    Type " type "\n    IO " io \
	"\n  }\n"
#define ROOM ITEM("room", "/28.A0B1C2000001/temperature", "double", "input")
#define LISTEN "  Modbus {\n    Listen \"192.168.1.10:1502\"\n  }\n"
#define PRINTED(name, address, type, count) \
	"  Item {\n" \
	"    Name                    \"" name "\"\n" \
	"    SlaveAdr                0\n" \
	"    RegisterAdr             " address "\n" \
	"    Type                    " type "\n" \
	"    Count                   " count "\n" \
	"  }\n"

static void test_the_whole_file_is_that_of_a_master_with_one_slave(void)
{
	TEST_ASSERT_EQUAL(CTL_DONE, converted(LISTEN, ROOM));
	TEST_ASSERT_EQUAL_STRING(
		"Modbus {\n"
		"  Name                    \"\"\n"
		"  Timeout                 1000\n"
		"  Flags                   8\n"
		"  Gap                     10000\n"
		"  Slave {\n"
		"    Name                    \"owsd\"\n"
		"    IPaddress               \"192.168.1.10\"\n"
		"    Subaddress              255\n"
		"    SlaveID                 0\n"
		"    MaxRequest              16\n"
		"    TCPport                 1502\n"
		"  }\n" PRINTED("room", "56004", "0x00200204", "4")
			PRINTED("owsd_live", "3", "0x00000204", "1")
				PRINTED("owsd_heart", "4", "0x00000204", "1")
					PRINTED("owsd_order", "0", "0x00000244", "2") "}\n",
		out);
	TEST_ASSERT_EQUAL_STRING("", err);
}

/* Each type by a form that holds its numbers; the way it goes shows in its type. */
static void test_each_type_has_its_form_and_its_function(void)
{
	static const struct {
		const char *type, *io, *item;
	} rows[] = {
		{"bool", "input", PRINTED("x", "1", "0x00000200", "1")},
		{"bool", "output", PRINTED("x", "1", "0x00000101", "1")},
		{"byte", "input", PRINTED("x", "40001", "0x00000284", "1")},
		{"short", "output", PRINTED("x", "40001", "0x00000184", "1")},
		{"float", "input", PRINTED("x", "46002", "0x00000244", "2")},
		{"float", "output", PRINTED("x", "46002", "0x00000144", "2")},
		{"word", "input", PRINTED("x", "56004", "0x00200204", "4")},
		{"long", "output", PRINTED("x", "56004", "0x00200104", "4")},
		{"dword", "input", PRINTED("x", "56004", "0x00200204", "4")},
		{"large", "input", PRINTED("x", "56004", "0x00200204", "4")},
		{"double", "output", PRINTED("x", "56004", "0x00200104", "4")},
	};
	char item[300];

	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		snprintf(item, sizeof(item),
		         "  Item { Name \"x\" Path \"/29.A0B1C2000004/PIO.BYTE\" Type %s IO %s }\n",
		         rows[i].type, rows[i].io);
		TEST_ASSERT_EQUAL(CTL_DONE, converted(LISTEN, item));
		holds(out, rows[i].item);
	}
}

static void test_a_name_is_one_text_of_the_file(void)
{
	TEST_ASSERT_EQUAL(CTL_DONE, converted(LISTEN, ITEM("C:\\\\", "/29.A0B1C2000004/PIO.0",
	                                                   "bool", "input")));
	holds(out, PRINTED("C:\\\\", "1", "0x00000200", "1"));
}

static void test_places_are_those_that_owsd_modbus_gives(void)
{
	write_file("map", "4 /28.A0B1C2000001/temperature\n2 /28.0000000000AA/gone\n");
	TEST_ASSERT_EQUAL(CTL_DONE,
	                  converted(LISTEN, ITEM("new", "/28.A0B1C2000002/temperature", "double",
	                                         "input") ITEM("text", "/28.A0B1C2000002/type",
	                                                       "string", "input") ROOM));
	holds(out, PRINTED("new", "56020", "0x00200204", "4")
	                   PRINTED("room", "56016", "0x00200204", "4"));
	TEST_ASSERT_NULL(strstr(out, "\"text\""));
	holds(err, "strings left out, which have no register: 1");
	/* as those of the configuration, which win */
	write_file("fixed", "9 /28.A0B1C2000001/temperature\n");
	char keys[400];
	snprintf(keys, sizeof(keys),
	         "  Modbus {\n    Listen \"127.0.0.1:502\"\n    Map \"%s/fixed\"\n  }\n",
	         folder_dir()->path);
	TEST_ASSERT_EQUAL(CTL_DONE, converted(keys, ROOM));
	holds(out, PRINTED("room", "56036", "0x00200204", "4"));
	/* none was given yet */
	snprintf(keys, sizeof(keys), "%s/map", folder_dir()->path);
	remove(keys);
	TEST_ASSERT_EQUAL(CTL_DONE, converted(LISTEN, ROOM));
	holds(out, PRINTED("room", "56004", "0x00200204", "4"));
}

static void test_what_owsd_modbus_would_not_do_is_said(void)
{
	TEST_ASSERT_EQUAL(CTL_DONE,
	                  converted("", ITEM("relay", "/29.A0B1C2000004/PIO.0", "bool", "output")));
	holds(out, "\"127.0.0.1\"");
	holds(out, "TCPport                 502\n");
	holds(err, "plant.rio has no Modbus block");
	holds(err, "Write is off");
	TEST_ASSERT_EQUAL(CTL_DONE, converted("  Modbus {\n    Listen \"0.0.0.0:502\"\n"
	                                      "    UnitId 7\n  }\n",
	                                      ROOM));
	holds(out, "Subaddress              7\n");
	holds(err, "0.0.0.0:502: it listens at each address");
}

static void test_what_is_wrong_is_refused(void)
{
	TEST_ASSERT_EQUAL(CTL_USAGE,
	                  converted("  Modbus {\n    Listen \"somewhere\"\n  }\n", ROOM));
	holds(err, "plant.rio:");
	write_file("map", "x\n");
	TEST_ASSERT_EQUAL(CTL_FAILED, converted(LISTEN, ROOM));
	holds(err, "map:1: no place and identity");
	TEST_ASSERT_EQUAL(CTL_FAILED, converted("  Modbus {\n    Listen \"127.0.0.1:502\"\n"
	                                        "    Map \"/nowhere/map\"\n  }\n",
	                                        ROOM));
	holds(err, "there is no /nowhere/map: the key Map names it");
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_convert, "convert plant.rio"));
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_convert, "convert --mbdrv"));
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_convert, "convert --mbdrv /nowhere/plant.rio"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_whole_file_is_that_of_a_master_with_one_slave);
	RUN_TEST(test_each_type_has_its_form_and_its_function);
	RUN_TEST(test_a_name_is_one_text_of_the_file);
	RUN_TEST(test_places_are_those_that_owsd_modbus_gives);
	RUN_TEST(test_what_owsd_modbus_would_not_do_is_said);
	RUN_TEST(test_what_is_wrong_is_refused);
	return UNITY_END();
}
