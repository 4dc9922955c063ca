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

#include "src/daemon/host/memory.h"
#include "tests/unit/aid/folder.h"

static char instance[32], path[DIR_PATH + 64];
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
static char why[512];

static const char *file(const char *kind)
{
	snprintf(path, sizeof(path), "%s", folder_file(instance, kind));
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
	unlink(file("force"));
}

static int make(void)
{
	return memory_make(&memory,
	                   &(struct memory_setup){
				   .instance = instance, .dir = folder_dir(), .config = &config},
	                   why, sizeof(why));
}

static void test_files_are_seen_once_they_are_shown(void)
{
	TEST_ASSERT_EQUAL_INT(0, make());
	TEST_ASSERT_EQUAL_INT(-1, access(file("image"), F_OK));
	TEST_ASSERT_EQUAL_INT(0, memory_show(&memory, NULL, why, sizeof(why)));
	TEST_ASSERT_EQUAL_INT(0, access(file("image"), F_OK));
	TEST_ASSERT_EQUAL_INT(0, access(file("force"), F_OK));
	memory_end(&memory);
	TEST_ASSERT_EQUAL_INT(0, access(file("image"), F_OK));
	TEST_ASSERT_EQUAL_INT(0, access(file("force"), F_OK));
}

static void test_a_file_that_cannot_be_made_leaves_nothing_behind(void)
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
	TEST_ASSERT_EQUAL_INT(-1, access(file("force.new"), F_OK));
	TEST_ASSERT_EQUAL_INT(-1, access(file("image.new"), F_OK));
}

static void test_a_directory_under_a_name_is_named_with_its_remedy(void)
{
	char remedy[DIR_PATH + 100];

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

static struct force_command in_force(void)
{
	const struct force_signal signal = {item.name, item.path, OWS_BYTE};
	struct force_command command = {0};
	char text[1];

	TEST_ASSERT_TRUE(memory.has_left);
	TEST_ASSERT_TRUE(force_find(&memory.left, &signal, &command, text, sizeof(text)));
	return command;
}

static void test_the_next_owsd_finds_which_command_is_in_force(void)
{
	TEST_ASSERT_EQUAL_INT(0, make());
	TEST_ASSERT_FALSE(memory.has_left);
	force_put(&memory.force, 0,
	          &(struct force_command){
			  .value = 5, .stamp = 3, .given = true, .controller = FORCE_NOBODY},
	          NULL);
	TEST_ASSERT_EQUAL_INT(0, memory_show(&memory, NULL, why, sizeof(why)));
	memory_end(&memory);
	TEST_ASSERT_EQUAL_INT(0, make());
	TEST_ASSERT_EQUAL_INT64(5, in_force().value);
	memory_resumed(&memory);
	TEST_ASSERT_FALSE(memory.has_left);
}

/* Whoever is refused by memory_show() has left the file of the owsd before as it was. */
static void test_what_is_in_force_is_lost_with_no_start_that_fails(void)
{
	test_the_next_owsd_finds_which_command_is_in_force();
	memory_end(&memory);
	TEST_ASSERT_EQUAL_INT(0, make());
	TEST_ASSERT_EQUAL_INT64(5, in_force().value);
}

static void test_a_damaged_file_of_the_owsd_before_is_no_obstacle(void)
{
	test_the_next_owsd_finds_which_command_is_in_force();
	memory_end(&memory);
	TEST_ASSERT_EQUAL_INT(0, truncate(file("force"), 256));
	TEST_ASSERT_EQUAL_INT(0, make());
	TEST_ASSERT_FALSE(memory.has_left);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_files_are_seen_once_they_are_shown);
	RUN_TEST(test_a_file_that_cannot_be_made_leaves_nothing_behind);
	RUN_TEST(test_a_directory_under_a_name_is_named_with_its_remedy);
	RUN_TEST(test_a_start_that_fails_leaves_the_image_of_the_owsd_before);
	RUN_TEST(test_memory_that_was_never_made_takes_no_descriptor_with_it);
	RUN_TEST(test_the_next_owsd_finds_which_command_is_in_force);
	RUN_TEST(test_what_is_in_force_is_lost_with_no_start_that_fails);
	RUN_TEST(test_a_damaged_file_of_the_owsd_before_is_no_obstacle);
	return UNITY_END();
}
