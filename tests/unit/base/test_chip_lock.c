/* SPDX-License-Identifier: MIT */
/* The lock of a chip, on a file in the place of the adapter's. */
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "unity.h"

#include "hal/base/chip_lock.h"

static char path[] = "/tmp/owsd-chip-lock-XXXXXX";
static int fd;

void setUp(void)
{
	fd = open(path, O_RDWR | O_CLOEXEC);
	TEST_ASSERT_GREATER_OR_EQUAL(0, fd);
}

void tearDown(void)
{
	close(fd);
}

/* What another process gets for the address, if the holder it sees is this one. */
static int other_process(uint8_t address)
{
	int status, holder = 0;
	pid_t child = fork();

	TEST_ASSERT_GREATER_OR_EQUAL(0, child);
	if (child == 0) {
		int own = open(path, O_RDWR | O_CLOEXEC);
		int err = chip_lock(own, address, &holder);

		_exit(err == -EADDRINUSE && holder == getppid() ? 1 : err ? 2 : 0);
	}
	TEST_ASSERT_EQUAL_INT(child, waitpid(child, &status, 0));
	TEST_ASSERT_TRUE(WIFEXITED(status));
	return WEXITSTATUS(status);
}

static void test_another_process_is_refused_and_told_by_whom(void)
{
	int holder;

	TEST_ASSERT_EQUAL_INT(0, chip_lock(fd, 0x18, &holder));
	TEST_ASSERT_EQUAL_INT(1, other_process(0x18));
}

static void test_the_other_chips_of_the_adapter_stay_free(void)
{
	int holder;

	TEST_ASSERT_EQUAL_INT(0, chip_lock(fd, 0x1a, &holder));
	for (uint8_t address = 0x18; address < 0x20; address++)
		TEST_ASSERT_EQUAL_INT(address == 0x1a, other_process(address));
}

static void test_another_target_of_this_process_is_refused(void)
{
	int second = open(path, O_RDWR | O_CLOEXEC), holder;

	TEST_ASSERT_EQUAL_INT(0, chip_lock(fd, 0x18, &holder));
	TEST_ASSERT_EQUAL_INT(-EADDRINUSE, chip_lock(second, 0x18, &holder));
	TEST_ASSERT_EQUAL_INT(0, holder);
	close(second);
	/* without the holder's name by now, but refused all the same */
	TEST_ASSERT_EQUAL_INT(2, other_process(0x18));
}

static void test_the_one_who_has_it_may_lock_again(void)
{
	int holder;

	TEST_ASSERT_EQUAL_INT(0, chip_lock(fd, 0x18, &holder));
	TEST_ASSERT_EQUAL_INT(0, chip_lock(fd, 0x18, &holder));
}

static void test_unlocked_or_closed_it_is_free(void)
{
	int holder;

	TEST_ASSERT_EQUAL_INT(0, chip_lock(fd, 0x18, &holder));
	chip_unlock(fd, 0x18);
	TEST_ASSERT_EQUAL_INT(0, other_process(0x18));
	TEST_ASSERT_EQUAL_INT(0, chip_lock(fd, 0x18, &holder));
	close(fd);
	TEST_ASSERT_EQUAL_INT(0, other_process(0x18));
	setUp();
}

int main(void)
{
	int made = mkstemp(path), failures;

	if (made < 0)
		return 1;
	close(made);
	UNITY_BEGIN();
	RUN_TEST(test_another_process_is_refused_and_told_by_whom);
	RUN_TEST(test_the_other_chips_of_the_adapter_stay_free);
	RUN_TEST(test_another_target_of_this_process_is_refused);
	RUN_TEST(test_the_one_who_has_it_may_lock_again);
	RUN_TEST(test_unlocked_or_closed_it_is_free);
	failures = UNITY_END();
	unlink(path);
	return failures;
}
