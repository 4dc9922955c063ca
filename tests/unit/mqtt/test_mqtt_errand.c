/* SPDX-License-Identifier: MIT */
/* Tests of what owsd-mqtt asks another program of this machine, and of how that ends. */
#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "unity.h"

#include "src/faces/kit/face.h"
#include "src/faces/mqtt/errand.h"
#include "src/memory/libows/open.h"
#include "tests/unit/aid/instance.h"

static const struct instance_signal signals[] = {{.name = "a", .path = "/a", .type = OWS_DOUBLE}};
static const struct broker_message asked = {.topic = "o/pi/a/rename",
                                            .text = "{\"v\":\"b\",\"id\":7}",
                                            .len = 16,
                                            .reply = "hmi/answers",
                                            .correlation = "c7",
                                            .correlation_len = 2};
static struct instance in;
static struct face_arguments arguments;
static struct face face;
static struct errand errand;
static struct sockaddr_un place = {.sun_family = AF_UNIX};
static int door;

void setUp(void)
{
	memset(&face, 0, sizeof(face));
	memset(&errand, 0, sizeof(errand));
	instance_start(&in, "errand", signals, 1);
	arguments.instance = in.name;
	face.arguments = &arguments;
	TEST_ASSERT_EQUAL_INT(0, ows_open(in.name, OWS_READ, &face.ows));
	snprintf(place.sun_path, sizeof(place.sun_path), "%.60s/%.32s.other", open_dir(face.ows),
	         in.name);
	unlink(place.sun_path);
	door = socket(AF_UNIX, SOCK_STREAM, 0);
	TEST_ASSERT_EQUAL_INT(0, bind(door, (struct sockaddr *)&place, sizeof(place)));
	TEST_ASSERT_EQUAL_INT(0, listen(door, 1));
}

void tearDown(void)
{
	errand_end(&errand, &face);
	close(door);
	unlink(place.sun_path);
	ows_close(face.ows);
	instance_end(&in);
}

static int begin(void)
{
	return errand_begin(&errand, ERRAND_RENAME, &face, "other", "hello", 5, "a", &asked);
}

/* All that the errand gets until the other side has ended. */
static void take_all(void)
{
	struct pollfd wait = {.fd = errand.fd, .events = POLLIN};

	do
		TEST_ASSERT_EQUAL_INT(1, poll(&wait, 1, 10000));
	while (!errand_ready(&errand, errand.fd));
}

static void test_the_answer_comes_whole_and_who_asked_is_kept(void)
{
	static char many[200000];
	char bytes[8] = "";
	int peer;

	TEST_ASSERT_EQUAL_INT(0, begin());
	TEST_ASSERT_EQUAL_UINT(1, face.fd_count);
	TEST_ASSERT_FALSE(errand_ready(&errand, errand.fd + 1));
	TEST_ASSERT_FALSE(errand_ready(&errand, errand.fd)); /* nothing is there yet */
	TEST_ASSERT_EQUAL_INT(-EBUSY, begin());
	peer = accept(door, NULL, NULL);
	TEST_ASSERT_EQUAL_INT(5, recv(peer, bytes, sizeof(bytes), 0));
	TEST_ASSERT_EQUAL_STRING("hello", bytes);
	memset(many, 'x', sizeof(many));
	for (size_t sent = 0; sent < sizeof(many); sent += 1000) {
		TEST_ASSERT_EQUAL_INT(1000, send(peer, many + sent, 1000, 0));
		TEST_ASSERT_FALSE(errand_ready(&errand, errand.fd));
	}
	close(peer);
	take_all();
	TEST_ASSERT_EQUAL_size_t(sizeof(many), errand.len);
	TEST_ASSERT_EQUAL_INT(0, errand.got[errand.len]);
	TEST_ASSERT_EQUAL_STRING("a", errand.name);
	TEST_ASSERT_EQUAL_STRING("b", errand.ask.value);
	TEST_ASSERT_EQUAL_STRING("7", errand.ask.id->text);
	TEST_ASSERT_EQUAL_STRING(asked.topic, errand.message.topic);
	TEST_ASSERT_EQUAL_STRING(asked.reply, errand.message.reply);
	TEST_ASSERT_EQUAL_MEMORY("c7", errand.message.correlation, 2);
	errand_end(&errand, &face);
	TEST_ASSERT_EQUAL_UINT(0, face.fd_count);
	TEST_ASSERT_EQUAL_INT(0, begin());
}

static void test_one_that_sends_without_end_is_cut(void)
{
	static char many[65536];
	bool ended = false;
	int peer;

	TEST_ASSERT_EQUAL_INT(0, begin());
	peer = accept(door, NULL, NULL);
	for (int i = 0; i < 100 && !ended; i++) {
		TEST_ASSERT_GREATER_THAN(0, send(peer, many, sizeof(many), MSG_DONTWAIT));
		for (int part = 0; part < 4 && !ended; part++)
			ended = errand_ready(&errand, errand.fd);
	}
	close(peer);
	TEST_ASSERT_TRUE(ended);
	TEST_ASSERT_LESS_OR_EQUAL(1u << 20, errand.len);
}

static void test_its_time_is_over_after_a_while(void)
{
	TEST_ASSERT_FALSE(errand_late(&errand, INT64_MAX));
	TEST_ASSERT_EQUAL_INT(0, begin());
	TEST_ASSERT_FALSE(errand_late(&errand, ows_now()));
	TEST_ASSERT_TRUE(errand_late(&errand, ows_now() + 75 * NS_PER_S));
}

static void test_where_nobody_listens_it_does_not_begin(void)
{
	close(door);
	TEST_ASSERT_EQUAL_INT(-ECONNREFUSED, begin());
	unlink(place.sun_path);
	TEST_ASSERT_EQUAL_INT(-ENOENT, begin());
	TEST_ASSERT_EQUAL_INT(ERRAND_NONE, errand.kind);
	TEST_ASSERT_EQUAL_UINT(0, face.fd_count);
	door = dup(0);
}

static void test_before_owsd_was_ever_seen_it_does_not_begin(void)
{
	struct ows *ows = face.ows;

	face.ows = NULL;
	TEST_ASSERT_EQUAL_INT(-ENOENT, begin());
	TEST_ASSERT_EQUAL_INT(ERRAND_NONE, errand.kind);
	face.ows = ows;
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_answer_comes_whole_and_who_asked_is_kept);
	RUN_TEST(test_one_that_sends_without_end_is_cut);
	RUN_TEST(test_its_time_is_over_after_a_while);
	RUN_TEST(test_where_nobody_listens_it_does_not_begin);
	RUN_TEST(test_before_owsd_was_ever_seen_it_does_not_begin);
	return UNITY_END();
}
