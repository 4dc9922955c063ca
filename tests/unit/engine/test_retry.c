/* SPDX-License-Identifier: MIT */
/* Tests of retries: the quality after failures, and the time until the next try. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "src/daemon/engine/retry.h"
#include "src/public/ows.h"

void setUp(void)
{
}
void tearDown(void)
{
}

static void test_quality_goes_bad_after_one_and_max_retries_failures(void)
{
	struct retry retry = {0};
	int64_t wait;

	for (int i = 0; i < 3; i++) {
		TEST_ASSERT_FALSE(retry_fail(&retry, 3, &wait));
		TEST_ASSERT_EQUAL_INT64(0, wait);
	}
	TEST_ASSERT_TRUE(retry_fail(&retry, 3, &wait));
}

static void test_with_no_retries_the_first_error_is_bad(void)
{
	struct retry retry = {0};
	int64_t wait;

	TEST_ASSERT_TRUE(retry_fail(&retry, 0, &wait));
	TEST_ASSERT_EQUAL_INT64(1000000000, wait);
}

static void test_the_back_off_doubles_from_one_second_to_a_minute(void)
{
	static const int64_t seconds[] = {1, 2, 4, 8, 16, 32, 60, 60, 60};
	struct retry retry = {0};
	int64_t wait;

	for (unsigned i = 0; i < sizeof(seconds) / sizeof(seconds[0]); i++) {
		retry_fail(&retry, 0, &wait);
		TEST_ASSERT_EQUAL_INT64(seconds[i] * 1000000000, wait);
	}
}

static void test_a_very_long_failure_does_not_wrap(void)
{
	struct retry retry = {0};
	int64_t wait = 0;

	for (int i = 0; i < 200000; i++)
		TEST_ASSERT_TRUE(retry_fail(&retry, 0, &wait));
	TEST_ASSERT_EQUAL_INT64(60000000000, wait);
}

static void test_one_success_clears_all(void)
{
	struct retry retry = {0};
	int64_t wait;

	for (int i = 0; i < 10; i++)
		retry_fail(&retry, 0, &wait);
	retry_clear(&retry);
	TEST_ASSERT_FALSE(retry_fail(&retry, 1, &wait));
	TEST_ASSERT_TRUE(retry_fail(&retry, 1, &wait));
	TEST_ASSERT_EQUAL_INT64(1000000000, wait);
}

static void test_a_lost_target_is_no_item_error(void)
{
	static const int lost[] = {-ENOTCONN, -ETIMEDOUT, -ECONNRESET, -EPROTO};

	for (unsigned i = 0; i < sizeof(lost) / sizeof(lost[0]); i++) {
		TEST_ASSERT_EQUAL_INT(FAILURE_TARGET, failure_of(lost[i]));
		TEST_ASSERT_EQUAL_HEX8(OWS_Q_TARGET, failure_quality(lost[i]));
	}
}

static void test_a_slow_answer_is_an_error_of_the_device_and_not_of_its_target(void)
{
	TEST_ASSERT_EQUAL_INT(FAILURE_ITEM, failure_of(-EINPROGRESS));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_DEVICE, failure_quality(-EINPROGRESS));
}

static void test_what_was_not_begun_says_nothing(void)
{
	TEST_ASSERT_EQUAL_INT(FAILURE_VOID, failure_of(-ETIME));
	TEST_ASSERT_EQUAL_INT(FAILURE_VOID, failure_of(-ECANCELED));
}

static void test_each_error_has_its_quality_and_none_is_good(void)
{
	static const struct {
		int err;
		uint8_t quality;
	} table[] = {
		{-ENODEV, OWS_Q_NO_DEVICE},   {-ENOENT, OWS_Q_NO_PROPERTY},
		{-EISDIR, OWS_Q_NO_PROPERTY}, {-ENOTDIR, OWS_Q_NO_PROPERTY},
		{-EILSEQ, OWS_Q_TYPE},        {-EMSGSIZE, OWS_Q_TYPE},
		{-EACCES, OWS_Q_ACCESS},      {-EPERM, OWS_Q_ACCESS},
		{-EBADMSG, OWS_Q_DEVICE},     {-EIO, OWS_Q_DEVICE},
		{-EINVAL, OWS_Q_DEVICE},      {-ECOMM, OWS_Q_SHORT},
		{-ERANGE, OWS_Q_SENSOR},
	};

	for (unsigned i = 0; i < sizeof(table) / sizeof(table[0]); i++) {
		TEST_ASSERT_EQUAL_INT(FAILURE_ITEM, failure_of(table[i].err));
		TEST_ASSERT_EQUAL_HEX8(table[i].quality, failure_quality(table[i].err));
	}
	for (int err = 1; err < 200; err++)
		TEST_ASSERT_FALSE(ows_good(failure_quality(-err)));
}

/* Each error of the bus contract: is it in force at once, or may the answer have been disturbed? */
static void test_a_verdict_is_what_the_device_says_of_itself(void)
{
	static const int verdicts[] = {-ENODATA, -ERANGE};
	static const int others[] = {
		0,           -ENODEV,   -ENXIO,       -ENOENT,   -EACCES, -EPERM,
		-EISDIR,     -EINVAL,   -EBADMSG,     -ECOMM,    -EBUSY,  -EIO,
		-EDOM,       -EILSEQ,   -ENOTDIR,     -EMSGSIZE, -ETIME,  -EPROTO,
		-EOPNOTSUPP, -ENOTCONN, -EINPROGRESS, -ECANCELED};

	for (size_t i = 0; i < sizeof(verdicts) / sizeof(verdicts[0]); i++) {
		TEST_ASSERT_TRUE(failure_is_verdict(verdicts[i]));
		TEST_ASSERT_EQUAL(FAILURE_ITEM, failure_of(verdicts[i]));
	}
	for (size_t i = 0; i < sizeof(others) / sizeof(others[0]); i++)
		TEST_ASSERT_FALSE_MESSAGE(failure_is_verdict(others[i]), strerror(-others[i]));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_quality_goes_bad_after_one_and_max_retries_failures);
	RUN_TEST(test_with_no_retries_the_first_error_is_bad);
	RUN_TEST(test_the_back_off_doubles_from_one_second_to_a_minute);
	RUN_TEST(test_a_very_long_failure_does_not_wrap);
	RUN_TEST(test_one_success_clears_all);
	RUN_TEST(test_a_lost_target_is_no_item_error);
	RUN_TEST(test_a_slow_answer_is_an_error_of_the_device_and_not_of_its_target);
	RUN_TEST(test_what_was_not_begun_says_nothing);
	RUN_TEST(test_each_error_has_its_quality_and_none_is_good);
	RUN_TEST(test_a_verdict_is_what_the_device_says_of_itself);
	return UNITY_END();
}
