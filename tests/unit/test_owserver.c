/* SPDX-License-Identifier: MIT */
/* The owserver bus against a peer on loopback. Deadlines are short where one has to pass. */
#include <dirent.h>
#include <errno.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/unit/host.h"
#include "tests/unit/peer.h"
#include "unity.h"

#define TEMPERATURE "/28.67C6697351FF/temperature"
#define OUTPUT      "/29.000029D60100/PIO.BYTE"
#define PATIENCE    (60 * HOST_S)
/* For the peer to say something, on a busy machine too; and it passes. */
#define ENOUGH      HOST_S

static struct host host;
static struct peer peer;
static struct bus *bus;
static bool is_peer_up;
static uint8_t data[70000];
static uint32_t next_id;

void setUp(void)
{
	host_init_real(&host);
	bus = NULL;
	is_peer_up = false;
	memset(data, 0, sizeof(data));
}

static void stop_peer(void)
{
	if (is_peer_up)
		peer_stop(&peer);
	is_peer_up = false;
}

void tearDown(void)
{
	bus_destroy(bus);
	stop_peer();
	peer_end(&peer);
}

static void start_as(int family, const char *plan)
{
	peer_start(&peer, family, plan);
	is_peer_up = true;
	bus = host_bus(&host, peer.target);
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host_now(&host) + PATIENCE));
	TEST_ASSERT_EQUAL_UINT8_MESSAGE(BUS_UP, host.event[0].news, host.event[0].text);
}

static void start(const char *plan)
{
	start_as(AF_INET, plan);
}

static const struct bus_answer *ask_within(enum bus_op op, const char *path, const char *text,
                                           uint32_t len, int64_t time_ns)
{
	struct bus_req req = { .id = ++next_id, .op = (uint8_t)op, .path = path, .data = data,
	                       .len = len, .fresh = true,
	                       .deadline_ns = host_now(&host) + time_ns };

	if (text)
		memcpy(data, text, len);
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req));
	TEST_ASSERT_TRUE(host_run_answers(&host, bus, host.answers + 1,
	                                  host_now(&host) + PATIENCE));
	TEST_ASSERT_EQUAL_UINT(1, host_answers(&host, next_id));
	return host_answer(&host, next_id);
}

static const struct bus_answer *ask(enum bus_op op, const char *path, const char *text,
                                    uint32_t len)
{
	return ask_within(op, path, text, len, PATIENCE);
}

static int read_temperature(void)
{
	const struct bus_answer *answer = ask(BUS_READ, TEMPERATURE, NULL, 256);

	if (answer->err == 0) {
		TEST_ASSERT_EQUAL_UINT32(12, answer->len);
		TEST_ASSERT_EQUAL_MEMORY("     21.0625", data, 12);
	}
	return answer->err;
}

/* What the peer's thread does comes when that has the processor. */
static void until_peer_saw(const unsigned *count, unsigned n)
{
	int64_t until = host_now(&host) + PATIENCE;

	while (peer_saw(count) < n && host_now(&host) < until)
		host_run(&host, bus, host_now(&host) + HOST_MS);
	TEST_ASSERT_EQUAL_UINT(n, peer_saw(count));
	host_run(&host, bus, host_now(&host) + 20 * HOST_MS);
}

static uint64_t counted(const char *name)
{
	size_t n;
	const struct bus_counter *counter = bus_counters(bus, &n);

	for (size_t i = 0; i < n; i++)
		if (strcmp(counter[i].name, name) == 0)
			return bus_counted(&counter[i]);
	TEST_FAIL_MESSAGE(name);
	return 0;
}

static void goes_down_with(int err, const char *word)
{
	const struct bus_event *event = &host.event[host.events];

	TEST_ASSERT_TRUE(host_run_events(&host, bus, host.events + 1, host_now(&host) + PATIENCE));
	TEST_ASSERT_EQUAL_UINT8_MESSAGE(BUS_DOWN, event->news, event->text);
	TEST_ASSERT_EQUAL_INT32_MESSAGE(err, event->err, event->text);
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(event->text, word), event->text);
}

