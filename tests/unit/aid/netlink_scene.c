/* SPDX-License-Identifier: MIT */
/* Sets up the target w1:netlink on a model of the kernel's 1-Wire core. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "hal/owfs/path.h"
#include "tests/unit/aid/netlink_scene.h"

struct netlink_scene nl;
static char root[64];
static struct bus_req req;
static uint32_t next_id;

void nl_begin(void)
{
	host_init_virtual(&nl.host);
	next_id = 0;
	nl.whole = false;
	snprintf(root, sizeof(root), "/tmp/owsd-netlink-XXXXXX");
	TEST_ASSERT_NOT_NULL(mkdtemp(root));
}

void nl_erase(const char *what)
{
	char line[200];

	snprintf(line, sizeof(line), "rm -rf %s/%s", root, what);
	TEST_ASSERT_EQUAL_INT(0, system(line));
}

void nl_close(void)
{
	bus_destroy(nl.bus);
	nl.bus = NULL;
}

void nl_end(void)
{
	nl_close();
	w1_core_stop();
	wire_clear();
	nl_erase("");
}

void nl_sysfs_master(unsigned number)
{
	char full[200];

	snprintf(full, sizeof(full), "%s/w1_bus_master%u", root, number);
	mkdir(full, 0755);
	strcat(full, "/w1_master_slaves");
	FILE *file = fopen(full, "w");
	TEST_ASSERT_NOT_NULL(file);
	fputs("not found.\n", file);
	fclose(file);
}

void nl_masters(unsigned masters)
{
	wire_init(&nl.host, masters, masters);
	w1_core_start(&nl.host, masters);
	for (unsigned i = 1; i <= masters; i++)
		nl_sysfs_master(i);
}

void nl_create(const char *rest)
{
	char target[150];

	snprintf(target, sizeof(target), "w1:netlink/root=%s%s", root, rest);
	nl.bus = host_bus(&nl.host, target);
}

void nl_start(void)
{
	nl_create("");
	TEST_ASSERT_TRUE(host_run_events(&nl.host, nl.bus, 1, nl.host.now + HOST_S));
	TEST_ASSERT_EQUAL_UINT8(BUS_UP, nl.host.event[0].news);
}

/* One bus gives many answers: only the last is kept. */
const struct bus_answer *nl_ask(enum bus_op op, const char *path, const char *value)
{
	static struct bus_answer last;
	size_t n = op == BUS_WRITE ? strlen(value) : NETLINK_ROOM - 1;
	int64_t until = nl.host.now + 61 * HOST_S;

	nl.host.answers = 0;
	req = (struct bus_req){.id = next_id++,
	                       .op = (uint8_t)op,
	                       .prio = BUS_INPUT,
	                       .fresh = true,
	                       .whole = nl.whole,
	                       .path = path,
	                       .data = nl.data,
	                       .len = (uint32_t)n,
	                       .deadline_ns = nl.host.now + 60 * HOST_S};
	memset(nl.data, 0, sizeof(nl.data));
	if (op == BUS_WRITE)
		memcpy(nl.data, value, n);
	TEST_ASSERT_EQUAL_INT(0, bus_submit(nl.bus, &req));
	while (!nl.host.answers && nl.host.now < until)
		host_run_answers(&nl.host, nl.bus, 1, until);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(1, nl.host.answers, path);
	last = nl.host.answer[0];
	return &last;
}

const char *nl_path(const struct sim_slave *slave, const char *property)
{
	static char paths[4][100];
	static unsigned turn;
	char *path = paths[turn++ % 4], name[ROM_TEXT_MAX];

	rom_print(slave->rom, ROM_F_I, name);
	snprintf(path, 100, "/%s%s%s", name, *property ? "/" : "", property);
	return path;
}

int nl_read(const struct sim_slave *slave, const char *property)
{
	return nl_ask(BUS_READ, nl_path(slave, property), NULL)->err;
}

void nl_reads(const struct sim_slave *slave, const char *property, const char *expected)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, nl_read(slave, property), property);
	TEST_ASSERT_EQUAL_STRING_MESSAGE(expected, (char *)nl.data, property);
}

int nl_write(const struct sim_slave *slave, const char *property, const char *value)
{
	return nl_ask(BUS_WRITE, nl_path(slave, property), value)->err;
}

bool nl_told(enum bus_news news, const char *part)
{
	for (unsigned i = 0; i < nl.host.events; i++)
		if (nl.host.event[i].news == news && strstr(nl.host.event[i].text, part))
			return true;
	return false;
}

struct sim_slave *nl_thermometer(unsigned channel, unsigned id, double value)
{
	struct sim_slave *slave = wire_add(channel, "DS18B20", id);

	wire_set(slave, "temperature", value);
	return slave;
}

void nl_lists(const char *directory, const char *expected)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, nl_ask(BUS_DIR, directory, NULL)->err, directory);
	TEST_ASSERT_EQUAL_STRING_MESSAGE(expected, (char *)nl.data, directory);
}
