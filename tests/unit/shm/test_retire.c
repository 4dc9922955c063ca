/* SPDX-License-Identifier: MIT */
/*
 * Tests of the segments of an owsd of layout 1, which the present one retires. What a program with
 * the library of that time does is written out here; it runs on segments that such an owsd made.
 */
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "unity.h"

#include "src/shm/futex.h"
#include "src/shm/owner.h"
#include "src/shm/retire.h"
#include "tests/unit/aid/folder.h"
#include "tests/unit/aid/recording.h"

#define STATE 16 /* offsets and numbers of major version 1 */
#define NEWS 128
enum { LIVE = 1, RETIRED = 2, STOPPED = 3 };

static char base[PLACE_PATH], path[PLACE_PATH + 80], bytes[SIZE_MAX_];
static const char *name;

void setUp(void)
{
	name = "OWS";
	snprintf(base, sizeof(base), "%s", folder_place()->path);
}

static const char *old_file(const char *kind)
{
	snprintf(path, sizeof(path), "%s/owsd.%s.%s", base, name, kind);
	return path;
}

void tearDown(void)
{
	static const char *const kinds[] = {"image", "command", "lock"};

	for (int i = 0; i < 3; i++)
		if (unlink(old_file(kinds[i])) < 0)
			rmdir(path);
}

static void put(const char *kind, const char *recorded, mode_t mode)
{
	uint32_t size = read_recording(recorded, bytes);
	int fd = open(old_file(kind), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);

	TEST_ASSERT_GREATER_OR_EQUAL(0, fd);
	TEST_ASSERT_EQUAL(size, write(fd, bytes, size));
	TEST_ASSERT_EQUAL(0, fchmod(fd, mode));
	close(fd);
}

static void put_both(void)
{
	put("command", RECORDED_BEFORE "command", 0660);
	put("image", RECORDED_BEFORE "image", 0640);
}

/* --- A program with the library of layout 1 --------------------------------------------------- */

struct old {
	char *image, *command;
	size_t image_size, command_size;
};

static uint32_t word_at(const char *memory, size_t at)
{
	return __atomic_load_n((const uint32_t *)(const void *)(memory + at), __ATOMIC_ACQUIRE);
}

static int old_map(const char *kind, bool write, const char *magic, char **memory, size_t *size)
{
	int fd = open(old_file(kind), (write ? O_RDWR : O_RDONLY) | O_NOFOLLOW | O_CLOEXEC);
	struct stat st;

	if (fd < 0)
		return errno == ELOOP ? -EPERM : -errno;
	TEST_ASSERT_EQUAL(0, fstat(fd, &st));
	if (!S_ISREG(st.st_mode) || !owner_trusted(st.st_uid) || st.st_size < 256) {
		close(fd);
		return st.st_size < 256 ? -EPROTO : -EPERM;
	}
	*size = (size_t)st.st_size;
	*memory = mmap(NULL, *size, PROT_READ | (write ? PROT_WRITE : 0), MAP_SHARED, fd, 0);
	close(fd);
	TEST_ASSERT_TRUE(*memory != MAP_FAILED);
	if (memcmp(*memory, magic, 4) == 0 && (word_at(*memory, 4) & 0xffff) == 1 &&
	    word_at(*memory, 8) == *size)
		return 0;
	munmap(*memory, *size);
	return -EPROTO;
}

static int old_open(struct old *old)
{
	int err = old_map("image", false, "OWSI", &old->image, &old->image_size);

	if (err)
		return err;
	err = old_map("command", true, "OWSC", &old->command, &old->command_size);
	if (err)
		munmap(old->image, old->image_size);
	return err;
}

static void old_close(struct old *old)
{
	munmap(old->image, old->image_size);
	munmap(old->command, old->command_size);
}

static int old_get(const struct old *old)
{
	return word_at(old->image, STATE) == LIVE ? 0 : -ESTALE;
}

/* May ows_get() call a value good? In a live or retired image, while the heartbeat is young. */
static bool old_may_be_good(const struct old *old)
{
	uint32_t state = word_at(old->image, STATE);

	return state == LIVE || state == RETIRED;
}

