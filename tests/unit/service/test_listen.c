/* SPDX-License-Identifier: MIT */
/* The sockets of a program: their rights, and what was left of another one. */
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "unity.h"

#include "src/ground/service/listen.h"
#include "tests/unit/aid/corpse.h"

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
	int fd = listen_at_path(at.sun_path, mode, (gid_t)-1);

	TEST_ASSERT_GREATER_OR_EQUAL(0, fd);
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
	}
}

static void test_what_a_process_listens_at_is_left_alone(void)
{
	int fd = make(0600);

	TEST_ASSERT_EQUAL(-EADDRINUSE, listen_at_path(at.sun_path, 0600, (gid_t)-1));
	close(fd);
	close(make(0600));
}

static void listen_there(void)
{
	make(0600);
}

static void test_the_socket_of_a_killed_process_that_is_stuck_is_not_in_the_way(void)
{
	struct corpse corpse;

	corpse_make(&corpse, listen_there);
	close(dial()); /* the kernel connects, and nobody answers */
	close(make(0600));
	corpse_end(&corpse);
}

static void test_a_file_that_is_no_socket_is_left_alone(void)
{
	FILE *file = fopen(at.sun_path, "w");

	fclose(file);
	TEST_ASSERT_EQUAL(-EEXIST, listen_at_path(at.sun_path, 0600, (gid_t)-1));
	TEST_ASSERT_EQUAL(0, access(at.sun_path, F_OK));
}

static void test_a_path_that_no_address_has_room_for_is_refused(void)
{
	char path[sizeof(at.sun_path) + 1];

	memset(path, 'a', sizeof(path) - 1);
	path[sizeof(path) - 1] = '\0';
	TEST_ASSERT_EQUAL(-ENAMETOOLONG, listen_at_path(path, 0600, (gid_t)-1));
}

static void test_at_a_name_of_a_folder_it_replaces_what_is_there(void)
{
	int directory = open(folder, O_PATH | O_DIRECTORY | O_CLOEXEC), before = make(0600);
	int fd = listen_at_name(directory, "socket", SOCK_STREAM, 0666, (gid_t)-1), peer;
	struct stat st;

	TEST_ASSERT_GREATER_OR_EQUAL(0, fd);
	TEST_ASSERT_EQUAL(0, stat(at.sun_path, &st));
	TEST_ASSERT_EQUAL_HEX(0666, st.st_mode & 0777);
	close(before);
	peer = dial();
	close(peer);
	close(fd);
	close(directory);
}

static void test_a_socket_that_another_process_put_in_its_place_is_not_removed(void)
{
	int directory = open(folder, O_PATH | O_DIRECTORY | O_CLOEXEC), before = make(0600), fd;
	struct listen_file own = listen_file_at(AT_FDCWD, at.sun_path), other;

	fd = listen_at_name(directory, "socket", SOCK_STREAM, 0600, (gid_t)-1);
	TEST_ASSERT_GREATER_OR_EQUAL(0, fd);
	other = listen_file_at(directory, "socket");
	listen_remove(AT_FDCWD, at.sun_path, &own);
	close(before);
	close(dial());
	listen_remove(directory, "socket", &other);
	TEST_ASSERT_EQUAL(-1, access(at.sun_path, F_OK));
	/* a file that was never there is not the one that is there now, and none is no error */
	own = listen_file_at(directory, "socket");
	listen_remove(directory, "socket", &own);
	close(make(0600));
	listen_remove(directory, "socket", &own);
	TEST_ASSERT_EQUAL(0, access(at.sun_path, F_OK));
	close(fd);
	close(directory);
}

static void test_an_address_of_another_machine_is_served_later_if_that_is_asked_for(void)
{
	struct sockaddr_storage to = {0};
	struct sockaddr_in *v4 = (struct sockaddr_in *)&to;
	int fd;

	/* 192.0.2.0/24 is for documentation */
	*v4 = (struct sockaddr_in){.sin_family = AF_INET, .sin_addr.s_addr = htonl(0xc0000201)};
	TEST_ASSERT_EQUAL(-EADDRNOTAVAIL, listen_at_address(&to, true, false));
	fd = listen_at_address(&to, true, true);
	TEST_ASSERT_GREATER_OR_EQUAL(0, fd);
	close(fd);
}

