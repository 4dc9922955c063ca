/* SPDX-License-Identifier: MIT */
/*
 * A key is one row of a table: it is read, checked, printed and edited by loops over the rows. A
 * table of a block that nobody has shows what a row can say; then each row of owsd's own table goes
 * through all loops.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/config/edit/edit.h"
#include "src/config/edit/print.h"
#include "src/config/read/build.h"
#include "src/config/read/load.h"
#include "src/config/read/options.h"
#include "tests/unit/aid/said.h"

static struct config_box box;
static struct build build;
static struct rio *rio;

void setUp(void)
{
	said_begin();
	box = (struct config_box){0};
	build = (struct build){.box = &box, .report = &report};
	rio = NULL;
}

void tearDown(void)
{
	arena_free(&box.arena);
	rio_free(rio);
}

/* --- A block that nobody has ----------------------------------------------------------------- */

struct house {
	const char *street;
	unsigned floor, doors;
	int64_t age_ns;
	double height;
	bool garden, has_floor, has_height;
	struct config_spot street_at;
};

static const char *check_street(const char *text)
{
	return strchr(text, ' ') ? NULL : "expected a street and a number";
}

static const struct option_def rows[] = {
	{.key = "Street",
         .place = PLACE_INFLUX,
         .kind = OPTION_TEXT,
         .offset = offsetof(struct house, street),
         .store = STORE_TEXT,
         .at = offsetof(struct house, street_at),
         .check = check_street,
         .preset = "Main 1"},
	{.key = "Floor",
         .place = PLACE_INFLUX,
         .kind = OPTION_COUNT,
         .offset = offsetof(struct house, floor),
         .store = STORE_UNSIGNED,
         .has = offsetof(struct house, has_floor),
         .most = 9},
	{.key = "Doors",
         .place = PLACE_INFLUX,
         .kind = OPTION_COUNT,
         .offset = offsetof(struct house, doors),
         .store = STORE_UNSIGNED,
         .least = 1,
         .most = 99,
         .preset = "2"},
	{.key = "Age",
         .place = PLACE_INFLUX,
         .kind = OPTION_SECONDS,
         .offset = offsetof(struct house, age_ns),
         .store = STORE_NS,
         .most = 100,
         .preset = "7",
         .quiet = true},
	{.key = "Height",
         .place = PLACE_INFLUX,
         .kind = OPTION_NUMBER,
         .offset = offsetof(struct house, height),
         .store = STORE_DOUBLE,
         .has = offsetof(struct house, has_height)},
	{.key = "Garden",
         .place = PLACE_INFLUX,
         .kind = OPTION_FLAG,
         .offset = offsetof(struct house, garden),
         .store = STORE_BOOL,
         .preset = "off"},
};
#define ROWS (sizeof(rows) / sizeof(rows[0]))

/* Read a block of that kind; what is reported is in said. */
static struct house read_house(const char *text)
{
	struct option_value values[ROWS];
	struct house house;

	TEST_ASSERT_EQUAL_INT(0, rio_parse("f", text, strlen(text), &report, &rio));
	memset(&house, 0x55, sizeof(house));
	for (size_t i = 0; i < ROWS; i++) {
		const struct rio_node *node = rio_child(rio->root.first, rows[i].key);

		option_begin(&rows[i], &values[i]);
		for (; node; node = rio_next(node))
			option_read(&rows[i], node, &values[i], &report);
		option_take(&build, &rows[i], &values[i], &house);
	}
	return house;
}

static void expect_printed(const char *text, const struct house *house)
{
	char printed[1024] = "";
	FILE *out = fmemopen(printed, sizeof(printed), "w");

	for (size_t i = 0; i < ROWS; i++)
		option_print(&rows[i], house, false, out);
	fclose(out);
	TEST_ASSERT_EQUAL_STRING(text, printed);
}

