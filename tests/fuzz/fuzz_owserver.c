/* SPDX-License-Identifier: MIT */
/*
 * The owserver bus with a hostile server: what its connection gives comes from the input. Bytes are
 * read when the bus waits for an answer; between the requests they say what is asked for next.
 */
#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/owfs/frame.h"
#include "hal/owserver/connection.h"
#include "tests/fuzz/bus_host.h"

#define REQUESTS 24
#define WAITS 600 /* for one input */

static struct fuzz fuzz;
static struct bus_host host;
static unsigned waits;
/* What the server has sent and nobody has read. */
static uint8_t wire[70000];
static size_t wire_at, wire_end;
static bool closed;

size_t fuzz_memory(size_t n)
{
	/* the bus and its tables, and the room of the requests */
	return 1500000 + 16 * n;
}

/* --- In the place of hal/owserver/connection.c ------------------------------------------------ */

int connection_init(struct connection *c, const struct bus_env *env, const char *where, char *why,
                    size_t why_size)
{
	(void)where, (void)why, (void)why_size;
	*c = (struct connection){.env = env, .fd = -1, .peer = "hostile:4304"};
	return 0;
}

static void forget(void)
{
	wire_at = wire_end = 0;
	closed = false;
}

int connection_begin(struct connection *c)
{
	connection_close(c);
	if (fuzz_left(&fuzz) && fuzz_byte(&fuzz) == 0xff) {
		strcpy(c->trouble, "hostile:4304: refused");
		return -ECONNREFUSED;
	}
	forget();
	c->fd = 1;
	return 0;
}

int connection_go_on(struct connection *c, int64_t until_ns)
{
	switch (fuzz_byte(&fuzz)) {
	case 0xfe:
		c->env->wait(c->env->ctx, -1, 0, until_ns);
		return -EAGAIN;
	case 0xff:
		connection_close(c);
		strcpy(c->trouble, "hostile:4304: no route");
		return -EHOSTUNREACH;
	}
	return 0;
}

int connection_open(struct connection *c, int64_t until_ns)
{
	int err = connection_begin(c);

	if (!err)
		err = connection_go_on(c, until_ns);
	if (err == -EAGAIN) {
		strcpy(c->trouble, "hostile:4304: Connection timed out");
		err = -ETIMEDOUT;
	}
	if (err)
		connection_close(c);
	return err;
}

void connection_close(struct connection *c)
{
	c->fd = -1;
}

bool connection_is_open(const struct connection *c)
{
	return c->fd >= 0;
}

bool connection_is_stale(const struct connection *c)
{
	TEST_ASSERT_TRUE(c->fd >= 0);
	return closed || wire_at < wire_end;
}

int connection_send(struct connection *c, const uint8_t *bytes, size_t n, int64_t until_ns,
                    size_t *sent)
{
	struct frame_header header;
	int what = fuzz_byte(&fuzz);

	TEST_ASSERT_TRUE(c->fd >= 0 && n >= FRAME_HEADER);
	frame_get_header(bytes, &header);
	TEST_ASSERT_EQUAL_size_t_MESSAGE(n, FRAME_HEADER + (size_t)header.payload,
	                                 "a request whose length is wrong");
	*sent = n;
	if (what < 0xf8)
		return 0;
	*sent = what & 1 ? n / 2 : 0;
	if (what & 2)
		return -EPIPE;
	c->env->wait(c->env->ctx, -1, 0, until_ns);
	return -ETIMEDOUT;
}

static void put(const void *bytes, size_t n)
{
	if (n > sizeof(wire) - wire_end)
		n = sizeof(wire) - wire_end;
	if (n)
		memcpy(wire + wire_end, bytes, n);
	wire_end += n;
}

static void put_frame(int32_t type, uint32_t flags, int32_t payload, int32_t size, size_t n,
                      const uint8_t *data)
{
	struct frame_header header = {
		.payload = payload, .type = type, .flags = flags, .size = size};
	uint8_t head[FRAME_HEADER];

	frame_put_header(head, &header);
	put(head, sizeof(head));
	put(data, n);
}

