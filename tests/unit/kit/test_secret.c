/* SPDX-License-Identifier: MIT */
/* Tests of files with tokens, passwords and keys. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "src/faces/kit/secret.h"
#include "tests/unit/aid/folder.h"

static char path[300], token[SECRET_SIZE], why[400];

void setUp(void)
{
	snprintf(path, sizeof(path), "%s/token", folder_dir()->path);
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
	return secret_read(path, token, why, sizeof(why));
}

static void test_a_token_stands_in_a_line_of_a_file_that_is_ours_alone(void)
{
	TEST_ASSERT_EQUAL_INT(0, read_text(" user:pass==\r\n", 0600));
	TEST_ASSERT_EQUAL_STRING("user:pass==", token);
	TEST_ASSERT_EQUAL_INT(0, read_text("a b \xc3\xa4\n", 0600));
	TEST_ASSERT_EQUAL_STRING("a b \xc3\xa4", token);
	TEST_ASSERT_EQUAL_INT(0, read_text("abc", 0400));
	TEST_ASSERT_EQUAL_STRING("abc", token);
	TEST_ASSERT_EQUAL_INT(0, secret_read(NULL, token, why, sizeof(why)));
	TEST_ASSERT_EQUAL_STRING("", token);
}

static void test_a_file_that_others_may_read_or_that_has_no_token_is_refused(void)
{
	char longest[SECRET_SIZE + 1];

	TEST_ASSERT_EQUAL_INT(-EPERM, read_text("abc\n", 0640));
	TEST_ASSERT_NOT_NULL(strstr(why, "others may read it: chmod 600"));
	TEST_ASSERT_EQUAL_STRING("", token);
	TEST_ASSERT_EQUAL_INT(-EINVAL, read_text("", 0600));
	TEST_ASSERT_EQUAL_INT(-EINVAL, read_text("\n \n", 0600));
	TEST_ASSERT_EQUAL_INT(-EINVAL, read_text("a\tb\n", 0600));
	TEST_ASSERT_EQUAL_INT(-EINVAL, read_text("a\nX-Header: b\n", 0600));
	TEST_ASSERT_EQUAL_INT(-EINVAL, read_text("a\x01"
	                                         "b\n",
	                                         0600));
	memset(longest, 'a', SECRET_SIZE);
	longest[SECRET_SIZE] = '\0';
	TEST_ASSERT_EQUAL_INT(-EINVAL, read_text(longest, 0600));
	TEST_ASSERT_EQUAL_STRING("", token);
	unlink(path);
	TEST_ASSERT_EQUAL_INT(-ENOENT, secret_read(path, token, why, sizeof(why)));
	TEST_ASSERT_EQUAL_INT(-EINVAL, secret_read(folder_dir()->path, token, why, sizeof(why)));
}

static void test_a_name_is_that_of_a_credential_of_the_service(void)
{
	TEST_ASSERT_EQUAL_INT(-ENOENT, secret_read("token", token, why, sizeof(why)));
	TEST_ASSERT_NOT_NULL(strstr(why, "LoadCredential="));
	setenv("CREDENTIALS_DIRECTORY", folder_dir()->path, 1);
	TEST_ASSERT_EQUAL_INT(-ENOENT, secret_read("another", token, why, sizeof(why)));
	TEST_ASSERT_NOT_NULL(strstr(why, "/etc/credstore"));
	read_text("abc\n", 0440);
	TEST_ASSERT_EQUAL_INT(0, secret_read("token", token, why, sizeof(why)));
	TEST_ASSERT_EQUAL_STRING("abc", token);
}

static void test_a_key_has_to_be_ours_alone_and_a_certificate_has_not(void)
{
	char found[SECRET_PATH];

	read_text("abc\n", 0644);
	TEST_ASSERT_EQUAL_INT(-EPERM, secret_file(path, true, found, why, sizeof(why)));
	TEST_ASSERT_NOT_NULL(strstr(why, "others may read it: chmod 600"));
	TEST_ASSERT_EQUAL_INT(0, secret_file(path, false, found, why, sizeof(why)));
	TEST_ASSERT_EQUAL_STRING(path, found);
	TEST_ASSERT_EQUAL_INT(0, chmod(path, 0600));
	TEST_ASSERT_EQUAL_INT(0, secret_file(path, true, found, why, sizeof(why)));
	TEST_ASSERT_EQUAL_INT(-ENOENT, secret_file("/no/key", false, found, why, sizeof(why)));
	setenv("CREDENTIALS_DIRECTORY", folder_dir()->path, 1);
	TEST_ASSERT_EQUAL_INT(0, secret_file("token", true, found, why, sizeof(why)));
	TEST_ASSERT_EQUAL_STRING(path, found);
}

static void test_a_reason_is_news_until_it_is_another(void)
{
	uint64_t print = 0;

	TEST_ASSERT_FALSE(secret_is_news("", &print));
	TEST_ASSERT_TRUE(secret_is_news("it is missing", &print));
	TEST_ASSERT_FALSE(secret_is_news("it is missing", &print));
	TEST_ASSERT_TRUE(secret_is_news("others may read it", &print));
	TEST_ASSERT_FALSE(secret_is_news("", &print));
	TEST_ASSERT_TRUE(secret_is_news("others may read it", &print));
}

static int checks(const char *name, enum secret_kind kind)
{
	return secret_check("owsd-face", "SomeFile", name, kind);
}

static void test_a_check_refuses_what_the_face_could_not_use(void)
{
	TEST_ASSERT_EQUAL_INT(0, checks(NULL, SECRET_TOKEN));
	TEST_ASSERT_EQUAL_INT(-ENOENT, checks(path, SECRET_TOKEN));
	TEST_ASSERT_EQUAL_INT(-ENOENT, checks(path, SECRET_PUBLIC));
	read_text("\n", 0600);
	TEST_ASSERT_EQUAL_INT(-EINVAL, checks(path, SECRET_TOKEN));
	TEST_ASSERT_EQUAL_INT(0, checks(path, SECRET_KEY));
	read_text("abc\n", 0644);
	TEST_ASSERT_EQUAL_INT(-EPERM, checks(path, SECRET_TOKEN));
	TEST_ASSERT_EQUAL_INT(-EPERM, checks(path, SECRET_KEY));
	TEST_ASSERT_EQUAL_INT(0, checks(path, SECRET_PUBLIC));
}

/* The service has it, and the shell of a person does not. */
static void test_a_check_without_credentials_refuses_none(void)
{
	TEST_ASSERT_EQUAL_INT(0, checks("token", SECRET_TOKEN));
	TEST_ASSERT_EQUAL_INT(0, setenv("CREDENTIALS_DIRECTORY", folder_dir()->path, 1));
	TEST_ASSERT_EQUAL_INT(-ENOENT, checks("token", SECRET_TOKEN));
	read_text("abc\n", 0600);
	TEST_ASSERT_EQUAL_INT(0, checks("token", SECRET_TOKEN));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_reason_is_news_until_it_is_another);
	RUN_TEST(test_a_token_stands_in_a_line_of_a_file_that_is_ours_alone);
	RUN_TEST(test_a_file_that_others_may_read_or_that_has_no_token_is_refused);
	RUN_TEST(test_a_name_is_that_of_a_credential_of_the_service);
	RUN_TEST(test_a_key_has_to_be_ours_alone_and_a_certificate_has_not);
	RUN_TEST(test_a_check_refuses_what_the_face_could_not_use);
	RUN_TEST(test_a_check_without_credentials_refuses_none);
	return UNITY_END();
}
