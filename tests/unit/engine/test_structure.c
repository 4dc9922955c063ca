/* SPDX-License-Identifier: MIT */
/* Tests of the entries of /structure: parsing, and which types fit a property. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "src/daemon/engine/structure.h"

void setUp(void)
{
}
void tearDown(void)
{
}

static int parse(const char *text, struct structure_entry *entry)
{
	return structure_parse(text, strlen(text), entry);
}

static const char *fault(const char *text, enum ows_type type, bool output)
{
	struct config_item item = {.type = type, .output = output, .readable = !output};
	struct structure_entry entry;
	const char *why;
	int err;

	TEST_ASSERT_EQUAL_INT(0, parse(text, &entry));
	err = structure_fault(&entry, &item, &why);
	TEST_ASSERT_EQUAL_INT(!*why, !err);
	return err ? why : NULL;
}

/* All texts are the genuine owserver's. */
static void test_entries_of_the_genuine_owserver_parse(void)
{
	struct structure_entry entry;

	TEST_ASSERT_EQUAL_INT(0, parse("t,000000,000001,ro,000012,v,", &entry));
	TEST_ASSERT_EQUAL_INT('t', entry.type);
	TEST_ASSERT_EQUAL_INT(0, entry.index);
	TEST_ASSERT_EQUAL_STRING("ro", entry.access);
	TEST_ASSERT_EQUAL_INT(0, parse("y,-000002,000008,rw,000012,s,", &entry));
	TEST_ASSERT_EQUAL_INT(-2, entry.index);
	TEST_ASSERT_EQUAL_STRING("rw", entry.access);
}

static void test_anything_else_is_refused(void)
{
	static const char *const bad[] = {
		"",
		"t",
		"t,000000",
		"28.551DDF030000",
		"t,000000,000001,xx,000012,v,",
		"?,000000,000001,ro,000012,v,",
		"t;000000;000001;ro;000012;v;",
		"t,00000000000000000000000000000000000000000000000000000000000000000,1,ro,1,v,",
	};
	struct structure_entry entry;

	for (unsigned i = 0; i < sizeof(bad) / sizeof(bad[0]); i++)
		TEST_ASSERT_EQUAL_INT_MESSAGE(-EILSEQ, parse(bad[i], &entry), bad[i]);
}

/* A field that is missing at the very end, and NULs in the middle, as only a liar sends them. */
static void test_an_entry_with_nuls_or_cut_off_is_refused(void)
{
	static const char whole[] = "t,000000,000001,ro,000012,v,";
	struct structure_entry entry;
	char bad[64];

	for (size_t len = 0; len < sizeof(bad); len++) {
		memset(bad, '0', sizeof(bad));
		memcpy(bad, "t,000000,", 9);
		if (len > 9)
			bad[len - 1] = ',';
		TEST_ASSERT_EQUAL_INT(-EILSEQ, structure_parse(bad, len, &entry));
	}
	for (size_t i = 0; i < 19; i++) {
		memcpy(bad, whole, sizeof(whole));
		bad[i] = '\0';
		TEST_ASSERT_EQUAL_INT(-EILSEQ, structure_parse(bad, sizeof(whole) - 1, &entry));
	}
}

static void test_a_temperature_fits_a_double_and_a_long(void)
{
	TEST_ASSERT_NULL(fault("t,000000,000001,ro,000012,v,", OWS_DOUBLE, false));
	TEST_ASSERT_NULL(fault("t,000000,000001,ro,000012,v,", OWS_LONG, false));
}

static void test_text_does_not_fit_a_number(void)
{
	TEST_ASSERT_NOT_NULL(fault("a,000000,000001,ro,000032,f,", OWS_DOUBLE, false));
	TEST_ASSERT_NOT_NULL(fault("b,000000,000001,ro,000009,v,", OWS_LONG, false));
	TEST_ASSERT_NOT_NULL(fault("d,000000,000001,rw,000024,v,", OWS_DOUBLE, false));
	TEST_ASSERT_NULL(fault("a,000000,000001,ro,000032,f,", OWS_STRING, false));
}

static void test_a_list_needs_a_string(void)
{
	TEST_ASSERT_NOT_NULL(fault("y,-000001,000008,rw,000015,s,", OWS_BYTE, false));
	TEST_ASSERT_NULL(fault("y,-000001,000008,rw,000015,s,", OWS_STRING, false));
	TEST_ASSERT_NULL(fault("y,-000002,000008,rw,000012,s,", OWS_BYTE, false));
}

static void test_an_output_needs_a_property_that_can_be_written(void)
{
	TEST_ASSERT_NOT_NULL(fault("y,-000002,000008,ro,000012,v,", OWS_BYTE, true));
	TEST_ASSERT_NULL(fault("y,-000002,000008,rw,000012,s,", OWS_BYTE, true));
	TEST_ASSERT_NULL(fault("y,000000,000001,wo,000001,s,", OWS_BOOL, true));
}

static void test_an_input_needs_a_property_that_can_be_read(void)
{
	TEST_ASSERT_NOT_NULL(fault("y,000000,000001,wo,000001,s,", OWS_BOOL, false));
}

static void test_each_path_is_asked_once_for_all_its_signals(void)
{
	struct config_item items[] = {
		{.name = "a", .path = "/28.551DDF030000/temperature12", .type = OWS_DOUBLE},
		{.name = "b", .path = "/29.B89115000000/PIO.BYTE", .type = OWS_BYTE},
		{.name = "c", .path = "/28.063BC8040000/temperature12", .type = OWS_DOUBLE},
		{.name = "d", .path = "/boiler/temperature", .type = OWS_DOUBLE},
		{.name = "e", .path = "/26.0CBEEA010000/HIH4000/humidity", .type = OWS_DOUBLE},
		{.name = "f", .path = "/simultaneous/temperature", .type = OWS_BOOL},
	};
	struct config config = {.items = items, .item_count = 6};
	struct structure structure;
	struct table table;

	TEST_ASSERT_EQUAL_INT(0, signal_table_init(&table, &config));
	TEST_ASSERT_EQUAL_INT(0, structure_init(&structure, &table));
	TEST_ASSERT_EQUAL_UINT32(3, structure.count);
	TEST_ASSERT_EQUAL_STRING("/structure/26/HIH4000/humidity", structure.checks[0].path);
	TEST_ASSERT_EQUAL_STRING("/structure/28/temperature12", structure.checks[1].path);
	TEST_ASSERT_EQUAL_UINT32(2, structure.checks[1].count);
	TEST_ASSERT_EQUAL_UINT32(0, structure.rows[structure.checks[1].first]);
	TEST_ASSERT_EQUAL_UINT32(2, structure.rows[structure.checks[1].first + 1]);
	TEST_ASSERT_EQUAL_STRING("/structure/29/PIO.BYTE", structure.checks[2].path);
	structure_free(&structure);
	signal_table_free(&table);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_entries_of_the_genuine_owserver_parse);
	RUN_TEST(test_anything_else_is_refused);
	RUN_TEST(test_an_entry_with_nuls_or_cut_off_is_refused);
	RUN_TEST(test_a_temperature_fits_a_double_and_a_long);
	RUN_TEST(test_text_does_not_fit_a_number);
	RUN_TEST(test_a_list_needs_a_string);
	RUN_TEST(test_an_output_needs_a_property_that_can_be_written);
	RUN_TEST(test_an_input_needs_a_property_that_can_be_read);
	RUN_TEST(test_each_path_is_asked_once_for_all_its_signals);
	return UNITY_END();
}
