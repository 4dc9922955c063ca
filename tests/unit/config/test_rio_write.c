/* SPDX-License-Identifier: MIT */
/* Tests of changes in the text of a .rio document. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/config/edit/rio_write.h"
#include "tests/unit/aid/rio_case.h"

void setUp(void)
{
	rio_case_begin();
}

void tearDown(void)
{
	rio_case_end();
}

static void expect_text(const char *text)
{
	TEST_ASSERT_EQUAL_size_t(strlen(text), rio->len);
	TEST_ASSERT_EQUAL_STRING(text, rio->text);
}

static void test_a_changed_value_changes_nothing_else(void)
{
	struct rio_node *a = rio_child(
		rio_case_parse("# top\r\nA {\r\n\tX   1  # one\r\n  Y \"two\"\r\n}"), "A");

	TEST_ASSERT_EQUAL_INT(0, rio_set(&rio, a, "X", "22"));
	TEST_ASSERT_EQUAL_INT(0, rio_set(&rio, rio_child(&rio->root, "A"), "Y", "\"2\""));
	expect_text("# top\r\nA {\r\n\tX   22  # one\r\n  Y \"2\"\r\n}");
}

static void test_a_value_that_touches_its_key_does_not_become_a_part_of_it(void)
{
	rio_case_parse("A { X=1 Y\"2\" }");
	TEST_ASSERT_EQUAL_INT(0, rio_set(&rio, rio_child(&rio->root, "A"), "X", "22"));
	TEST_ASSERT_EQUAL_INT(0, rio_set(&rio, rio_child(&rio->root, "A"), "Y", "3"));
	expect_text("A { X 22 Y 3 }");
	rio_case_expect(rio_child(&rio->root, "A"), "X", RIO_WORD, "22");
}

static void test_a_new_key_goes_behind_the_values_with_their_indent_and_line_end(void)
{
	struct rio_node *a = rio_child(
		rio_case_parse("A {\r\n   X 1 # one\r\n   B { Z 1 }\r\n}\r\n"), "A");

	TEST_ASSERT_EQUAL_INT(0, rio_set(&rio, a, "New", "7"));
	expect_text("A {\r\n   X 1 # one\r\n   New                     7\r\n   B { Z 1 }\r\n}\r\n");
	TEST_ASSERT_EQUAL_INT(0,
	                      rio_set(&rio, rio_child(rio_child(&rio->root, "A"), "B"), "Q", "2"));
	expect_text("A {\r\n   X 1 # one\r\n   New                     7\r\n"
	            "   B { Z 1 Q                       2 }\r\n}\r\n");
}

static void test_an_empty_block_opens_for_its_first_key(void)
{
	static const char *const empty[] = {"A { }", "A {\n}", "A {}"};

	for (size_t i = 0; i < sizeof(empty) / sizeof(empty[0]); i++) {
		struct rio_node *a = rio_child(rio_case_parse(empty[i]), "A");

		TEST_ASSERT_EQUAL_INT(0, rio_set(&rio, a, "K", "1"));
		rio_case_expect(rio_child(&rio->root, "A"), "K", RIO_WORD, "1");
		TEST_ASSERT_EQUAL_CHAR('}', rio->text[rio->len - 1]);
		TEST_ASSERT_EQUAL_CHAR('\n', rio->text[rio->len - 2]);
	}
}

static void test_a_key_added_behind_a_block_whose_end_shares_its_line_stays_inside(void)
{
	struct rio_node *a = rio_child(rio_case_parse("A {\n  X 1 }"), "A");

	TEST_ASSERT_EQUAL_INT(0, rio_set(&rio, a, "Y", "2"));
	rio_case_expect(rio_child(&rio->root, "A"), "Y", RIO_WORD, "2");
	TEST_ASSERT_NULL(rio_child(&rio->root, "Y"));
}

static void test_a_removed_block_takes_its_lines_along_and_leaves_comments(void)
{
	struct rio_node *root = rio_case_parse(
		"A {\n  # first\n  B {\n    X 1\n  }\n  # second\n  C { Y 2 }\n}\n");
	struct rio_node *a = rio_child(root, "A");

	TEST_ASSERT_EQUAL_INT(0, rio_remove(&rio, rio_child(a, "B")));
	expect_text("A {\n  # first\n  # second\n  C { Y 2 }\n}\n");
	a = rio_child(&rio->root, "A");
	TEST_ASSERT_EQUAL_INT(0, rio_remove(&rio, rio_child(a, "C")->first));
	expect_text("A {\n  # first\n  # second\n  C { }\n}\n");
}

static void test_strings_are_wrapped_only_when_long_and_read_back(void)
{
	char text[1000], *quoted;
	uint32_t state = 12345;

	quoted = rio_quote("12345678901234567890123456789012345678901234567890");
	TEST_ASSERT_NULL(strchr(quoted, '\n'));
	free(quoted);
	quoted = rio_quote("123456789012345678901234567890123456789012345678901");
	TEST_ASSERT_EQUAL_STRING("\"12345678901234567890123456789012345678901234567890\"\n\"1\"",
	                         quoted);
	free(quoted);
	for (size_t len = 0; len < 300; len++) {
		char document[2000];

		for (size_t i = 0; i < len; i++) {
			state = state * 1664525 + 1013904223;
			text[i] = "ab\"\\ #{}/.="[(state >> 16) % 11];
		}
		text[len] = '\0';
		quoted = rio_quote(text);
		snprintf(document, sizeof(document), "K %s", quoted);
		rio_case_expect(rio_case_parse(document), "K", RIO_STRING, text);
		free(quoted);
	}
}

static void test_a_character_of_several_bytes_is_not_cut_by_wrapping(void)
{
	char text[100];
	char *quoted, *end;

	memset(text, 'x', sizeof(text));
	memcpy(text + 49, "\xe2\x82\xac", 4);
	quoted = rio_quote(text);
	end = strchr(quoted, '\n');
	TEST_ASSERT_NULL(end);
	free(quoted);
	memcpy(text + 49,
	       "\xe2\x82\xac"
	       "y",
	       5);
	quoted = rio_quote(text);
	TEST_ASSERT_NOT_NULL(strstr(quoted, "\xe2\x82\xac\"\n\"y\""));
	free(quoted);
}

/* The only block's keys and values, a line each, but for those of one key. */
static void list(const struct rio *from, const char *without, char *to, size_t size)
{
	size_t used = 0;

	*to = '\0';
	for (const struct rio_node *node = from->root.first->first; node; node = node->next)
		if (!without || strcmp(node->key, without))
			used += (size_t)snprintf(
				to + used, size - used, "%s %d %s\n", node->key, node->kind,
				node->kind == RIO_BLOCK && node->first ? node->first->key
								       : node->value);
	TEST_ASSERT_LESS_THAN_size_t(size, used);
}

