/* SPDX-License-Identifier: MIT */
/* owsd.sim(5) lists every simulated chip, and every option of one, in its table of families. */
#include <stdio.h>
#include <string.h>

#include "hal/sim/slave.h"
#include "unity.h"

static char page[65536], *families;

void setUp(void)
{
	FILE *file = fopen("docs/owsd.sim.5", "r");
	size_t n = 0;
	int c;

	TEST_ASSERT_NOT_NULL_MESSAGE(file, "run this from the top of the source");
	while ((c = fgetc(file)) != EOF && n < sizeof(page) - 1) {
		if (c != '\\')
			page[n++] = (char)c;
		else if ((c = fgetc(file)) == 'f')
			fgetc(file); /* a font */
		else
			page[n++] = (char)c;
	}
	page[n] = '\0';
	fclose(file);
	families = strstr(page, "\n.SS Families\n");
	TEST_ASSERT_NOT_NULL(families);
	TEST_ASSERT_NOT_NULL(strstr(families, "\n.fi\n"));
	*strstr(families, "\n.fi\n") = '\0';
}

void tearDown(void)
{
}

static bool is_of_a_word(char c)
{
	return c && strchr("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-", c);
}

static void named(const char *name)
{
	const char *at = families;

	while ((at = strstr(at, name))) {
		if (!is_of_a_word(at[strlen(name)]) && !is_of_a_word(at[-1]))
			return;
		at++;
	}
	TEST_FAIL_MESSAGE(name);
}

static void test_each_chip_and_each_option_is_in_the_table(void)
{
	unsigned chips = 0;

	for (; sim_families[chips]; chips++) {
		const struct sim_option *option = sim_families[chips]->options;

		named(sim_families[chips]->name);
		for (; option && option->name; option++)
			named(option->name);
	}
	TEST_ASSERT_GREATER_THAN(90, chips);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_chip_and_each_option_is_in_the_table);
	return UNITY_END();
}
