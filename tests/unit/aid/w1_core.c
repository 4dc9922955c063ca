/* SPDX-License-Identifier: MIT */
/* A model of the kernel's 1-Wire core behind a netlink socket. */
#include <errno.h>
#include <fcntl.h>
#include <linux/connector.h>
#include <linux/netlink.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "hal/netlink/talk.h"
#include "unity.h"

#include "hal/wire/search.h"
#include "tests/unit/aid/w1_core.h"

#define RESET_NS 1184000
#define SLOT_NS 69250
#define HEADS (NLMSG_HDRLEN + sizeof(struct cn_msg))
#define MESSAGE 12
#define COMMAND 4
#define LIST_MASTERS 6

struct w1_core w1_core;

static int (*real_socket)(void);
static int64_t clock_ns;
static uint8_t reply[8192];
static size_t reply_n;

static int make_socket(void)
{
	int pair[2];

	w1_core.sockets++;
	if (w1_core.socket_error)
		return w1_core.socket_error;
	TEST_ASSERT_EQUAL_INT(0, socketpair(AF_UNIX, SOCK_SEQPACKET, 0, pair));
	if (w1_core.fd >= 0)
		close(w1_core.fd);
	w1_core.fd = pair[1];
	fcntl(w1_core.fd, F_SETFL, O_NONBLOCK);
	return pair[0];
}

static unsigned get16(const uint8_t *at)
{
	uint16_t value;

	memcpy(&value, at, sizeof(value));
	return value;
}

static uint32_t get32(const uint8_t *at)
{
	uint32_t value;

	memcpy(&value, at, sizeof(value));
	return value;
}

static void put(const void *bytes, size_t n)
{
	TEST_ASSERT_LESS_OR_EQUAL_size_t(sizeof(reply), reply_n + n);
	if (n)
		memcpy(reply + reply_n, bytes, n);
	reply_n += n;
}

static void transmit(const uint8_t *bytes, size_t n)
{
	TEST_ASSERT_EQUAL_INT((int)n, (int)send(w1_core.fd, bytes, n, MSG_NOSIGNAL));
}

static unsigned random_number(void)
{
	w1_core.seed = w1_core.seed * 1103515245 + 12345;
	return w1_core.seed >> 8;
}

static void scramble(void)
{
	w1_core.scrambles--;
	reply[random_number() % reply_n] ^= (uint8_t)(1 + random_number() % 255);
}

static void finish(void)
{
	struct nlmsghdr head = {.nlmsg_len = (uint32_t)reply_n, .nlmsg_type = NLMSG_DONE};

	if (reply_n <= NLMSG_HDRLEN)
		return;
	memcpy(reply, &head, sizeof(head));
	if (w1_core.silent) {
		w1_core.silent--;
	} else if (w1_core.late) {
		w1_core.late--;
		memcpy(w1_core.kept, reply, reply_n);
		w1_core.kept_n = reply_n;
	} else if (w1_core.garbage) {
		w1_core.garbage--;
		head.nlmsg_len -= 3;
		memcpy(reply, &head, sizeof(head));
		transmit(reply, reply_n - 3);
	} else {
		if (w1_core.scrambles)
			scramble();
		if (w1_core.kept_n)
			transmit(w1_core.kept, w1_core.kept_n);
		w1_core.kept_n = 0;
		transmit(reply, reply_n);
	}
	reply_n = NLMSG_HDRLEN;
}

static void put_message(const uint8_t *request, bool answer, unsigned status, unsigned len)
{
	uint32_t seq = get32(request + NLMSG_HDRLEN + 8);
	struct cn_msg connector = {.id = {CN_W1_IDX, CN_W1_VAL},
	                           .seq = seq,
	                           .ack = answer ? seq + 1 : 0,
	                           .len = (uint16_t)(MESSAGE + len)};
	uint8_t message[MESSAGE];

	memcpy(message, request + HEADS, MESSAGE);
	message[1] = (uint8_t)status;
	message[2] = (uint8_t)len;
	message[3] = (uint8_t)(len >> 8);
	put(&connector, sizeof(connector));
	put(message, MESSAGE);
}

static void put_command(const uint8_t *request, bool answer, unsigned status, uint8_t code,
                        const uint8_t *data, unsigned n)
{
	uint8_t head[COMMAND] = {code, 0, (uint8_t)n, (uint8_t)(n >> 8)};

	put_message(request, answer, status, COMMAND + n);
	put(head, sizeof(head));
	put(data, n);
	if (w1_core.spreads)
		finish();
}

static bool slot(struct sim_wire *wire, bool out)
{
	bool line = sim_wire_slot(wire, out, false, clock_ns);

	clock_ns += SLOT_NS;
	return line;
}

static bool reset(struct sim_wire *wire)
{
	bool present = sim_wire_reset(wire, false, clock_ns);

	clock_ns += RESET_NS;
	return present;
}

static uint8_t byte(struct sim_wire *wire, uint8_t out)
{
	uint8_t in = 0;

	for (int i = 0; i < 8; i++)
		in |= (uint8_t)(slot(wire, out >> i & 1) << i);
	return in;
}

/* Select the first slave, as w1_therm does when another program reads it meanwhile. */
static void intrude(struct sim_wire *wire)
{
	if (!wire->count || !reset(wire))
		return;
	byte(wire, 0x55);
	for (int i = 0; i < 8; i++)
		byte(wire, wire->slaves[0]->rom[i]);
}

