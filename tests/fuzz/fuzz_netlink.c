/* SPDX-License-Identifier: MIT */
/*
 * The target w1:netlink with a kernel that answers what it likes: the input says, for each request,
 * which datagrams come. Replies can be made as the kernel makes them, for the request at hand, with
 * something wrong in them.
 */
#include <errno.h>
#include <linux/connector.h>
#include <linux/netlink.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "hal/native/state.h"
#include "hal/netlink/run.h"
#include "hal/netlink/talk.h"
#include "hal/owfs/path.h"
#include "tests/fuzz/bus_host.h"
#include "tests/fuzz/sysfs.h"

#define STEPS 24
#define REPLIES 400
#define DATAGRAM 2048
#define HEADS (NLMSG_HDRLEN + sizeof(struct cn_msg) + 12)

static struct fuzz fuzz;
static struct bus_host host;
static int kernel = -1;
static unsigned replies;
static uint8_t request[DATAGRAM];
static size_t request_n;

size_t fuzz_memory(size_t n)
{
	return 8000000 + 16 * n;
}

static int open_pair(void)
{
	int pair[2];

	if (kernel >= 0)
		close(kernel);
	kernel = -1;
	if (fuzz_byte(&fuzz) == 0xff)
		return -EPERM;
	if (socketpair(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0, pair))
		return -errno;
	kernel = pair[1];
	return pair[0];
}

static void put16(uint8_t *at, uint16_t value)
{
	memcpy(at, &value, sizeof(value));
}

/* Replies as of Linux 6.1 to the commands of the request, or to one that was not asked. */
static size_t make_reply(uint8_t what, uint8_t *out)
{
	struct cn_msg connector;
	size_t n = HEADS, data_n;
	uint8_t status = what & 0x40 ? fuzz_byte(&fuzz) : 0;
	const uint8_t *data = fuzz_bytes(&fuzz, 255, &data_n);

	if (request_n < HEADS)
		return 0;
	memcpy(out, request, HEADS);
	out[HEADS - 11] = status;
	if (what & 0x08) { /* data of one command */
		uint8_t command[4] = {request_n > HEADS ? request[HEADS] : 0};

		put16(command + 2, (uint16_t)data_n);
		memcpy(out + n, command, 4);
		n += 4;
		if (data_n)
			memcpy(out + n, data, data_n);
		n += data_n;
	} else if (what & 0x10) { /* all of it back, as TOUCH does; with a status for each */
		memcpy(out + n, request + HEADS, request_n - HEADS);
		n = request_n;
		for (size_t i = 0; i < data_n && HEADS + 4 + i < n; i++)
			out[HEADS + 4 + i] ^= data[i];
	} else if (data_n) { /* a list of masters */
		memcpy(out + n, data, data_n);
		n += data_n;
	}
	put16(out + HEADS - 10, (uint16_t)(n - HEADS));
	memcpy(&connector, out + NLMSG_HDRLEN, sizeof(connector));
	connector.len = (uint16_t)(n - HEADS + 12);
	connector.ack = what & 0x20 ? connector.seq + 1 : connector.seq;
	memcpy(out + NLMSG_HDRLEN, &connector, sizeof(connector));
	memcpy(out, &(uint32_t){(uint32_t)n}, 4);
	return n;
}

/* One connector message with one w1 message; *n is where it goes. */
static void add_message(uint8_t *out, size_t *n, bool is_status, uint8_t status, uint8_t code,
                        const uint8_t *data, size_t data_n)
{
	struct cn_msg connector;
	uint8_t *at = out + *n;

	if (data_n > DATAGRAM / 2 || *n + HEADS + 4 + data_n > 2 * DATAGRAM)
		return;
	memcpy(at, request + NLMSG_HDRLEN, HEADS - NLMSG_HDRLEN);
	memcpy(&connector, at, sizeof(connector));
	connector.ack = is_status ? connector.seq : connector.seq + 1;
	connector.len = (uint16_t)(12 + 4 + data_n);
	memcpy(at, &connector, sizeof(connector));
	at += sizeof(connector);
	at[1] = status;
	put16(at + 2, (uint16_t)(4 + data_n));
	at += 12;
	at[0] = code;
	at[1] = 0;
	put16(at + 2, (uint16_t)data_n);
	if (data_n)
		memcpy(at + 4, data, data_n);
	*n += sizeof(connector) + 12 + 4 + data_n;
}

/* To every command what it asks for, with bytes of the input, and one length that need not fit. */
static size_t answer_all(uint8_t what, uint8_t *out)
{
	static uint8_t data[DATAGRAM];
	size_t n = NLMSG_HDRLEN, given_n, at = HEADS;
	const uint8_t *given = fuzz_bytes(&fuzz, 255, &given_n);
	uint8_t odd = what & 0x40 ? fuzz_byte(&fuzz) : 0xff;

	if (request_n < HEADS)
		return 0;
	for (unsigned i = 0; at + 4 <= request_n; i++) {
		uint8_t code = request[at];
		uint16_t len;
		bool reads = code == W1_READ || code == W1_TOUCH || code == W1_SEARCH;

		memcpy(&len, request + at + 2, 2);
		if (len > request_n - at - 4)
			break;
		memset(data, 0xff, sizeof(data));
		memcpy(data, request + at + 4, len);
		if (given_n)
			memcpy(data, given, code == W1_SEARCH || given_n < len ? given_n : len);
		if (reads)
			add_message(out, &n, false, 0, code, data,
			            (code == W1_SEARCH ? given_n : len) +
			                    ((odd & 15) == i ? (size_t)(odd >> 4) * 9 : 0));
		add_message(out, &n, true, 0, code, NULL, 0);
		at += 4u + len;
	}
	memcpy(out, request, NLMSG_HDRLEN);
	memcpy(out, &(uint32_t){(uint32_t)n}, 4);
	return n;
}

