/* SPDX-License-Identifier: MIT */
/* Programs connect to the control room: hellos of every shape, what a controller gets, how it
 * ends. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "unity.h"

#include "hal/base/time.h"
#include "src/memory/shm/futex.h"
#include "src/public/ows.h"
#include "tests/unit/aid/control_scene.h"

#define SEALS (F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL)

void setUp(void)
{
	control_open();
}

void tearDown(void)
{
	control_close();
}

static int say(const void *bytes, size_t len)
{
	struct ows_welcome welcome = {0};
	int fds[3], fd = control_connect(), err;

	TEST_ASSERT_GREATER_OR_EQUAL(0, fd);
	TEST_ASSERT_EQUAL(len, send(fd, bytes, len, MSG_NOSIGNAL));
	err = control_receive(fd, &welcome, fds);
	TEST_ASSERT_EQUAL(-1, fds[0]);
	close(fd);
	return err ? err : welcome.err;
}

static void test_a_hello_of_a_wrong_size_is_refused(void)
{
	struct {
		struct ows_hello hello;
		char more[4096];
	} long_hello = {.hello = control_hello(OWS_HELLO_COMMAND, "long")};
	const size_t sizes[] = {1, 4, 127, 129, 256, sizeof(long_hello)};

	for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++)
		TEST_ASSERT_EQUAL(-EPROTO, say(&long_hello, sizes[i]));
	control_wait_count("control_refused_protocol", 6);
	TEST_ASSERT_EQUAL_UINT(0, control_joined());
}

static void test_a_hello_of_another_kind_or_version_is_refused(void)
{
	struct ows_hello hello = control_hello(OWS_HELLO_COMMAND, "x");

	hello.magic = OWS_WELCOME_MAGIC;
	TEST_ASSERT_EQUAL(-EPROTO, say(&hello, sizeof(hello)));
	hello = control_hello(OWS_HELLO_COMMAND, "x");
	hello.major = OWS_LAYOUT_MAJOR + 1;
	TEST_ASSERT_EQUAL(-EPROTO, say(&hello, sizeof(hello)));
	hello.major = 1;
	TEST_ASSERT_EQUAL(-EPROTO, say(&hello, sizeof(hello)));
	memset(&hello, 0xff, sizeof(hello));
	TEST_ASSERT_EQUAL(-EPROTO, say(&hello, sizeof(hello)));
}

static void test_a_later_minor_version_with_flags_that_are_not_known_is_welcome(void)
{
	struct ows_hello hello = control_hello(~(uint32_t)OWS_HELLO_RELOAD, "later");
	struct ows_welcome welcome;
	int fds[3], fd = control_connect();

	hello.minor = 99;
	memset(hello.spare, 0xff, sizeof(hello.spare));
	send(fd, &hello, sizeof(hello), 0);
	TEST_ASSERT_EQUAL(0, control_receive(fd, &welcome, fds));
	TEST_ASSERT_EQUAL(0, welcome.err);
	for (int i = 0; i < 3; i++)
		close(fds[i]);
	close(fd);
}

static void test_who_says_nothing_in_time_is_hung_up_on(void)
{
	struct ows_welcome welcome;
	int fds[3], fd = control_connect();

	TEST_ASSERT_EQUAL(0, control_receive(fd, &welcome, fds));
	TEST_ASSERT_EQUAL(-ETIMEDOUT, welcome.err);
	TEST_ASSERT_EQUAL(-EPIPE, control_receive(fd, &welcome, fds));
	control_wait_count("control_connections", 0);
	TEST_ASSERT_EQUAL_UINT(1, control_count("control_refused_protocol"));
	close(fd);
}

static void test_a_controller_gets_a_sealed_memory_a_bell_and_news(void)
{
	struct control_client client;
	const struct ows_controller_header *h;
	struct pollfd news;

	TEST_ASSERT_EQUAL(0, control_join(&client, OWS_HELLO_COMMAND, "plc\n"));
	TEST_ASSERT_EQUAL_HEX32(OWS_WELCOME_MAGIC, client.welcome.magic);
	TEST_ASSERT_EQUAL_UINT(OWS_LAYOUT_MAJOR, client.welcome.major);
	TEST_ASSERT_EQUAL_UINT(1, client.welcome.generation);
	TEST_ASSERT_EQUAL_UINT(101, client.welcome.start_id);
	TEST_ASSERT_EQUAL(SEALS, fcntl(client.fds[0], F_GET_SEALS) & (SEALS | F_SEAL_WRITE));
	h = (const void *)client.memory;
	TEST_ASSERT_EQUAL_HEX32(OWS_CONTROLLER_MAGIC, h->magic);
	TEST_ASSERT_EQUAL_UINT(client.welcome.size, h->size);
	TEST_ASSERT_EQUAL_UINT(client.welcome.serial, h->serial);
	TEST_ASSERT_EQUAL_UINT(OWS_STATE_LIVE, h->state);
	/* the engine had it before the welcome went out, and who it is by the kernel's word */
	TEST_ASSERT_EQUAL_UINT(1, control_inside());
	TEST_ASSERT_EQUAL_INT(getpid(), control_message_of(h->serial)->controller.who.pid);
	TEST_ASSERT_EQUAL_UINT(getuid(), control_message_of(h->serial)->controller.who.uid);
	TEST_ASSERT_EQUAL_STRING("plc?", control_message_of(h->serial)->controller.who.name);
	/* the news ring when it waits for them */
	news = (struct pollfd){.fd = client.fds[2], .events = POLLIN};
	control_ring_news();
	TEST_ASSERT_EQUAL(0, poll(&news, 1, 0));
	((struct ows_controller_header *)(void *)client.memory)->waits = 1;
	control_ring_news();
	TEST_ASSERT_EQUAL(1, poll(&news, 1, CONTROL_SCENE_MS));
	control_leave(&client);
}

