/* SPDX-License-Identifier: MIT */
/*
 * The simulator's language: what stands before a NUL is a scenario; it is read, run for some
 * virtual time, and if it has few events served as target sim:FILE. Behind the NUL come events, a
 * line each, that happen one after the other.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "hal/sim/event.h"
#include "hal/sim/scenario.h"
#include "tests/fuzz/bus_host.h"

#define EVENTS 16
#define NS_MS INT64_C(1000000)

static struct bus_host host;

size_t fuzz_memory(size_t n)
{
	/* the bus; each line may be a device with its memory */
	return 9000000 + 400 * n;
}

static void check_why(const char *name, const char *why)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, strncmp(why, name, strlen(name)), why);
	TEST_ASSERT_TRUE_MESSAGE(strlen(why) > strlen(name), why);
}

/* Everything that the chips do, and what a host sees that talks to each of them. */
static void run(struct sim_net *net, int64_t *now, int64_t ns)
{
	static const uint8_t bytes[] = {0xf0, 0xb4, 0xa5, 0xcc, 0x44, 0xe1, 0xf0};

	for (int i = 0; i < 4; i++) {
		*now += ns / 4;
		sim_net_run(net, *now);
		for (uint8_t address = 0x18; address < 0x20; address++) {
			if (!sim_i2c_start(net, address, false, *now))
				continue;
			for (size_t k = 0; k < sizeof(bytes); k++)
				sim_i2c_write(net, bytes[k], *now += 100000);
			if (sim_i2c_start(net, address, true, *now))
				sim_i2c_read(net, *now += 20000);
		}
	}
	TEST_ASSERT_TRUE(sim_net_next(net) > *now || sim_net_next(net) == INT64_MAX);
}

static int64_t shortest_repetition(const struct sim_net *net)
{
	int64_t shortest = INT64_MAX;

	for (size_t i = 0; i < net->events; i++)
		if (net->event[i].every_ns && net->event[i].every_ns < shortest)
			shortest = net->event[i].every_ns;
	return shortest;
}

static void run_parsed(const char *text, struct fuzz *fuzz, bool *calm)
{
	struct sim_net net;
	char why[200] = "", line[200];
	int64_t now = 1000 * BUS_HOST_S;
	int err = sim_scenario_parse("s", text, &net, why, sizeof(why));

	*calm = false;
	TEST_ASSERT_TRUE(err == 0 || err == -EINVAL);
	if (err) {
		check_why("s:", why);
		return;
	}
	*calm = shortest_repetition(&net) >= 10 * NS_MS;
	/* what happens a million times a second is given less of them */
	run(&net, &now, *calm ? 2 * BUS_HOST_S : 4 * NS_MS);
	for (int i = 0; i < EVENTS && fuzz_left(fuzz); i++) {
		fuzz_line(fuzz, line, sizeof(line));
		why[0] = '\0';
		err = sim_scenario_event(&net, line, now, why, sizeof(why));
		TEST_ASSERT_TRUE(err == 0 || (err == -EINVAL && why[0]));
		run(&net, &now, *calm ? 100 * NS_MS : NS_MS);
	}
	if (*calm)
		run(&net, &now, 4 * 3600 * BUS_HOST_S / 1000);
	sim_net_clear(&net);
}

/* The whole of it: the driver of the chips, and the devices as files. */
static void serve(const char *text)
{
	int fd = memfd_create("scenario", MFD_CLOEXEC);
	char target[40];

	TEST_ASSERT_TRUE(fd >= 0);
	TEST_ASSERT_EQUAL((ssize_t)strlen(text), write(fd, text, strlen(text)));
	snprintf(target, sizeof(target), "sim:/proc/self/fd/%d", fd);
	bus_host_begin(&host);
	TEST_ASSERT_NOT_NULL(bus_host_open(&host, target));
	close(fd);
	bus_host_run(&host, 100 * NS_MS, false);
	bus_host_ask(&host, BUS_DIR, "/", true, NULL, 4096, BUS_HOST_S);
	bus_host_ask(&host, BUS_WRITE, "/simultaneous/temperature", true, "1", 1, BUS_HOST_S);
	bus_host_ask(&host, BUS_READ, "/28.000000000001/temperature", true, NULL, 256, BUS_HOST_S);
	bus_host_ask(&host, BUS_READ, "/29.000000000001/PIO.ALL", true, NULL, 256, BUS_HOST_S);
	bus_host_ask(&host, BUS_DIR, "/alarm", true, NULL, 4096, BUS_HOST_S);
	bus_host_ask(&host, BUS_DIR, "/simulator", true, NULL, 4096, BUS_HOST_S);
	bus_host_ask(&host, BUS_WRITE, "/simulator/b", true, "1", 1, BUS_HOST_S);
	bus_host_ask(&host, BUS_READ, "/simulator/b", true, NULL, 1, BUS_HOST_S);
	bus_host_run(&host, 3 * BUS_HOST_S, true);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(0, host.lent, "a request was never answered");
	bus_host_end(&host);
}

void fuzz_one(const uint8_t *bytes, size_t n)
{
	size_t len = n ? strnlen((const char *)bytes, n) : 0;
	struct fuzz fuzz = {bytes + len + (len < n), bytes + n};
	char *text = malloc(len + 1);
	bool calm;

	TEST_ASSERT_NOT_NULL(text);
	if (len)
		memcpy(text, bytes, len);
	text[len] = '\0';
	run_parsed(text, &fuzz, &calm);
	if (calm && len < 600)
		serve(text);
	free(text);
}
