/* SPDX-License-Identifier: MIT */
/* Tests of the mapped files of an instance, and of its lock. */
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "unity.h"

#include "src/memory/shm/futex.h"
#include "src/memory/shm/lock.h"
#include "src/memory/shm/segment.h"
#include "src/public/ows.h"
#include "tests/unit/aid/asleep.h"
#include "tests/unit/aid/corpse.h"
#include "tests/unit/aid/folder.h"

#define SIZE 8192

static char name[SEGMENT_NAME_MAX + 1];
static struct segment segment;

void setUp(void)
{
	snprintf(name, sizeof(name), "segment.%d", (int)getpid());
	TEST_ASSERT_EQUAL(0, segment_create(folder_dir(), name, SEGMENT_IMAGE, SIZE, &segment));
}

void tearDown(void)
{
	segment_close(&segment);
	remove(folder_file(name, "image"));
	unlink(folder_file(name, "lock"));
}

static bool exists(const char *kind)
{
	struct stat st;

	return lstat(folder_file(name, kind), &st) == 0;
}

static void test_names_that_would_leave_the_directory_are_refused(void)
{
	static const char *const bad[] = {
		"", ".", "..", "a/b", "a b", "\xc3\xa9", ".x", "123456789012345678901234567890123"};
	struct segment s;
	bool stolen;
	pid_t pid;

	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
		TEST_ASSERT_FALSE(segment_name_ok(bad[i]));
		TEST_ASSERT_EQUAL(-EINVAL,
		                  segment_create(folder_dir(), bad[i], SEGMENT_IMAGE, SIZE, &s));
		TEST_ASSERT_EQUAL(-EINVAL,
		                  segment_open_old(folder_dir(), bad[i], SEGMENT_IMAGE, &s));
		TEST_ASSERT_EQUAL(-EINVAL, segment_lock(folder_dir(), bad[i], &pid, &stolen));
	}
	TEST_ASSERT_TRUE(segment_name_ok("OWS"));
	TEST_ASSERT_TRUE(segment_name_ok("Boiler-2_x.y"));
	TEST_ASSERT_TRUE(segment_name_ok("12345678901234567890123456789012"));
}

static void test_a_segment_is_seen_only_after_it_is_shown(void)
{
	TEST_ASSERT_TRUE(exists("image.new"));
	TEST_ASSERT_FALSE(exists("image"));
	TEST_ASSERT_EQUAL(0, segment_show(name, &segment));
	TEST_ASSERT_FALSE(exists("image.new"));
	TEST_ASSERT_TRUE(exists("image"));
	segment_close(&segment);
	TEST_ASSERT_TRUE(exists("image"));
}

static void test_a_segment_never_shown_leaves_nothing_behind(void)
{
	segment_close(&segment);
	TEST_ASSERT_FALSE(exists("image.new"));
}

static void test_a_segment_is_zeroed_whole_and_closed_to_others(void)
{
	struct stat st;

	for (int i = 0; i < SIZE; i++)
		TEST_ASSERT_EQUAL(0, segment.base[i]);
	TEST_ASSERT_EQUAL(0, fstat(segment.fd, &st));
	TEST_ASSERT_EQUAL(SIZE, st.st_size);
	TEST_ASSERT_GREATER_OR_EQUAL(SIZE / 512, st.st_blocks);
	TEST_ASSERT_EQUAL(0, st.st_mode & 0117);
}

static void test_what_owsd_keeps_for_itself_is_closed_to_every_group(void)
{
	struct segment force;
	struct stat st;

	TEST_ASSERT_EQUAL(0, segment_create(folder_dir(), name, SEGMENT_FORCE, SIZE, &force));
	TEST_ASSERT_EQUAL(0, fstat(force.fd, &st));
	TEST_ASSERT_EQUAL(0600, st.st_mode & 07777);
	segment_close(&force);
	TEST_ASSERT_FALSE(exists("force.new"));
}

static void test_what_a_killed_start_left_is_no_obstacle(void)
{
	struct segment other;

	TEST_ASSERT_EQUAL(0, segment_create(folder_dir(), name, SEGMENT_IMAGE, SIZE, &other));
	segment_close(&other);
}