#define SLEEPERS 8
static uint32_t image_word, sleepers;

static void *sleep_on_image(void *ctx)
{
	(void)ctx;
	__atomic_fetch_add(&sleepers, 1, __ATOMIC_RELAXED);
	while (!__atomic_load_n(&image_word, __ATOMIC_ACQUIRE))
		if (segment_wait(&image_word, 0, CONTROL_SCENE_MS * NS_PER_MS) == -ETIMEDOUT)
			return ctx;
	return NULL;
}

/* The engine wakes the first of them, and the thread of news the others. */
static void test_all_sleepers_of_an_image_are_woken(void)
{
	const struct timespec asleep = {.tv_nsec = 20 * NS_PER_MS};
	pthread_t thread[SLEEPERS];
	void *late;

	for (unsigned n = 0; n <= SLEEPERS; n++) {
		image_word = sleepers = 0;
		for (unsigned i = 0; i < n; i++)
			TEST_ASSERT_EQUAL(
				0, pthread_create(&thread[i], NULL, sleep_on_image, &image_word));
		while (__atomic_load_n(&sleepers, __ATOMIC_RELAXED) < n)
			sched_yield();
		nanosleep(&asleep, NULL); /* they have said that they sleep, and now do */
		__atomic_store_n(&image_word, 1, __ATOMIC_RELEASE);
		control_news(control_room, &image_word);
		for (unsigned i = 0; i < n; i++) {
			TEST_ASSERT_EQUAL(0, pthread_join(thread[i], &late));
			TEST_ASSERT_NULL(late);
		}
	}
}

static void test_two_controllers_share_nothing(void)
{
	struct control_client a, b;
	struct ows_controller_header *ha, *hb;

	TEST_ASSERT_EQUAL(0, control_join(&a, OWS_HELLO_COMMAND, "a"));
	TEST_ASSERT_EQUAL(0, control_join(&b, OWS_HELLO_COMMAND, "b"));
	ha = (void *)a.memory;
	hb = (void *)b.memory;
	TEST_ASSERT_TRUE(a.welcome.serial != b.welcome.serial);
	TEST_ASSERT_TRUE(memcmp(a.welcome.token, b.welcome.token, 16) != 0);
	memset(a.memory, 0xff, a.welcome.size);
	TEST_ASSERT_EQUAL_HEX32(OWS_CONTROLLER_MAGIC, hb->magic);
	TEST_ASSERT_EQUAL_UINT(0, hb->marked);
	TEST_ASSERT_EQUAL_HEX32(0xffffffff, ha->magic);
	control_leave(&a);
	control_leave(&b);
}

