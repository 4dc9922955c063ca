/* SPDX-License-Identifier: MIT */
/* What the owserver bus asks and takes from a server, a peer on loopback. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>

#include "unity.h"

#include "hal/bus/backends.h"
#include "tests/unit/aid/owserver_scene.h"

void setUp(void)
{
	owserver_begin();
}

void tearDown(void)
{
	owserver_end();
}

static void test_it_greets_before_it_is_up_and_says_where_it_is(void)
{
	serve("");
	TEST_ASSERT_NOT_NULL(strstr(host.event[0].text, peer.target));
	TEST_ASSERT_EQUAL_INT64(INT64_C(15000000000), host.event[0].cache_ns);
	TEST_ASSERT_EQUAL_UINT(4, peer_saw(&peer.greetings));
	TEST_ASSERT_EQUAL_UINT(0, peer_saw(&peer.requests));
}

static void test_a_server_that_is_slow_to_name_its_buses_is_up(void)
{
	serve("z");
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
	TEST_ASSERT_EQUAL_UINT(1, peer_saw(&peer.connections));
	TEST_ASSERT_EQUAL_UINT8(BUS_DETAIL_SIMULATED,
	                        request(BUS_READ, TEMPERATURE, NULL, 64)->detail);
}

static void test_requests_share_one_connection(void)
{
	uint64_t before;

	serve("");
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
	serve("");
	TEST_ASSERT_EQUAL_INT(0, request(BUS_READ, TEMPERATURE, NULL, 40)->err);
	TEST_ASSERT_EQUAL_UINT(1, peer_saw(&peer.requests));
	TEST_ASSERT_EQUAL_INT32(40, peer.size);
	TEST_ASSERT_EQUAL_HEX32(0x24, peer.flags);
	TEST_ASSERT_EQUAL_INT(0, request(BUS_READ, TEMPERATURE, NULL, 70000)->err);
	TEST_ASSERT_EQUAL_UINT(2, peer_saw(&peer.requests));
	TEST_ASSERT_EQUAL_INT32(65536, peer.size);
	TEST_ASSERT_EQUAL_INT(-EMSGSIZE, request(BUS_READ, TEMPERATURE, NULL, 0)->err);
}

static void test_an_empty_text_is_an_answer(void)
{
	serve("");
	TEST_ASSERT_EQUAL_INT(0, request(BUS_READ, "/28.67C6697351FF/locator", NULL, 64)->err);
	TEST_ASSERT_EQUAL_UINT32(0, host.answer[0].len);
}

static void test_answers_of_a_simulated_server_say_so(void)
{
	serve("");
	TEST_ASSERT_EQUAL_UINT8(BUS_DETAIL_SIMULATED,
	                        request(BUS_READ, TEMPERATURE, NULL, 64)->detail);
}

static void test_a_write_is_done_once(void)
{
	serve("");
	TEST_ASSERT_EQUAL_INT(0, request(BUS_WRITE, OUTPUT, "137", 3)->err);
	TEST_ASSERT_EQUAL_UINT32(3, host.answer[0].len);
	TEST_ASSERT_EQUAL_UINT(1, peer_saw(&peer.writes));
}

static void test_a_write_that_was_cut_is_an_error(void)
{
	serve("");
	TEST_ASSERT_EQUAL_INT(-EIO, request(BUS_WRITE, OUTPUT, "123456789", 9)->err);
}

static void test_device_and_property_are_missed_by_different_errors(void)
{
	serve("");
	TEST_ASSERT_EQUAL_INT(-ENODEV, request(BUS_READ, "/28.AABBCCDDEEFF/type", NULL, 64)->err);
	TEST_ASSERT_EQUAL_INT(-ENOENT, request(BUS_READ, "/28.67C6697351FF/colour", NULL, 64)->err);
	TEST_ASSERT_EQUAL_INT(-ENOENT, request(BUS_READ, "/settings/colour", NULL, 64)->err);
	TEST_ASSERT_EQUAL_INT(-ENODEV, request(BUS_WRITE, "/28.AABBCCDDEEFF/PIO", "1", 1)->err);
	TEST_ASSERT_EQUAL_INT(-EACCES,
	                      request(BUS_WRITE, "/28.67C6697351FF/readonly", "1", 1)->err);
	TEST_ASSERT_EQUAL_INT(-EISDIR,
	                      request(BUS_READ, "/28.67C6697351FF/directory", NULL, 64)->err);
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
}

static void test_a_probe_asks_for_the_device_alone(void)
{
	peer_has_a_wire = true;
	serve("");
	TEST_ASSERT_EQUAL_INT(0, request(BUS_PROBE, TEMPERATURE, NULL, 0)->err);
	TEST_ASSERT_EQUAL_UINT(2, peer_saw(&peer.requests));
	TEST_ASSERT_EQUAL_STRING("/28.67C6697351FF/present", peer.path);
	TEST_ASSERT_EQUAL_INT(-ENODEV, request(BUS_PROBE, "/28.AABBCCDDEEFF/x", NULL, 0)->err);
}

/* Its cache has the device, the wire has not: what is read of it are the ones of the idle wire. */
static void test_a_server_whose_cache_has_a_device_that_is_away_is_not_believed(void)
{
	peer_has_a_wire = true;
	serve("");
	TEST_ASSERT_EQUAL_INT(-ENODEV, request(BUS_READ, "/30.000029D60100/volt", NULL, 64)->err);
	TEST_ASSERT_EQUAL_INT(-ENODEV, request(BUS_PROBE, "/30.000029D60100/volt", NULL, 0)->err);
	TEST_ASSERT_EQUAL_STRING("/30.000029D60100/present", peer.path);
	/* a server without the property says all that it can by PRESENT */
	TEST_ASSERT_EQUAL_INT(0, request(BUS_PROBE, OUTPUT, NULL, 0)->err);
}

