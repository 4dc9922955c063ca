/* SPDX-License-Identifier: MIT */
/* Tests of the reader of .rio documents. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "unity.h"

#include "src/config/edit/rio_write.h"
#include "src/config/read/rio.h"
#include "src/config/read/rio_file.h"
#include "tests/unit/aid/rio_case.h"

void setUp(void)
{
	rio_case_begin();
}

void tearDown(void)
{
	rio_case_end();
}

static void parse_bytes(const char *text, size_t len)
{
	rio_free(rio);
	TEST_ASSERT_EQUAL_INT(0, rio_parse("f", text, len, &report, &rio));
}

static void test_values_of_every_kind_are_read(void)
{
	struct rio_node *root = rio_case_parse(
		"A { W 0x0118\n N -4.7 S \"a b\" L [ 0 \"]\" 0 ]\n E \"\" B { } }");
	struct rio_node *a = rio_child(root, "A");

	rio_case_expect(root, "A", RIO_BLOCK, "");
	rio_case_expect(a, "W", RIO_WORD, "0x0118");
	rio_case_expect(a, "N", RIO_WORD, "-4.7");
	rio_case_expect(a, "S", RIO_STRING, "a b");
	rio_case_expect(a, "L", RIO_LIST, "[ 0 \"]\" 0 ]");
	rio_case_expect(a, "E", RIO_STRING, "");
	rio_case_expect(a, "B", RIO_BLOCK, "");
	TEST_ASSERT_NULL(rio_child(a, "C"));
	TEST_ASSERT_EQUAL_PTR(a, a->first->parent);
}

static void test_adjacent_strings_are_one(void)
{
	struct rio_node *root = rio_case_parse(
		"P \"abc\"\n\"def\" \"ghi\"\n# no part\n\"jkl\"\nQ \"x\"");

	rio_case_expect(root, "P", RIO_STRING, "abcdefghijkl");
	rio_case_expect(root, "Q", RIO_STRING, "x");
	TEST_ASSERT_EQUAL_INT(5, rio_child(root, "Q")->at.line);
}

static void test_a_string_may_begin_in_the_line_behind_its_key(void)
{
	rio_case_expect(rio_case_parse("P\n  \"abc\"\n"), "P", RIO_STRING, "abc");
}

static void test_backslashes_escape_quotes_and_themselves_only(void)
{
	rio_case_expect(rio_case_parse("P \"a\\\"b\\\\c\\n\""), "P", RIO_STRING, "a\"b\\c\\n");
}

static void test_comments_and_commented_keys_are_skipped(void)
{
	struct rio_node *root = rio_case_parse(
		"#Comment1 \"not { this\"\n#\"continued\"\n#GUID 7dbe\n"
		"A { # behind {\n  X \"#\" # no comment in a string\n#}\n}\n#");

	rio_case_expect(rio_child(root, "A"), "X", RIO_STRING, "#");
	TEST_ASSERT_NULL(root->first->next);
}

static void test_lines_and_columns_are_those_of_an_editor(void)
{
	struct rio_node *root = rio_case_parse("A {\r\n\tKey \"\xc3\xa4\"  Next 1 }\r\n");
	struct rio_node *a = rio_child(root, "A");

	TEST_ASSERT_EQUAL_INT(1, a->at.line);
	TEST_ASSERT_EQUAL_INT(3, a->value_at.column);
	TEST_ASSERT_EQUAL_INT(2, a->first->at.line);
	TEST_ASSERT_EQUAL_INT(2, a->first->at.column);
	TEST_ASSERT_EQUAL_INT(6, a->first->value_at.column);
	TEST_ASSERT_EQUAL_INT(11, a->last->at.column);
	TEST_ASSERT_EQUAL_INT(16, a->last->value_at.column);
}

static void test_a_line_ends_with_lf_or_crlf_or_cr(void)
{
	static const struct {
		const char *text, *line_end;
	} cases[] = {
		{"# x\nA [ 1\n2 ] # y\nB \"1\"\n\n\"2\"\nC 3", "\n"},
		{"# x\r\nA [ 1\r\n2 ] # y\r\nB \"1\"\r\n\r\n\"2\"\r\nC 3", "\r\n"},
		{"# x\rA [ 1\r2 ] # y\rB \"1\"\r\r\"2\"\rC 3", "\r"},
		{"# x\rA [ 1\r\n2 ] # y\nB \"1\"\r\r\"2\"\r\nC 3", "\r"},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct rio_node *root = rio_case_parse(cases[i].text);

		TEST_ASSERT_EQUAL_STRING(cases[i].line_end, rio->line_end);
		TEST_ASSERT_EQUAL_INT(2, root->first->at.line);
		TEST_ASSERT_EQUAL_INT(4, rio_child(root, "B")->at.line);
		rio_case_expect(root, "B", RIO_STRING, "12");
		TEST_ASSERT_EQUAL_INT(7, rio_child(root, "C")->at.line);
		TEST_ASSERT_EQUAL_INT(3, rio_child(root, "C")->value_at.column);
	}
	TEST_ASSERT_EQUAL_STRING("\n", (rio_case_parse("A 1"), rio->line_end));
}

static void test_a_byte_order_mark_is_no_part_of_the_first_key(void)
{
	struct rio_node *root = rio_case_parse("\xef\xbb\xbf"
	                                       "A 1");

	rio_case_expect(root, "A", RIO_WORD, "1");
	TEST_ASSERT_EQUAL_INT(1, root->first->at.column);
	TEST_ASSERT_EQUAL_size_t(3, root->first->begin);
}

static void test_empty_texts_are_documents_without_keys(void)
{
	TEST_ASSERT_NULL(rio_case_parse("")->first);
	TEST_ASSERT_NULL(rio_case_parse("\n\r\n \t# x")->first);
}

static void test_syntax_errors_say_place_and_expectation(void)
{
	static const struct {
		const char *text, *said;
	} cases[] = {
		{"A {", "f:1:4: error: expected '}' to end A of line 1\n"},
		{"A {\n B {\n }\n", "f:4:1: error: expected '}' to end A of line 1\n"},
		{"A { } }", "f:1:7: error: expected a key, found '}'\n"},
		{"A {\n  Key\n  B 1\n}", "f:2:6: error: expected a value after Key\n"},
		{"A { Key }", "f:1:8: error: expected a value after Key\n"},
		{"Key", "f:1:4: error: expected a value after Key\n"},
		{"Key \"abc\nB 1",
	         "f:1:5: error: expected '\"' at the end of the string, found the end "
	         "of the line\n"},
		{"Key \"abc",
	         "f:1:5: error: expected '\"' at the end of the string, found the end of "
	         "the file\n"},
		{"Key [ 1 2 }", "f:1:5: error: expected ']' at the end of the list\n"
	                        "f:1:11: error: expected a key, found '}'\n"},
		{"{ A 1 }", "f:1:1: error: expected a key before '{'\n"},
		{"A { B 1 2 }", "f:1:9: error: expected a key or '}', found '2'\n"
	                        "f:1:12: error: expected '}' to end A of line 1\n"},
		{"A { \"x\" }\n}", "f:1:5: error: expected a key or '}', found '\"'\n"},
		{"A 1 \x0b", "f:1:5: error: expected a key, found the byte 0x0B\n"},
		{"# a\rA 1\r\r\nB\r", "f:4:2: error: expected a value after B\n"},
		{"\xc3\xa4 1", "f:1:1: error: expected a key\n"},
		{"A \"x\x01y\x02\"",
	         "f:1:5: error: a control character (byte 0x01) is not allowed\n"},
		{"A \"x\"\nB \"y\nC 1\nD \"z\n",
	         "f:2:3: error: expected '\"' at the end of the string, found the end of the line\n"
	         "f:4:3: error: expected '\"' at the end of the string, found the end of the line\n"},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		said[0] = '\0';
		report.errors = 0;
		parse_bytes(cases[i].text, strlen(cases[i].text));
		TEST_ASSERT_EQUAL_STRING_MESSAGE(cases[i].said, said, cases[i].text);
		TEST_ASSERT_TRUE(report.errors > 0);
	}
}

static void test_a_nul_byte_is_refused_wherever_it_is(void)
{
	static const char texts[][12] = {"A\0 1", "A 1\0",   "A \"\0\"",
	                                 "\0A 1", "A [\0 ]", "A {\0}"};

	for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++) {
		unsigned before = report.errors;

		parse_bytes(texts[i], sizeof(texts[i]));
		TEST_ASSERT_TRUE(report.errors > before);
	}
}

static void test_limits_are_refused_plainly(void)
{
	char deep[3 * (RIO_DEPTH_MAX + 2) + 1] = "", longer[RIO_VALUE_MAX + 100];

	for (int i = 0; i < RIO_DEPTH_MAX + 2; i++)
		strcat(deep, "A {");
	parse_bytes(deep, strlen(deep));
	TEST_ASSERT_EQUAL_STRING("f:1:51: error: blocks are nested deeper than 16\n", said);
	said[0] = '\0';
	memset(longer, 'x', sizeof(longer));
	parse_bytes(longer, sizeof(longer));
	TEST_ASSERT_NOT_NULL(strstr(said, "f:1:1: error: the key is longer than 63 bytes\n"));
	said[0] = '\0';
	memcpy(longer, "K ", 2);
	parse_bytes(longer, sizeof(longer));
	TEST_ASSERT_EQUAL_STRING("f:1:3: error: the value of K is longer than 4096 bytes\n", said);
	parse_bytes(longer, RIO_VALUE_MAX + 2);
	TEST_ASSERT_EQUAL_size_t(RIO_VALUE_MAX, strlen(rio->root.first->value));
}

static void test_a_text_beyond_the_size_limit_is_refused_unread(void)
{
	struct rio *none;

	TEST_ASSERT_EQUAL_INT(-EFBIG, rio_parse("f", "", (size_t)RIO_FILE_MAX + 1, &report, &none));
	TEST_ASSERT_EQUAL_STRING("f: error: longer than 16777216 bytes\n", said);
	TEST_ASSERT_NULL(none);
}

static void test_errors_are_reported_fifty_at_most_and_all_counted(void)
{
	char text[401];
	unsigned lines = 0;

	for (int i = 0; i < 200; i++)
		memcpy(text + 2 * i, "}\n", 2);
	parse_bytes(text, 400);
	for (const char *p = said; *p; p++)
		lines += *p == '\n';
	TEST_ASSERT_EQUAL_UINT(200, report.errors);
	TEST_ASSERT_EQUAL_UINT(REPORT_MAX + 1, lines);
	TEST_ASSERT_NOT_NULL(
		strstr(said, "f:51:1: error: more than 50 errors, the rest is not shown"));
}

static void test_files_of_genuine_shape_come_back_byte_for_byte(void)
{
	static const char *const files[] = {
		"tests/unit/data/relay_and_inputs.rio", "tests/unit/data/one_thermometer.rio",
		"tests/unit/data/four_thermometers.rio", "tests/unit/data/light_and_humidity.rio"};

	for (size_t i = 0; i < sizeof(files) / sizeof(files[0]); i++) {
		struct rio_node *driver, *version;
		char *text;
		size_t len;

		TEST_ASSERT_EQUAL_INT(0, rio_read(files[i], &report, &text, &len));
		parse_bytes(text, len);
		TEST_ASSERT_EQUAL_STRING("", said);
		TEST_ASSERT_EQUAL_size_t(len, rio->len);
		TEST_ASSERT_EQUAL_MEMORY(text, rio->text, len);
		/* an edit that sets what is there changes nothing either */
		driver = rio_child(&rio->root, "OwsDrv");
		version = rio_child(driver, "Version");
		TEST_ASSERT_EQUAL_STRING("1.00", version->value);
		TEST_ASSERT_EQUAL_INT(0, rio_set(&rio, driver, "Version", "1.00"));
		TEST_ASSERT_EQUAL_size_t(len, rio->len);
		TEST_ASSERT_EQUAL_MEMORY(text, rio->text, len);
		free(text);
	}
}