static struct rio *parse_silently(const char *text, size_t len)
{
	struct config_report silent = {0};
	struct rio *made;

	TEST_ASSERT_EQUAL_INT(0, rio_parse("f", text, len, &silent, &made));
	if (!silent.errors)
		return made;
	rio_free(made);
	return NULL;
}

/* Text edited, with what the edit is about left out of the look, says what it said before. */
static bool check_edit(const char *text, const char *key, const char *value)
{
	struct rio *made = parse_silently(text, strlen(text)), *again;
	struct rio_node *block;
	char before[300], after[300];

	if (!made)
		return false;
	block = made->root.first;
	list(made, key, before, sizeof(before));
	if (value)
		TEST_ASSERT_EQUAL_INT(0, rio_set(&made, block, key, value));
	else
		TEST_ASSERT_EQUAL_INT(0, rio_remove(&made, rio_child(block, key)));
	again = parse_silently(made->text, made->len);
	TEST_ASSERT_NOT_NULL_MESSAGE(again, text);
	list(again, key, after, sizeof(after));
	TEST_ASSERT_EQUAL_STRING_MESSAGE(before, after, text);
	TEST_ASSERT_EQUAL_MESSAGE(value != NULL, rio_child(again->root.first, key) != NULL, text);
	rio_free(again);
	rio_free(made);
	return true;
}

