/* SPDX-License-Identifier: MIT */
/* Tests of the shared memory of an instance: made, shown, retired. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "src/host/memory.h"

static char instance[32], path[96];
static struct config_target target = {.text = "null:"};
static struct config_item item = {.name = "out",
                                  .path = "/29.000000000002/PIO.BYTE",
                                  .type = OWS_BYTE,
                                  .output = true,
                                  .per_factor = 1,
                                  .init_text = "",
                                  .safe_text = ""};
static struct config config = {.targets = &target,
                               .target_count = 1,
                               .items = &item,
                               .item_count = 1,
                               .period_ns = 100000000};
static struct memory memory;
static char why[256];

static const char *file(const char *kind)
{
	snprintf(path, sizeof(path), "/dev/shm/owsd.%s.%s", instance, kind);
	return path;
}

void setUp(void)
{
	snprintf(instance, sizeof(instance), "memory-%ld", (long)getpid());
	memory = (struct memory){0};
}

void tearDown(void)
{
	memory_end(&memory);
	unlink(file("image"));
	unlink(file("command"));
}

static int make(void)
{
	return memory_make(&memory, &(struct memory_setup){.instance = instance, .config = &config},
	                   why, sizeof(why));
}

static void test_segments_are_seen_once_they_are_shown(void)
{
	TEST_ASSERT_EQUAL_INT(0, make());
	TEST_ASSERT_EQUAL_INT(-1, access(file("image"), F_OK));
	TEST_ASSERT_EQUAL_INT(0, memory_show(&memory, NULL, why, sizeof(why)));
	TEST_ASSERT_EQUAL_INT(0, access(file("image"), F_OK));
	TEST_ASSERT_EQUAL_INT(0, access(file("command"), F_OK));
	memory_end(&memory);
	TEST_ASSERT_EQUAL_INT(0, access(file("image"), F_OK));
	TEST_ASSERT_EQUAL_INT(0, access(file("command"), F_OK));
}

static void test_a_command_segment_that_cannot_be_made_leaves_nothing_behind(void)
{
	int next = open("/dev/null", O_RDONLY);
	struct rlimit before, limit;

	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, next);
	close(next);
	TEST_ASSERT_EQUAL_INT(0, getrlimit(RLIMIT_NOFILE, &before));
	limit = before;
	limit.rlim_cur = (rlim_t)next + 1; /* the image has the last one */
	TEST_ASSERT_EQUAL_INT(0, setrlimit(RLIMIT_NOFILE, &limit));
	TEST_ASSERT_EQUAL_INT(-EMFILE, make());
	TEST_ASSERT_EQUAL_INT(0, setrlimit(RLIMIT_NOFILE, &before));
	TEST_ASSERT_NOT_EQUAL_CHAR('\0', why[0]);
	memory_end(&memory);
	TEST_ASSERT_EQUAL_INT(-1, access(file("command.new"), F_OK));
	TEST_ASSERT_EQUAL_INT(-1, access(file("image.new"), F_OK));
}

static void test_a_directory_under_a_name_is_named_with_its_remedy(void)
{
	char remedy[160];

	TEST_ASSERT_EQUAL_INT(0, mkdir(file("image"), 0700));
	TEST_ASSERT_EQUAL_INT(0, make());
	TEST_ASSERT_LESS_THAN_INT(0, memory_show(&memory, NULL, why, sizeof(why)));
	TEST_ASSERT_EQUAL_INT(0, rmdir(file("image")));
	snprintf(remedy, sizeof(remedy), " is in the way: as root, rm -r %s", path);
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(why, ": a directory of user "), why);
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(why, remedy), why);
}

static void test_a_start_that_fails_leaves_the_image_of_the_owsd_before(void)
{
	int fd = open(file("image"), O_CREAT | O_RDWR, 0600);

	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, fd);
	close(fd);
	TEST_ASSERT_EQUAL_INT(0, make());
	memory_end(&memory);
	TEST_ASSERT_EQUAL_INT(0, access(file("image"), F_OK));
}

static void test_memory_that_was_never_made_takes_no_descriptor_with_it(void)
{
	int fd = dup2(STDOUT_FILENO, STDIN_FILENO);

	TEST_ASSERT_EQUAL_INT(STDIN_FILENO, fd);
	memory_end(&memory);
	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, fcntl(STDIN_FILENO, F_GETFD));
}

static void test_a_segment_made_again_is_seen_once_it_is_shown(void)
{
	struct stat before, after;
	int err = 0;

	TEST_ASSERT_EQUAL_INT(0, make());
	TEST_ASSERT_EQUAL_INT(0, memory_show(&memory, NULL, why, sizeof(why)));
	TEST_ASSERT_EQUAL_INT(0, stat(file("command"), &before));
	TEST_ASSERT_EQUAL_INT(0, truncate(path, 0));
	TEST_ASSERT_TRUE(memory_commands_lost(&memory));
	TEST_ASSERT_NOT_NULL(memory_renew_commands(&memory, &err));
	TEST_ASSERT_FALSE(memory_commands_lost(&memory));
	TEST_ASSERT_EQUAL_INT(0, stat(file("command"), &after));
	TEST_ASSERT_TRUE(before.st_ino == after.st_ino);
	TEST_ASSERT_EQUAL_INT(0, memory_show_commands(&memory));
	TEST_ASSERT_EQUAL_INT(0, stat(file("command"), &after));
	TEST_ASSERT_TRUE(before.st_ino != after.st_ino && after.st_size > 0);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_segments_are_seen_once_they_are_shown);
	RUN_TEST(test_a_command_segment_that_cannot_be_made_leaves_nothing_behind);
	RUN_TEST(test_a_directory_under_a_name_is_named_with_its_remedy);
	RUN_TEST(test_a_start_that_fails_leaves_the_image_of_the_owsd_before);
	RUN_TEST(test_memory_that_was_never_made_takes_no_descriptor_with_it);
	RUN_TEST(test_a_segment_made_again_is_seen_once_it_is_shown);
	return UNITY_END();
}