static void test_a_file_of_utf_16_is_refused_as_such(void)
{
	static const char texts[][4] = {{'\xff', '\xfe', 'O', '\0'},
	                                {'\xfe', '\xff', '\0', 'O'},
	                                {'O', '\0', 'w', '\0'},
	                                {'\0', 'O', '\0', 'w'}};
	char path[] = "/tmp/owsd-utf16-XXXXXX", *text;
	int fd = mkstemp(path);
	size_t len;

	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, fd);
	for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++) {
		said[0] = '\0';
		TEST_ASSERT_EQUAL_INT(4, pwrite(fd, texts[i], 4, 0));
		TEST_ASSERT_EQUAL_INT(-EILSEQ, rio_read(path, &report, &text, &len));
		TEST_ASSERT_NULL(text);
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(said, "is UTF-16: save it as UTF-8"), said);
	}
	close(fd);
	unlink(path);
}

static void test_a_file_that_cannot_be_read_is_said(void)
{
	size_t len;
	char *text;

	TEST_ASSERT_EQUAL_INT(-ENOENT, rio_read("tests/unit/data/none.rio", &report, &text, &len));
	TEST_ASSERT_EQUAL_STRING(
		"tests/unit/data/none.rio: error: cannot be read: No such file or directory\n",
		said);
	TEST_ASSERT_NULL(text);
}

