/* SPDX-License-Identifier: MIT */
/* One slave on a wire of the native bus, and requests to it. */
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/owfs/path.h"
#include "tests/unit/aid/one_slave.h"

struct sim_slave *slave;
uint8_t slave_data[4096];
static struct bus_req slave_req;
static uint32_t next_id, offset;

void one_slave_begin(void)
{
	host_init_virtual(&host);
}

void one_slave_end(void)
{
	one_bus_end();
	wire_clear();
}

const struct bus_answer *exchange(enum bus_op op, enum bus_prio prio, const char *path,
                                  const char *text)
{
	slave_req = (struct bus_req){.id = next_id++,
	                             .op = (uint8_t)op,
	                             .prio = (uint8_t)prio,
	                             .fresh = true,
	                             .path = path,
	                             .data = slave_data,
	                             .len = sizeof(slave_data) - 1,
	                             .deadline_ns = host.now + 20 * HOST_S};
	if (text) {
		slave_req.len = (uint32_t)strlen(text);
		slave_req.offset = offset;
		memcpy(slave_data, text, slave_req.len);
	}
	host.answers = 0;
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &slave_req));
	TEST_ASSERT_TRUE(host_run_answers(&host, bus, 1, host.now + 21 * HOST_S));
	TEST_ASSERT_EQUAL_UINT(1, host.answers);
	return &host.answer[0];
}

const char *slave_path(const char *property)
{
	static char path[128];
	char name[ROM_TEXT_MAX];

	rom_print(slave->rom, ROM_F_I, name);
	snprintf(path, sizeof(path), "/%s/%s", name, property);
	return path;
}

const struct bus_answer *go(enum bus_op op, const char *property, const char *text)
{
	return exchange(op, BUS_OUTPUT, slave_path(property), text);
}

const struct bus_answer *put_at(uint32_t at, const char *property, const char *text)
{
	const struct bus_answer *answer;

	offset = at;
	answer = go(BUS_WRITE, property, text);
	offset = 0;
	return answer;
}

void reads(const char *property, const char *text)
{
	const struct bus_answer *answer = go(BUS_READ, property, NULL);

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer->err, property);
	slave_data[answer->len] = '\0';
	TEST_ASSERT_EQUAL_STRING_MESSAGE(text, (char *)slave_data, property);
}

void writes(const char *property, const char *text)
{
	const struct bus_answer *answer = go(BUS_WRITE, property, text);

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer->err, property);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(strlen(text), answer->len, property);
}

void refuses(int err, enum bus_op op, const char *property, const char *text)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(err, go(op, property, text)->err, property);
}