static void comes_up(void)
{
	const struct bus_event *event = &host.event[host.events];

	TEST_ASSERT_TRUE(host_run_events(&host, bus, host.events + 1, host_now(&host) + PATIENCE));
	TEST_ASSERT_EQUAL_UINT8_MESSAGE(BUS_UP, event->news, event->text);
}

/* --- What it does ---------------------------------------------------------------------------- */

static void test_it_greets_before_it_is_up_and_says_where_it_is(void)
{
	start("");
	TEST_ASSERT_NOT_NULL(strstr(host.event[0].text, peer.target));
	TEST_ASSERT_EQUAL_UINT(3, peer_saw(&peer.greetings));
	TEST_ASSERT_EQUAL_UINT(0, peer_saw(&peer.requests));
}

static void test_a_server_that_is_slow_to_name_its_buses_is_up(void)
{
	start("z");
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
	TEST_ASSERT_EQUAL_UINT(1, peer_saw(&peer.connections));
	TEST_ASSERT_EQUAL_UINT8(BUS_DETAIL_SIMULATED, ask(BUS_READ, TEMPERATURE, NULL, 64)->detail);
}

static void test_requests_share_one_connection(void)
{
	uint64_t before;

	start("");
	before = counted("requests");
	for (unsigned i = 0; i < 100; i++)
		TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_UINT(1, peer_saw(&peer.connections));
	TEST_ASSERT_EQUAL_UINT(100, peer_saw(&peer.requests));
	TEST_ASSERT_EQUAL_UINT64(before + 100, counted("requests"));
	TEST_ASSERT_GREATER_THAN_UINT64(3600, counted("bytes_in"));
}

static void test_a_read_asks_for_the_room_it_has_and_past_the_cache(void)
{
	start("");
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_READ, TEMPERATURE, NULL, 40)->err);
	TEST_ASSERT_EQUAL_UINT(1, peer_saw(&peer.requests));
	TEST_ASSERT_EQUAL_INT32(40, peer.size);
	TEST_ASSERT_EQUAL_HEX32(0x24, peer.flags);
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_READ, TEMPERATURE, NULL, 70000)->err);
	TEST_ASSERT_EQUAL_UINT(2, peer_saw(&peer.requests));
	TEST_ASSERT_EQUAL_INT32(65536, peer.size);
	TEST_ASSERT_EQUAL_INT(-EMSGSIZE, ask(BUS_READ, TEMPERATURE, NULL, 0)->err);
}

static void test_an_empty_text_is_an_answer(void)
{
	start("");
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_READ, "/28.67C6697351FF/locator", NULL, 64)->err);
	TEST_ASSERT_EQUAL_UINT32(0, host.answer[0].len);
}

static void test_answers_of_a_simulated_server_say_so(void)
{
	start("");
	TEST_ASSERT_EQUAL_UINT8(BUS_DETAIL_SIMULATED, ask(BUS_READ, TEMPERATURE, NULL, 64)->detail);
}

static void test_a_write_is_done_once(void)
{
	start("");
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_WRITE, OUTPUT, "137", 3)->err);
	TEST_ASSERT_EQUAL_UINT32(3, host.answer[0].len);
	TEST_ASSERT_EQUAL_UINT(1, peer_saw(&peer.writes));
}

static void test_a_write_that_was_cut_is_an_error(void)
{
	start("");
	TEST_ASSERT_EQUAL_INT(-EIO, ask(BUS_WRITE, OUTPUT, "123456789", 9)->err);
}

