/* SPDX-License-Identifier: MIT */
/* The limits of the control room: seats, seats and memory of a user, and crowds. */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "unity.h"

#include "tests/unit/aid/control_scene.h"

#define SOMEBODY 54321

static struct control_client clients[OWS_CONTROLLERS];
#define USERS 5
static struct config_holder users[USERS] = {{.id = SOMEBODY},
                                            {.id = SOMEBODY + 1},
                                            {.id = SOMEBODY + 2},
                                            {.id = SOMEBODY + 3},
                                            {.id = SOMEBODY + 4}};
static struct config_allow allow = {
	.text = "* user:54321", .pattern = "*", .holders = users, .holder_count = USERS};

void setUp(void)
{
	control_config.allows = &allow;
	control_config.allow_count = 1;
	control_open();
}

void tearDown(void)
{
	control_close();
}

static unsigned descriptors(void)
{
	DIR *all = opendir("/proc/self/fd");
	unsigned count = 0;

	TEST_ASSERT_NOT_NULL(all);
	while (readdir(all))
		count++;
	closedir(all);
	return count;
}

static void test_a_place_is_free_again_when_its_controller_has_left(void)
{
	struct control_client client;
	unsigned before = descriptors();

	for (unsigned i = 0; i < 1000; i++) {
		TEST_ASSERT_EQUAL(0, control_join(&client, OWS_HELLO_COMMAND, "one"));
		TEST_ASSERT_EQUAL_UINT(i + 1, client.welcome.serial);
		control_leave(&client);
	}
	control_wait_count("control_connections", 0);
	TEST_ASSERT_EQUAL_UINT(1000, control_joined());
	TEST_ASSERT_EQUAL_UINT(1000, control_left());
	/* the last memories are emptied a moment later */
	for (int ms = 0; descriptors() != before && ms < CONTROL_SCENE_MS; ms++)
		nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL); /* pace */
	TEST_ASSERT_EQUAL_UINT(before, descriptors());
}

static void test_no_more_controllers_join_than_there_are_places(void)
{
	struct control_client more;

	if (getuid())
		TEST_IGNORE_MESSAGE("only root may have all places");
	for (unsigned i = 0; i < OWS_CONTROLLERS; i++)
		TEST_ASSERT_EQUAL(0, control_join(&clients[i], OWS_HELLO_COMMAND, "many"));
	TEST_ASSERT_EQUAL(-ENOSPC, control_join(&more, OWS_HELLO_COMMAND, "more"));
	control_leave(&more);
	control_reload();
	TEST_ASSERT_EQUAL_UINT(OWS_CONTROLLERS, control_inside());
	control_leave(&clients[0]);
	control_wait_count("control_connections", OWS_CONTROLLERS - 1);
	TEST_ASSERT_EQUAL(0, control_join(&clients[0], OWS_HELLO_COMMAND, "again"));
	for (unsigned i = 0; i < OWS_CONTROLLERS; i++)
		control_leave(&clients[i]);
	control_wait_count("control_connections", 0);
	TEST_ASSERT_EQUAL_UINT(1, control_count("control_refused_limits"));
}

/* Its result is how many joined and, if half, how many connections it could leave half open. */
static int crowd(uint32_t uid, bool half, int hold)
{
	struct control_client client;
	int joined = 0;
	char byte;

	if (setgid(uid) < 0 || setuid(uid) < 0)
		return 255;
	for (int i = 0; i < 50; i++) {
		if (half)
			joined += control_connect() >= 0;
		else if (control_join(&client, OWS_HELLO_COMMAND, "crowd") == 0)
			joined++;
	}
	if (half && control_join(&client, OWS_HELLO_COMMAND, "crowd") == -ENOSPC)
		joined = 100;
	return read(hold, &byte, 1) < 0 ? 255 : joined;
}

static void check_crowd(bool half, int expected)
{
	struct control_client client;
	int hold[2], status;
	pid_t pid;

	if (getuid())
		TEST_IGNORE_MESSAGE("only root can be another user");
	TEST_ASSERT_EQUAL(0, pipe(hold));
	pid = fork();
	if (pid == 0) {
		close(hold[1]);
		_exit(crowd(SOMEBODY, half, hold[0]));
	}
	control_wait_count("control_connections", 32);
	/* they are in nobody's way */
	TEST_ASSERT_EQUAL(0, control_join(&client, OWS_HELLO_COMMAND, "other"));
	control_leave(&client);
	close(hold[1]);
	TEST_ASSERT_EQUAL(pid, waitpid(pid, &status, 0));
	close(hold[0]);
	TEST_ASSERT_TRUE(WIFEXITED(status));
	TEST_ASSERT_EQUAL(expected, WEXITSTATUS(status));
	control_wait_count("control_connections", 0);
}

static void test_a_user_has_32_places_at_most(void)
{
	check_crowd(false, 32);
}

static void test_connections_that_say_nothing_count_too(void)
{
	check_crowd(true, 100);
}