/* ows_set(): looks before the value is written, and again after the bell. */
static int old_set(struct old *old)
{
	if (word_at(old->command, STATE) != LIVE)
		return -ESTALE;
	__atomic_fetch_add((uint32_t *)(void *)(old->command + 256 + 8), 1, __ATOMIC_RELEASE);
	return word_at(old->command, STATE) == LIVE ? 0 : -ESTALE;
}

/* ows_reopen() of a handle that may set. */
static int old_reopen(void)
{
	struct old again;
	int err = old_open(&again);

	if (!err)
		old_close(&again);
	return err == -EPROTO ? -ENOENT : err;
}

/* --- Tests ------------------------------------------------------------------------------------ */

static void test_a_program_that_runs_gets_estale_and_sets_nothing_into_the_void(void)
{
	struct old old;
	uint32_t stamp;

	put_both();
	TEST_ASSERT_EQUAL(0, old_open(&old));
	TEST_ASSERT_EQUAL(0, old_get(&old));
	TEST_ASSERT_TRUE(old_may_be_good(&old));
	TEST_ASSERT_EQUAL(0, old_set(&old));
	stamp = word_at(old.command, 256 + 8);
	TEST_ASSERT_EQUAL(2, retire_segments(base, name));
	TEST_ASSERT_EQUAL(-ESTALE, old_get(&old));
	TEST_ASSERT_FALSE(old_may_be_good(&old));
	TEST_ASSERT_EQUAL(-ESTALE, old_set(&old));
	TEST_ASSERT_EQUAL(stamp, word_at(old.command, 256 + 8));
	TEST_ASSERT_EQUAL(-ENOENT, old_reopen());
	TEST_ASSERT_EQUAL(-ESTALE, old_set(&old));
	old_close(&old);
}

static void test_a_program_that_starts_later_gets_eproto(void)
{
	struct old old;

	put_both();
	TEST_ASSERT_EQUAL(2, retire_segments(base, name));
	TEST_ASSERT_EQUAL(-EPROTO, old_open(&old));
}

static int sleeper;

static void *sleep_on_news(void *arg)
{
	const struct old *old = arg;
	const uint32_t *news = (const void *)(old->image + NEWS);

	__atomic_store_n(&sleeper, (int)syscall(SYS_gettid), __ATOMIC_RELEASE);
	while (word_at(old->image, STATE) == LIVE)
		if (segment_wait(news, *news, 100 * S) == -ETIMEDOUT)
			return NULL;
	return arg;
}

static bool sleeps(int task)
{
	char file[64], text[256], *end;
	size_t len;
	FILE *stat;

	snprintf(file, sizeof(file), "/proc/self/task/%d/stat", task);
	stat = fopen(file, "re");
	len = stat ? fread(text, 1, sizeof(text) - 1, stat) : 0;
	text[len] = '\0';
	end = strrchr(text, ')');
	if (stat)
		fclose(stat);
	return end && end[2] == 'S';
}

static void test_a_program_that_sleeps_is_woken(void)
{
	pthread_t thread;
	struct old old;
	void *woken;

	put_both();
	TEST_ASSERT_EQUAL(0, old_open(&old));
	TEST_ASSERT_EQUAL(0, pthread_create(&thread, NULL, sleep_on_news, &old));
	while (!sleeps(__atomic_load_n(&sleeper, __ATOMIC_ACQUIRE)))
		sched_yield();
	TEST_ASSERT_EQUAL(2, retire_segments(base, name));
	TEST_ASSERT_EQUAL(0, pthread_join(thread, &woken));
	TEST_ASSERT_NOT_NULL(woken);
	old_close(&old);
}

static unsigned files_in_base(void)
{
	char command[PLACE_PATH + 40];
	unsigned count = 0;
	FILE *list;

	snprintf(command, sizeof(command), "ls -A '%s' | wc -l", base);
	list = popen(command, "re");
	TEST_ASSERT_NOT_NULL(list);
	TEST_ASSERT_EQUAL(1, fscanf(list, "%u", &count));
	pclose(list);
	return count;
}

