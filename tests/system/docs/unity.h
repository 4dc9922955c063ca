/* SPDX-License-Identifier: MIT */
/* What examples of unit tests in the documentation need of Unity, to be compiled and not run. */
#pragma once

#define UNITY_BEGIN()
#define UNITY_END() 0
#define RUN_TEST(test) test()
#define TEST_ASSERT_TRUE(is) ((void)(is))
#define TEST_ASSERT_EQUAL_INT(must, is) ((void)((must) == (is)))
#define TEST_ASSERT_EQUAL_STRING(must, is) ((void)(must), (void)(is))
