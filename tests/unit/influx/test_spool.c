/* SPDX-License-Identifier: MIT */
/* Tests of the spool: order, bounds, what is refused, full disks and power cuts. */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "src/faces/influx/spool.h"
#include "tests/unit/aid/folder.h"
#include "tests/unit/aid/power_disk.h"

#define BIG (100 * 4096)

static struct power_disk power;
static struct spool spool;
static char path[512], data[1 << 20];
static int folders;

static void reopen(uint64_t limit)
{
	spool_close(&spool);
	TEST_ASSERT_EQUAL_INT(0, spool_open(&spool, path, limit, &power.disk));
}

void setUp(void)
{
	snprintf(path, sizeof(path), "%s/spool%d", folder_place()->path, folders++);
	power_init(&power);
	spool.dir = -1;
	reopen(64000000);
}

void tearDown(void)
{
	spool_close(&spool);
	power_free(&power);
}

static void put(const char *text)
{
	TEST_ASSERT_EQUAL_INT(0, spool_put(&spool, text, strlen(text)));
}

static void expect_oldest(const char *text)
{
	int64_t len = spool_read(&spool, data, sizeof(data));

	TEST_ASSERT_EQUAL_INT64((int64_t)strlen(text), len);
	TEST_ASSERT_EQUAL_STRING_LEN(text, data, (size_t)len);
}

static int files(const char *kind)
{
	DIR *dir = opendir(path);
	struct dirent *entry;
	int count = 0;

	TEST_ASSERT_NOT_NULL(dir);
	while ((entry = readdir(dir)))
		count += strstr(entry->d_name, kind) != NULL;
	closedir(dir);
	return count;
}

static void test_the_oldest_batch_comes_first_also_after_a_restart(void)
{
	put("a\n");
	put("b\n");
	expect_oldest("a\n");
	reopen(64000000);
	put("c\n");
	TEST_ASSERT_EQUAL_size_t(3, spool_count(&spool));
	for (const char *text = "abc"; *text; text++) {
		const char line[] = {*text, '\n', '\0'};

		expect_oldest(line);
		spool_remove(&spool);
	}
	TEST_ASSERT_EQUAL_size_t(0, spool_count(&spool));
	TEST_ASSERT_EQUAL_UINT64(0, spool.bytes);
	TEST_ASSERT_EQUAL_INT(0, files("lines"));
}

static void test_hundreds_of_batches_keep_their_order(void)
{
	char text[16];
	int next = 0;

	spool_close(&spool);
	TEST_ASSERT_EQUAL_INT(0, spool_open(&spool, path, 64000000, &spool_disk_system));
	for (int i = 0; i < 300; i++) {
		snprintf(text, sizeof(text), "%d\n", i);
		put(text);
		if (i % 3 != 0)
			continue;
		snprintf(text, sizeof(text), "%d\n", next++);
		expect_oldest(text);
		spool_remove(&spool);
	}
	TEST_ASSERT_EQUAL_size_t(200, spool_count(&spool));
	snprintf(text, sizeof(text), "%d\n", next);
	expect_oldest(text);
}

static void test_a_second_program_finds_the_directory_locked(void)
{
	struct spool other;

	TEST_ASSERT_EQUAL_INT(-EBUSY, spool_open(&other, path, 1000000, &power.disk));
	TEST_ASSERT_EQUAL_INT(-1, other.dir);
}

static void test_a_lock_of_the_directory_keeps_nobody_out(void)
{
	int directory = open(path, O_RDONLY | O_DIRECTORY);
	struct stat lock;

	spool_close(&spool);
	TEST_ASSERT_EQUAL_INT(0, flock(directory, LOCK_EX | LOCK_NB));
	TEST_ASSERT_EQUAL_INT(0, spool_open(&spool, path, 1000000, &power.disk));
	TEST_ASSERT_EQUAL_INT(0, fstatat(directory, "lock", &lock, 0));
	TEST_ASSERT_EQUAL_INT(0600, lock.st_mode & 0777);
	close(directory);
}

static void test_the_size_is_bounded_and_the_oldest_are_dropped_and_counted(void)
{
	memset(data, 'x', BIG);
	reopen(10 * BIG);
	for (int i = 0; i < 15; i++) {
		data[0] = (char)('a' + i);
		TEST_ASSERT_EQUAL_INT(0, spool_put(&spool, data, BIG));
		TEST_ASSERT_TRUE(spool.bytes <= 10 * BIG);
	}
	TEST_ASSERT_EQUAL_size_t(10, spool_count(&spool));
	TEST_ASSERT_EQUAL_UINT64(5 * BIG, spool.dropped);
	TEST_ASSERT_EQUAL_INT64(BIG, spool_read(&spool, data, sizeof(data)));
	TEST_ASSERT_EQUAL_INT('f', data[0]);
	TEST_ASSERT_EQUAL_INT(10, files("lines"));
	/* a small file takes a block */
	reopen(10 * BIG);
	put("small\n");
	TEST_ASSERT_EQUAL_UINT64(9 * BIG + 4096, spool.bytes);
}