static void test_an_old_segment_is_found_with_what_it_held(void)
{
	struct segment old;

	TEST_ASSERT_EQUAL(-ENOENT, segment_open_old(folder_dir(), name, SEGMENT_IMAGE, &old));
	strcpy(segment.base + 100, "kept");
	TEST_ASSERT_EQUAL(0, segment_show(name, &segment));
	TEST_ASSERT_EQUAL(0, segment_open_old(folder_dir(), name, SEGMENT_IMAGE, &old));
	TEST_ASSERT_EQUAL(SIZE, old.size);
	TEST_ASSERT_EQUAL_STRING("kept", old.base + 100);
	segment_close(&old);
	TEST_ASSERT_EQUAL(0, ftruncate(segment.fd, 0));
	TEST_ASSERT_EQUAL(-EPROTO, segment_open_old(folder_dir(), name, SEGMENT_IMAGE, &old));
}

static void test_a_link_or_pipe_in_the_way_is_not_opened(void)
{
	struct segment old;
	const char *path = folder_file(name, "image");

	TEST_ASSERT_EQUAL(0, symlink("/etc/passwd", path));
	TEST_ASSERT_EQUAL(-EPERM, segment_open_old(folder_dir(), name, SEGMENT_IMAGE, &old));
	TEST_ASSERT_EQUAL(0, unlink(path));
	TEST_ASSERT_EQUAL(0, mkfifo(path, 0600));
	TEST_ASSERT_EQUAL(-EPERM, segment_open_old(folder_dir(), name, SEGMENT_IMAGE, &old));
}

static void test_one_owsd_for_each_name(void)
{
	bool stolen;
	pid_t pid;
	int first, second;

	first = segment_lock(folder_dir(), name, &pid, &stolen);
	TEST_ASSERT_GREATER_OR_EQUAL(0, first);
	TEST_ASSERT_EQUAL(-EBUSY, segment_lock(folder_dir(), name, &pid, &stolen));
	TEST_ASSERT_EQUAL(getpid(), pid);
	TEST_ASSERT_FALSE(stolen);
	close(first);
	second = segment_lock(folder_dir(), name, &pid, &stolen);
	TEST_ASSERT_GREATER_OR_EQUAL(0, second);
	TEST_ASSERT_FALSE(stolen);
	close(second);
}

static void test_a_lock_whose_file_was_removed_or_replaced_is_not_held(void)
{
	bool stolen;
	pid_t pid;
	int first, second;

	first = segment_lock(folder_dir(), name, &pid, &stolen);
	TEST_ASSERT_GREATER_OR_EQUAL(0, first);
	TEST_ASSERT_TRUE(segment_lock_held(folder_dir(), first, name));
	TEST_ASSERT_TRUE_MESSAGE(segment_lock_held(folder_dir(), -1, name),
	                         "a look that fails is no loss");
	TEST_ASSERT_EQUAL(0, unlink(folder_file(name, "lock")));
	TEST_ASSERT_FALSE(segment_lock_held(folder_dir(), first, name));
	second = segment_lock(folder_dir(), name, &pid, &stolen);
	TEST_ASSERT_GREATER_OR_EQUAL(0, second);
	TEST_ASSERT_FALSE(segment_lock_held(folder_dir(), first, name));
	TEST_ASSERT_TRUE(segment_lock_held(folder_dir(), second, name));
	close(first);
	close(second);
}

static void take_lock(void)
{
	bool stolen;
	pid_t pid;

	if (segment_lock(folder_dir(), name, &pid, &stolen) < 0)
		_exit(1);
}

static void test_a_corpses_lock_is_left_behind(void)
{
	bool stolen, stolen_twice;
	struct corpse corpse;
	pid_t pid, other;
	int fd;

	corpse_make(&corpse, take_lock);
	fd = segment_lock(folder_dir(), name, &pid, &stolen);
	TEST_ASSERT_GREATER_OR_EQUAL(0, fd);
	TEST_ASSERT_TRUE(stolen);
	TEST_ASSERT_EQUAL(corpse.pid, pid);
	TEST_ASSERT_EQUAL(-EBUSY, segment_lock(folder_dir(), name, &other, &stolen_twice));
	TEST_ASSERT_EQUAL(getpid(), other);
	TEST_ASSERT_FALSE(stolen_twice);
	corpse_end(&corpse);
	close(fd);
}

static void test_a_dead_owners_lock_is_free(void)
{
	bool stolen;
	pid_t pid, child = fork();
	int fd, status;

	if (child == 0)
		_exit(segment_lock(folder_dir(), name, &pid, &stolen) < 0);
	TEST_ASSERT_EQUAL(child, waitpid(child, &status, 0));
	TEST_ASSERT_EQUAL(0, status);
	fd = segment_lock(folder_dir(), name, &pid, &stolen);
	TEST_ASSERT_GREATER_OR_EQUAL(0, fd);
	TEST_ASSERT_FALSE(stolen);
	close(fd);
}

