/* SPDX-License-Identifier: MIT */
/* What a scan means for a configuration that is there, as a table of cases. */
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/config/edit/edit.h"
#include "src/config/read/load.h"
#include "src/tool/owsctl/scan/scan_item.h"
#include "src/tool/owsctl/scan/scan_merge.h"
#include "src/tool/scan/scan.h"

#define MOST 8

void setUp(void)
{
}

void tearDown(void)
{
}

/* A device is a letter: upper case of family 28, lower case of family 10. */
static void rom_of(char letter, uint8_t rom[ROM_LEN])
{
	memset(rom, 0, ROM_LEN);
	rom[0] = letter >= 'a' ? 0x10 : 0x28;
	rom[1] = (uint8_t)letter;
	rom[ROM_LEN - 1] = rom_crc8(rom, ROM_LEN - 1);
}

static unsigned list_of(const char *letters, struct merge_device *list)
{
	unsigned count = 0;

	for (; *letters; letters++)
		rom_of(*letters, list[count++].rom);
	return count;
}

/*
 * "A+ B-1 Cr": each with its fate (+ stays, - missing, n new, r replaced), and pairs if there are.
 */
static void print(const struct merge_device *list, unsigned count, char *out)
{
	static const char fates[] = {[MERGE_STAYS] = '+',
	                             [MERGE_MISSING] = '-',
	                             [MERGE_NEW] = 'n',
	                             [MERGE_REPLACED] = 'r'};

	*out = '\0';
	for (unsigned i = 0; i < count; i++) {
		out += sprintf(out, "%s%c%c", i ? " " : "", list[i].rom[1], fates[list[i].fate]);
		if (list[i].pairs)
			out += sprintf(out, "%u", list[i].pairs);
	}
}

static const struct {
	const char *known, *found, *pairs; /* pairs: "AB" is --replace A=B */
	const char *fault;                 /* what the reason has */
	unsigned wrong;
	const char *says_known, *says_found;
} cases[] = {
	{"", "", "", NULL, 0, "", ""},
	{"AB", "AB", "", NULL, 0, "A+ B+", "A+ B+"},
	{"AB", "BA", "", NULL, 0, "A+ B+", "B+ A+"},
	{"A", "AB", "", NULL, 0, "A+", "A+ Bn"},
	{"AB", "A", "", NULL, 0, "A+ B-", "A+"},
	{"AB", "", "", NULL, 0, "A- B-", ""},
	/* one gone, one come, of a family: perhaps replaced, but never without being asked */
	{"AB", "AC", "", NULL, 0, "A+ B-1", "A+ Cn1"},
	{"AB", "CD", "", NULL, 0, "A-2 B-2", "Cn2 Dn2"},
	/* other counts, or another family: no guess */
	{"AB", "C", "", NULL, 0, "A- B-", "Cn"},
	{"A", "BC", "", NULL, 0, "A-", "Bn Cn"},
	{"A", "b", "", NULL, 0, "A-", "bn"},
	{"Aa", "Bbc", "", NULL, 0, "A-1 a-", "Bn1 bn cn"},
	/* asked for */
	{"AB", "AC", "BC", NULL, 0, "A+ Br", "A+ Cr"},
	{"AB", "CD", "AD", NULL, 0, "Ar B-1", "Cn1 Dr"},
	{"AB", "CD", "ADBC", NULL, 0, "Ar Br", "Cr Dr"},
	{"A", "BCD", "AC", NULL, 0, "Ar", "Bn Cr Dn"},
	/* refused */
	{"A", "C", "BC", "no item of the file", 0, NULL, NULL},
	{"A", "AC", "AC", "still there", 0, NULL, NULL},
	{"A", "B", "AC", "not found", 0, NULL, NULL},
	{"AB", "B", "AB", "items in the file already", 0, NULL, NULL},
	{"A", "b", "Ab", "different families", 0, NULL, NULL},
	{"AB", "CD", "ACBC", "another --replace", 1, NULL, NULL},
	{"AB", "CD", "ACAD", "another --replace", 1, NULL, NULL},
	{"AB", "CD", "BDAx", "not found", 1, NULL, NULL},
};

