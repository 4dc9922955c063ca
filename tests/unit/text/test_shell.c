/* SPDX-License-Identifier: MIT */
/* Tests of words for a shell; the judge is the shell itself. */
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/ground/text/shell.h"

static char text[SHELL_WORD];

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_a_word_without_a_character_of_the_shell_stands_as_it_is(void)
{
	static const char *const plain[] = {"/etc/owsd/OWS.rio", "owsd@OWS", "i2c:/dev/i2c-1",
	                                    "A=B"};

	for (size_t i = 0; i < sizeof(plain) / sizeof(plain[0]); i++)
		TEST_ASSERT_EQUAL_PTR(plain[i], shell_word(plain[i], text));
	TEST_ASSERT_EQUAL_STRING("''", shell_word("", text));
	/* in zsh the path of ls */
	TEST_ASSERT_EQUAL_STRING("'=ls'", shell_word("=ls", text));
}

static void test_the_shell_has_each_other_word_as_it_was(void)
{
	static const char *const words[] = {
		"my house.rio", "$(id)",  "`id`;id&", "a|b", "it's", "'",
		"''a''",        "\\x2d",  "~",        "*",   "a\tb", "é",
		"#no",          "!!\"<>", "{a,b}"};
	char command[SHELL_WORD + 20], said[64];

	for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++) {
		FILE *shell;
		size_t len;

		snprintf(command, sizeof(command), "printf %%s %s", shell_word(words[i], text));
		shell = popen(command, "r");
		TEST_ASSERT_NOT_NULL(shell);
		len = fread(said, 1, sizeof(said) - 1, shell);
		said[len] = '\0';
		TEST_ASSERT_EQUAL_INT(0, pclose(shell));
		TEST_ASSERT_EQUAL_STRING(words[i], said);
	}
}

static void test_what_does_not_fit_leaves_no_open_quote(void)
{
	static char word[2 * SHELL_WORD];
	size_t quotes = 0;

	memset(word, '\'', sizeof(word) - 1);
	shell_word(word, text);
	TEST_ASSERT_TRUE(strlen(text) < SHELL_WORD);
	for (const char *at = text; *at; at++)
		quotes += *at == '\'' && (at == text || at[-1] != '\\');
	TEST_ASSERT_EQUAL_INT(0, quotes % 2);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_word_without_a_character_of_the_shell_stands_as_it_is);
	RUN_TEST(test_the_shell_has_each_other_word_as_it_was);
	RUN_TEST(test_what_does_not_fit_leaves_no_open_quote);
	return UNITY_END();
}