static void test_only_a_regular_file_of_a_size_is_read_at_all(void)
{
	char path[] = "/tmp/test_rio.XXXXXX", pipe[40];
	struct sockaddr_un at = {.sun_family = AF_UNIX};
	int fd = mkstemp(path), local = socket(AF_UNIX, SOCK_STREAM, 0);
	const struct {
		const char *file, *said;
		int err;
	} cases[] = {
		{"", "error: the name of the configuration is empty\n", -EINVAL},
		{"tests/unit", "tests/unit: error: is a directory: only a regular file is read\n",
	         -EINVAL},
		{"/dev/zero", "/dev/zero: error: is a device: only a regular file is read\n",
	         -EINVAL},
		{"/dev/null", "/dev/null: error: is a device: only a regular file is read\n",
	         -EINVAL},
		{pipe, ": error: is a pipe: only a regular file is read\n", -EINVAL},
		{at.sun_path, ": error: is a socket: only a regular file is read\n", -EINVAL},
		{path, ": error: longer than 16777216 bytes\n", -EFBIG},
	};
	size_t len;
	char *text;

	snprintf(pipe, sizeof(pipe), "%s.pipe", path);
	snprintf(at.sun_path, sizeof(at.sun_path), "%s.socket", path);
	TEST_ASSERT_EQUAL_INT(0, mkfifo(pipe, 0600));
	TEST_ASSERT_EQUAL_INT(0, bind(local, (void *)&at, sizeof(at)));
	TEST_ASSERT_EQUAL_INT(0, ftruncate(fd, (off_t)RIO_FILE_MAX + 1));
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		said[0] = '\0';
		TEST_ASSERT_EQUAL_INT(cases[i].err, rio_read(cases[i].file, &report, &text, &len));
		TEST_ASSERT_NULL(text);
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(said, cases[i].said), said);
	}
	close(local);
	close(fd);
	unlink(path);
	unlink(pipe);
	unlink(at.sun_path);
}

