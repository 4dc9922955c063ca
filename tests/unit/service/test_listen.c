/* SPDX-License-Identifier: MIT */
/* The sockets of a program: their rights, and what was left of another one. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "src/ground/service/listen.h"

static char folder[] = "/tmp/listen.XXXXXX";
static struct sockaddr_un at = {.sun_family = AF_UNIX};

void setUp(void)
{
	strcpy(folder + strlen(folder) - 6, "XXXXXX");
	TEST_ASSERT_NOT_NULL(mkdtemp(folder));
	snprintf(at.sun_path, sizeof(at.sun_path), "%s/socket", folder);
}

void tearDown(void)
{
	unlink(at.sun_path);
	rmdir(folder);
}

static int make(mode_t mode)
{
	int fd = listen_local(&at, SOCK_STREAM, mode, (gid_t)-1);

	TEST_ASSERT_GREATER_OR_EQUAL(0, fd);
	TEST_ASSERT_EQUAL(0, listen(fd, 4));
	return fd;
}

static int dial(void)
{
	int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);

	TEST_ASSERT_EQUAL(0, connect(fd, (const struct sockaddr *)&at, sizeof(at)));
	return fd;
}

static void test_a_socket_has_the_mode_that_is_asked_for_whatever_the_umask(void)
{
	static const mode_t modes[] = {0600, 0660, 0666};
	struct stat st;

	for (size_t i = 0; i < sizeof(modes) / sizeof(modes[0]); i++) {
		int fd = make(modes[i]);

		TEST_ASSERT_EQUAL(0, stat(at.sun_path, &st));
		TEST_ASSERT_EQUAL_HEX(modes[i], st.st_mode & 0777);
		close(fd);
		TEST_ASSERT_EQUAL(0, listen_vacate(&at));
	}
}

static void test_what_a_process_listens_at_is_left_alone(void)
{
	int fd = make(0600);

	TEST_ASSERT_EQUAL(-EADDRINUSE, listen_vacate(&at));
	close(fd);
	TEST_ASSERT_EQUAL(0, listen_vacate(&at));
	TEST_ASSERT_EQUAL(-1, access(at.sun_path, F_OK));
	TEST_ASSERT_EQUAL(0, listen_vacate(&at));
}

static void test_a_file_that_is_no_socket_is_left_alone(void)
{
	FILE *file = fopen(at.sun_path, "w");

	fclose(file);
	TEST_ASSERT_EQUAL(-EEXIST, listen_vacate(&at));
	TEST_ASSERT_EQUAL(0, access(at.sun_path, F_OK));
}

static void test_a_byte_out_of_band_keeps_its_place(void)
{
	struct sockaddr_storage from = {0};
	socklen_t len = sizeof(from);
	int fd = make(0600), peer = dial(), connection;
	char bytes[4] = "";

	connection = listen_accept(fd, (struct sockaddr *)&from, &len);
	TEST_ASSERT_GREATER_OR_EQUAL(0, connection);
	TEST_ASSERT_EQUAL(AF_UNIX, from.ss_family);
	if (send(peer, "!", 1, MSG_OOB) != 1)
		TEST_IGNORE_MESSAGE("this kernel has no byte out of band for these sockets");
	TEST_ASSERT_EQUAL(1, recv(connection, bytes, sizeof(bytes), MSG_DONTWAIT));
	TEST_ASSERT_EQUAL('!', bytes[0]);
	close(connection);
	close(peer);
	close(fd);
}

static void test_nobody_who_connects_is_no_error_of_the_listener(void)
{
	struct sockaddr_storage from = {0};
	socklen_t len = sizeof(from);
	int fd = make(0600);

	TEST_ASSERT_EQUAL(-EAGAIN, listen_accept(fd, (struct sockaddr *)&from, &len));
	close(fd);
}

static void test_without_a_service_manager_there_is_no_socket_of_it(void)
{
	int fds[2];
	char pid[16];

	unsetenv("LISTEN_PID");
	TEST_ASSERT_EQUAL(0, listen_inherited(fds, 2));
	snprintf(pid, sizeof(pid), "%d", (int)getpid() + 1);
	setenv("LISTEN_PID", pid, 1);
	setenv("LISTEN_FDS", "1", 1);
	TEST_ASSERT_EQUAL(0, listen_inherited(fds, 2));
	snprintf(pid, sizeof(pid), "%d", (int)getpid());
	setenv("LISTEN_PID", pid, 1);
	setenv("LISTEN_FDS", "3", 1);
	TEST_ASSERT_EQUAL(-EINVAL, listen_inherited(fds, 2));
	TEST_ASSERT_NULL(getenv("LISTEN_FDS"));
}

static void test_an_address_that_cannot_be_had_has_a_remedy(void)
{
	TEST_ASSERT_NOT_NULL(strstr(listen_remedy(-EADDRINUSE), "ss -ltnp"));
	TEST_ASSERT_NOT_NULL(strstr(listen_remedy(-EACCES), "1024"));
	TEST_ASSERT_NOT_NULL(strstr(listen_remedy(-EADDRNOTAVAIL), "ip addr"));
	TEST_ASSERT_EQUAL_STRING("", listen_remedy(-EMFILE));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_socket_has_the_mode_that_is_asked_for_whatever_the_umask);
	RUN_TEST(test_what_a_process_listens_at_is_left_alone);
	RUN_TEST(test_a_file_that_is_no_socket_is_left_alone);
	RUN_TEST(test_a_byte_out_of_band_keeps_its_place);
	RUN_TEST(test_nobody_who_connects_is_no_error_of_the_listener);
	RUN_TEST(test_without_a_service_manager_there_is_no_socket_of_it);
	RUN_TEST(test_an_address_that_cannot_be_had_has_a_remedy);
	return UNITY_END();
}
