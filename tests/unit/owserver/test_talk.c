/* SPDX-License-Identifier: MIT */
/*
 * What a peer can send before its reply is whole, on a virtual clock: each look at the socket is
 * counted.
 */
#include <errno.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "unity.h"

#include "hal/owserver/talk.h"

#define MS INT64_C(1000000)
#define S INT64_C(1000000000)

static struct talk talk;
static struct bus_counter counters[TALK_COUNTERS];
static int there;                         /* the peer's end */
static int64_t now_ns, sent_ns, every_ns; /* the peer sends a piece so often */
static const uint8_t *piece;
static size_t piece_len, left; /* how many it still sends */
static unsigned looks;
static uint8_t room[60000], reply[FRAME_HEADER + sizeof(room)];
static uint8_t alive[FRAME_HEADER] = {[4] = 0xff, 0xff, 0xff, 0xff};

static int64_t get_now(void *ctx)
{
	(void)ctx;
	return now_ns;
}

static void peer_sends_until(int64_t until_ns)
{
	while (left && sent_ns + every_ns <= until_ns) {
		TEST_ASSERT_EQUAL(piece_len, send(there, piece, piece_len, MSG_DONTWAIT));
		if (piece != alive)
			piece += piece_len;
		sent_ns += every_ns;
		left--;
	}
}

static int wait_for(void *ctx, int fd, short events, int64_t until_ns)
{
	uint8_t byte;

	(void)ctx;
	(void)events;
	looks++;
	if (fd >= 0 && recv(fd, &byte, 1, MSG_PEEK | MSG_DONTWAIT) < 1) {
		if (!left || sent_ns + every_ns > until_ns) {
			now_ns = until_ns;
			return 0;
		}
		now_ns = sent_ns + every_ns;
	} else if (fd < 0) {
		now_ns = until_ns;
	}
	peer_sends_until(now_ns);
	return fd >= 0;
}

static const struct bus_env env = {.now = get_now, .wait = wait_for};

void setUp(void)
{
	int ends[2];

	TEST_ASSERT_EQUAL(0, socketpair(AF_UNIX, SOCK_STREAM, 0, ends));
	memset(counters, 0, sizeof(counters));
	memset(&talk, 0, sizeof(talk));
	talk.connection.env = &env;
	talk.connection.fd = ends[0];
	talk.counter = counters;
	there = ends[1];
	now_ns = sent_ns = S;
	looks = 0;
	left = 0;
}

void tearDown(void)
{
	connection_close(&talk.connection);
	close(there);
}

static int ask(int64_t timeout_ns)
{
	const struct talk_request request = {.type = FRAME_READ,
	                                     .path = "/x",
	                                     .size = sizeof(room),
	                                     .room = room,
	                                     .limit = sizeof(room)};
	int err = talk_send(&talk, &request, now_ns + timeout_ns);

	return err ? err : talk_receive(&talk, now_ns + timeout_ns);
}

static void send_pieces(const uint8_t *what, size_t len, size_t count, int64_t each_ns)
{
	piece = what;
	piece_len = len;
	left = count;
	every_ns = each_ns;
}

static void test_a_reply_that_comes_byte_by_byte_costs_few_looks(void)
{
	struct frame_header header = {
		.payload = sizeof(room), .type = sizeof(room), .flags = FRAME_PERSIST};

	frame_put_header(reply, &header);
	memset(reply + FRAME_HEADER, 'x', sizeof(room));
	send_pieces(reply, 1, sizeof(reply), 10000);
	TEST_ASSERT_EQUAL(0, ask(S));
	TEST_ASSERT_EQUAL_HEX8('x', room[sizeof(room) - 1]);
	/* a byte each 10 us for 0.6 s: two looks a millisecond */
	TEST_ASSERT_LESS_THAN_UINT(1300, looks);
}

static void test_keep_alives_without_end_end_the_request(void)
{
	int64_t begun = now_ns;

	send_pieces(alive, sizeof(alive), 1000000, 10000);
	TEST_ASSERT_EQUAL(-EPROTO, ask(60 * S));
	TEST_ASSERT_FALSE(connection_is_open(&talk.connection));
	TEST_ASSERT_NOT_NULL(strstr(talk.trouble, "keep-alives without end"));
	TEST_ASSERT_EQUAL_UINT64(1, counters[TALK_FLOODS].value);
	TEST_ASSERT_LESS_THAN_UINT64(100, counters[TALK_KEEPALIVES].value);
	TEST_ASSERT_LESS_THAN_INT64(begun + S, now_ns);
}

static void test_keep_alives_just_too_often_end_it_too(void)
{
	send_pieces(alive, sizeof(alive), 1000000, 30 * MS);
	TEST_ASSERT_EQUAL(-EPROTO, ask(60 * S));
	TEST_ASSERT_EQUAL_UINT64(1, counters[TALK_FLOODS].value);
}

static void test_the_keep_alives_of_a_slow_owserver_are_a_sign_of_life_for_as_long_as_it_is_slow(
	void)
{
	/* as of a genuine one, and five times as often */
	static const int64_t every[] = {S, 200 * MS};

	for (size_t i = 0; i < sizeof(every) / sizeof(every[0]); i++) {
		sent_ns = now_ns;
		send_pieces(alive, sizeof(alive), 1000000, every[i]);
		TEST_ASSERT_EQUAL(-EAGAIN, ask(3600 * S));
		TEST_ASSERT_TRUE(talk.heard);
	}
	TEST_ASSERT_EQUAL_UINT64(0, counters[TALK_FLOODS].value);
}

static void test_what_one_request_has_cost_is_not_laid_to_the_next(void)
{
	for (int i = 0; i < 100; i++) {
		sent_ns = now_ns;
		send_pieces(alive, sizeof(alive), 20, 1000);
		TEST_ASSERT_EQUAL(-EAGAIN, ask(100 * MS));
	}
	TEST_ASSERT_EQUAL_UINT64(2000, counters[TALK_KEEPALIVES].value);
	TEST_ASSERT_EQUAL_UINT64(0, counters[TALK_FLOODS].value);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_reply_that_comes_byte_by_byte_costs_few_looks);
	RUN_TEST(test_keep_alives_without_end_end_the_request);
	RUN_TEST(test_keep_alives_just_too_often_end_it_too);
	RUN_TEST(
		test_the_keep_alives_of_a_slow_owserver_are_a_sign_of_life_for_as_long_as_it_is_slow);
	RUN_TEST(test_what_one_request_has_cost_is_not_laid_to_the_next);
	return UNITY_END();
}
