/* SPDX-License-Identifier: MIT */
/* Tests of Others of the Web block. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/config/edit/print.h"
#include "src/config/read/load.h"
#include "src/config/read/others.h"
#include "tests/unit/aid/config_case.h"

static struct other_place place;

void setUp(void)
{
	config_case_begin();
}

void tearDown(void)
{
	config_case_end();
}

static const char *parse_other(const char *text)
{
	return other_parse(text, strlen(text), &place);
}

static void expect(const char *text, const char *host, const char *port, const char *path,
                   const char *page)
{
	const char *why = parse_other(text);

	TEST_ASSERT_NULL_MESSAGE(why, text);
	TEST_ASSERT_EQUAL_STRING("boiler", place.name);
	TEST_ASSERT_EQUAL_STRING(host, place.host);
	TEST_ASSERT_EQUAL_STRING(port, place.port);
	TEST_ASSERT_EQUAL_STRING(path, place.path);
	TEST_ASSERT_EQUAL_STRING(page, place.page);
}

static void test_an_address_is_also_the_page_unless_another_is_named(void)
{
	expect("boiler http://pi2.local:8040", "pi2.local", "8040", "/", "http://pi2.local:8040");
	expect("boiler http://10.0.0.7/owsd", "10.0.0.7", "80", "/owsd/", "http://10.0.0.7/owsd");
	expect("boiler \t http://[fd00::7]:8040/a/", "fd00::7", "8040", "/a/",
	       "http://[fd00::7]:8040/a/");
	expect("boiler http://127.0.0.1:8443/ https://pi2.example/owsd/", "127.0.0.1", "8443", "/",
	       "https://pi2.example/owsd/");
	expect("boiler /run/owsd/B.web", "/run/owsd/B.web", "", "/", "");
	expect("boiler /run/owsd/B.web https://a/b/", "/run/owsd/B.web", "", "/", "https://a/b/");
}

static void test_what_is_no_address_is_refused(void)
{
	static const char *const wrong[] = {
		"",
		"boiler",
		"boiler http://a http://b http://c",
		"boiler pi2.local:8040",
		"boiler ftp://a",
		"boiler http://",
		"boiler http://:80",
		"boiler http://a:0",
		"boiler http://a:65536",
		"boiler http://a:80b",
		"boiler http://a:",
		"boiler http://user@a/",
		"boiler http://a/b?c=d",
		"boiler http://a/b\r\nX:y",
		"boiler http://[fd00::7",
		"boiler http://[fd00::7]8040",
		"boiler http://[a]:80",
		"boiler /run/owsd/B",
		"boiler .web",
		"boiler /run/B.web javascript:alert(1)",
		"boiler /run/B.web //other",
		"boi\xffler http://a",
		"boi\xe2\x80\xaeler http://a",
	};

	for (size_t i = 0; i < COUNT(wrong); i++)
		TEST_ASSERT_NOT_NULL_MESSAGE(parse_other(wrong[i]), wrong[i]);
	TEST_ASSERT_NOT_NULL(strstr(parse_other("boiler https://a"), "ssh -L"));
}

static void test_what_is_too_long_is_refused(void)
{
	char text[700];

	for (size_t len = 50; len < 600; len += 50) {
		memset(text, 'a', sizeof(text));
		memcpy(text, "boiler http://", 14);
		text[len] = '\0';
		TEST_ASSERT_EQUAL_INT(len > 255, parse_other(text) != NULL);
		memcpy(text, "boiler /", 8);
		memcpy(text + len - 4, ".web", 4);
		TEST_ASSERT_EQUAL_INT(len - 7 > 107, parse_other(text) != NULL);
		memset(text, 'a', len);
		memcpy(text + len - 9, " http://a", 9);
		TEST_ASSERT_EQUAL_INT(len - 9 > 63, parse_other(text) != NULL);
	}
}

static void test_a_list_is_read_and_printed_so_that_it_reads_the_same(void)
{
	static const char list[] = "boiler http://pi2:8040, attic /run/owsd/B.web";
	const char *text = list, *why;
	size_t len;
	char *printed;
	FILE *out = open_memstream(&printed, &len);

	TEST_ASSERT_NOT_NULL(out);
	TEST_ASSERT_EQUAL_INT(
		0,
		parse_driver("Web { Others \"boiler http://pi2:8040, attic /run/owsd/B.web\" }"));
	config_print(config, out);
	TEST_ASSERT_EQUAL_INT(0, fclose(out));
	config_free(config);
	config = NULL;
	TEST_ASSERT_EQUAL_INT(0, parse(printed));
	free(printed);
	TEST_ASSERT_EQUAL_STRING(list, config->web.others);
	TEST_ASSERT_TRUE(other_next(&text, &place, &why));
	TEST_ASSERT_EQUAL_STRING("boiler", place.name);
	TEST_ASSERT_TRUE(other_next(&text, &place, &why));
	TEST_ASSERT_EQUAL_STRING("attic", place.name);
	TEST_ASSERT_FALSE(other_next(&text, &place, &why));
}

static void test_each_wrong_machine_of_the_list_is_named(void)
{
	static const struct line blocks[] = {
		{"Web { Others \"a http://a, b b\" }",
	         "f:2:14: error: Others \"b b\": expected http://HOST:PORT/ or the socket of an "
	         "owsd-web\n"},
		{"Web { Others \"a http://a, b http://b, a http://c\" }",
	         "f:2:14: error: Others \"a http://c\": a machine before it has that name\n"},
		{"Web { Others \"a http://a,\" }",
	         "f:2:14: error: Others \"\": expected NAME ADDRESS, or NAME ADDRESS PAGE\n"},
	};

	expect_errors(blocks, COUNT(blocks), parse_driver);
}

static void test_there_may_be_32_machines(void)
{
	char text[2000];
	size_t len;

	for (int most = OTHERS_MAX; most <= OTHERS_MAX + 1; most++) {
		len = (size_t)snprintf(text, sizeof(text), "Web { Others \"");
		for (int i = 0; i < most; i++)
			len += (size_t)snprintf(text + len, sizeof(text) - len, "%sm%d http://m%d",
			                        i ? ", " : "", i, i);
		snprintf(text + len, sizeof(text) - len, "\" }");
		if (most == OTHERS_MAX)
			TEST_ASSERT_EQUAL_INT(0, parse_driver(text));
		else
			TEST_ASSERT_NOT_EQUAL_INT(0, parse_driver(text));
		config_free(config);
		config = NULL;
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_address_is_also_the_page_unless_another_is_named);
	RUN_TEST(test_what_is_no_address_is_refused);
	RUN_TEST(test_what_is_too_long_is_refused);
	RUN_TEST(test_a_list_is_read_and_printed_so_that_it_reads_the_same);
	RUN_TEST(test_each_wrong_machine_of_the_list_is_named);
	RUN_TEST(test_there_may_be_32_machines);
	return UNITY_END();
}