static void test_a_stub_of_the_present_version_stays_in_place_of_each(void)
{
	static const char *const kinds[] = {"image", "command"};
	struct stat st;

	put_both();
	put("lock", RECORDED_BEFORE "command", 0600);
	TEST_ASSERT_EQUAL(2, retire_segments(base, name));
	for (int i = 0; i < 2; i++) {
		FILE *file = fopen(old_file(kinds[i]), "re");

		TEST_ASSERT_NOT_NULL(file);
		TEST_ASSERT_EQUAL(256, fread(bytes, 1, sizeof(bytes), file));
		fclose(file);
		TEST_ASSERT_EQUAL(0, memcmp(bytes, i ? "OWSC" : "OWSI", 4));
		TEST_ASSERT_EQUAL(2, word_at(bytes, 4) & 0xffff);
		TEST_ASSERT_EQUAL(256, word_at(bytes, 8));
		TEST_ASSERT_EQUAL(STOPPED, word_at(bytes, STATE));
		TEST_ASSERT_EQUAL(0, stat(path, &st));
		TEST_ASSERT_EQUAL_MESSAGE(0640, st.st_mode & 07777,
		                          "nobody writes a segment of before there");
	}
	TEST_ASSERT_EQUAL_MESSAGE(2, files_in_base(), "the lock and other names are gone");
	TEST_ASSERT_EQUAL_MESSAGE(0, retire_segments(base, name), "it is done once");
}

static void test_names_of_the_greatest_length_are_found(void)
{
	name = "12345678901234567890123456789012";
	put_both();
	TEST_ASSERT_EQUAL(2, retire_segments(base, name));
}

static void test_without_segments_of_before_nothing_is_made(void)
{
	TEST_ASSERT_EQUAL(0, retire_segments(base, name));
	TEST_ASSERT_EQUAL(0, files_in_base());
	TEST_ASSERT_EQUAL(0, retire_segments("/nowhere/at/all", name));
}

static void unchanged(const char *what)
{
	struct stat before, after;

	TEST_ASSERT_EQUAL(0, lstat(path, &before));
	TEST_ASSERT_EQUAL_MESSAGE(0, retire_segments(base, name), what);
	TEST_ASSERT_EQUAL(0, lstat(path, &after));
	TEST_ASSERT_EQUAL_MESSAGE(before.st_ino, after.st_ino, what);
	TEST_ASSERT_EQUAL_MESSAGE(before.st_mtim.tv_nsec, after.st_mtim.tv_nsec, what);
}

static void test_what_is_no_segment_of_before_is_left_alone(void)
{
	char victim[PLACE_PATH + 80];

	put("victim", RECORDED_BEFORE "image", 0600);
	snprintf(victim, sizeof(victim), "%s", path);
	TEST_ASSERT_EQUAL(0, symlink(victim, old_file("image")));
	unchanged("a link");
	TEST_ASSERT_EQUAL(0, unlink(path));
	TEST_ASSERT_EQUAL(0, mkfifo(path, 0600));
	unchanged("a pipe");
	TEST_ASSERT_EQUAL(0, unlink(path));
	TEST_ASSERT_EQUAL(0, mkdir(path, 0700));
	unchanged("a directory");
	TEST_ASSERT_EQUAL(0, rmdir(path));
	put("image", RECORDED_BEFORE "command", 0600);
	unchanged("another magic number");
	TEST_ASSERT_EQUAL(0, unlink(path));
	put("image", RECORDED_BEFORE "image", 0600);
	TEST_ASSERT_EQUAL(0, truncate(path, 255));
	unchanged("too short");
	if (geteuid() == 0) {
		TEST_ASSERT_EQUAL(0, unlink(path));
		put("image", RECORDED_BEFORE "image", 0666);
		TEST_ASSERT_EQUAL(0, chown(path, 4711, 4711));
		unchanged("another user's");
	}
	TEST_ASSERT_EQUAL(0, unlink(victim));
}

