/* SPDX-License-Identifier: MIT */
/* The families' tables against owserver's own /structure, of which data/ has an extract. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/chips/field.h"
#include "hal/chips/find.h"
#include "hal/native/tables.h"
#include "unity.h"

#include "hal/chips/family.h"
#include "hal/chips/format.h"
#include "hal/native/native.h"

enum { FAMILY, NAME, TYPE, ARRAY, ACCESS, SIZE, LIFE, VISIBILITY, RAW, COLUMNS };

static unsigned rows_of[256], rows_without[256];

void setUp(void)
{
}

void tearDown(void)
{
}

static void split(char *line, char *column[COLUMNS])
{
	line[strcspn(line, "\n")] = '\0';
	for (int i = 0; i < COLUMNS; i++) {
		column[i] = line;
		line += strcspn(line, "\t");
		if (*line)
			*line++ = '\0';
	}
}

/* Where owserver's table is wrong: a blank, two underscores, twice as many limits as channels. */
static void correct(char *column[COLUMNS])
{
	static const char *const limits[] = {"current_hi", "current_low", "volts_hi", "volts_low"};
	static char light[] = "EDS0067/threshold/light_hi";
	static char resistance[] = "EDS0071/set_alarm/resistance_hi";
	static char array[] = "8:numbers:separate", raw[] = "f,000000,000008,rw,000012,s,";
	static char of_some[] = "VISIBLE_BOTH"; /* not of every chip with that code */
	char *limit = strstr(column[NAME], "/threshold/");

	if (strcmp(column[FAMILY] + 1, "6") == 0 && strcmp(column[NAME], "temperature") == 0 &&
	    (column[FAMILY][0] == '2' || column[FAMILY][0] == 'A'))
		column[VISIBILITY] = of_some;
	if (strcmp(column[FAMILY], "7E") != 0)
		return;
	if (strcmp(column[NAME], "EDS0067/threshold/light_hi ") == 0)
		column[NAME] = light;
	if (strcmp(column[NAME], "EDS0071/set_alarm/resistance__hi") == 0)
		column[NAME] = resistance;
	for (unsigned i = 0; limit && i < sizeof(limits) / sizeof(limits[0]); i++) {
		if (strcmp(limit + strlen("/threshold/"), limits[i]) != 0)
			continue;
		array[0] = raw[14] = strncmp(column[ARRAY], "16:", 3) == 0 ? '8' : '4';
		column[ARRAY] = array;
		column[RAW] = raw;
	}
}

static void check_array(const struct property *property, const char *array, const char *name)
{
	char text[40] = "-";

	if (property->array.index != INDEX_NONE && property->array.count == 0)
		snprintf(text, sizeof(text), "sparse:%s:sparse",
		         property->array.index == INDEX_LETTERS ? "letters" : "numbers");
	else if (property->array.index != INDEX_NONE)
		snprintf(text, sizeof(text), "%u:%s:%s", property->array.count,
		         property->array.index == INDEX_LETTERS ? "letters" : "numbers",
		         property->array.aggregate ? "aggregate"
		         : strstr(array, ":mixed") ? "mixed"
		                                   : "separate");
	TEST_ASSERT_EQUAL_STRING_MESSAGE(array, text, name);
}

/* owserver lists these too; to read them is to write to the memory of a DS2760 (ws603.h). */
static bool writes_when_it_is_read(char *column[COLUMNS])
{
	return strcmp(column[FAMILY], "30") == 0 && strncmp(column[NAME], "WS603/", 6) == 0 &&
	       column[ACCESS][0] == 'r' && strcmp(column[NAME], "WS603/temperature") != 0;
}

