/* SPDX-License-Identifier: MIT */
/* Sets up the native bus over a net of simulated slaves. */
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/owfs/path.h"
#include "tests/unit/aid/native_scene.h"

struct bus_req req[NATIVE_REQUESTS];
uint8_t data[NATIVE_REQUESTS][4096];
static char path[NATIVE_REQUESTS][128];
static uint32_t next_id;

void native_begin(void)
{
	host_init_virtual(&host);
	next_id = 0;
	list_whole = false;
}

void native_end(void)
{
	one_bus_end();
	wire_clear();
}

void forget(void)
{
	next_id = 0;
	host.answers = 0;
}

void start(void)
{
	bus = wire_open();
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host.now + HOST_S));
	TEST_ASSERT_EQUAL_UINT8(BUS_UP, host.event[0].news);
}

uint32_t write_offset, write_nuls;
bool list_whole;

uint32_t ask(enum bus_op op, enum bus_prio prio, bool fresh, const char *what, const char *text)
{
	uint32_t id = next_id++;

	snprintf(path[id], sizeof(path[id]), "%s", what);
	req[id] = (struct bus_req){.id = id,
	                           .op = (uint8_t)op,
	                           .prio = (uint8_t)prio,
	                           .fresh = fresh,
	                           .whole = list_whole,
	                           .path = path[id],
	                           .data = data[id],
	                           .len = sizeof(data[id]),
	                           .offset = op == BUS_WRITE ? write_offset : 0,
	                           .deadline_ns = host.now + 20 * HOST_S};
	memset(data[id], 0, sizeof(data[id]));
	if (op == BUS_WRITE) {
		req[id].len = (uint32_t)strlen(text) + write_nuls;
		memcpy(data[id], text, strlen(text));
	}
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req[id]));
	return id;
}

const struct bus_answer *answer_to(uint32_t id)
{
	int64_t until = host.now + 21 * HOST_S;

	while (!host_answer(&host, id) && host.now < until)
		host_run_answers(&host, bus, host.answers + 1, until);
	TEST_ASSERT_EQUAL_UINT(1, host_answers(&host, id));
	return host_answer(&host, id);
}

void expect(bool fresh, const char *what, const char *text)
{
	uint32_t id = ask(BUS_READ, BUS_INPUT, fresh, what, NULL);

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer_to(id)->err, what);
	TEST_ASSERT_EQUAL_STRING_MESSAGE(text, (char *)data[id], what);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(strlen(text), answer_to(id)->len, what);
}

int result(enum bus_op op, const char *what, const char *text)
{
	return answer_to(ask(op, BUS_INPUT, true, what, text))->err;
}

const char *name_of(const struct sim_slave *slave)
{
	static char names[4][40];
	static unsigned turn;
	char *name = names[turn++ % 4];

	name[0] = '/';
	rom_print(slave->rom, ROM_F_I, name + 1);
	return name;
}

const char *of(const struct sim_slave *slave, const char *property)
{
	static char paths[4][100];
	static unsigned turn;
	char *text = paths[turn++ % 4];

	snprintf(text, 100, "%s/%s", name_of(slave), property);
	return text;
}