static void test_what_is_refused_is_kept_aside_the_newest_eight_of_it(void)
{
	for (int i = 0; i < 12; i++)
		put("x\n");
	for (int i = 0; i < 6; i++)
		spool_refuse(&spool, NULL, 0);
	for (int i = 0; i < 4; i++)
		spool_refuse(&spool, "y\n", 2);
	TEST_ASSERT_EQUAL_INT(SPOOL_REFUSED, files("refused"));
	TEST_ASSERT_EQUAL_INT(6, files("lines"));
	reopen(64000000);
	spool_refuse(&spool, NULL, 0);
	TEST_ASSERT_EQUAL_INT(SPOOL_REFUSED, files("refused"));
	TEST_ASSERT_EQUAL_size_t(5, spool_count(&spool));
}

static void test_a_disk_that_takes_nothing_leaves_what_is_there(void)
{
	put("a\n");
	power.fail_after = 0;
	power.fail_with = -ENOSPC;
	TEST_ASSERT_EQUAL_INT(-ENOSPC, spool_put(&spool, "b\n", 2));
	TEST_ASSERT_EQUAL_size_t(1, spool_count(&spool));
	TEST_ASSERT_EQUAL_INT(0, files("half"));
	power.fail_after = -1;
	put("c\n");
	expect_oldest("a\n");
	spool_remove(&spool);
	expect_oldest("c\n");
}

static void test_what_is_not_of_the_spool_stays_and_what_is_half_goes(void)
{
	static const char *const names[] = {"notes.txt", "1.lines", "000000000007.half",
	                                    "000000000009.lines.bak", "000000000000.lines"};
	char name[600];

	for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
		snprintf(name, sizeof(name), "%s/%s", path, names[i]);
		fclose(fopen(name, "w"));
	}
	snprintf(name, sizeof(name), "%s/000000000005.lines", path);
	TEST_ASSERT_EQUAL_INT(0, mkdir(name, 0700));
	reopen(64000000);
	TEST_ASSERT_EQUAL_size_t(0, spool_count(&spool));
	TEST_ASSERT_EQUAL_INT(0, files("half"));
	TEST_ASSERT_EQUAL_INT(1, files("notes"));
	put("a\n");
	TEST_ASSERT_EQUAL_INT(1, files("000000000008.lines"));
}

static void test_a_file_that_is_too_long_is_no_batch(void)
{
	char name[600];

	snprintf(name, sizeof(name), "%s/000000000001.lines", path);
	fclose(fopen(name, "w"));
	TEST_ASSERT_EQUAL_INT(0, truncate(name, 3 << 20));
	reopen(64000000);
	TEST_ASSERT_EQUAL_INT64(-EFBIG, spool_read(&spool, data, sizeof(data)));
}

/* After each cut: whole batches in their order, all that were there and none that was not. */
static void expect_after_cut(int cut, const int *done, int puts)
{
	struct spool left;
	char after[600], text[16];
	uint64_t seed = 88172645463325252u + (uint64_t)cut;
	int first, have = 0;

	snprintf(after, sizeof(after), "%s/cut", folder_place()->path);
	mkdir(after, 0700);
	power_cut(&power, cut, &seed, after);
	TEST_ASSERT_EQUAL_INT(0, spool_open(&left, after, 64000000, &spool_disk_system));
	for (first = -1; spool_count(&left); have++) {
		int64_t len = spool_read(&left, data, sizeof(data) - 1);
		int number;

		TEST_ASSERT_TRUE(len > 0);
		data[len] = '\0';
		TEST_ASSERT_EQUAL_INT(1, sscanf(data, "%d", &number));
		snprintf(text, sizeof(text), "%d\n", number);
		TEST_ASSERT_EQUAL_STRING(text, data);
		if (first < 0)
			first = number;
		TEST_ASSERT_EQUAL_INT(first + have, number);
		spool_remove(&left);
	}
	for (int i = 0; i < puts; i++)
		if (done[i] <= cut)
			TEST_ASSERT_TRUE_MESSAGE(first >= 0 && i < first + have, "one is lost");
	spool_close(&left);
}

static void test_a_power_cut_leaves_whole_batches_and_all_that_were_written(void)
{
	int done[20];
	char text[16];

	for (int i = 0; i < 20; i++) {
		snprintf(text, sizeof(text), "%d\n", i);
		put(text);
		done[i] = power.count;
	}
	for (int cut = 0; cut <= power.count; cut++)
		expect_after_cut(cut, done, 20);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_oldest_batch_comes_first_also_after_a_restart);
	RUN_TEST(test_hundreds_of_batches_keep_their_order);
	RUN_TEST(test_a_second_program_finds_the_directory_locked);
	RUN_TEST(test_a_lock_of_the_directory_keeps_nobody_out);
	RUN_TEST(test_the_size_is_bounded_and_the_oldest_are_dropped_and_counted);
	RUN_TEST(test_what_is_refused_is_kept_aside_the_newest_eight_of_it);
	RUN_TEST(test_a_disk_that_takes_nothing_leaves_what_is_there);
	RUN_TEST(test_what_is_not_of_the_spool_stays_and_what_is_half_goes);
	RUN_TEST(test_a_file_that_is_too_long_is_no_batch);
	RUN_TEST(test_a_power_cut_leaves_whole_batches_and_all_that_were_written);
	return UNITY_END();
}
