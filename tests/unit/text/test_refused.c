/* SPDX-License-Identifier: MIT */
/* Tests of the words for a refused option. */
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/ground/text/refused.h"

enum { CHECK = 256 };

static const struct option longs[] = {
	{"name", required_argument, NULL, 'n'}, {"board", optional_argument, NULL, 'b'},
	{"check", no_argument, NULL, CHECK},    {"verbose", no_argument, NULL, 'v'},
	{"version", no_argument, NULL, 'V'},    {0},
};

void setUp(void)
{
	optind = 0;
	opterr = 0;
}
void tearDown(void)
{
}

/* What is said of the first word that is refused; "" when none is. */
static const char *said(const char *letters, const char *words)
{
	static char why[64], copy[128];
	char *argv[16] = {copy};
	int argc = 0, c;

	why[0] = '\0';
	optind = 0;
	strcpy(copy, words);
	for (char *word = strtok(copy, " "); word; word = strtok(NULL, " "))
		argv[argc++] = word;
	while ((c = getopt_long(argc, argv, letters, longs, NULL)) != -1)
		if (c == '?' || c == ':') {
			refused_option(c, longs, argv, why, sizeof(why));
			break;
		}
	return why;
}

static void test_an_option_is_refused_by_the_name_that_was_typed(void)
{
	static const char *const cases[][2] = {
		{"x --check --name=a -n b --board --board=1 -vV --verb", ""},
		{"x --version=3", "--version takes no value: --version=3"},
		{"x --check=", "--check takes no value: --check="},
		{"x --verb=3", "--verbose takes no value: --verb=3"},
		{"x a --name", "option without its argument: --name"},
		{"x a -n", "option without its argument: -n"},
		{"x --check -vn", "option without its argument: -n"},
		{"x --colour=3", "unknown option: --colour=3"},
		{"x -q", "unknown option: -q"},
		{"x --version -vqn", "unknown option: -q"},
		{"x --name=a -qv", "unknown option: -q"},
		{"x -:", "unknown option: -:"},
		{"x -v-", "unknown option: --"},
		{"x --ver", "--ver may be --verbose or --version"},
		{"x --ver=1", "--ver=1 may be --verbose or --version"},
		{"x -\xc3\xa4", "unknown option: - and the byte 0xC3"},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		TEST_ASSERT_EQUAL_STRING_MESSAGE(cases[i][1], said(":n:b::vV", cases[i][0]),
		                                 cases[i][0]);
		TEST_ASSERT_EQUAL_STRING_MESSAGE(
			cases[i][1][0] && strstr(cases[i][0], " a ") ? "" : cases[i][1],
			said("+:n:b::vV", cases[i][0]), cases[i][0]);
	}
}

static void test_a_long_word_is_cut(void)
{
	char words[100] = "x --ver=";

	memset(words + strlen(words), 'y', 80);
	TEST_ASSERT_EQUAL_STRING_LEN("unknown option: --ver=yyyy", said(":", words), 26);
	TEST_ASSERT_EQUAL_size_t(63, strlen(said(":", words)));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_option_is_refused_by_the_name_that_was_typed);
	RUN_TEST(test_a_long_word_is_cut);
	return UNITY_END();
}
