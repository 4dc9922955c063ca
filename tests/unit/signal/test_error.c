/* SPDX-License-Identifier: MIT */
/* The words of errors, and that causes with different remedies can be told apart by them. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "src/engine/retry.h"
#include "src/libows/ows.h"
#include "src/signal/error.h"

void setUp(void)
{
}

void tearDown(void)
{
}

/* Those of struct bus_answer, and those that the engine makes. */
static const int errors[] = {
	-ENODEV,   -ENOENT,    -EACCES,     -EPERM,    -EISDIR,     -ENOTDIR,    -EINVAL,
	-EBADMSG,  -ECOMM,     -ERANGE,     -EMSGSIZE, -EOPNOTSUPP, -ETIME,      -EINPROGRESS,
	-ENOTCONN, -ETIMEDOUT, -ECONNRESET, -EPROTO,   -EILSEQ,     -EPROTOTYPE,
};
#define ERRORS (sizeof(errors) / sizeof(errors[0]))

static void test_each_error_of_a_bus_has_words_of_its_own(void)
{
	for (size_t i = 0; i < ERRORS; i++) {
		TEST_ASSERT_NOT_NULL(error_remedy(errors[i]));
		TEST_ASSERT_NOT_EQUAL_MESSAGE(0,
		                              strcmp(strerror(-errors[i]), error_text(errors[i])),
		                              strerror(-errors[i]));
		for (size_t other = 0; other < i; other++)
			TEST_ASSERT_NOT_EQUAL_MESSAGE(
				0, strcmp(error_text(errors[other]), error_text(errors[i])),
				error_text(errors[i]));
	}
	TEST_ASSERT_EQUAL_STRING(strerror(EXDEV), error_text(-EXDEV));
	TEST_ASSERT_EQUAL_STRING("", error_remedy(-EXDEV));
}

static void test_what_is_wrong_in_a_configuration_has_a_remedy(void)
{
	char words[ERROR_WORDS];

	for (size_t i = 0; i < ERRORS; i++) {
		switch (failure_quality(errors[i])) {
		case OWS_Q_NO_PROPERTY:
		case OWS_Q_TYPE:
		case OWS_Q_ACCESS:
			if (errors[i] != -ENOTDIR && errors[i] != -EOPNOTSUPP)
				TEST_ASSERT_NOT_EQUAL_MESSAGE(0, strlen(error_remedy(errors[i])),
				                              error_text(errors[i]));
		}
		error_words(errors[i], words);
		TEST_ASSERT_LESS_THAN_size_t(ERROR_WORDS - 1, strlen(words));
	}
}

/* A typing error, a wrong type and a refused access look alike in no table. */
static void test_three_causes_have_three_qualities_with_words_of_their_own(void)
{
	static const uint8_t quality[] = {OWS_Q_NO_PROPERTY, OWS_Q_TYPE, OWS_Q_ACCESS};

	TEST_ASSERT_EQUAL_STRING("no such property", ows_quality_text(failure_quality(-ENOENT)));
	TEST_ASSERT_EQUAL_STRING("wrong type", ows_quality_text(failure_quality(-EILSEQ)));
	TEST_ASSERT_EQUAL_STRING("access refused", ows_quality_text(failure_quality(-EACCES)));
	for (size_t i = 0; i < 3; i++)
		TEST_ASSERT_EQUAL_HEX8(0, quality[i] & 0xc0);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_error_of_a_bus_has_words_of_its_own);
	RUN_TEST(test_what_is_wrong_in_a_configuration_has_a_remedy);
	RUN_TEST(test_three_causes_have_three_qualities_with_words_of_their_own);
	return UNITY_END();
}