/* Behind the datagram nothing is read. */
static void forbid_rest(size_t n)
{
	struct native *native = (struct native *)host.bus;
	struct w1_talk *talk = &((struct w1_netlink *)native->master)->talk;

	fuzz_forbid(talk->in, sizeof(talk->in), false);
	fuzz_forbid(talk->in + n, sizeof(talk->in) - n, true);
}

/* True: a datagram came. */
static bool reply(void)
{
	static uint8_t out[DATAGRAM * 2];
	uint8_t what = fuzz_byte(&fuzz), at, by;
	size_t n = 0, part;
	const uint8_t *data;

	switch (what & 7) {
	case 0: /* silence */
		return false;
	case 1:
		data = fuzz_bytes(&fuzz, 255, &n);
		if (n)
			memcpy(out, data, n);
		break;
	case 2: /* a reply with some bytes changed */
		n = make_reply(what, out);
		do {
			at = fuzz_byte(&fuzz);
			by = fuzz_byte(&fuzz);
			if (n)
				out[at % n] ^= by;
		} while (by & 0x80 && fuzz_left(&fuzz));
		break;
	case 3: /* cut */
		n = make_reply(what, out);
		part = fuzz_byte(&fuzz);
		n -= part < n ? part : n;
		break;
	case 4: /* two in one datagram */
		n = make_reply(what, out);
		part = n;
		if (n)
			n += make_reply(fuzz_byte(&fuzz), out + n) - NLMSG_HDRLEN;
		if (n > part)
			memmove(out + part, out + part + NLMSG_HDRLEN, n - part);
		memcpy(out, &(uint32_t){(uint32_t)n}, 4);
		break;
	case 5:
		n = make_reply(what, out);
		break;
	default:
		n = answer_all(what, out);
		break;
	}
	if (n)
		forbid_rest(n);
	return n && send(kernel, out, n, MSG_DONTWAIT | MSG_NOSIGNAL) == (ssize_t)n;
}

/* The kernel works while the bus waits for it. */
static int64_t ready(void *ctx, int fd, short events)
{
	uint8_t peeked;
	ssize_t n;

	(void)ctx, (void)events;
	if (recv(fd, &peeked, 1, MSG_PEEK | MSG_DONTWAIT) > 0)
		return host.now;
	while ((n = recv(kernel, request, sizeof(request), MSG_DONTWAIT)) > 0)
		request_n = (size_t)n;
	if (replies++ >= REPLIES || !reply())
		return INT64_MAX;
	return host.now + BUS_HOST_MS;
}

static void ask(uint8_t what)
{
	static const char *const paths[] = {
		"/28.A10000000000/temperature", "/",
		"/29.B10000000000/PIO.BYTE",    "/alarm",
		"/simultaneous/temperature",    "/26.110000000000/VAD",
		"/28.A10000000000/present",     "/23.C10000000000/memory",
		"/29.B10000000000/latch.ALL",   "/28.A10000000000/templow",
	};
	const char *path = paths[(what >> 3 & 15) % 10];
	enum bus_op op = strchr(path + 1, '/') ? what & 0x80 ? BUS_WRITE : BUS_READ : BUS_DIR;

	bus_host_ask(&host, op, path, true, op == BUS_WRITE ? "1" : NULL,
	             op == BUS_WRITE ? 1 : 4096, 20 * BUS_HOST_S);
}

void fuzz_one(const uint8_t *bytes, size_t n)
{
	fuzz = (struct fuzz){bytes, bytes + n};
	replies = 0;
	request_n = 0;
	w1_socket = open_pair;
	sysfs_clear();
	sysfs_directory("w1_bus_master1", NULL, 0);
	sysfs_directory("w1_bus_master2", NULL, 0);
	bus_host_begin(&host);
	host.ready = ready;
	TEST_ASSERT_NOT_NULL(bus_host_open(&host, "w1:netlink/root=" SYSFS_ROOT));
	for (int i = 0; i < STEPS && fuzz_left(&fuzz); i++) {
		uint8_t what = fuzz_byte(&fuzz);

		if ((what & 7) == 7)
			sysfs_remove(what & 8 ? "w1_bus_master1" : "w1_bus_master2", NULL);
		else if ((what & 7) == 6)
			bus_host_run(&host, 10 * BUS_HOST_S, false);
		else
			ask(what);
		bus_host_run(&host, 30 * BUS_HOST_S, true);
	}
	fuzz.at = fuzz.end;
	bus_host_run(&host, 120 * BUS_HOST_S, true);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(0, host.lent, "a request was never answered");
	bus_host_end(&host);
	if (kernel >= 0)
		close(kernel);
	kernel = -1;
}
