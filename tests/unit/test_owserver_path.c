/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <string.h>

#include "hal/owserver/path.h"
#include "hal/owserver/status.h"
#include "unity.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static void has_device(const char *path, const char *name)
{
	struct path_part part;

	TEST_ASSERT_TRUE_MESSAGE(path_device(path, strlen(path), &part), path);
	TEST_ASSERT_EQUAL_size_t_MESSAGE(strlen(name), part.len, path);
	TEST_ASSERT_EQUAL_MEMORY_MESSAGE(name, path + part.at, part.len, path);
}

static void has_none(const char *path)
{
	struct path_part part;

	TEST_ASSERT_FALSE_MESSAGE(path_device(path, strlen(path), &part), path);
}

static void test_the_device_is_the_first_component(void)
{
	has_device("/28.551DDF030000/temperature12", "28.551DDF030000");
	has_device("28.551DDF030000", "28.551DDF030000");
	has_device("/boiler/HIH4000/humidity", "boiler");
}

static void test_the_device_stands_behind_the_prefixes(void)
{
	has_device("/alarm/29.066418000000/latch.BYTE", "29.066418000000");
	has_device("/uncached/alarm/boiler", "boiler");
	has_device("/bus.0/uncached/28.551DDF030000", "28.551DDF030000");
}

static void test_below_a_branch_stands_another_device(void)
{
	has_device("/1F.A1B2C3040506/main/28.551DDF030000/temperature", "28.551DDF030000");
	has_device("/1F.A1B2C3040506/aux/1F.000000000001/main/pump", "pump");
	has_device("/1F.A1B2C3040506/main", "1F.A1B2C3040506");
	has_device("/1F.A1B2C3040506/control", "1F.A1B2C3040506");
}

static void test_some_paths_have_no_device(void)
{
	has_none("/");
	has_none("");
	has_none("/alarm");
	has_none("/bus.1");
	has_none("/bus.1/interface/settings/name");
	has_none("/settings/timeout/volatile");
	has_none("/simultaneous/temperature");
	has_none("/structure/28/temperature");
}

static void test_a_rom_name_is_told_from_an_alias(void)
{
	TEST_ASSERT_TRUE(path_is_rom_name("28.551DDF030000", 15));
	TEST_ASSERT_TRUE(path_is_rom_name("28.551ddf030000", 15));
	TEST_ASSERT_FALSE(path_is_rom_name("28.551DDF03000", 14));
	TEST_ASSERT_FALSE(path_is_rom_name("28.551DDF03000G", 15));
	TEST_ASSERT_FALSE(path_is_rom_name("28551DDF0300000", 15));
	TEST_ASSERT_FALSE(path_is_rom_name("boiler", 6));
}

static void test_return_codes_become_errors_of_the_contract(void)
{
	TEST_ASSERT_EQUAL_INT(1, status_of(-1, BUS_READ));
	TEST_ASSERT_EQUAL_INT(-ENOENT, status_of(-21, BUS_READ));
	TEST_ASSERT_EQUAL_INT(-ENOENT, status_of(-20, BUS_DIR));
	TEST_ASSERT_EQUAL_INT(-EACCES, status_of(-95, BUS_READ));
	TEST_ASSERT_EQUAL_INT(-EACCES, status_of(-30, BUS_WRITE));
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
	RUN_TEST(test_the_device_is_the_first_component);
	RUN_TEST(test_the_device_stands_behind_the_prefixes);
	RUN_TEST(test_below_a_branch_stands_another_device);
	RUN_TEST(test_some_paths_have_no_device);
	RUN_TEST(test_a_rom_name_is_told_from_an_alias);
	RUN_TEST(test_return_codes_become_errors_of_the_contract);
	return UNITY_END();
}
