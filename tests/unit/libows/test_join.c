/* SPDX-License-Identifier: MIT */
/* Tests of becoming a controller: what libows believes of a welcome, and what becomes of
 * descriptors. */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "unity.h"

#include "tests/unit/aid/folder.h"
#include "tests/unit/aid/instance.h"

static const struct instance_signal signals[] = {
	{"heat", "/3A.1/PIO.A", OWS_BOOL, true, 0},
	{"label", "/23.1/memory", OWS_STRING, true, 0},
};
#define COUNT 2

static struct instance in;

void setUp(void)
{
	instance_start(&in, "join", signals, COUNT);
}

void tearDown(void)
{
	instance_end(&in);
}

static unsigned descriptors(void)
{
	DIR *directory = opendir("/proc/self/fd");
	unsigned count = 0;

	while (readdir(directory) != NULL)
		count++;
	closedir(directory);
	return count;
}

static void expect(enum door_lie lie, int err)
{
	struct ows *h;

	door_lie(in.door, lie);
	TEST_ASSERT_EQUAL_MESSAGE(err, ows_open(in.name, OWS_CONTROL, &h), "a lie was believed");
	TEST_ASSERT_NULL(h);
}

static void test_a_welcome_that_lies_is_refused(void)
{
	expect(DOOR_OTHER_MAGIC, -EPROTO);
	expect(DOOR_OTHER_MAJOR, -EPROTO);
	expect(DOOR_SHORT, -EPROTO);
	expect(DOOR_NO_FDS, -EPROTO);
	expect(DOOR_ONE_FD, -EPROTO);
	expect(DOOR_MANY_FDS, -EMFILE);
	expect(DOOR_NO_SEALS, -EPROTO);
	expect(DOOR_OTHER_SIZE, -EPROTO);
	expect(DOOR_SMALL, -EPROTO);
	expect(DOOR_OTHER_MEMORY, -EPROTO);
	expect(DOOR_OUTSIDE, -EPROTO);
}

static void test_a_refusal_is_passed_on(void)
{
	expect(DOOR_REFUSES, -EACCES);
	expect(DOOR_HANGS_UP, -ENOENT);
}

static void test_an_owsd_that_does_not_answer_is_waited_for_two_seconds(void)
{
	int64_t before = ows_now();

	expect(DOOR_SILENT, -ETIMEDOUT);
	TEST_ASSERT_GREATER_OR_EQUAL_INT64(2 * INSTANCE_S, ows_now() - before);
}

static void test_a_memory_of_another_generation_is_not_used(void)
{
	expect(DOOR_OTHER_START, -ETIMEDOUT);
}

/* The test is the door too, which keeps its end of each connection until it hangs up. */
static void test_no_descriptor_is_left_behind(void)
{
	unsigned before, opened = 0;
	struct ows *h;

	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_CONTROL, &h));
	ows_close(h);
	door_wait_gone(in.door, 0);
	before = descriptors();
	for (int lie = DOOR_HONEST; lie < DOOR_LIES; lie++) {
		door_lie(in.door, (enum door_lie)lie);
		if (ows_open(in.name, OWS_CONTROL, &h) == 0)
			opened++;
		ows_close(h);
		door_wait_gone(in.door, instance_controllers(&in) - 1);
	}
	TEST_ASSERT_EQUAL(2, opened); /* and the one that loses only what comes later */
	/* the door itself keeps three for each that it has welcomed */
	TEST_ASSERT_EQUAL(before + 3 * (instance_controllers(&in) - 1), descriptors());
}

#define LOOKED_AT 256

static void test_descriptors_are_closed_on_exec(void)
{
	bool before[LOOKED_AT];
	struct ows *h;

	for (int fd = 0; fd < LOOKED_AT; fd++)
		before[fd] = fcntl(fd, F_GETFD) >= 0;
	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_CONTROL, &h));
	for (int fd = 0; fd < LOOKED_AT; fd++) {
		int flags = before[fd] ? -1 : fcntl(fd, F_GETFD);

		if (flags >= 0)
			TEST_ASSERT_TRUE_MESSAGE(flags & FD_CLOEXEC, "a program would inherit it");
	}
	ows_close(h);
}

/* With one descriptor more at each try it opens at last, and says before what is missing. */
static int open_with_few(void)
{
	rlim_t most = descriptors() + 16;
	struct rlimit limit;
	struct ows *h;

	for (rlim_t few = 0; few < most; few++) {
		int err;

		getrlimit(RLIMIT_NOFILE, &limit);
		limit.rlim_cur = few;
		setrlimit(RLIMIT_NOFILE, &limit);
		err = ows_open(in.name, OWS_CONTROL, &h);
		if (err == 0)
			return few > 0 ? 0 : 1;
		if (err != -EMFILE)
			return 2;
	}
	return 3;
}

