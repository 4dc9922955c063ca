/* SPDX-License-Identifier: MIT */
/* The words of errors, and that causes with different remedies can be told apart by them. */
#include <errno.h>
#include <float.h>
#include <string.h>

#include "unity.h"

#include "hal/bus/bus.h"
#include "src/daemon/engine/retry.h"
#include "src/ground/signal/error.h"
#include "src/ground/signal/quality.h"
#include "src/public/ows.h"

void setUp(void)
{
}

void tearDown(void)
{
}

/* Those that the engine makes, and those of struct bus_answer. */
#define ERROR(name) -name,
/* clang-format off */
static const int errors[] = {
	-EILSEQ, -ECONNREFUSED, -EREMCHG, BUS_ERRORS(ERROR)
};
/* clang-format on */
#undef ERROR
#define ERRORS (sizeof(errors) / sizeof(errors[0]))

/* The words of the system do: the quality, or the log, says the rest. */
static bool is_plain(int err)
{
	return err == -EIO || err == -EBUSY || err == -ECANCELED;
}

static void test_each_error_of_a_bus_has_words_of_its_own(void)
{
	for (size_t i = 0; i < ERRORS; i++) {
		if (is_plain(errors[i]))
			continue;
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

static void test_each_error_has_a_remedy_and_fits_into_its_room(void)
{
	char words[ERROR_WORDS];

	for (size_t i = 0; i < ERRORS; i++) {
		if (is_plain(errors[i]))
			continue;
		TEST_ASSERT_NOT_EQUAL_MESSAGE(0, strlen(error_remedy(errors[i])),
		                              error_text(errors[i]));
		error_words(errors[i], words);
		TEST_ASSERT_LESS_THAN_size_t(ERROR_WORDS - 1, strlen(words));
	}
}

/* What an error becomes, and what needs no error; good, and what owsd never says, have nothing. */
static void test_of_what_the_chip_cannot_measure_the_number_is_named(void)
{
	char words[ERROR_WORDS];

	TEST_ASSERT_EQUAL_STRING("a value out of the chip's range: -109.938",
	                         error_answer_text(-EDOM, -109.9375, words));
	TEST_ASSERT_EQUAL_STRING("a value out of the chip's range: 278.4: look at the sensor and "
	                         "its supply",
	                         error_answer_words(-EDOM, 278.4, words));
	TEST_ASSERT_EQUAL_STRING(error_text(-EIO), error_answer_text(-EIO, 21.5, words));
	TEST_ASSERT_NOT_NULL(
		strstr(error_answer_words(-EDOM, -DBL_MAX, words), "e+308: look at the sensor"));
}

static void test_each_quality_that_is_not_good_has_a_cause_and_a_remedy(void)
{
	static const uint8_t own[] = {OWS_Q_STALE, OWS_Q_DIFFERS, OWS_Q_INITIAL, OWS_Q_LAST_USABLE,
	                              OWS_Q_RANGE, OWS_Q_LOW,     OWS_Q_HIGH,    OWS_Q_CUT};

	for (size_t i = 0; i < ERRORS + sizeof(own); i++) {
		uint8_t quality = i < ERRORS ? failure_quality(errors[i]) : own[i - ERRORS];

		TEST_ASSERT_FALSE(ows_good(quality));
		TEST_ASSERT_NOT_EQUAL_MESSAGE(0, strlen(quality_cause(quality)),
		                              ows_quality_text(quality));
		TEST_ASSERT_NOT_EQUAL_MESSAGE(0, strlen(quality_remedy(quality)),
		                              ows_quality_text(quality));
		TEST_ASSERT_NOT_EQUAL_MESSAGE(0, strcmp("bad", ows_quality_text(quality)),
		                              ows_quality_text(quality));
	}
	TEST_ASSERT_EQUAL_STRING("", quality_cause(OWS_Q_GOOD));
	TEST_ASSERT_EQUAL_STRING("", quality_remedy(0x3c));
}

static void test_an_alarm_of_a_device_has_words_a_cause_and_a_remedy(void)
{
	static const uint8_t own[][2] = {{OWS_ALARM_DEVICE, OWS_ALARM_RAISED},
	                                 {OWS_ALARM_DEVICE, OWS_ALARM_FAILED},
	                                 {OWS_ALARM_POR, OWS_ALARM_RAISED}};

	for (size_t i = 0; i < sizeof(own) / sizeof(own[0]); i++) {
		TEST_ASSERT_NOT_EQUAL(0, strlen(alarm_word(own[i][0], own[i][1])));
		TEST_ASSERT_NOT_EQUAL(0, strlen(alarm_cause(own[i][0], own[i][1])));
		TEST_ASSERT_NOT_EQUAL(0, strlen(alarm_remedy(own[i][0], own[i][1])));
	}
	TEST_ASSERT_EQUAL_STRING("", alarm_word(OWS_ALARM_H, OWS_ALARM_RAISED));
	TEST_ASSERT_EQUAL_STRING("", alarm_cause(OWS_ALARM_DEVICE, OWS_ALARM_RETURNED));
	TEST_ASSERT_EQUAL_STRING("", alarm_remedy(OWS_ALARM_H, OWS_ALARM_RAISED));
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
	RUN_TEST(test_each_error_has_a_remedy_and_fits_into_its_room);
	RUN_TEST(test_of_what_the_chip_cannot_measure_the_number_is_named);
	RUN_TEST(test_each_quality_that_is_not_good_has_a_cause_and_a_remedy);
	RUN_TEST(test_an_alarm_of_a_device_has_words_a_cause_and_a_remedy);
	RUN_TEST(test_three_causes_have_three_qualities_with_words_of_their_own);
	return UNITY_END();
}