static void check_row(char *column[COLUMNS])
{
	unsigned code = (unsigned)strtoul(column[FAMILY], NULL, 16);
	const struct family *family = family_of((uint8_t)code);
	char name[100], text[64];

	if (family == &family_common) {
		rows_without[code]++;
		return;
	}
	rows_of[code]++;
	correct(column);
	snprintf(name, sizeof(name), "%s/%s", column[FAMILY], column[NAME]);
	const struct property *property = family_property(family, NULL, column[NAME],
	                                                  strlen(column[NAME]));
	TEST_ASSERT_NOT_NULL_MESSAGE(property, name);
	bool directory = property->type == PROPERTY_DIRECTORY;
	TEST_ASSERT_EQUAL_CHAR_MESSAGE(
		column[TYPE][0], property->type == PROPERTY_BITS ? 'y' : property->type, name);
	check_array(property, column[ARRAY], name);
	TEST_ASSERT_EQUAL_INT_MESSAGE(strcmp(column[VISIBILITY], "hidden") == 0 ||
	                                      writes_when_it_is_read(column),
	                              property->hidden, name);
	/* Of a hidden one owserver does not state which chips have it. */
	TEST_ASSERT_EQUAL_INT_MESSAGE(strncmp(column[VISIBILITY], "VISIBLE", 7) == 0 ||
	                                      strncmp(column[VISIBILITY], "is_visible", 10) == 0,
	                              property->kinds != 0 && !property->hidden, name);
	if (directory)
		return;
	int extension = property->array.index == INDEX_NONE      ? EXTENSION_NONE
	                : property->array.index == INDEX_LETTERS ? EXTENSION_LETTERS
	                                                         : 0;
	TEST_ASSERT_TRUE_MESSAGE(extension_fits(property, extension), name);
	int n = structure_print(property, extension, text, sizeof(text));
	TEST_ASSERT_GREATER_THAN_INT_MESSAGE(0, n, name);
	TEST_ASSERT_EQUAL_STRING_MESSAGE(column[RAW], text, name);
	TEST_ASSERT_TRUE_MESSAGE(
		!(property->access & ACCESS_READ) || property_reader(family, property), name);
	TEST_ASSERT_TRUE_MESSAGE(
		!(property->access & ACCESS_WRITE) || property_writer(family, property), name);
}

static void check_rows(const char *name)
{
	FILE *file = fopen(name, "r");
	char line[400], *column[COLUMNS];

	TEST_ASSERT_NOT_NULL_MESSAGE(file, name);
	TEST_ASSERT_NOT_NULL(fgets(line, sizeof(line), file));
	while (fgets(line, sizeof(line), file)) {
		split(line, column);
		check_row(column);
	}
	fclose(file);
}

/* And the hidden ones that owserver does not have. */
static void test_every_family_has_the_properties_that_owserver_states(void)
{
	check_rows("tests/unit/data/owfs-structure.tsv");
	check_rows("tests/unit/data/own-structure.tsv");
}

static void test_families_without_a_table_are_counted(void)
{
	unsigned families = 0, rows = 0;
	char text[80];

	for (unsigned code = 1; code < 256; code++) {
		families += rows_without[code] > 0;
		rows += rows_without[code];
	}
	snprintf(text, sizeof(text), "%u families of owserver, %u properties, have no table here",
	         families, rows);
	TEST_MESSAGE(text);
	TEST_ASSERT_LESS_THAN_UINT(48, families);
}

static void test_no_family_has_a_property_more(void)
{
	const struct family *family;

	for (unsigned n = 0; (family = family_nth(n)); n++) {
		const struct property *property = NULL;
		unsigned count = 0;

		while ((property = family_next(family, NULL, property)))
			count++;
		/* there is no row of a family that nobody has stated */
		if (rows_of[family->code])
			TEST_ASSERT_EQUAL_UINT_MESSAGE(rows_of[family->code], count, family->type);
	}
}

static void test_every_row_names_what_stands_in_the_lists_of_its_family(void)
{
	const struct family *family;

	for (unsigned n = 0; (family = family_nth(n)); n++) {
		for (unsigned i = 0; i < family->count; i++) {
			const struct property *property = &family->properties[i];

			TEST_ASSERT_TRUE_MESSAGE(!property->how ||
			                                 property->how < family->how_count,
			                         property->name);
			TEST_ASSERT_TRUE_MESSAGE(!property->field.area ||
			                                 property->field.area < family->area_count,
			                         property->name);
			TEST_ASSERT_TRUE_MESSAGE(!property->array.aggregate ||
			                                 property->type == PROPERTY_BITS ||
			                                 property->array.count <= TXN_NUMBERS,
			                         property->name);
			if (i > 0)
				TEST_ASSERT_LESS_THAN_INT_MESSAGE(
					0, strcmp(property[-1].name, property->name),
					property->name);
		}
		for (unsigned i = 1; i < family->area_count; i++)
			TEST_ASSERT_NOT_NULL_MESSAGE(family->areas[i], family->type);
		for (unsigned i = 1; i < family->how_count; i++)
			TEST_ASSERT_TRUE_MESSAGE(!family->how[i].set.area ||
			                                 family->how[i].set.area <
			                                         family->area_count,
			                         family->type);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_every_family_has_the_properties_that_owserver_states);
	RUN_TEST(test_families_without_a_table_are_counted);
	RUN_TEST(test_no_family_has_a_property_more);
	RUN_TEST(test_every_row_names_what_stands_in_the_lists_of_its_family);
	return UNITY_END();
}
