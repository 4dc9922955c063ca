/* SPDX-License-Identifier: MIT */
/* Programs ask for a reload at the control socket: who may, which reload is theirs, the answers. */
#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "unity.h"

#include "hal/base/bell.h"
#include "src/memory/control/private.h"
#include "src/memory/control/welcome.h"
#include "src/public/ows.h"
#include "tests/unit/aid/control_scene.h"

#define ASKERS 4

void setUp(void)
{
	control_open();
}

void tearDown(void)
{
	control_close();
}

/* What an asker was answered. */
struct answer {
	struct ows_welcome welcome;
	char words[OWS_WHY + 1];
};

static int ask(const char *name)
{
	struct ows_hello hello = control_hello(OWS_HELLO_RELOAD, name);
	int fd = control_connect();

	TEST_ASSERT_GREATER_OR_EQUAL(0, fd);
	TEST_ASSERT_EQUAL(sizeof(hello), send(fd, &hello, sizeof(hello), MSG_NOSIGNAL));
	return fd;
}

static void wait_asked(void)
{
	struct pollfd bell = {.fd = control_asked_bell(control_room), .events = POLLIN};

	TEST_ASSERT_EQUAL(1, poll(&bell, 1, CONTROL_SCENE_MS));
	TEST_ASSERT_TRUE(control_asked(control_room));
	TEST_ASSERT_EQUAL(0, poll(&bell, 1, 0));
}

static struct answer answer_of(int fd)
{
	struct pollfd poll_fd = {.fd = fd, .events = POLLIN};
	struct answer answer = {0};
	ssize_t n;
	char byte;

	TEST_ASSERT_EQUAL(1, poll(&poll_fd, 1, CONTROL_SCENE_MS));
	n = recv(fd, &answer, sizeof(answer), 0);
	TEST_ASSERT_GREATER_OR_EQUAL(sizeof(answer.welcome), n);
	TEST_ASSERT_LESS_THAN(sizeof(answer), n);
	TEST_ASSERT_EQUAL_HEX32(OWS_WELCOME_MAGIC, answer.welcome.magic);
	TEST_ASSERT_EQUAL_UINT(0, answer.welcome.size);
	TEST_ASSERT_EQUAL(0, recv(fd, &byte, 1, 0));
	close(fd);
	return answer;
}

static void reload(int err, const char *why)
{
	control_take_askers(control_room);
	if (!err)
		control_reload();
	control_answer(control_room, err, why);
}

static void test_who_asks_is_answered_when_the_reload_is_done(void)
{
	int fd = ask("editor");
	struct pollfd poll_fd = {.fd = fd, .events = POLLIN};
	struct answer answer;

	wait_asked();
	TEST_ASSERT_EQUAL(0, poll(&poll_fd, 1, 50));
	reload(0, "");
	answer = answer_of(fd);
	TEST_ASSERT_EQUAL(0, answer.welcome.err);
	TEST_ASSERT_EQUAL_UINT(2, answer.welcome.generation);
	TEST_ASSERT_EQUAL_STRING("", answer.words);
	TEST_ASSERT_FALSE(control_asked(control_room));
	TEST_ASSERT_EQUAL_UINT(1, control_count("control_asked"));
	control_wait_count("control_connections", 0);
	TEST_ASSERT_EQUAL_UINT(0, control_joined());
}

static void test_a_refusal_comes_with_its_reason_in_words(void)
{
	char words[1000];
	int fds[] = {ask("one"), -1};
	struct answer answer;

	wait_asked();
	reload(-EINVAL, "house.rio:3:2: error: no such key");
	answer = answer_of(fds[0]);
	TEST_ASSERT_EQUAL(-EINVAL, answer.welcome.err);
	TEST_ASSERT_EQUAL_UINT(1, answer.welcome.generation);
	TEST_ASSERT_EQUAL_STRING("house.rio:3:2: error: no such key", answer.words);
	/* a long one is cut */
	memset(words, 'x', sizeof(words) - 1);
	words[sizeof(words) - 1] = '\0';
	fds[1] = ask("two");
	wait_asked();
	reload(-EBUSY, words);
	answer = answer_of(fds[1]);
	TEST_ASSERT_EQUAL(-EBUSY, answer.welcome.err);
	TEST_ASSERT_EQUAL_UINT(OWS_WHY, strlen(answer.words));
}

static void test_a_reload_comes_with_its_warnings_in_words(void)
{
	int fd = ask("editor");
	struct answer answer;

	wait_asked();
	reload(0, "1 warning; the first: house.rio:3:2: warning: unknown key");
	answer = answer_of(fd);
	TEST_ASSERT_EQUAL(0, answer.welcome.err);
	TEST_ASSERT_EQUAL_STRING("1 warning; the first: house.rio:3:2: warning: unknown key",
	                         answer.words);
}