/* One thing that the server does. False: nothing, for ever. */
static bool serve(void)
{
	static const uint8_t blanks[16384] = "/28.67C6697351FF,/10.ABC,alias one,/bus.0";
	uint8_t what = fuzz_byte(&fuzz);
	const uint8_t *data;
	int8_t status;
	size_t n;

	switch (what & 7) {
	case 0: /* an answer that fits what was asked, with a status */
		status = (int8_t)fuzz_byte(&fuzz);
		data = fuzz_bytes(&fuzz, 255, &n);
		put_frame(status < 0 ? status : (int32_t)n, FRAME_PERSIST, (int32_t)n, (int32_t)n,
		          n, data);
		return true;
	case 1: /* bytes */
		data = fuzz_bytes(&fuzz, 255, &n);
		put(data, n);
		return true;
	case 2:
		put_frame(0, 0, -1, 0, 0, NULL);
		return true;
	case 3: /* numbers that need not fit */
		data = fuzz_bytes(&fuzz, 255, &n);
		put_frame((int32_t)fuzz_word(&fuzz), fuzz_word(&fuzz), (int32_t)fuzz_word(&fuzz),
		          (int32_t)fuzz_word(&fuzz), n, data);
		return true;
	case 4:
		closed = true;
		return true;
	case 5: /* as long as it says, and long */
		n = fuzz_word(&fuzz) % (sizeof(blanks) + 1);
		put_frame((int32_t)n, FRAME_PERSIST, (int32_t)n, 0, n, blanks);
		return true;
	case 6: /* with tokens */
		data = fuzz_bytes(&fuzz, 255, &n);
		put_frame(0, FRAME_PERSIST, (int32_t)n, 0, n, data);
		wire[(wire_end - n - FRAME_HEADER) % sizeof(wire) + 1] = 1;
		wire[(wire_end - n - FRAME_HEADER) % sizeof(wire) + 3] = fuzz_byte(&fuzz);
		return true;
	}
	return false;
}

int connection_receive(struct connection *c, uint8_t *bytes, size_t room, int64_t until_ns)
{
	size_t n = 1 + fuzz_byte(&fuzz) * 17u;

	TEST_ASSERT_TRUE(c->fd >= 0);
	if (host.shutdown)
		return -ECANCELED;
	if (++waits > WAITS) {
		c->env->wait(c->env->ctx, -1, 0, until_ns);
		return -ETIMEDOUT;
	}
	host.now += BUS_HOST_MS;
	if (wire_at == wire_end && !closed) {
		wire_at = wire_end = 0;
		if (!serve()) {
			c->env->wait(c->env->ctx, -1, 0, until_ns);
			return -ETIMEDOUT;
		}
	}
	if (wire_at == wire_end)
		return closed ? 0 : -ECONNRESET;
	if (n > wire_end - wire_at)
		n = wire_end - wire_at;
	if (n > room)
		n = room;
	memcpy(bytes, wire + wire_at, n);
	wire_at += n;
	return (int)n;
}

/* --- What is asked ---------------------------------------------------------------------------- */

static void ask(void)
{
	static const char *const paths[] = {
		"/28.67C6697351FF/temperature",
		"/",
		"/bus.0/28.67C6697351FF",
		"/alias/memory",
		"/29.000029D60100/PIO.BYTE",
		"/simultaneous/temperature",
		"/alarm",
		"/1F.000029D60100/main/28.67C6697351FF/type",
	};
	static const uint32_t rooms[] = {0, 1, 12, 256, 4096, 65536, 100000, 2};
	static const int64_t times[] = {BUS_HOST_MS, 100 * BUS_HOST_MS, BUS_HOST_S,
	                                20 * BUS_HOST_S};
	static const uint8_t value[100000];
	uint8_t what = fuzz_byte(&fuzz), how = fuzz_byte(&fuzz);
	enum bus_op op = (enum bus_op)(what & 3);

	bus_host_ask(&host, op, paths[what >> 2 & 7], what & 0x20, op == BUS_WRITE ? value : NULL,
	             rooms[how & 7], times[how >> 3 & 3]);
	if ((how & 0xc0) == 0xc0)
		bus_suspend(host.bus, what & 0x40);
}

void fuzz_one(const uint8_t *bytes, size_t n)
{
	fuzz = (struct fuzz){bytes, bytes + n};
	waits = 0;
	forget();
	bus_host_begin(&host);
	TEST_ASSERT_NOT_NULL(bus_host_open(&host, "owserver:hostile"));
	bus_host_run(&host, BUS_HOST_S, false);
	for (int i = 0; i < REQUESTS && fuzz_left(&fuzz); i++) {
		ask();
		bus_host_run(&host, 21 * BUS_HOST_S, true);
		if (fuzz_byte(&fuzz) & 1)
			bus_host_run(&host, 2 * BUS_HOST_S, false);
	}
	bus_suspend(host.bus, false);
	bus_host_run(&host, 21 * BUS_HOST_S, false);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(0, host.lent, "a request was never answered");
	TEST_ASSERT_FALSE_MESSAGE(host.down_owed, "the loss of the target was not told");
	bus_host_end(&host);
}
