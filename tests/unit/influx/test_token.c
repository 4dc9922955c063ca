/* SPDX-License-Identifier: MIT */
/* Tests of the file that has the token. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "src/influx/token.h"
#include "tests/unit/aid/folder.h"

static char path[300], token[TOKEN_SIZE], why[400];

void setUp(void)
{
	snprintf(path, sizeof(path), "%s/token", folder_place()->path);
	unsetenv("CREDENTIALS_DIRECTORY");
}

void tearDown(void)
{
	unlink(path);
}

static int read_text(const char *text, mode_t mode)
{
	FILE *file = fopen(path, "w");

	TEST_ASSERT_NOT_NULL(file);
	fputs(text, file);
	fclose(file);
	TEST_ASSERT_EQUAL_INT(0, chmod(path, mode));
	return token_read(path, token, why, sizeof(why));
}

static void test_a_token_stands_in_a_line_of_a_file_that_is_ours_alone(void)
{
	TEST_ASSERT_EQUAL_INT(0, read_text(" user:pass==\r\n", 0600));
	TEST_ASSERT_EQUAL_STRING("user:pass==", token);
	TEST_ASSERT_EQUAL_INT(0, read_text("abc", 0400));
	TEST_ASSERT_EQUAL_STRING("abc", token);
	TEST_ASSERT_EQUAL_INT(0, token_read(NULL, token, why, sizeof(why)));
	TEST_ASSERT_EQUAL_STRING("", token);
}

static void test_a_file_that_others_may_read_or_that_has_no_token_is_refused(void)
{
	char longest[TOKEN_SIZE + 1];

	TEST_ASSERT_EQUAL_INT(-EPERM, read_text("abc\n", 0640));
	TEST_ASSERT_NOT_NULL(strstr(why, "others may read it: chmod 600"));
	TEST_ASSERT_EQUAL_STRING("", token);
	TEST_ASSERT_EQUAL_INT(-EINVAL, read_text("", 0600));
	TEST_ASSERT_EQUAL_INT(-EINVAL, read_text("\n \n", 0600));
	TEST_ASSERT_EQUAL_INT(-EINVAL, read_text("a b\n", 0600));
	TEST_ASSERT_EQUAL_INT(-EINVAL, read_text("a\nX-Header: b\n", 0600));
	TEST_ASSERT_EQUAL_INT(-EINVAL, read_text("a\x01"
	                                         "b\n",
	                                         0600));
	memset(longest, 'a', TOKEN_SIZE);
	longest[TOKEN_SIZE] = '\0';
	TEST_ASSERT_EQUAL_INT(-EINVAL, read_text(longest, 0600));
	TEST_ASSERT_EQUAL_STRING("", token);
	unlink(path);
	TEST_ASSERT_EQUAL_INT(-ENOENT, token_read(path, token, why, sizeof(why)));
	TEST_ASSERT_EQUAL_INT(-EINVAL, token_read(folder_place()->path, token, why, sizeof(why)));
}

static void test_a_name_is_that_of_a_credential_of_the_service(void)
{
	TEST_ASSERT_EQUAL_INT(-ENOENT, token_read("token", token, why, sizeof(why)));
	TEST_ASSERT_NOT_NULL(strstr(why, "LoadCredential="));
	setenv("CREDENTIALS_DIRECTORY", folder_place()->path, 1);
	read_text("abc\n", 0440);
	TEST_ASSERT_EQUAL_INT(0, token_read("token", token, why, sizeof(why)));
	TEST_ASSERT_EQUAL_STRING("abc", token);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_token_stands_in_a_line_of_a_file_that_is_ours_alone);
	RUN_TEST(test_a_file_that_others_may_read_or_that_has_no_token_is_refused);
	RUN_TEST(test_a_name_is_that_of_a_credential_of_the_service);
	return UNITY_END();
}