static void test_many_users_leave_root_a_place(void)
{
	struct control_client client;
	pid_t pids[USERS];
	int hold[2];

	if (getuid())
		TEST_IGNORE_MESSAGE("only root can be another user");
	TEST_ASSERT_EQUAL(0, pipe(hold));
	for (unsigned i = 0; i < USERS; i++) {
		pids[i] = fork();
		if (pids[i] == 0) {
			close(hold[1]);
			_exit(crowd(users[i].id, false, hold[0]));
		}
	}
	control_wait_count("control_refused_limits", USERS * 50 - (OWS_CONTROLLERS - 8));
	TEST_ASSERT_EQUAL(0, control_join(&client, OWS_HELLO_COMMAND, "root"));
	control_leave(&client);
	close(hold[1]);
	for (unsigned i = 0; i < USERS; i++)
		TEST_ASSERT_EQUAL(pids[i], waitpid(pids[i], NULL, 0));
	close(hold[0]);
	control_wait_count("control_connections", 0);
}

static void test_a_memory_is_emptied_though_its_user_keeps_the_file(void)
{
	struct control_client client;
	struct stat st = {.st_blocks = 1};
	char path[32];
	int kept, left_ms = CONTROL_SCENE_MS;

	TEST_ASSERT_EQUAL(0, control_join(&client, 0, "keeper"));
	snprintf(path, sizeof(path), "/proc/self/fd/%d", client.fds[0]);
	kept = open(path, O_PATH | O_CLOEXEC);
	TEST_ASSERT_GREATER_OR_EQUAL(0, kept);
	TEST_ASSERT_EQUAL(0, fstat(kept, &st));
	TEST_ASSERT_GREATER_THAN(0, st.st_blocks);
	control_leave(&client);
	while (fstat(kept, &st) == 0 && st.st_blocks && left_ms-- > 0)
		nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL); /* pace */
	TEST_ASSERT_EQUAL(0, st.st_blocks);
	close(kept);
}

static void test_a_thousand_programs_at_once_each_get_an_answer(void)
{
	struct rlimit files;
	unsigned welcome = 0, refused = 0;
	int fds[1000];

	TEST_ASSERT_EQUAL(0, getrlimit(RLIMIT_NOFILE, &files));
	if (files.rlim_max < 2048)
		TEST_IGNORE_MESSAGE("too few descriptors are allowed here");
	files.rlim_cur = 2048;
	TEST_ASSERT_EQUAL(0, setrlimit(RLIMIT_NOFILE, &files));
	for (unsigned i = 0; i < 1000; i++) {
		struct ows_hello hello = control_hello(OWS_HELLO_COMMAND, "crowd");

		fds[i] = control_connect();
		TEST_ASSERT_GREATER_OR_EQUAL(0, fds[i]);
		send(fds[i], &hello, sizeof(hello), MSG_NOSIGNAL);
	}
	for (unsigned i = 0; i < 1000; i++) {
		struct ows_welcome answer = {0};
		int got[3];

		TEST_ASSERT_EQUAL(0, control_receive(fds[i], &answer, got));
		welcome += answer.err == 0;
		refused += answer.err == -ENOSPC;
		for (int k = 0; k < 3; k++)
			if (got[k] >= 0)
				close(got[k]);
	}
	TEST_ASSERT_EQUAL_UINT(getuid() ? 32 : OWS_CONTROLLERS, welcome);
	TEST_ASSERT_EQUAL_UINT(1000, welcome + refused);
	for (unsigned i = 0; i < 1000; i++)
		close(fds[i]);
	control_wait_count("control_connections", 0);
	TEST_ASSERT_EQUAL_UINT(control_joined(), control_left());
}

static void test_without_a_descriptor_a_program_waits_until_there_is_one(void)
{
	struct ows_hello hello = control_hello(OWS_HELLO_COMMAND, "patient");
	struct ows_welcome answer = {0};
	struct rlimit before, full;
	int fd = dup(STDIN_FILENO), got[3];

	TEST_ASSERT_GREATER_OR_EQUAL(0, fd);
	close(fd);
	TEST_ASSERT_EQUAL(0, getrlimit(RLIMIT_NOFILE, &before));
	full = before;
	full.rlim_cur = (rlim_t)fd + 1; /* the one of the program */
	TEST_ASSERT_EQUAL(0, setrlimit(RLIMIT_NOFILE, &full));
	fd = control_connect();
	control_wait_count("control_refused_errors", 1);
	TEST_ASSERT_EQUAL(0, setrlimit(RLIMIT_NOFILE, &before));
	send(fd, &hello, sizeof(hello), MSG_NOSIGNAL);
	TEST_ASSERT_EQUAL(0, control_receive(fd, &answer, got));
	TEST_ASSERT_EQUAL_INT(0, answer.err);
	for (int i = 0; i < 3; i++)
		close(got[i]);
	close(fd);
	control_wait_count("control_connections", 0);
}

int main(void)
{
	signal(SIGPIPE, SIG_IGN);
	UNITY_BEGIN();
	RUN_TEST(test_a_place_is_free_again_when_its_controller_has_left);
	RUN_TEST(test_no_more_controllers_join_than_there_are_places);
	RUN_TEST(test_a_user_has_32_places_at_most);
	RUN_TEST(test_connections_that_say_nothing_count_too);
	RUN_TEST(test_many_users_leave_root_a_place);
	RUN_TEST(test_without_a_descriptor_a_program_waits_until_there_is_one);
	RUN_TEST(test_a_memory_is_emptied_though_its_user_keeps_the_file);
	RUN_TEST(test_a_thousand_programs_at_once_each_get_an_answer);
	return UNITY_END();
}