static void test_an_address_of_another_machine_is_not_here(void)
{
	struct sockaddr_storage to = {0};
	struct sockaddr_in *v4 = (struct sockaddr_in *)&to;

	*v4 = (struct sockaddr_in){.sin_family = AF_INET, .sin_addr.s_addr = htonl(0xc0000201)};
	TEST_ASSERT_FALSE(listen_is_here(&to));
	v4->sin_addr.s_addr = htonl(INADDR_ANY);
	TEST_ASSERT_TRUE(listen_is_here(&to));
	/* also with a port that this user may not have, or that is taken */
	v4->sin_addr.s_addr = htonl(INADDR_LOOPBACK);
	v4->sin_port = htons(1);
	TEST_ASSERT_TRUE(listen_is_here(&to));
	TEST_ASSERT_EQUAL_UINT16(1, ntohs(v4->sin_port));
}

static void test_an_address_has_one_listener(void)
{
	struct sockaddr_storage to = {0}, from = {0};
	struct sockaddr_in *v4 = (struct sockaddr_in *)&to;
	socklen_t len = sizeof(to);
	int fd, peer = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0), connection;

	*v4 = (struct sockaddr_in){.sin_family = AF_INET,
	                           .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
	fd = listen_at_address(&to, true, false);
	TEST_ASSERT_GREATER_OR_EQUAL(0, fd);
	TEST_ASSERT_EQUAL(0, getsockname(fd, (struct sockaddr *)&to, &len));
	TEST_ASSERT_EQUAL(-EADDRINUSE, listen_at_address(&to, true, false));
	TEST_ASSERT_EQUAL(0, connect(peer, (struct sockaddr *)&to, sizeof(*v4)));
	connection = listen_accept(fd, (struct sockaddr *)&from, &len);
	TEST_ASSERT_GREATER_OR_EQUAL(0, connection);
	close(connection);
	close(peer);
	close(fd);
}

static void test_no_room_for_a_connection_is_no_error_of_it(void)
{
	TEST_ASSERT_TRUE(listen_is_full(-EMFILE) && listen_is_full(-ENFILE) &&
	                 listen_is_full(-ENOMEM) && listen_is_full(-ENOBUFS));
	TEST_ASSERT_FALSE(listen_is_full(-EAGAIN) || listen_is_full(-ECONNABORTED) ||
	                  listen_is_full(0));
}

static void test_listeners_that_pause_are_not_ready(void)
{
	int fds[] = {-1, make(0600)}, epoll = epoll_create1(EPOLL_CLOEXEC), peer = dial();
	struct epoll_event event = {.events = EPOLLIN, .data.u32 = 1};

	TEST_ASSERT_EQUAL(0, epoll_ctl(epoll, EPOLL_CTL_ADD, fds[1], &event));
	TEST_ASSERT_EQUAL(1, epoll_wait(epoll, &event, 1, 0));
	listen_pause(epoll, fds, 2);
	TEST_ASSERT_EQUAL(0, epoll_wait(epoll, &event, 1, 0));
	listen_resume(epoll, fds, 2);
	event.data.u32 = 0;
	TEST_ASSERT_EQUAL(1, epoll_wait(epoll, &event, 1, 0));
	TEST_ASSERT_EQUAL_UINT32(1, event.data.u32);
	close(peer);
	close(fds[1]);
	close(epoll);
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
	RUN_TEST(test_the_socket_of_a_killed_process_that_is_stuck_is_not_in_the_way);
	RUN_TEST(test_a_file_that_is_no_socket_is_left_alone);
	RUN_TEST(test_a_path_that_no_address_has_room_for_is_refused);
	RUN_TEST(test_at_a_name_of_a_folder_it_replaces_what_is_there);
	RUN_TEST(test_a_socket_that_another_process_put_in_its_place_is_not_removed);
	RUN_TEST(test_an_address_of_another_machine_is_served_later_if_that_is_asked_for);
	RUN_TEST(test_an_address_of_another_machine_is_not_here);
	RUN_TEST(test_an_address_has_one_listener);
	RUN_TEST(test_no_room_for_a_connection_is_no_error_of_it);
	RUN_TEST(test_listeners_that_pause_are_not_ready);
	RUN_TEST(test_a_byte_out_of_band_keeps_its_place);
	RUN_TEST(test_nobody_who_connects_is_no_error_of_the_listener);
	RUN_TEST(test_without_a_service_manager_there_is_no_socket_of_it);
	RUN_TEST(test_an_address_that_cannot_be_had_has_a_remedy);
	return UNITY_END();
}
