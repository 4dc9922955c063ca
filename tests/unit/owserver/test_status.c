/* SPDX-License-Identifier: MIT */
/* Tests of the return codes of owserver as errors of the bus contract. */
#include <errno.h>

#include "unity.h"

#include "hal/owserver/status.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_return_codes_become_errors_of_the_contract(void)
{
	TEST_ASSERT_EQUAL_INT(1, status_of(-1, BUS_READ));
	TEST_ASSERT_EQUAL_INT(-EISDIR, status_of(-21, BUS_READ));
	TEST_ASSERT_EQUAL_INT(-ENOTDIR, status_of(-20, BUS_DIR));
	TEST_ASSERT_EQUAL_INT(-EACCES, status_of(-95, BUS_READ));
	TEST_ASSERT_EQUAL_INT(-EPERM, status_of(-30, BUS_WRITE));
	TEST_ASSERT_EQUAL_INT(-EPERM, status_of(-66, BUS_WRITE));
	TEST_ASSERT_EQUAL_INT(-EINVAL, status_of(-22, BUS_WRITE));
	TEST_ASSERT_EQUAL_INT(-EINVAL, status_of(-14, BUS_WRITE));
	TEST_ASSERT_EQUAL_INT(-EINVAL, status_of(-34, BUS_WRITE));
	TEST_ASSERT_EQUAL_INT(-EMSGSIZE, status_of(-34, BUS_READ));
	TEST_ASSERT_EQUAL_INT(-EIO, status_of(-5, BUS_READ));
	TEST_ASSERT_EQUAL_INT(-EIO, status_of(-12345, BUS_WRITE));
	TEST_ASSERT_EQUAL_INT(-EIO, status_of(INT32_MIN, BUS_WRITE));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_return_codes_become_errors_of_the_contract);
	return UNITY_END();
}