static void test_device_and_property_are_missed_by_different_errors(void)
{
	start("");
	TEST_ASSERT_EQUAL_INT(-ENODEV, ask(BUS_READ, "/28.AABBCCDDEEFF/type", NULL, 64)->err);
	TEST_ASSERT_EQUAL_INT(-ENOENT, ask(BUS_READ, "/28.67C6697351FF/colour", NULL, 64)->err);
	TEST_ASSERT_EQUAL_INT(-ENOENT, ask(BUS_READ, "/settings/colour", NULL, 64)->err);
	TEST_ASSERT_EQUAL_INT(-ENODEV, ask(BUS_WRITE, "/28.AABBCCDDEEFF/PIO", "1", 1)->err);
	TEST_ASSERT_EQUAL_INT(-EACCES, ask(BUS_WRITE, "/28.67C6697351FF/readonly", "1", 1)->err);
	TEST_ASSERT_EQUAL_INT(-EISDIR, ask(BUS_READ, "/28.67C6697351FF/directory", NULL, 64)->err);
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
}

static void test_a_probe_asks_for_the_device_alone(void)
{
	start("");
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_PROBE, TEMPERATURE, NULL, 0)->err);
	TEST_ASSERT_EQUAL_UINT(1, peer_saw(&peer.requests));
	TEST_ASSERT_EQUAL_STRING("/28.67C6697351FF", peer.path);
	TEST_ASSERT_EQUAL_INT(-ENODEV, ask(BUS_PROBE, "/28.AABBCCDDEEFF/x", NULL, 0)->err);
}

static void lists(const char *path, const char *expected)
{
	const struct bus_answer *answer = ask(BUS_DIR, path, NULL, sizeof(data));

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer->err, path);
	data[answer->len] = '\0';
	TEST_ASSERT_EQUAL_STRING(expected, (char *)data);
}

static void test_a_device_with_an_alias_is_listed_by_its_id(void)
{
	unsigned before;

	start("");
	lists("/", "/28.67C6697351FF\n/29.000029D60100\n/bus.0\n/settings\n");
	before = peer_saw(&peer.requests);
	lists("/alarm", "/alarm/28.67C6697351FF\n");
	lists("/28.67C6697351FF", "/28.67C6697351FF/address\n/28.67C6697351FF/type\n");
	TEST_ASSERT_EQUAL_UINT(before + 2, peer_saw(&peer.requests));
}

static void test_an_entry_that_is_nobody_keeps_its_name_and_bad_ones_are_left_out(void)
{
	start("");
	lists("/odd", "/stranger\n/29.000029D60100\n");
}

static void test_a_listing_longer_than_the_room_is_an_error(void)
{
	start("");
	TEST_ASSERT_EQUAL_INT(-EMSGSIZE, ask(BUS_DIR, "/", NULL, 30)->err);
	TEST_ASSERT_EQUAL_UINT32(0, host.answer[0].len);
	TEST_ASSERT_EQUAL_INT(-ENODEV, ask(BUS_DIR, "/28.AABBCCDDEEFF", NULL, 64)->err);
}

static void test_a_path_too_long_to_send_is_an_error_of_this_request(void)
{
	static char path[1100];

	start("");
	memset(path, 'x', sizeof(path) - 1);
	path[0] = '/';
	TEST_ASSERT_EQUAL_INT(-EMSGSIZE, ask(BUS_READ, path, NULL, 64)->err);
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_UINT(1, peer_saw(&peer.connections));
}

static void test_ipv6_is_served(void)
{
	start_as(AF_INET6, "");
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_NOT_NULL(strstr(host.event[0].text, "[::1]"));
}

static void test_a_unix_socket_is_served_and_come_back_to(void)
{
	start_as(AF_UNIX, "");
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_NOT_NULL(strstr(host.event[0].text, peer.path_of_socket));
	peer_stop(&peer);
	goes_down_with(-ECONNRESET, peer.path_of_socket);
	host_run_events(&host, bus, host.events + 1, host_now(&host) + 500 * HOST_MS);
	peer_restart(&peer, "");
	comes_up();
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
}