static void test_a_token_comes_back_as_it_was_presented(void)
{
	struct ows_hello hello = control_hello(OWS_HELLO_COMMAND, "again");
	struct ows_welcome welcome;
	int fds[3], fd = control_connect();

	memset(hello.token, 0x5a, sizeof(hello.token));
	send(fd, &hello, sizeof(hello), 0);
	TEST_ASSERT_EQUAL(0, control_receive(fd, &welcome, fds));
	TEST_ASSERT_EQUAL_MEMORY(hello.token, welcome.token, sizeof(hello.token));
	TEST_ASSERT_EQUAL_MEMORY(hello.token, control_message_of(welcome.serial)->controller.token,
	                         sizeof(hello.token));
	for (int i = 0; i < 3; i++)
		close(fds[i]);
	close(fd);
}

static void test_the_memory_can_be_neither_cut_nor_sealed_and_a_hole_harms_only_its_controller(void)
{
	struct control_client a, b;
	const struct control_message *message;

	TEST_ASSERT_EQUAL(0, control_join(&a, OWS_HELLO_COMMAND, "a"));
	TEST_ASSERT_EQUAL(0, control_join(&b, OWS_HELLO_COMMAND, "b"));
	message = control_message_of(a.welcome.serial);
	TEST_ASSERT_EQUAL(-1, ftruncate(a.fds[0], 0));
	TEST_ASSERT_EQUAL(-1, ftruncate(a.fds[0], (off_t)a.welcome.size * 2));
	TEST_ASSERT_EQUAL(-1, fcntl(a.fds[0], F_ADD_SEALS, F_SEAL_WRITE));
	TEST_ASSERT_EQUAL(0, fallocate(a.fds[0], FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 0,
	                               (off_t)a.welcome.size));
	/* owsd reads zeros there, and answers in it */
	TEST_ASSERT_EQUAL(-1, controller_next_dirty(&message->controller.memory, 0));
	controller_taken(&message->controller.memory, 1, 7, 0);
	TEST_ASSERT_EQUAL_HEX32(OWS_CONTROLLER_MAGIC,
	                        ((struct ows_controller_header *)(void *)b.memory)->magic);
	control_leave(&a);
	control_wait_count("control_connections", 1);
	TEST_ASSERT_EQUAL_UINT(1, control_count("control_hung_up"));
	TEST_ASSERT_EQUAL_UINT(1, control_inside());
	control_leave(&b);
}

static void test_a_controller_that_closes_leaves_and_finds_its_memory_dead(void)
{
	struct control_client client;
	struct ows_controller_header *h;

	TEST_ASSERT_EQUAL(0, control_join(&client, OWS_HELLO_COMMAND, "x"));
	h = (void *)client.memory;
	close(client.fd);
	client.fd = -1;
	control_wait_count("control_connections", 0);
	TEST_ASSERT_EQUAL_UINT(0, control_inside());
	TEST_ASSERT_NOT_EQUAL(OWS_STATE_LIVE, h->state);
	control_leave(&client);
}

static void test_a_second_message_ends_the_connection(void)
{
	struct control_client client;
	struct ows_welcome welcome;
	int fds[3];

	TEST_ASSERT_EQUAL(0, control_join(&client, OWS_HELLO_COMMAND, "talker"));
	TEST_ASSERT_EQUAL(4, send(client.fd, "more", 4, 0));
	TEST_ASSERT_EQUAL(-EPIPE, control_receive(client.fd, &welcome, fds));
	control_wait_count("control_connections", 0);
	TEST_ASSERT_EQUAL_UINT(1, control_count("control_refused_protocol"));
	control_leave(&client);
}

/* Its own socket lies in it, which would keep the connection alive for ever. */
static void test_a_second_message_right_behind_the_hello_ends_the_connection(void)
{
	struct ows_hello hello = control_hello(OWS_HELLO_COMMAND, "twice");
	union {
		struct cmsghdr align;
		char bytes[CMSG_SPACE(sizeof(int))];
	} room = {{0}};
	struct iovec part = {.iov_base = &hello, .iov_len = sizeof(hello)};
	struct msghdr message = {.msg_iov = &part,
	                         .msg_iovlen = 1,
	                         .msg_control = &room,
	                         .msg_controllen = sizeof(room)};
	struct cmsghdr *c = CMSG_FIRSTHDR(&message);

	for (unsigned i = 1; i <= 20; i++) {
		int fd = control_connect();

		c->cmsg_level = SOL_SOCKET;
		c->cmsg_type = SCM_RIGHTS;
		c->cmsg_len = CMSG_LEN(sizeof(fd));
		memcpy(CMSG_DATA(c), &fd, sizeof(fd));
		TEST_ASSERT_EQUAL(sizeof(hello), send(fd, &hello, sizeof(hello), MSG_NOSIGNAL));
		sendmsg(fd, &message, MSG_NOSIGNAL);
		close(fd);
	}
	control_wait_count("control_connections", 0);
}