static void test_random_bytes_are_survived(void)
{
	static const char alphabet[] =
		"{}[]\"\"##\\ \n\n\r\tAbc01_.\0\xef\xbb\xbf{ Item { Name \"x\" }";
	const unsigned seed = 4711;
	char text[400], message[32];

	srand(seed);
	snprintf(message, sizeof(message), "seed %u", seed);
	report.line = NULL;
	for (int i = 0; i < 4000; i++) {
		size_t len = 1 + (size_t)rand() % (sizeof(text) - 1);

		for (size_t j = 0; j < len; j++)
			text[j] = alphabet[(size_t)rand() % sizeof(alphabet)];
		parse_bytes(text, len);
		TEST_ASSERT_EQUAL_MEMORY_MESSAGE(text, rio->text, len, message);
		for (const struct rio_node *n = rio->root.first; n; n = n->next) {
			TEST_ASSERT_TRUE_MESSAGE(n->begin <= n->value_begin, message);
			TEST_ASSERT_TRUE_MESSAGE(n->value_begin <= n->value_end, message);
			TEST_ASSERT_TRUE_MESSAGE(n->value_end <= n->end && n->end <= len, message);
			if (n->next)
				TEST_ASSERT_TRUE_MESSAGE(n->end <= n->next->begin, message);
		}
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_values_of_every_kind_are_read);
	RUN_TEST(test_adjacent_strings_are_one);
	RUN_TEST(test_a_string_may_begin_in_the_line_behind_its_key);
	RUN_TEST(test_backslashes_escape_quotes_and_themselves_only);
	RUN_TEST(test_comments_and_commented_keys_are_skipped);
	RUN_TEST(test_lines_and_columns_are_those_of_an_editor);
	RUN_TEST(test_a_file_of_utf_16_is_refused_as_such);
	RUN_TEST(test_a_line_ends_with_lf_or_crlf_or_cr);
	RUN_TEST(test_a_byte_order_mark_is_no_part_of_the_first_key);
	RUN_TEST(test_empty_texts_are_documents_without_keys);
	RUN_TEST(test_syntax_errors_say_place_and_expectation);
	RUN_TEST(test_a_nul_byte_is_refused_wherever_it_is);
	RUN_TEST(test_limits_are_refused_plainly);
	RUN_TEST(test_a_text_beyond_the_size_limit_is_refused_unread);
	RUN_TEST(test_errors_are_reported_fifty_at_most_and_all_counted);
	RUN_TEST(test_files_of_genuine_shape_come_back_byte_for_byte);
	RUN_TEST(test_a_file_that_cannot_be_read_is_said);
	RUN_TEST(test_only_a_regular_file_of_a_size_is_read_at_all);
	RUN_TEST(test_random_bytes_are_survived);
	return UNITY_END();
}