static void *toggle(void *arg)
{
	int fd = __atomic_load_n((int *)arg, __ATOMIC_RELAXED);

	while (fd == __atomic_load_n((int *)arg, __ATOMIC_RELAXED))
		if (ftruncate(fd, 0) < 0 || ftruncate(fd, 8192) < 0)
			break;
	return NULL;
}

static void test_whoever_may_truncate_a_segment_does_no_harm(void)
{
	for (int i = 0; i < 100; i++) {
		pthread_t thread;
		int fd, kept;

		put("command", RECORDED_BEFORE "command", 0660);
		kept = fd = open(path, O_RDWR | O_CLOEXEC);
		TEST_ASSERT_GREATER_OR_EQUAL(0, fd);
		TEST_ASSERT_EQUAL(0, pthread_create(&thread, NULL, toggle, &fd));
		TEST_ASSERT_LESS_OR_EQUAL(1, retire_segments(base, name));
		__atomic_store_n(&fd, -1, __ATOMIC_RELAXED);
		pthread_join(thread, NULL);
		close(kept);
		TEST_ASSERT_EQUAL(0, unlink(old_file("command")));
	}
}

/* Another process holds the lock's file, which has this mode. What is seen of it? */
static pid_t seen_with(mode_t mode, uid_t owner, pid_t *holder)
{
	struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET, .l_len = 1};
	int ready[2], done[2], status;
	pid_t seen;
	char c;

	TEST_ASSERT_EQUAL(0, pipe(ready));
	TEST_ASSERT_EQUAL(0, pipe(done));
	*holder = fork();
	if (*holder == 0) {
		int fd = open(old_file("lock"), O_RDWR | O_CREAT, 0600);

		close(done[1]);
		if (dprintf(fd, "%d\n", (int)getpid()) < 0 || fcntl(fd, F_OFD_SETLK, &lock) < 0 ||
		    fchmod(fd, mode) < 0 || fchown(fd, owner, (gid_t)-1) < 0 ||
		    write(ready[1], "x", 1) != 1 || read(done[0], &c, 1) != 0)
			_exit(1);
		_exit(0);
	}
	TEST_ASSERT_EQUAL(1, read(ready[0], &c, 1));
	seen = retire_running(base, name);
	close(done[1]);
	TEST_ASSERT_EQUAL(*holder, waitpid(*holder, &status, 0));
	TEST_ASSERT_EQUAL(0, status);
	close(ready[0]);
	close(ready[1]);
	close(done[0]);
	TEST_ASSERT_EQUAL(0, retire_running(base, name));
	TEST_ASSERT_EQUAL(0, unlink(old_file("lock")));
	return seen;
}

static void test_an_owsd_of_before_that_runs_is_found_by_its_lock(void)
{
	pid_t holder, seen;

	TEST_ASSERT_EQUAL(0, retire_running(base, name));
	seen = seen_with(0600, geteuid(), &holder);
	TEST_ASSERT_EQUAL(holder, seen);
}

static void test_a_lock_that_others_could_hold_proves_no_owsd(void)
{
	pid_t holder;

	TEST_ASSERT_EQUAL_MESSAGE(0, seen_with(0660, geteuid(), &holder),
	                          "a command segment under the lock's name");
	if (geteuid() == 0)
		TEST_ASSERT_EQUAL_MESSAGE(0, seen_with(0600, 4711, &holder), "a stranger's");
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_program_that_runs_gets_estale_and_sets_nothing_into_the_void);
	RUN_TEST(test_a_program_that_starts_later_gets_eproto);
	RUN_TEST(test_a_program_that_sleeps_is_woken);
	RUN_TEST(test_a_stub_of_the_present_version_stays_in_place_of_each);
	RUN_TEST(test_names_of_the_greatest_length_are_found);
	RUN_TEST(test_without_segments_of_before_nothing_is_made);
	RUN_TEST(test_what_is_no_segment_of_before_is_left_alone);
	RUN_TEST(test_whoever_may_truncate_a_segment_does_no_harm);
	RUN_TEST(test_an_owsd_of_before_that_runs_is_found_by_its_lock);
	RUN_TEST(test_a_lock_that_others_could_hold_proves_no_owsd);
	return UNITY_END();
}