/* Search by the tree, as a master does: wire->slaves are not used. */
static void search(struct sim_wire *wire, const uint8_t *request, uint8_t code)
{
	uint8_t roms[512], rom[8] = {0};
	unsigned n = 0;
	int branch = -1;

	do {
		int untried = -1;

		if (!reset(wire))
			break;
		byte(wire, code == W1_SEARCH ? 0xf0 : 0xec);
		for (int i = 0; i < 64; i++) {
			bool id = slot(wire, true), complement = slot(wire, true);
			bool old = rom[i / 8] >> i % 8 & 1;
			bool taken = id != complement ? id : i < branch ? old : i == branch;

			TEST_ASSERT_FALSE(id && complement);
			if (id == complement && !taken)
				untried = i;
			slot(wire, taken);
			rom[i / 8] = (uint8_t)((rom[i / 8] & ~(1 << i % 8)) | taken << i % 8);
		}
		branch = untried;
		TEST_ASSERT_LESS_THAN_UINT(sizeof(roms), n + 8);
		memcpy(roms + n, rom, 8);
		n += 8;
	} while (branch >= 0);
	/* The kernel splits long lists. */
	unsigned first = w1_core.spreads ? n / 16 * 8 : n;
	put_command(request, true, 0, code, roms, first);
	if (first < n)
		put_command(request, true, 0, code, roms + first, n - first);
}

static void carry_out(struct sim_wire *wire, const uint8_t *request, const uint8_t *command)
{
	unsigned n = get16(command + 2), status = 0;
	uint8_t in[256];

	TEST_ASSERT_LESS_OR_EQUAL_UINT(sizeof(in), n);
	TEST_ASSERT_LESS_THAN_UINT(8, command[0]);
	w1_core.commands[command[0]]++;
	for (unsigned i = 0; i < n; i++) {
		in[i] = command[0] == W1_READ ? 0xff : command[COMMAND + i];
		in[i] = byte(wire, in[i]);
	}
	if (command[0] == W1_RESET)
		status = reset(wire) ? 0 : W1_STATUS_NOBODY;
	if (command[0] == W1_READ || command[0] == W1_TOUCH)
		put_command(request, true, 0, command[0], in, n);
	if (command[0] == W1_SEARCH)
		search(wire, request, command[0]);
	put_command(request, false, status, command[0], NULL, 0);
}

static void serve_master(const uint8_t *request, size_t n)
{
	uint32_t master = get32(request + HEADS + 4);
	unsigned left = get16(request + HEADS + 2);
	const uint8_t *command = request + HEADS + MESSAGE;

	TEST_ASSERT_EQUAL_UINT(n - HEADS - MESSAGE, left);
	TEST_ASSERT_EQUAL_UINT(1, get16(request + NLMSG_HDRLEN + 18));
	w1_core.requests++;
	if (w1_core.refuses) {
		w1_core.refuses--;
		put_message(request, false, EINVAL, 0);
		return;
	}
	if (!master || master > w1_core.masters || master == w1_core.gone) {
		put_message(request, false, ENODEV, 0);
		return;
	}
	struct sim_wire *wire = &wire_net.wire[master - 1];
	if (w1_core.intrudes)
		intrude(wire);
	while (left) {
		unsigned size = COMMAND + get16(command + 2);

		TEST_ASSERT_LESS_OR_EQUAL_UINT(left, size);
		carry_out(wire, request, command);
		command += size;
		left -= size;
	}
}

static void serve(const uint8_t *request, size_t n)
{
	TEST_ASSERT_GREATER_OR_EQUAL_size_t(HEADS + MESSAGE, n);
	TEST_ASSERT_EQUAL_UINT(n, get32(request));
	TEST_ASSERT_EQUAL_UINT(CN_W1_IDX, get32(request + NLMSG_HDRLEN));
	TEST_ASSERT_EQUAL_UINT(CN_W1_VAL, get32(request + NLMSG_HDRLEN + 4));
	TEST_ASSERT_EQUAL_UINT(n - HEADS, get16(request + NLMSG_HDRLEN + 16));
	reply_n = NLMSG_HDRLEN;
	if (w1_core.masters == 0)
		return;
	if (request[HEADS] != LIST_MASTERS) {
		serve_master(request, n);
	} else {
		unsigned count = w1_core.masters - (w1_core.gone ? 1 : 0);

		put_message(request, true, 0, 4 * count);
		/* The youngest master is first. */
		for (uint32_t i = w1_core.masters; i; i--)
			if (i != w1_core.gone)
				put(&i, sizeof(i));
	}
	finish();
}

static int64_t ready(void *ctx, int fd, short events)
{
	uint8_t request[4096];
	struct pollfd poll_fd = {.fd = fd, .events = POLLIN};
	ssize_t n;

	(void)ctx;
	TEST_ASSERT_EQUAL_INT(POLLIN, events);
	clock_ns = w1_core.host->now;
	while ((n = recv(w1_core.fd, request, sizeof(request), 0)) > 0)
		serve(request, (size_t)n);
	return poll(&poll_fd, 1, 0) == 1 ? clock_ns : INT64_MAX;
}

void w1_core_start(struct host *host, unsigned masters)
{
	w1_core = (struct w1_core){.host = host, .fd = -1, .masters = masters};
	host->ready = ready;
	real_socket = w1_socket;
	w1_socket = make_socket;
}

void w1_core_stop(void)
{
	w1_socket = real_socket;
	if (w1_core.fd >= 0)
		close(w1_core.fd);
}
