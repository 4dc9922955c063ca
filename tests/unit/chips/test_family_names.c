/* SPDX-License-Identifier: MIT */
/* The names that the image has for families are those of the native bus. */
#include "unity.h"

#include "hal/chips/family.h"
#include "src/signal/family.h"

static const struct family *const families[] = {
#define FAMILY(code) &family_##code,
#include "hal/chips/families.h"
#undef FAMILY
};

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_each_family_has_the_name_of_its_usual_chip(void)
{
	for (size_t i = 0; i < sizeof(families) / sizeof(families[0]); i++)
		TEST_ASSERT_EQUAL_STRING(families[i]->type, family_name(families[i]->code));
}

static void test_an_unknown_code_has_no_name(void)
{
	TEST_ASSERT_NULL(family_name(0));
	TEST_ASSERT_NULL(family_name(0xfa));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_family_has_the_name_of_its_usual_chip);
	RUN_TEST(test_an_unknown_code_has_no_name);
	return UNITY_END();
}