static void test_the_path_of_a_socket_has_its_limit(void)
{
	char target[200] = "owserver:/";
	struct bus *none = NULL;
	char why[200];

	memset(target + 10, 'x', 107);
	TEST_ASSERT_EQUAL_INT(-EINVAL, bus_create(target, &host.env, &none, why, sizeof(why)));
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(why, "107 bytes"), why);
	TEST_ASSERT_NULL(none);
	target[10 + 106] = '\0';
	TEST_ASSERT_EQUAL_INT(0, bus_create(target, &host.env, &none, why, sizeof(why)));
	bus_destroy(none);
}

static void test_a_name_is_resolved_and_all_its_addresses_are_tried(void)
{
	char target[40];

	peer_start(&peer, AF_INET, "");
	is_peer_up = true;
	snprintf(target, sizeof(target), "localhost:%u", peer.port);
	bus = host_bus(&host, target);
	comes_up();
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
}

/* --- What goes wrong ------------------------------------------------------------------------- */

static void test_a_reply_in_single_bytes_is_read(void)
{
	start("ff");
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
}

static void test_keep_alives_are_passed_over(void)
{
	start("kka");
	for (unsigned i = 0; i < 3; i++)
		TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_UINT64(6, counted("keepalives"));
	TEST_ASSERT_EQUAL_UINT(1, peer_saw(&peer.connections));
}

static void test_keep_alives_do_not_extend_the_deadline_and_the_target_stays_up(void)
{
	int64_t begun;

	start("K");
	begun = host_now(&host);
	TEST_ASSERT_EQUAL_INT(-EINPROGRESS,
	                      ask_within(BUS_READ, TEMPERATURE, NULL, 64, ENOUGH)->err);
	TEST_ASSERT_GREATER_OR_EQUAL_INT64(begun + ENOUGH, host_now(&host));
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
	TEST_ASSERT_EQUAL_UINT(2, peer_saw(&peer.connections));
	TEST_ASSERT_EQUAL_UINT64(1, counted("timeouts"));
}

static void test_half_an_answer_is_a_sign_of_life_too(void)
{
	start("d");
	TEST_ASSERT_EQUAL_INT(-EINPROGRESS,
	                      ask_within(BUS_READ, TEMPERATURE, NULL, 64, ENOUGH)->err);
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
}

static void test_silence_takes_the_target_down_and_it_comes_back(void)
{
	start("s");
	TEST_ASSERT_EQUAL_INT(-ETIMEDOUT,
	                      ask_within(BUS_READ, TEMPERATURE, NULL, 64, 100 * HOST_MS)->err);
	goes_down_with(-ETIMEDOUT, peer.target);
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, read_temperature());
	comes_up();
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_UINT64(1, counted("reconnects"));
}

static void test_refused_persistence_is_no_failure(void)
{
	start("rrrr");
	for (unsigned i = 0; i < 5; i++)
		TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_UINT64(4, counted("refused_persistence"));
	TEST_ASSERT_EQUAL_UINT(5, peer_saw(&peer.connections));
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
	TEST_ASSERT_EQUAL_HEX32(0x24, peer.flags);
}

static void test_a_connection_closed_while_idle_is_replaced_unseen(void)
{
	start("caca");
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	until_peer_saw(&peer.closed, 1);
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_WRITE, OUTPUT, "1", 1)->err);
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_GREATER_OR_EQUAL_UINT64(2, counted("stale_connection"));
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
	TEST_ASSERT_EQUAL_UINT(1, peer_saw(&peer.writes));
}

static void test_a_read_that_met_a_closing_server_is_repeated_once(void)
{
	start("axaaxx");
	for (unsigned i = 0; i < 3; i++)
		TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
	TEST_ASSERT_EQUAL_UINT64(1, counted("stale_connection"));
	TEST_ASSERT_EQUAL_INT(-ECONNRESET, read_temperature());
	goes_down_with(-ECONNRESET, "closed");
}

