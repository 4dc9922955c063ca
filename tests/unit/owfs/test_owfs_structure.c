/* SPDX-License-Identifier: MIT */
/* The families' tables against owserver's own /structure, of which data/ has an extract. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/chips/field.h"
#include "hal/chips/find.h"
#include "hal/native/structure.h"
#include "unity.h"

#include "hal/chips/family.h"
#include "hal/chips/format.h"
#include "hal/native/native.h"

enum { FAMILY, NAME, TYPE, ARRAY, ACCESS, SIZE, LIFE, VISIBILITY, RAW, COLUMNS };

static unsigned rows_of[256];

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

static void check_array(const struct property *property, const char *array, const char *name)
{
	char text[40] = "-";

	if (property->array.index != INDEX_NONE)
		snprintf(text, sizeof(text), "%u:%s:%s", property->array.count,
		         property->array.index == INDEX_LETTERS ? "letters" : "numbers",
		         property->array.aggregate ? "aggregate" : "separate");
	TEST_ASSERT_EQUAL_STRING_MESSAGE(array, text, name);
}

static void check_row(char *column[COLUMNS])
{
	unsigned code = (unsigned)strtoul(column[FAMILY], NULL, 16);
	const struct family *family = family_of((uint8_t)code);
	char name[100], text[64];

	if (family == &family_common)
		return;
	rows_of[code]++;
	snprintf(name, sizeof(name), "%s/%s", column[FAMILY], column[NAME]);
	const struct property *property = family_property(family, NULL, column[NAME],
	                                                  strlen(column[NAME]));
	TEST_ASSERT_NOT_NULL_MESSAGE(property, name);
	bool directory = property->type == PROPERTY_DIRECTORY;
	TEST_ASSERT_EQUAL_CHAR_MESSAGE(
		column[TYPE][0], property->type == PROPERTY_BITS ? 'y' : property->type, name);
	check_array(property, column[ARRAY], name);
	TEST_ASSERT_EQUAL_INT_MESSAGE(strcmp(column[VISIBILITY], "hidden") == 0, property->hidden,
	                              name);
	TEST_ASSERT_EQUAL_INT_MESSAGE(strncmp(column[VISIBILITY], "VISIBLE", 7) == 0,
	                              property->visible != NULL, name);
	if (directory)
		return;
	const char *extension = property->array.index == INDEX_NONE      ? ""
	                        : property->array.index == INDEX_LETTERS ? ".A"
	                                                                 : ".0";
	snprintf(name, sizeof(name), "%s/%s%s", column[FAMILY], column[NAME], extension);
	int n = structure_read(name, strlen(name), text, sizeof(text));
	TEST_ASSERT_GREATER_THAN_INT_MESSAGE(0, n, name);
	TEST_ASSERT_EQUAL_STRING_MESSAGE(column[RAW], text, name);
	TEST_ASSERT_TRUE_MESSAGE(!(property->access & ACCESS_READ) || property_reader(property),
	                         name);
	TEST_ASSERT_TRUE_MESSAGE(!(property->access & ACCESS_WRITE) || property_writer(property),
	                         name);
}

static void test_every_family_has_the_properties_that_owserver_states(void)
{
	FILE *file = fopen("tests/unit/data/owfs-structure.tsv", "r");
	char line[400], *column[COLUMNS];

	TEST_ASSERT_NOT_NULL(file);
	TEST_ASSERT_NOT_NULL(fgets(line, sizeof(line), file));
	while (fgets(line, sizeof(line), file)) {
		split(line, column);
		check_row(column);
	}
	fclose(file);
}

static void test_no_family_has_a_property_more(void)
{
	const struct family *family;

	for (unsigned n = 0; (family = family_nth(n)); n++) {
		const struct property *property = NULL;
		unsigned count = 0;

		while ((property = family_next(family, NULL, property)))
			count++;
		TEST_ASSERT_EQUAL_UINT_MESSAGE(rows_of[family->code], count, family->type);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_every_family_has_the_properties_that_owserver_states);
	RUN_TEST(test_no_family_has_a_property_more);
	return UNITY_END();
}