static void test_a_program_without_a_free_descriptor_is_told_so(void)
{
	pid_t child = fork();
	int status;

	if (child == 0)
		_exit(open_with_few());
	TEST_ASSERT_EQUAL(child, waitpid(child, &status, 0));
	TEST_ASSERT_EQUAL(0, status);
}

static void test_a_forked_child_takes_no_news_from_its_parent(void)
{
	struct pollfd poll_fd = {.events = POLLIN};
	const uint64_t one = 1;
	struct ows *h;
	uint32_t news = 0;
	pid_t child;
	int status;

	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_CONTROL, &h));
	poll_fd.fd = ows_fd(h);
	TEST_ASSERT_GREATER_OR_EQUAL(0, poll_fd.fd);
	ows_wait(h, &news, 0);
	TEST_ASSERT_EQUAL(sizeof(one), write(door_controller(in.door, 0)->news, &one, sizeof(one)));
	child = fork();
	if (child == 0)
		_exit(ows_wait(h, &news, 1000000) == 0 ? 0 : 1);
	TEST_ASSERT_EQUAL(child, waitpid(child, &status, 0));
	TEST_ASSERT_EQUAL(0, status);
	TEST_ASSERT_EQUAL(1, poll(&poll_fd, 1, 0));
	ows_close(h);
}

static void test_nobody_who_listens_is_no_owsd(void)
{
	struct ows *h;

	instance_kill(&in);
	TEST_ASSERT_EQUAL(-ENOENT, ows_open(in.name, OWS_CONTROL, &h));
	/* what is no socket is none either */
	close(open(folder_file(in.name, "control"), O_CREAT | O_WRONLY | O_CLOEXEC, 0600));
	TEST_ASSERT_EQUAL(-ENOENT, ows_open(in.name, OWS_CONTROL, &h));
	TEST_ASSERT_EQUAL(0, unlink(folder_file(in.name, "control")));
}

static void test_a_hang_up_raises_no_sigpipe(void)
{
	struct sigaction by_default = {.sa_handler = SIG_DFL}, before;
	struct ows *h;

	TEST_ASSERT_EQUAL(0, sigaction(SIGPIPE, &by_default, &before));
	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_CONTROL, &h));
	instance_kill(&in);
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "heat"), 1, NULL));
	TEST_ASSERT_EQUAL(-ENOENT, ows_reopen(h));
	TEST_ASSERT_EQUAL(-ESTALE, ows_set(h, ows_find(h, "heat"), 1, NULL));
	ows_close(h);
	TEST_ASSERT_EQUAL(0, sigaction(SIGPIPE, &before, NULL));
}

static void test_errno_is_left_alone(void)
{
	struct ows *h;

	errno = EDOM;
	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_CONTROL, &h));
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "heat"), 1, NULL));
	TEST_ASSERT_EQUAL(0, ows_reopen(h));
	instance_kill(&in);
	TEST_ASSERT_EQUAL(-ENOENT, ows_reopen(h));
	ows_close(h);
	TEST_ASSERT_EQUAL(-ENOENT, ows_open(in.name, OWS_CONTROL, &h));
	TEST_ASSERT_EQUAL(EDOM, errno);
}

static void test_a_program_without_room_for_the_descriptor_asks_again_later(void)
{
	struct rlimit had, none;
	struct ows *h;

	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_CONTROL, &h));
	TEST_ASSERT_EQUAL(0, getrlimit(RLIMIT_NOFILE, &had));
	none = (struct rlimit){.rlim_max = had.rlim_max};
	TEST_ASSERT_EQUAL(0, setrlimit(RLIMIT_NOFILE, &none));
	errno = EDOM;
	TEST_ASSERT_EQUAL(-EMFILE, ows_fd(h));
	TEST_ASSERT_EQUAL(EDOM, errno);
	TEST_ASSERT_EQUAL(0, setrlimit(RLIMIT_NOFILE, &had));
	TEST_ASSERT_GREATER_OR_EQUAL(0, ows_fd(h));
	TEST_ASSERT_EQUAL(EDOM, errno);
	ows_close(h);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_welcome_that_lies_is_refused);
	RUN_TEST(test_a_refusal_is_passed_on);
	RUN_TEST(test_an_owsd_that_does_not_answer_is_waited_for_two_seconds);
	RUN_TEST(test_a_memory_of_another_generation_is_not_used);
	RUN_TEST(test_no_descriptor_is_left_behind);
	RUN_TEST(test_descriptors_are_closed_on_exec);
	RUN_TEST(test_a_program_without_a_free_descriptor_is_told_so);
	RUN_TEST(test_a_forked_child_takes_no_news_from_its_parent);
	RUN_TEST(test_nobody_who_listens_is_no_owsd);
	RUN_TEST(test_a_hang_up_raises_no_sigpipe);
	RUN_TEST(test_errno_is_left_alone);
	RUN_TEST(test_a_program_without_room_for_the_descriptor_asks_again_later);
	return UNITY_END();
}