static void test_rows_read_what_is_given(void)
{
	struct house house = read_house("House {\nStreet \"High 7\" Floor 0 Doors 0x10 Age 0.5\n"
	                                "Height -1.5 Garden on }");

	TEST_ASSERT_EQUAL_STRING("", said);
	TEST_ASSERT_EQUAL_STRING("High 7", house.street);
	TEST_ASSERT_EQUAL_INT(2, house.street_at.line);
	TEST_ASSERT_EQUAL_INT(8, house.street_at.column);
	TEST_ASSERT_TRUE(house.has_floor);
	TEST_ASSERT_EQUAL_UINT(0, house.floor);
	TEST_ASSERT_EQUAL_UINT(16, house.doors);
	TEST_ASSERT_EQUAL_INT64(500000000, house.age_ns);
	TEST_ASSERT_EQUAL_DOUBLE(-1.5, house.height);
	TEST_ASSERT_TRUE(house.has_height && house.garden);
	expect_printed("    Street                  \"High 7\"\n"
	               "    Floor                   0\n"
	               "    Doors                   16\n"
	               "    Age                     0.5\n"
	               "    Height                  -1.5\n"
	               "    Garden                  on\n",
	               &house);
}

static void test_rows_have_defaults(void)
{
	struct house house = read_house("House { }");

	TEST_ASSERT_EQUAL_STRING("", said);
	TEST_ASSERT_EQUAL_STRING("Main 1", house.street);
	TEST_ASSERT_EQUAL_INT(0, house.street_at.line);
	TEST_ASSERT_FALSE(house.has_floor);
	TEST_ASSERT_EQUAL_UINT(2, house.doors);
	TEST_ASSERT_EQUAL_INT64(7000000000, house.age_ns);
	TEST_ASSERT_FALSE(house.has_height || house.garden);
	expect_printed("    Street                  \"Main 1\"\n"
	               "    Doors                   2\n"
	               "    Garden                  off\n",
	               &house);
	for (size_t i = 0; i < ROWS; i++)
		TEST_ASSERT_TRUE_MESSAGE(option_is_preset(&rows[i], &house), rows[i].key);
}

static void test_rows_refuse_what_cannot_be(void)
{
	read_house("House { Street Main Floor 10 Doors 0\nAge 101 Height x Garden 2 Garden on }");
	TEST_ASSERT_EQUAL_STRING(
		"f:1:16: error: Street \"Main\": expected a street and a number\n"
		"f:1:27: error: Floor \"10\": expected a whole number from 0 to 9\n"
		"f:1:36: error: Doors \"0\": expected a whole number from 1 to 99\n"
		"f:2:5: error: Age \"101\": expected seconds from 0 to 100\n"
		"f:2:16: error: Height \"x\": expected a number\n"
		"f:2:25: error: Garden \"2\": expected on or off\n"
		"f:2:27: error: Garden is given twice, first in line 2\n",
		said);
}

/* --- The rows of owsd ------------------------------------------------------------------------ */

/* The least file with each block that a key is needed of */
static char base[1024];

static void write_base(void)
{
	size_t len = (size_t)snprintf(base, sizeof(base), "OwsDrv { Notify { Mail a }\n");

	for (int i = 0; i < OPTION_COUNT_ALL; i++)
		if (option_table[i].needed)
			len += (size_t)snprintf(base + len, sizeof(base) - len,
			                        "%s { %s \"%s\" }\n",
			                        option_place_name(option_table[i].place),
			                        option_table[i].key, option_table[i].needed);
	snprintf(base + len, sizeof(base) - len, "Item { Name i Path /a/b Type double } }");
}

static char *print_document(void)
{
	struct config *config;
	char *text = NULL;
	size_t len;
	FILE *out;

	if (config_parse("f", rio->text, rio->len, &report, &config))
		return NULL;
	out = open_memstream(&text, &len);
	config_print(config, out);
	fclose(out);
	config_free(config);
	return text;
}

/* Is the key printed with that value, by itself or as a text? */
static bool shows(const char *printed, const struct option_def *def, const char *value)
{
	char line[200];

	snprintf(line, sizeof(line), "  %-*s %s%s%s\n", 23, def->key,
	         def->kind == OPTION_TEXT ? "\"" : "", value, def->kind == OPTION_TEXT ? "\"" : "");
	return printed && strstr(printed, line);
}

/* Is a block without the key an error? */
static bool is_missed(const struct option_def *def)
{
	return def->needed || def == &option_table[OPT_NOTIFY_MAIL] ||
	       def == &option_table[OPT_PATH] || def == &option_table[OPT_TYPE];
}