static void test_an_answer_that_came_twice_does_not_pass_for_the_next(void)
{
	start("aD");
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	until_peer_saw(&peer.done, 2);
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_READ, "/28.67C6697351FF/type", NULL, 64)->err);
	TEST_ASSERT_EQUAL_MEMORY("DS18B20", data, 7);
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
}

static void test_a_write_that_was_sent_is_never_repeated(void)
{
	start("ax");
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_WRITE, OUTPUT, "1", 1)->err);
	TEST_ASSERT_EQUAL_INT(-ECONNRESET, ask(BUS_WRITE, OUTPUT, "2", 1)->err);
	TEST_ASSERT_EQUAL_UINT(2, peer_saw(&peer.writes));
	goes_down_with(-ECONNRESET, peer.target);
	comes_up();
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_WRITE, OUTPUT, "2", 1)->err);
	TEST_ASSERT_EQUAL_UINT(3, peer_saw(&peer.writes));
}

static void test_a_server_lost_in_the_middle_of_an_answer_is_down(void)
{
	start("am");
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_INT(-ECONNRESET, read_temperature());
	goes_down_with(-ECONNRESET, "closed");
	comes_up();
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
}

static void test_the_answer_comes_before_the_news_of_the_loss(void)
{
	struct bus_req req = { .id = 9, .op = BUS_READ, .path = TEMPERATURE, .data = data,
	                       .len = 64, .deadline_ns = host_now(&host) + PATIENCE };

	start("m");
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req));
	while (host.answers == 0) {
		TEST_ASSERT_EQUAL_UINT(1, host.events);
		bus_step(bus, host_now(&host));
	}
	TEST_ASSERT_EQUAL_UINT(1, host.events);
	bus_step(bus, host_now(&host));
	TEST_ASSERT_EQUAL_UINT(2, host.events);
}

static void test_a_reset_is_a_loss(void)
{
	start("RR");
	TEST_ASSERT_EQUAL_INT(-ECONNRESET, read_temperature());
	goes_down_with(-ECONNRESET, peer.target);
}

static void is_garbage(const char *plan)
{
	start(plan);
	TEST_ASSERT_EQUAL_INT_MESSAGE(-EPROTO, read_temperature(), plan);
	goes_down_with(-EPROTO, peer.target);
	TEST_ASSERT_EQUAL_UINT64(1, counted("garbage"));
	comes_up();
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	bus_destroy(bus);
	bus = NULL;
	stop_peer();
	peer_end(&peer);
	host_init_real(&host);
}

static void test_garbage_of_each_kind_takes_the_target_down(void)
{
	is_garbage("g");
	is_garbage("h");
	is_garbage("n");
	is_garbage("v");
	is_garbage("w");
	is_garbage("l");
	is_garbage("t");
}

static unsigned descriptors(void)
{
	DIR *dir = opendir("/proc/self/fd");
	unsigned n = 0;

	TEST_ASSERT_NOT_NULL(dir);
	while (readdir(dir))
		n++;
	closedir(dir);
	return n;
}

static void test_a_target_that_is_not_there_is_tried_for_ever_and_told_once(void)
{
	unsigned open_before;

	peer_start(&peer, AF_INET, "");
	peer_stop(&peer);
	bus = host_bus(&host, peer.target);
	open_before = descriptors();
	goes_down_with(-ECONNRESET, "refused");
	host_run(&host, bus, host_now(&host) + 700 * HOST_MS);
	TEST_ASSERT_EQUAL_UINT(1, host.events);
	TEST_ASSERT_EQUAL_UINT(open_before, descriptors());
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, read_temperature());
	peer_restart(&peer, "");
	is_peer_up = true;
	comes_up();
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_UINT64(0, counted("reconnects"));
}