static void test_a_wait_ends_in_time(void)
{
	uint32_t *word = (void *)segment.base;
	int64_t before = ows_now();

	TEST_ASSERT_EQUAL(-ETIMEDOUT, segment_wait(word, 0, 50000000));
	TEST_ASSERT_GREATER_OR_EQUAL_INT64(50000000, ows_now() - before);
	TEST_ASSERT_EQUAL(0, segment_wait(word, 1, 50000000));
	TEST_ASSERT_EQUAL(-ETIMEDOUT, segment_wait(word, 0, 0));
	TEST_ASSERT_EQUAL(0, segment_wake(word, 1));
}

/* More than 32 bits of nanoseconds, and of seconds if the halves were taken for each other. */
static void *wake_later(void *arg)
{
	until_asleep(NULL);
	__atomic_store_n((uint32_t *)arg, 1, __ATOMIC_RELEASE);
	segment_wake(arg, 1);
	return NULL;
}

static void test_a_long_wait_ends_by_a_wake_from_another_mapping(void)
{
	static const int64_t limits[] = {INT64_C(30000000000), INT64_C(5000000000000000), INT64_MAX,
	                                 -1};
	uint32_t *here = (void *)segment.base;
	void *there = mmap(NULL, SIZE, PROT_READ | PROT_WRITE, MAP_SHARED, segment.fd, 0);

	TEST_ASSERT_TRUE(there != MAP_FAILED);
	for (size_t i = 0; i < sizeof(limits) / sizeof(limits[0]); i++) {
		pthread_t thread;

		__atomic_store_n(here, 0, __ATOMIC_RELAXED);
		TEST_ASSERT_EQUAL(0, pthread_create(&thread, NULL, wake_later, there));
		TEST_ASSERT_EQUAL(0, segment_wait(here, 0, limits[i]));
		pthread_join(thread, NULL);
		TEST_ASSERT_EQUAL(1, __atomic_load_n(here, __ATOMIC_ACQUIRE));
	}
	munmap(there, SIZE);
}

static void test_a_wait_on_truncated_memory_says_so(void)
{
	TEST_ASSERT_EQUAL(0, ftruncate(segment.fd, 0));
	TEST_ASSERT_EQUAL(-EFAULT, segment_wait((void *)segment.base, 0, 1000000));
}

static int run_child(void (*body)(void))
{
	pid_t child = fork();
	int status;

	if (child == 0) {
		body();
		_exit(0);
	}
	TEST_ASSERT_EQUAL(child, waitpid(child, &status, 0));
	return status;
}

static void ask_for_too_much(void)
{
	struct rlimit limit = {.rlim_cur = 4096, .rlim_max = 4096};
	struct segment other;

	signal(SIGXFSZ, SIG_IGN);
	if (setrlimit(RLIMIT_FSIZE, &limit) < 0)
		_exit(1);
	_exit(segment_create(folder_dir(), name, SEGMENT_FORCE, SIZE, &other) == -EFBIG &&
	                      other.fd < 0
	              ? 7
	              : 8);
}

static void test_memory_that_cannot_be_had_is_an_error_now(void)
{
	int status = run_child(ask_for_too_much);

	TEST_ASSERT_TRUE(WIFEXITED(status));
	TEST_ASSERT_EQUAL(7, WEXITSTATUS(status));
	TEST_ASSERT_FALSE(exists("force.new"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_names_that_would_leave_the_directory_are_refused);
	RUN_TEST(test_a_segment_is_seen_only_after_it_is_shown);
	RUN_TEST(test_a_segment_never_shown_leaves_nothing_behind);
	RUN_TEST(test_a_segment_is_zeroed_whole_and_closed_to_others);
	RUN_TEST(test_what_owsd_keeps_for_itself_is_closed_to_every_group);
	RUN_TEST(test_what_a_killed_start_left_is_no_obstacle);
	RUN_TEST(test_an_old_segment_is_found_with_what_it_held);
	RUN_TEST(test_a_link_or_pipe_in_the_way_is_not_opened);
	RUN_TEST(test_one_owsd_for_each_name);
	RUN_TEST(test_a_lock_whose_file_was_removed_or_replaced_is_not_held);
	RUN_TEST(test_a_corpses_lock_is_left_behind);
	RUN_TEST(test_a_dead_owners_lock_is_free);
	RUN_TEST(test_a_wait_ends_in_time);
	RUN_TEST(test_a_long_wait_ends_by_a_wake_from_another_mapping);
	RUN_TEST(test_a_wait_on_truncated_memory_says_so);
	RUN_TEST(test_memory_that_cannot_be_had_is_an_error_now);
	return UNITY_END();
}