static void test_who_asks_during_a_reload_waits_for_the_next(void)
{
	int early = ask("early"), late;
	struct pollfd poll_fd = {.events = POLLIN};

	wait_asked();
	control_take_askers(control_room);
	late = ask("late");
	wait_asked();
	control_answer(control_room, 0, "");
	TEST_ASSERT_EQUAL(0, answer_of(early).welcome.err);
	poll_fd.fd = late;
	TEST_ASSERT_EQUAL(0, poll(&poll_fd, 1, 50));
	TEST_ASSERT_TRUE(control_asked(control_room));
	reload(-EINVAL, "later");
	TEST_ASSERT_EQUAL(-EINVAL, answer_of(late).welcome.err);
}

static void test_more_askers_than_owsd_lets_wait_are_refused(void)
{
	int fds[ASKERS], fd;

	for (int i = 0; i < ASKERS; i++) {
		fds[i] = ask("one of many");
		wait_asked();
	}
	control_wait_count("control_connections", ASKERS);
	fd = ask("too many");
	TEST_ASSERT_EQUAL(-ENOSPC, answer_of(fd).welcome.err);
	TEST_ASSERT_EQUAL_UINT(1, control_count("control_refused_limits"));
	/* who hangs up makes room */
	close(fds[0]);
	control_wait_count("control_connections", ASKERS - 1);
	fds[0] = ask("again");
	wait_asked();
	reload(0, "");
	for (int i = 0; i < ASKERS; i++)
		TEST_ASSERT_EQUAL(0, answer_of(fds[i]).welcome.err);
	control_wait_count("control_connections", 0);
}

static void test_an_asker_that_says_more_is_hung_up_on(void)
{
	int fd = ask("talks");
	char byte = 0;

	wait_asked();
	TEST_ASSERT_EQUAL(1, send(fd, &byte, 1, MSG_NOSIGNAL));
	control_wait_count("control_connections", 0);
	TEST_ASSERT_FALSE(control_asked(control_room));
	reload(0, "");
	TEST_ASSERT_EQUAL(0, recv(fd, &byte, 1, 0));
	close(fd);
}

static void test_an_asker_waits_for_a_time_that_ends(void)
{
	int fds[] = {ask("waits"), -1};

	wait_asked();
	control_take_askers(control_room);
	fds[1] = ask("waits too");
	wait_asked();
	pthread_mutex_lock(&control_room->lock);
	for (unsigned i = 0; i < OWS_CONTROLLERS; i++)
		control_room->seats[i].until_ns = 1;
	pthread_mutex_unlock(&control_room->lock);
	bell_ring(control_room->wake);
	for (int i = 0; i < 2; i++)
		TEST_ASSERT_EQUAL(-ETIMEDOUT, answer_of(fds[i]).welcome.err);
	control_answer(control_room, 0, "");
	TEST_ASSERT_EQUAL_UINT(0, control_count("control_connections"));
}

static void test_a_stranger_may_not_ask(void)
{
	if (getuid())
		TEST_IGNORE_MESSAGE("only root can be another user");
	TEST_ASSERT_EQUAL(-EACCES, control_join_as(300, NULL, 0, OWS_HELLO_RELOAD));
	TEST_ASSERT_FALSE(control_asked(control_room));
}

static void test_the_log_names_what_was_refused_and_not_another_door(void)
{
	char text[200];

	welcome_refusal(WELCOME_RELOAD, -EACCES, "OWS.control", text, sizeof(text));
	TEST_ASSERT_EQUAL_STRING("reload by OWS.control: that is for root, the user of owsd and, "
	                         "of the service, group owsd-config",
	                         text);
	welcome_refusal(WELCOME_COMMAND, -EACCES, "OWS.control", text, sizeof(text));
	TEST_ASSERT_EQUAL_STRING("command by OWS.control: it has no right to", text);
	welcome_refusal(WELCOME_CONNECT, -ENOSPC, "OWS.control", text, sizeof(text));
	TEST_ASSERT_EQUAL_STRING("connect to OWS.control: there are too many, of this user or all",
	                         text);
}

static void test_who_waits_at_the_end_of_owsd_is_hung_up_on(void)
{
	int fd = ask("waits");
	char byte;

	wait_asked();
	control_close();
	TEST_ASSERT_EQUAL(0, recv(fd, &byte, 1, 0));
	close(fd);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_who_asks_is_answered_when_the_reload_is_done);
	RUN_TEST(test_a_refusal_comes_with_its_reason_in_words);
	RUN_TEST(test_a_reload_comes_with_its_warnings_in_words);
	RUN_TEST(test_who_asks_during_a_reload_waits_for_the_next);
	RUN_TEST(test_more_askers_than_owsd_lets_wait_are_refused);
	RUN_TEST(test_an_asker_that_says_more_is_hung_up_on);
	RUN_TEST(test_an_asker_waits_for_a_time_that_ends);
	RUN_TEST(test_a_stranger_may_not_ask);
	RUN_TEST(test_the_log_names_what_was_refused_and_not_another_door);
	RUN_TEST(test_who_waits_at_the_end_of_owsd_is_hung_up_on);
	return UNITY_END();
}