static void test_a_server_that_goes_while_idle_is_noticed(void)
{
	start("");
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	stop_peer();
	goes_down_with(-ECONNRESET, "refused");
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, read_temperature());
}

static void test_an_unknown_name_says_so(void)
{
	bus = host_bus(&host, "no-such-host.invalid:4304");
	goes_down_with(-ECONNRESET, "no-such-host.invalid");
}

static void test_shutdown_ends_a_request_at_once(void)
{
	struct bus_req req = { .id = 9, .op = BUS_READ, .path = TEMPERATURE, .data = data,
	                       .len = 64, .deadline_ns = INT64_MAX };

	start("s");
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req));
	host.shutdown = true;
	bus_step(bus, host_now(&host));
	TEST_ASSERT_EQUAL_INT(-EINPROGRESS, host_answer(&host, 9)->err);
}

static void test_a_suspended_bus_lets_go_of_the_connection(void)
{
	unsigned open_before;

	start("");
	open_before = descriptors();
	bus_suspend(bus, true);
	TEST_ASSERT_LESS_OR_EQUAL_UINT(open_before - 1, descriptors());
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, read_temperature());
	bus_suspend(bus, false);
	comes_up();
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
}

static unsigned backs_within(int64_t time_ns)
{
	host_run(&host, bus, host_now(&host) + time_ns);
	return host_events(&host, BUS_BACK);
}

static void test_a_suspended_bus_sees_when_the_server_is_back(void)
{
	unsigned open_before;

	start("");
	stop_peer();
	bus_suspend(bus, true);
	open_before = descriptors();
	TEST_ASSERT_EQUAL_UINT(0, backs_within(300 * HOST_MS));
	peer_restart(&peer, "");
	is_peer_up = true;
	TEST_ASSERT_TRUE(host_run_events(&host, bus, host.events + 1, host_now(&host) + PATIENCE));
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_BACK));
	TEST_ASSERT_EQUAL_UINT(0, peer_saw(&peer.requests));
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
	stop_peer();
	TEST_ASSERT_EQUAL_UINT(open_before, descriptors());
}

static void test_a_server_that_hangs_is_not_back(void)
{
	int fd = socket(AF_INET, SOCK_STREAM, 0);
	struct sockaddr_in address = { .sin_family = AF_INET,
	                               .sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
	socklen_t len = sizeof(address);
	char target[32];

	TEST_ASSERT_EQUAL_INT(0, bind(fd, (struct sockaddr *)&address, len));
	TEST_ASSERT_EQUAL_INT(0, listen(fd, 4));
	TEST_ASSERT_EQUAL_INT(0, getsockname(fd, (struct sockaddr *)&address, &len));
	snprintf(target, sizeof(target), "127.0.0.1:%d", ntohs(address.sin_port));
	bus = host_bus(&host, target);
	bus_suspend(bus, true);
	TEST_ASSERT_EQUAL_UINT(0, backs_within(400 * HOST_MS));
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, read_temperature());
	close(fd);
}

static void test_any_mixture_of_faults_ends_in_one_answer_each_and_no_leak(void)
{
	static const char letters[] = "aaaafkrcxRmdshgnvwlt";
	const unsigned seed = 1963;
	char plan[61];
	unsigned open_before;

	srand(seed);
	for (unsigned i = 0; i < sizeof(plan) - 1; i++)
		plan[i] = letters[(size_t)rand() % (sizeof(letters) - 1)];
	plan[sizeof(plan) - 1] = '\0';
	start(plan);
	open_before = descriptors();
	for (unsigned i = 0; i < 40; i++) {
		int err = ask_within(i % 3 ? BUS_READ : BUS_WRITE, i % 3 ? TEMPERATURE : OUTPUT,
		                     i % 3 ? NULL : "1", i % 3 ? 64 : 1, 60 * HOST_MS)->err;

		TEST_ASSERT_TRUE_MESSAGE(err == 0 || err == -EINPROGRESS || err == -ETIMEDOUT ||
		                         err == -ECONNRESET || err == -EPROTO || err == -ENOTCONN ||
		                         err == -ETIME, plan);
		if (err == -ENOTCONN)
			host_run_events(&host, bus, host.events + 1,
			                host_now(&host) + 500 * HOST_MS);
	}
	TEST_ASSERT_LESS_OR_EQUAL_UINT_MESSAGE(open_before + 1, descriptors(), plan);
}

