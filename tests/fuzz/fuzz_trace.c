/* SPDX-License-Identifier: MIT */
/*
 * Recordings, as strangers send them: made anonymous, which keeps all but digits and triplets, and
 * replayed as target replay:FILE, whatever their links, adapters and servers answer.
 */
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "hal/trace/anonymous.h"
#include "hal/trace/trace.h"
#include "tests/fuzz/bus_host.h"

#define MOST 20000

static struct bus_host host;

size_t fuzz_memory(size_t n)
{
	/* the bus; each byte may be a line */
	return 11000000 + 200 * n;
}

static void make_anonymous(const char *text)
{
	static const uint8_t mask[TRACE_MASK] = {0xa5, 0x17, 0xff, 0x80};
	char *copy = strdup(text);

	TEST_ASSERT_NOT_NULL(copy);
	trace_anonymous(copy, mask);
	TEST_ASSERT_EQUAL_size_t(strlen(text), strlen(copy));
	for (size_t i = 0; text[i]; i++)
		if (!strchr("0123456789abcdefABCDEF", text[i]))
			TEST_ASSERT_EQUAL_INT(text[i], copy[i]);
	free(copy);
}

/* The other end of a pair of sockets. */
static int64_t ready(void *ctx, int fd, short events)
{
	struct pollfd one = {.fd = fd, .events = events};

	(void)ctx;
	return poll(&one, 1, 0) > 0 ? host.now : INT64_MAX;
}

static void replay(const char *text)
{
	int fd = memfd_create("trace", MFD_CLOEXEC);
	char target[50];

	TEST_ASSERT_TRUE(fd >= 0);
	TEST_ASSERT_EQUAL((ssize_t)strlen(text), write(fd, text, strlen(text)));
	snprintf(target, sizeof(target), "replay:/proc/self/fd/%d", fd);
	bus_host_begin(&host);
	host.ready = ready;
	if (bus_host_open(&host, target)) {
		bus_host_run(&host, 300 * BUS_HOST_MS, false);
		bus_host_ask(&host, BUS_DIR, "/", true, NULL, 4096, BUS_HOST_S);
		bus_host_ask(&host, BUS_READ, "/28.000000000001/temperature", true, NULL, 256,
		             BUS_HOST_S);
		bus_host_ask(&host, BUS_WRITE, "/29.000000000001/PIO.BYTE", true, "1", 1,
		             BUS_HOST_S);
		bus_host_ask(&host, BUS_DIR, "/alarm", true, NULL, 4096, BUS_HOST_S);
		bus_host_run(&host, 100 * BUS_HOST_S, true);
		TEST_ASSERT_EQUAL_UINT_MESSAGE(0, host.lent, "a request was never answered");
	}
	close(fd);
	bus_host_end(&host);
}

void fuzz_one(const uint8_t *bytes, size_t n)
{
	size_t len = n < MOST ? n : MOST;
	char *text = malloc(len + sizeof(TRACE_BEGIN));

	TEST_ASSERT_NOT_NULL(text);
	strcpy(text, TRACE_BEGIN);
	memcpy(text + strlen(TRACE_BEGIN), bytes, len);
	text[strlen(TRACE_BEGIN) + len] = '\0';
	make_anonymous(text);
	replay(text);
	free(text);
}
