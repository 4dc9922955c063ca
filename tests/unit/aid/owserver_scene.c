/* SPDX-License-Identifier: MIT */
/* Sets up the owserver bus against a peer on loopback. */
#include <dirent.h>
#include <errno.h>
#include <netinet/in.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

#include "unity.h"

#include "tests/unit/aid/owserver_scene.h"

struct peer peer;
bool is_peer_up;
uint8_t room[70000];
static uint32_t next_id;

void owserver_begin(void)
{
	peer_has_a_wire = false;
	/* the time-out of a name server that does not answer */
	setenv("RES_OPTIONS", "timeout:1 attempts:1", 1);
	host_init_real(&host);
	is_peer_up = false;
	memset(room, 0, sizeof(room));
}

void stop_peer(void)
{
	if (is_peer_up)
		peer_stop(&peer);
	is_peer_up = false;
}

void owserver_end(void)
{
	one_bus_end();
	stop_peer();
	peer_end(&peer);
}

void serve_as(int family, const char *plan)
{
	peer_start(&peer, family, plan);
	is_peer_up = true;
	bus = host_bus(&host, peer.target);
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host_now(&host) + PATIENCE));
	TEST_ASSERT_EQUAL_UINT8_MESSAGE(BUS_UP, host.event[0].news, host.event[0].text);
}

void serve(const char *plan)
{
	serve_as(AF_INET, plan);
}

const struct bus_answer *request_within(enum bus_op op, const char *path, const char *text,
                                        uint32_t len, int64_t time_ns)
{
	struct bus_req req = {.id = ++next_id,
	                      .op = (uint8_t)op,
	                      .path = path,
	                      .data = room,
	                      .len = len,
	                      .fresh = true,
	                      .deadline_ns = host_now(&host) + time_ns};

	if (text)
		memcpy(room, text, len);
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req));
	TEST_ASSERT_TRUE(
		host_run_answers(&host, bus, host.answers + 1, host_now(&host) + PATIENCE));
	TEST_ASSERT_EQUAL_UINT(1, host_answers(&host, next_id));
	return host_answer(&host, next_id);
}

const struct bus_answer *request(enum bus_op op, const char *path, const char *text, uint32_t len)
{
	return request_within(op, path, text, len, PATIENCE);
}

int read_temperature(void)
{
	const struct bus_answer *answer = request(BUS_READ, TEMPERATURE, NULL, 256);

	if (answer->err == 0) {
		TEST_ASSERT_EQUAL_UINT32(12, answer->len);
		TEST_ASSERT_EQUAL_MEMORY("     21.0625", room, 12);
	}
	return answer->err;
}

void goes_down_with(int err, const char *word)
{
	const struct bus_event *event = &host.event[host.events];

	TEST_ASSERT_TRUE(host_run_events(&host, bus, host.events + 1, host_now(&host) + PATIENCE));
	TEST_ASSERT_EQUAL_UINT8_MESSAGE(BUS_DOWN, event->news, event->text);
	TEST_ASSERT_EQUAL_INT32_MESSAGE(err, event->err, event->text);
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(event->text, word), event->text);
}

void comes_up(void)
{
	const struct bus_event *event = &host.event[host.events];

	TEST_ASSERT_TRUE(host_run_events(&host, bus, host.events + 1, host_now(&host) + PATIENCE));
	TEST_ASSERT_EQUAL_UINT8_MESSAGE(BUS_UP, event->news, event->text);
}

/* The peer's thread acts only when it has the processor. */
void until_peer_saw(const unsigned *count, unsigned n)
{
	int64_t until = host_now(&host) + PATIENCE;

	while (peer_saw(count) < n && host_now(&host) < until)
		host_run(&host, bus, host_now(&host) + HOST_MS);
	TEST_ASSERT_EQUAL_UINT(n, peer_saw(count));
	host_run(&host, bus, host_now(&host) + 20 * HOST_MS);
}

unsigned descriptors(void)
{
	DIR *dir = opendir("/proc/self/fd");
	unsigned n = 0;

	TEST_ASSERT_NOT_NULL(dir);
	while (readdir(dir))
		n++;
	closedir(dir);
	return n;
}
