/* SPDX-License-Identifier: MIT */
/* Tests of the judgement of a server's readings, over all properties that measure. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/chips/find.h"
#include "hal/owserver/judge.h"

#define S 1000000000LL
#define ROOM_PATH "/28.551DDF030000/temperature"
#define HALL_PATH "/28.063BC8040000/temperature12"

static struct judge judge;
static double number;

void setUp(void)
{
	memset(&judge, 0, sizeof(judge));
}
void tearDown(void)
{
}

static int judged(const char *path, const char *text, int64_t now_ns)
{
	return judge_reading(&judge, path, text, strlen(text), false, now_ns, &number);
}

/* Of the property, or its element: the text of this number, alone and as the last of a list. */
static void expect(const char *path, double value, int err)
{
	char text[64];

	snprintf(text, sizeof(text), "%12.15G", value);
	TEST_ASSERT_EQUAL_INT_MESSAGE(err, judged(path, text, S), path);
	if (err)
		TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(value, number, path);
	snprintf(text, sizeof(text), "none,%12.15G\n", value);
	TEST_ASSERT_EQUAL_INT_MESSAGE(err, judged(path, text, S), path);
}

static unsigned expect_of_row(const struct family *family, const struct property *row)
{
	const char *element = row->array.index == INDEX_LETTERS   ? ".A"
	                      : row->array.index == INDEX_NUMBERS ? ".0"
	                                                          : "";
	char path[96];

	snprintf(path, sizeof(path), "/%02X.551DDF030000/%s%s", family->code, row->name, element);
	if (!(row->measures.least < row->measures.most)) {
		/* a limit is a temperature all the same */
		TEST_ASSERT_EQUAL_INT_MESSAGE(row->type == PROPERTY_TEMPERATURE ? -EDOM : 0,
		                              judged(path, "-999.9", S), path);
		return 0;
	}
	expect(path, row->measures.least, 0);
	if (isfinite(row->measures.least))
		expect(path, row->measures.least - 1, -EDOM);
	if (isfinite(row->measures.most))
		expect(path, row->measures.most + 1, -EDOM);
	return 1;
}

static void test_what_no_chip_can_measure_is_refused_of_all_families(void)
{
	unsigned rows = 0;

	for (unsigned n = 0; family_nth(n); n++) {
		const struct family *family = family_nth(n);

		for (unsigned i = 0; i < family->count; i++)
			rows += expect_of_row(family, &family->properties[i]);
	}
	TEST_ASSERT_GREATER_THAN_UINT(40, rows);
}

static void test_what_is_no_number_or_no_measurement_passes(void)
{
	static const char *const rows[][2] = {
		{ROOM_PATH, ""},          {ROOM_PATH, "   "},
		{ROOM_PATH, "-999.9abc"}, {ROOM_PATH, "21.5"},
		{"/", "-999.9"},          {"/28.551DDF030000/scratchpad", "-999.9"},
		{"not a path", "85"},     {"/system/process/pid", "123456"},
	};

	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++)
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, judged(rows[i][0], rows[i][1], S), rows[i][1]);
	TEST_ASSERT_EQUAL_INT(0, judge_reading(&judge, ROOM_PATH, "400", 3, true, S, &number));
}

static void test_of_an_alias_only_what_nothing_can_measure_is_refused(void)
{
	TEST_ASSERT_EQUAL_INT(0, judged("/oven/temperature", "1200", S));
	TEST_ASSERT_EQUAL_INT(-EDOM, judged("/oven/temperature", "-999.9", S));
}

static void test_a_reading_without_power_is_refused_by_what_its_own_chip_read_before(void)
{
	TEST_ASSERT_EQUAL_INT(-ERANGE, judged(ROOM_PATH, "85", S));
	TEST_ASSERT_EQUAL_INT(-ERANGE, judged(ROOM_PATH, "127.938", S));
	TEST_ASSERT_EQUAL_INT(0, judged(ROOM_PATH, "84.5", 2 * S));
	TEST_ASSERT_EQUAL_INT(0, judged("/28.551DDF030000/temperature9", "85", 3 * S));
	TEST_ASSERT_EQUAL_INT(0, judged("/bus.0/28551ddf030000/temperature", "85", 3 * S));
	TEST_ASSERT_EQUAL_INT(-ERANGE, judged(HALL_PATH, "85", 3 * S));
	TEST_ASSERT_EQUAL_INT(-ERANGE, judged("/boiler/temperature", "85", 3 * S));
	TEST_ASSERT_EQUAL_INT(0, judged("/boiler/temperature", "83", 4 * S));
	TEST_ASSERT_EQUAL_INT(0, judged("/boiler/temperature", "85", 5 * S));
	TEST_ASSERT_EQUAL_INT(-ERANGE, judged(ROOM_PATH, "85", 200 * S));
}

static void test_what_is_refused_does_not_vouch_for_85(void)
{
	TEST_ASSERT_EQUAL_INT(-EDOM, judged(ROOM_PATH, "-999.9", S));
	TEST_ASSERT_EQUAL_INT(-ERANGE, judged(ROOM_PATH, "85", S));
	TEST_ASSERT_EQUAL_INT(-ERANGE, judged(ROOM_PATH, "85", 2 * S));
}

static void test_the_thermometers_of_a_large_plant_keep_apart(void)
{
	char path[64];

	for (unsigned i = 0; i < 200; i++) {
		snprintf(path, sizeof(path), "/28.%012X/temperature", i * 0x10001);
		TEST_ASSERT_EQUAL_INT(0, judged(path, "84", S));
	}
	for (unsigned i = 0; i < 200; i++) {
		snprintf(path, sizeof(path), "/28.%012X/temperature", i * 0x10001);
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, judged(path, "85", 2 * S), path);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_what_no_chip_can_measure_is_refused_of_all_families);
	RUN_TEST(test_what_is_no_number_or_no_measurement_passes);
	RUN_TEST(test_of_an_alias_only_what_nothing_can_measure_is_refused);
	RUN_TEST(test_a_reading_without_power_is_refused_by_what_its_own_chip_read_before);
	RUN_TEST(test_what_is_refused_does_not_vouch_for_85);
	RUN_TEST(test_the_thermometers_of_a_large_plant_keep_apart);
	return UNITY_END();
}