static void test_each_case_is_decided_as_the_table_says(void)
{
	for (unsigned i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct merge_device known[MOST] = {0}, found[MOST] = {0};
		unsigned known_count = list_of(cases[i].known, known);
		unsigned found_count = list_of(cases[i].found, found), wrong, pairs = 0;
		struct merge_pair pair[MOST];
		char text[80], what[40];
		const char *fault;

		for (const char *p = cases[i].pairs; *p; p += 2, pairs++) {
			rom_of(p[0], pair[pairs].old_rom);
			rom_of(p[1], pair[pairs].new_rom);
		}
		snprintf(what, sizeof(what), "case %u: %s, %s, %s", i, cases[i].known,
		         cases[i].found, cases[i].pairs);
		fault = merge_decide(known, known_count, found, found_count, pair, pairs, &wrong);
		TEST_ASSERT_EQUAL_MESSAGE(!cases[i].fault, !fault, what);
		if (cases[i].fault) {
			TEST_ASSERT_NOT_NULL_MESSAGE(strstr(fault, cases[i].fault), what);
			TEST_ASSERT_EQUAL_UINT_MESSAGE(cases[i].wrong, wrong, what);
			continue;
		}
		print(known, known_count, text);
		TEST_ASSERT_EQUAL_STRING_MESSAGE(cases[i].says_known, text, what);
		print(found, found_count, text);
		TEST_ASSERT_EQUAL_STRING_MESSAGE(cases[i].says_found, text, what);
	}
}

static void test_what_is_replaced_knows_by_what(void)
{
	struct merge_device known[2], found[2];
	struct merge_pair pair[2];
	unsigned wrong;

	list_of("AB", known);
	list_of("CD", found);
	for (int i = 0; i < 2; i++) {
		rom_of("AB"[i], pair[i].old_rom);
		rom_of("DC"[i], pair[i].new_rom);
	}
	TEST_ASSERT_NULL(merge_decide(known, 2, found, 2, pair, 2, &wrong));
	for (int i = 0; i < 2; i++) {
		TEST_ASSERT_EQUAL(1 - i, known[i].other);
		TEST_ASSERT_EQUAL(1 - i, found[i].other);
	}
}

/* A server names couplers as it likes: what it says is a path, and no other key or block. */
static void test_a_path_of_a_server_is_one_text_of_the_configuration(void)
{
	static const char path[] = "/system\" Type double } ControlAllow \"* group:users\" "
				   "Item { Name q Path \"/main/28.551DDF030000";
	struct config_report report = {0};
	struct scan_device device;
	struct scan_names names;
	struct config *config;
	struct rio *rio;

	TEST_ASSERT_TRUE(scan_device_of(path, &device));
	scan_names_init(&names, SCAN_PROPERTIES);
	TEST_ASSERT_TRUE(scan_make_items(&names, &device, (struct scan_choice){0}));
	TEST_ASSERT_EQUAL_INT(0, rio_parse("f", edit_empty, strlen(edit_empty), &report, &rio));
	TEST_ASSERT_EQUAL_INT(0, scan_add_items(&rio, &names));
	TEST_ASSERT_EQUAL_INT(0, config_parse("f", rio->text, rio->len, &report, &config));
	TEST_ASSERT_EQUAL_UINT(0, config->allow_count);
	TEST_ASSERT_EQUAL_UINT(names.count, config->item_count);
	TEST_ASSERT_EQUAL_STRING_LEN(path, config->items[0].path, strlen(path));
	config_free(config);
	rio_free(rio);
	scan_names_free(&names);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_case_is_decided_as_the_table_says);
	RUN_TEST(test_what_is_replaced_knows_by_what);
	RUN_TEST(test_a_path_of_a_server_is_one_text_of_the_configuration);
	return UNITY_END();
}