/* Set the key in a file, and take it out again: what is printed follows. */
static bool goes_through(const struct option_def *def, const char *value)
{
	const char *block = def->place == PLACE_ITEM ? "i" : option_place_name(def->place);
	char setting[200], *printed, *before, *after = NULL;
	const char *settings[] = {setting};
	bool shown;

	snprintf(setting, sizeof(setting), "%s=%s", def->key, value);
	TEST_ASSERT_EQUAL_INT(0, rio_parse("f", base, strlen(base), &report, &rio));
	/* an empty block prints its defaults, too */
	edit_set(&rio, block, settings, 0, &report);
	before = print_document();
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, edit_set(&rio, block, settings, 1, &report), said);
	printed = print_document();
	shown = shows(printed, def, value) && !shows(before, def, value);
	if (shown && !is_missed(def)) {
		TEST_ASSERT_EQUAL_INT_MESSAGE(
			0, edit_unset(&rio, block, (const char *const[]){def->key}, 1, &report),
			said);
		after = print_document();
		TEST_ASSERT_EQUAL_STRING_MESSAGE(before, after, setting);
	}
	free(before);
	free(printed);
	free(after);
	rio_free(rio);
	rio = NULL;
	return shown;
}

/* Is there a value that goes through? */
static bool some_goes_through(const struct option_def *def)
{
	static const char *const texts[] = {
		"/x/y",          "ab",     "http://h/w", "mqtt://h",    "2026-11-22",
		"3.1.1",         "plain",  "interval 5", "4:0 20:100",  "root",
		"8080",          "a=b",    "critical",   "22:00-06:30", "boiler http://pi2/",
		"pump 10.0.0.1", "little", "exception"};
	char number[40];

	switch (def->kind) {
	case OPTION_TEXT:
		for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++)
			if (goes_through(def, texts[i]))
				return true;
		return false;
	case OPTION_FLAG:
		return goes_through(def, "on") || goes_through(def, "off");
	case OPTION_TYPE:
		return goes_through(def, "float");
	case OPTION_IO:
		return goes_through(def, "output");
	case OPTION_COUNT:
	case OPTION_SECONDS:
	case OPTION_NUMBER:
		snprintf(number, sizeof(number), "%.10g", def->least + 2);
		return goes_through(def, number);
	case OPTION_BLOCK:
		break;
	}
	return true;
}

static void test_each_row_is_read_printed_and_edited(void)
{
	char why[80];
	unsigned count = 0;

	write_base();
	for (int i = 0; i < OPTION_COUNT_ALL; i++) {
		const struct option_def *def = &option_table[i];

		/* two are of outputs, some belong together, and a block is found by its name */
		if (!def->store || i == OPT_START || i == OPT_READ_BACK || i == OPT_NAME ||
		    i == OPT_MQTT_CERT_FILE || i == OPT_MQTT_KEY_FILE ||
		    i == OPT_NOTIFY_ESCALATE_MAIL)
			continue;
		said_begin();
		snprintf(why, sizeof(why), "%s: texts[] has no value for it", def->key);
		TEST_ASSERT_TRUE_MESSAGE(some_goes_through(def), why);
		count++;
	}
	TEST_ASSERT_GREATER_THAN_UINT(70, count);
}

static void test_each_row_without_a_member_is_one_of_these(void)
{
	static const char others[] = " Version TargetName MaxRequests Listen ListenAllow "
				     "ControlAllow ItemCount IOType ";
	char key[64];

	for (int i = 0; i < OPTION_COUNT_ALL; i++) {
		const struct option_def *def = &option_table[i];

		if (def->store || def->kind == OPTION_BLOCK || def->place == PLACE_BUS)
			continue;
		snprintf(key, sizeof(key), " %s ", def->key);
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(others, key), def->key);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_rows_read_what_is_given);
	RUN_TEST(test_rows_have_defaults);
	RUN_TEST(test_rows_refuse_what_cannot_be);
	RUN_TEST(test_each_row_is_read_printed_and_edited);
	RUN_TEST(test_each_row_without_a_member_is_one_of_these);
	return UNITY_END();
}