int main(void)
{
	/* of a name server that does not answer */
	setenv("RES_OPTIONS", "timeout:1 attempts:1", 1);
	UNITY_BEGIN();
	RUN_TEST(test_it_greets_before_it_is_up_and_says_where_it_is);
	RUN_TEST(test_a_server_that_is_slow_to_name_its_buses_is_up);
	RUN_TEST(test_requests_share_one_connection);
	RUN_TEST(test_a_read_asks_for_the_room_it_has_and_past_the_cache);
	RUN_TEST(test_an_empty_text_is_an_answer);
	RUN_TEST(test_answers_of_a_simulated_server_say_so);
	RUN_TEST(test_a_write_is_done_once);
	RUN_TEST(test_a_write_that_was_cut_is_an_error);
	RUN_TEST(test_device_and_property_are_missed_by_different_errors);
	RUN_TEST(test_a_probe_asks_for_the_device_alone);
	RUN_TEST(test_a_device_with_an_alias_is_listed_by_its_id);
	RUN_TEST(test_an_entry_that_is_nobody_keeps_its_name_and_bad_ones_are_left_out);
	RUN_TEST(test_a_listing_longer_than_the_room_is_an_error);
	RUN_TEST(test_a_path_too_long_to_send_is_an_error_of_this_request);
	RUN_TEST(test_ipv6_is_served);
	RUN_TEST(test_a_unix_socket_is_served_and_come_back_to);
	RUN_TEST(test_the_path_of_a_socket_has_its_limit);
	RUN_TEST(test_a_name_is_resolved_and_all_its_addresses_are_tried);
	RUN_TEST(test_a_reply_in_single_bytes_is_read);
	RUN_TEST(test_keep_alives_are_passed_over);
	RUN_TEST(test_keep_alives_do_not_extend_the_deadline_and_the_target_stays_up);
	RUN_TEST(test_half_an_answer_is_a_sign_of_life_too);
	RUN_TEST(test_silence_takes_the_target_down_and_it_comes_back);
	RUN_TEST(test_refused_persistence_is_no_failure);
	RUN_TEST(test_a_connection_closed_while_idle_is_replaced_unseen);
	RUN_TEST(test_a_read_that_met_a_closing_server_is_repeated_once);
	RUN_TEST(test_an_answer_that_came_twice_does_not_pass_for_the_next);
	RUN_TEST(test_a_write_that_was_sent_is_never_repeated);
	RUN_TEST(test_a_server_lost_in_the_middle_of_an_answer_is_down);
	RUN_TEST(test_the_answer_comes_before_the_news_of_the_loss);
	RUN_TEST(test_a_reset_is_a_loss);
	RUN_TEST(test_garbage_of_each_kind_takes_the_target_down);
	RUN_TEST(test_a_target_that_is_not_there_is_tried_for_ever_and_told_once);
	RUN_TEST(test_a_server_that_goes_while_idle_is_noticed);
	RUN_TEST(test_an_unknown_name_says_so);
	RUN_TEST(test_shutdown_ends_a_request_at_once);
	RUN_TEST(test_a_suspended_bus_lets_go_of_the_connection);
	RUN_TEST(test_a_suspended_bus_sees_when_the_server_is_back);
	RUN_TEST(test_a_server_that_hangs_is_not_back);
	RUN_TEST(test_any_mixture_of_faults_ends_in_one_answer_each_and_no_leak);
	return UNITY_END();
}