static void test_an_edit_leaves_every_neighbour_whatever_stands_between_them(void)
{
	static const char *const nodes[] = {" 1", "\"1\"", "[1]", "{}", "{ X 1}"},
				 *const edges[] = {"", " ", "\n  "},
				 *const gaps[] = {"",      " ",    "\t ",      "\n",
	                                          " \n  ", "#c\n", " # \"c\n", "\r"};
	static const unsigned choices[] = {5, 5, 5, 3, 8, 8, 3};
	unsigned checked = 0;
	char text[200];

	for (unsigned i = 0; i < 5 * 5 * 5 * 3 * 8 * 8 * 3; i++) {
		unsigned left = i, part[7];

		for (int k = 0; k < 7; left /= choices[k++])
			part[k] = left % choices[k];
		snprintf(text, sizeof(text), "A {%sP%s%sM%s%sN%s%s}", edges[part[3]],
		         nodes[part[0]], gaps[part[4]], nodes[part[1]], gaps[part[5]],
		         nodes[part[2]], edges[part[6]]);
		if (!check_edit(text, "M", NULL))
			continue;
		check_edit(text, "P", NULL);
		check_edit(text, "N", NULL);
		check_edit(text, "New", "7");
		check_edit(text, "New", "\"7\"");
		if (part[1] < 3)
			check_edit(text, "M", part[1] ? "\"7\"" : "7");
		checked++;
	}
	TEST_ASSERT_GREATER_THAN_UINT(50000, checked);
}

static struct rio_node *nth(const char *key, int n)
{
	struct rio_node *node = rio_child(rio_child(&rio->root, "A"), key);

	while (n-- > 0)
		node = rio_next(node);
	return node;
}

static void test_a_block_is_moved_with_its_comments_byte_for_byte(void)
{
	static const char first[] = "\t# one\n  # and more\r\n  I { X 0x1 } # mine\r\n";
	static const char second[] = "  I {\n\tX 2\r  }\n", third[] = "I { X 3 }\n";
	static const char head[] = "A {\r\n  K 1 # K\n\n", tail[] = "  # end\n}\n";
	const char *const parts[] = {first, second, third};
	static const struct {
		int node, other;
		bool behind;
		const char *order;
	} moves[] = {
		{0, 1, true, "102"},  {0, 2, true, "120"},  {2, 0, false, "201"},
		{2, 1, false, "021"}, {1, 0, false, "102"}, {1, 2, true, "021"},
		{0, 1, false, "012"}, {1, 1, true, "012"},  {1, 0, true, "012"},
		{2, 0, true, "021"},  {0, 2, false, "102"},
	};
	char text[512];

	for (unsigned i = 0; i < sizeof(moves) / sizeof(moves[0]); i++) {
		snprintf(text, sizeof(text), "%s%s%s%s%s", head, first, second, third, tail);
		rio_case_parse(text);
		TEST_ASSERT_EQUAL_INT(0, rio_move(&rio, nth("I", moves[i].node),
		                                  nth("I", moves[i].other), moves[i].behind));
		snprintf(text, sizeof(text), "%s%s%s%s%s", head, parts[moves[i].order[0] - '0'],
		         parts[moves[i].order[1] - '0'], parts[moves[i].order[2] - '0'], tail);
		expect_text(text);
	}
}

static void test_what_shares_its_line_is_not_moved(void)
{
	static const char *const texts[] = {
		"A { I { X 1 }\n I { X 2 }\n}\n",
		"A {\n I { X 1 } I { X 2 }\n}\n",
		"A {\n I { X 1 }\n I { X 2 } }",
	};

	for (unsigned i = 0; i < sizeof(texts) / sizeof(texts[0]); i++) {
		rio_case_parse(texts[i]);
		TEST_ASSERT_EQUAL_INT(-EINVAL, rio_move(&rio, nth("I", 0), nth("I", 1), true));
		TEST_ASSERT_EQUAL_INT(-EINVAL, rio_move(&rio, nth("I", 1), nth("I", 0), false));
		expect_text(texts[i]);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_changed_value_changes_nothing_else);
	RUN_TEST(test_a_value_that_touches_its_key_does_not_become_a_part_of_it);
	RUN_TEST(test_a_new_key_goes_behind_the_values_with_their_indent_and_line_end);
	RUN_TEST(test_an_empty_block_opens_for_its_first_key);
	RUN_TEST(test_a_key_added_behind_a_block_whose_end_shares_its_line_stays_inside);
	RUN_TEST(test_a_removed_block_takes_its_lines_along_and_leaves_comments);
	RUN_TEST(test_strings_are_wrapped_only_when_long_and_read_back);
	RUN_TEST(test_a_character_of_several_bytes_is_not_cut_by_wrapping);
	RUN_TEST(test_a_block_is_moved_with_its_comments_byte_for_byte);
	RUN_TEST(test_what_shares_its_line_is_not_moved);
	RUN_TEST(test_an_edit_leaves_every_neighbour_whatever_stands_between_them);
	return UNITY_END();
}