static void lists(const char *path, const char *expected)
{
	const struct bus_answer *answer = request(BUS_DIR, path, NULL, sizeof(room));

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer->err, path);
	room[answer->len] = '\0';
	TEST_ASSERT_EQUAL_STRING(expected, (char *)room);
}

static void test_a_device_with_an_alias_is_listed_by_its_id(void)
{
	unsigned before;

	serve("");
	lists("/", "/28.67C6697351FF\n/29.000029D60100\n/bus.0\n/settings\n");
	before = peer_saw(&peer.requests);
	lists("/alarm", "/alarm/28.67C6697351FF\n");
	lists("/28.67C6697351FF", "/28.67C6697351FF/address\n/28.67C6697351FF/type\n");
	TEST_ASSERT_EQUAL_UINT(before + 2, peer_saw(&peer.requests));
}

static void test_an_entry_that_is_nobody_keeps_its_name_and_bad_ones_are_left_out(void)
{
	serve("");
	lists("/odd", "/stranger\n/29.000029D60100\n");
}

static void test_a_listing_longer_than_the_room_is_an_error(void)
{
	serve("");
	TEST_ASSERT_EQUAL_INT(-EMSGSIZE, request(BUS_DIR, "/", NULL, 30)->err);
	TEST_ASSERT_EQUAL_UINT32(0, host.answer[0].len);
	TEST_ASSERT_EQUAL_INT(-ENODEV, request(BUS_DIR, "/28.AABBCCDDEEFF", NULL, 64)->err);
}

static void test_a_path_too_long_to_send_is_an_error_of_this_request(void)
{
	static char path[1100];

	serve("");
	memset(path, 'x', sizeof(path) - 1);
	path[0] = '/';
	TEST_ASSERT_EQUAL_INT(-EMSGSIZE, request(BUS_READ, path, NULL, 64)->err);
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_EQUAL_UINT(1, peer_saw(&peer.connections));
}

static void test_ipv6_is_served(void)
{
	serve_as(AF_INET6, "");
	TEST_ASSERT_EQUAL_INT(0, read_temperature());
	TEST_ASSERT_NOT_NULL(strstr(host.event[0].text, "[::1]"));
}

static void test_a_unix_socket_is_served_and_come_back_to(void)
{
	serve_as(AF_UNIX, "");
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

int main(void)
{
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
	RUN_TEST(test_a_server_whose_cache_has_a_device_that_is_away_is_not_believed);
	RUN_TEST(test_a_device_with_an_alias_is_listed_by_its_id);
	RUN_TEST(test_an_entry_that_is_nobody_keeps_its_name_and_bad_ones_are_left_out);
	RUN_TEST(test_a_listing_longer_than_the_room_is_an_error);
	RUN_TEST(test_a_path_too_long_to_send_is_an_error_of_this_request);
	RUN_TEST(test_ipv6_is_served);
	RUN_TEST(test_a_unix_socket_is_served_and_come_back_to);
	RUN_TEST(test_the_path_of_a_socket_has_its_limit);
	RUN_TEST(test_a_name_is_resolved_and_all_its_addresses_are_tried);
	return UNITY_END();
}