/*
 * A program of its own that joins and stays; with a child, that lives on until the test closes
 * told, and has the socket and all the rest.
 */
static pid_t start_program(int told[2], bool with_child)
{
	struct control_client client;
	char byte = 1;
	int ready[2];
	pid_t pid;

	TEST_ASSERT_EQUAL(0, pipe2(told, O_CLOEXEC));
	TEST_ASSERT_EQUAL(0, pipe2(ready, O_CLOEXEC));
	pid = fork();
	if (pid == 0) {
		close(told[1]);
		if (control_join(&client, OWS_HELLO_COMMAND, "program"))
			_exit(1);
		if (with_child && fork() == 0)
			_exit(read(told[0], &byte, 1) != 0);
		if (write(ready[1], &byte, 1) != 1)
			_exit(1);
		for (;;)
			pause();
	}
	close(ready[1]);
	TEST_ASSERT_EQUAL(1, read(ready[0], &byte, 1));
	close(ready[0]);
	return pid;
}

static void end_program(pid_t pid)
{
	int status;

	kill(pid, SIGKILL);
	TEST_ASSERT_EQUAL(pid, waitpid(pid, &status, 0));
}

static void test_a_controller_that_is_killed_is_lost(void)
{
	int told[2];
	pid_t pid = start_program(told, false);

	TEST_ASSERT_EQUAL_UINT(1, control_inside());
	end_program(pid);
	control_wait_count("control_connections", 0);
	TEST_ASSERT_EQUAL_UINT(0, control_inside());
	TEST_ASSERT_EQUAL_UINT(1, control_count("control_hung_up") + control_count("control_died"));
	close(told[0]);
	close(told[1]);
}

static void test_a_controller_that_is_killed_is_lost_though_its_child_holds_the_socket(void)
{
	int told[2];
	pid_t pid = start_program(told, true);

	end_program(pid);
	control_wait_count("control_died", 1);
	control_wait_count("control_connections", 0);
	TEST_ASSERT_EQUAL_UINT(0, control_inside());
	close(told[1]); /* the child ends */
	close(told[0]);
}

static void test_of_a_process_that_ended_before_its_hello_nobody_becomes_a_controller(void)
{
	struct ows_hello hello = control_hello(OWS_HELLO_COMMAND, "late");
	int pair[2], status, fd, fds[3];
	struct ows_welcome welcome;
	pid_t pid;

	/* the child connects and hands the socket to this process before it ends */
	TEST_ASSERT_EQUAL(0, socketpair(AF_UNIX, SOCK_DGRAM, 0, pair));
	pid = fork();
	if (pid == 0) {
		union {
			struct cmsghdr align;
			char bytes[CMSG_SPACE(sizeof(int))];
		} room = {{0}};
		struct iovec part = {.iov_base = &status, .iov_len = 1};
		struct msghdr message = {.msg_iov = &part,
		                         .msg_iovlen = 1,
		                         .msg_control = &room,
		                         .msg_controllen = sizeof(room)};

		fd = control_connect();
		room.align = (struct cmsghdr){.cmsg_level = SOL_SOCKET,
		                              .cmsg_type = SCM_RIGHTS,
		                              .cmsg_len = CMSG_LEN(sizeof(int))};
		memcpy(CMSG_DATA(&room.align), &fd, sizeof(fd));
		_exit(sendmsg(pair[0], &message, 0) != 1);
	}
	TEST_ASSERT_EQUAL(pid, waitpid(pid, &status, 0));
	TEST_ASSERT_EQUAL(0, status);
	/* what control_receive() takes with a welcome it takes here too */
	TEST_ASSERT_EQUAL(-EMSGSIZE, control_receive(pair[1], &welcome, fds));
	fd = fds[0];
	send(fd, &hello, sizeof(hello), MSG_NOSIGNAL);
	TEST_ASSERT_EQUAL(-EPIPE, control_receive(fd, &welcome, fds));
	TEST_ASSERT_EQUAL_UINT(1, control_count("control_died"));
	TEST_ASSERT_EQUAL_UINT(0, control_joined());
	close(fd);
	close(pair[0]);
	close(pair[1]);
}

