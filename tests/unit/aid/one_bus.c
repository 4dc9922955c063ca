/* SPDX-License-Identifier: MIT */
/* The one bus of a test and its host. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "tests/unit/aid/one_bus.h"

struct host host;
struct bus *bus;

void simulate(const char *scenario)
{
	char file[] = "/tmp/owsd-test-XXXXXX", target[64];
	int fd = mkstemp(file);

	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, fd);
	TEST_ASSERT_EQUAL_INT(strlen(scenario), write(fd, scenario, strlen(scenario)));
	close(fd);
	host_init_virtual(&host);
	snprintf(target, sizeof(target), "sim:%s", file);
	bus = host_bus(&host, target);
	unlink(file);
}

uint64_t counted(const char *name)
{
	size_t n;
	const struct bus_counter *counter = bus_counters(bus, &n);

	for (size_t i = 0; i < n; i++)
		if (strcmp(counter[i].name, name) == 0)
			return bus_counted(&counter[i]);
	TEST_FAIL_MESSAGE(name);
	return 0;
}

void one_bus_end(void)
{
	bus_destroy(bus);
	bus = NULL;
}