static void test_a_stopped_controller_keeps_nobody_waiting(void)
{
	struct control_client client;
	int told[2];
	pid_t pid = start_program(told, false);

	kill(pid, SIGSTOP);
	for (int i = 0; i < 50; i++) {
		control_reload();
		TEST_ASSERT_EQUAL(0, control_join(&client, OWS_HELLO_COMMAND, "other"));
		control_leave(&client);
	}
	control_wait_count("control_connections", 1);
	TEST_ASSERT_EQUAL_UINT(1, control_inside());
	end_program(pid);
	control_wait_count("control_connections", 0);
	close(told[0]);
	close(told[1]);
}

static void test_a_reload_sends_a_new_memory_over_the_same_connection(void)
{
	struct control_client client;
	struct ows_welcome welcome;
	int fds[3];

	TEST_ASSERT_EQUAL(0, control_join(&client, OWS_HELLO_COMMAND, "x"));
	control_reload();
	TEST_ASSERT_EQUAL(0, control_receive(client.fd, &welcome, fds));
	TEST_ASSERT_EQUAL(0, welcome.err);
	TEST_ASSERT_EQUAL_UINT(client.welcome.serial, welcome.serial);
	TEST_ASSERT_EQUAL_MEMORY(client.welcome.token, welcome.token, 16);
	TEST_ASSERT_EQUAL_UINT(2, welcome.generation);
	TEST_ASSERT_EQUAL(-1, fds[1]);
	TEST_ASSERT_EQUAL(-1, fds[2]);
	TEST_ASSERT_EQUAL(SEALS, fcntl(fds[0], F_GET_SEALS) & SEALS);
	TEST_ASSERT_EQUAL_UINT(1, control_inside());
	close(fds[0]);
	control_leave(&client);
}

/* Its socket holds one welcome at most: others would keep the memory of every reload. */
static void test_who_reads_late_gets_the_last_welcome_after_the_first_it_did_not_read(void)
{
	struct control_client client;
	struct ows_welcome welcome;
	struct pollfd readable;
	int fds[3];

	TEST_ASSERT_EQUAL(0, control_join(&client, OWS_HELLO_COMMAND, "x"));
	readable = (struct pollfd){.fd = client.fd, .events = POLLIN};
	control_reload();
	TEST_ASSERT_EQUAL(1, poll(&readable, 1, CONTROL_SCENE_MS));
	for (int i = 0; i < 4; i++)
		control_reload();
	TEST_ASSERT_EQUAL(0, control_receive(client.fd, &welcome, fds));
	TEST_ASSERT_EQUAL_UINT(2, welcome.generation);
	close(fds[0]);
	TEST_ASSERT_EQUAL(0, control_receive(client.fd, &welcome, fds));
	TEST_ASSERT_EQUAL_UINT(6, welcome.generation);
	close(fds[0]);
	control_leave(&client);
}

int main(void)
{
	signal(SIGPIPE, SIG_IGN);
	UNITY_BEGIN();
	RUN_TEST(test_a_hello_of_a_wrong_size_is_refused);
	RUN_TEST(test_a_hello_of_another_kind_or_version_is_refused);
	RUN_TEST(test_a_later_minor_version_with_flags_that_are_not_known_is_welcome);
	RUN_TEST(test_who_says_nothing_in_time_is_hung_up_on);
	RUN_TEST(test_a_controller_gets_a_sealed_memory_a_bell_and_news);
	RUN_TEST(test_all_sleepers_of_an_image_are_woken);
	RUN_TEST(test_two_controllers_share_nothing);
	RUN_TEST(test_a_token_comes_back_as_it_was_presented);
	RUN_TEST(
		test_the_memory_can_be_neither_cut_nor_sealed_and_a_hole_harms_only_its_controller);
	RUN_TEST(test_a_controller_that_closes_leaves_and_finds_its_memory_dead);
	RUN_TEST(test_a_second_message_ends_the_connection);
	RUN_TEST(test_a_second_message_right_behind_the_hello_ends_the_connection);
	RUN_TEST(test_a_controller_that_is_killed_is_lost);
	RUN_TEST(test_a_controller_that_is_killed_is_lost_though_its_child_holds_the_socket);
	RUN_TEST(test_of_a_process_that_ended_before_its_hello_nobody_becomes_a_controller);
	RUN_TEST(test_a_stopped_controller_keeps_nobody_waiting);
	RUN_TEST(test_a_reload_sends_a_new_memory_over_the_same_connection);
	RUN_TEST(test_who_reads_late_gets_the_last_welcome_after_the_first_it_did_not_read);
	return UNITY_END();
}
