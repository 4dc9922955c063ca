/* SPDX-License-Identifier: MIT */
/* Sets up the w1 bus on a directory that looks like /sys/bus/w1/devices. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "hal/owfs/path.h"
#include "tests/unit/aid/fs_scene.h"

struct fs fs;

void fs_erase(const char *what)
{
	char line[200];

	snprintf(line, sizeof(line), "rm -rf %s/%s", fs.root, what);
	TEST_ASSERT_EQUAL_INT(0, system(line));
}

void fs_put(const char *directory, const char *name, const void *bytes, size_t n)
{
	char full[200];

	snprintf(full, sizeof(full), "%s/%s", fs.root, directory);
	mkdir(full, 0755);
	snprintf(full, sizeof(full), "%s/%s/%s", fs.root, directory, name);
	FILE *file = fopen(full, "w");
	TEST_ASSERT_NOT_NULL(file);
	TEST_ASSERT_EQUAL_size_t(n, fwrite(bytes, 1, n, file));
	fclose(file);
}

void fs_text(const char *directory, const char *name, const char *what)
{
	fs_put(directory, name, what, strlen(what));
}

void fs_byte(const char *directory, const char *name, int value)
{
	uint8_t one = (uint8_t)value;

	fs_put(directory, name, &one, 1);
}

void fs_broken(const char *directory, const char *name)
{
	char full[200];

	snprintf(full, sizeof(full), "%s/%s/%s", fs.root, directory, name);
	unlink(full);
	TEST_ASSERT_EQUAL_INT(0, symlink("/proc/self/mem", full));
}

const char *fs_now_in(const char *directory, const char *name)
{
	static char content[600];
	char full[200];

	snprintf(full, sizeof(full), "%s/%s/%s", fs.root, directory, name);
	FILE *file = fopen(full, "r");
	TEST_ASSERT_NOT_NULL(file);
	content[fread(content, 1, sizeof(content) - 1, file)] = '\0';
	fclose(file);
	return content;
}

void fs_slave_of(const char *master, const char *name)
{
	char inner[80], outer[200];

	fs_text(master, "uevent", "");
	snprintf(inner, sizeof(inner), "%s/%s", master, name);
	fs_text(inner, "name", name);
	snprintf(outer, sizeof(outer), "%s/%s", fs.root, name);
	TEST_ASSERT_EQUAL_INT(0, symlink(inner, outer));
}

void fs_slave(const char *name)
{
	fs_slave_of("w1_bus_master1", name);
}

void fs_gone(const char *name)
{
	char inner[80];

	snprintf(inner, sizeof(inner), "w1_bus_master*/%s", name);
	fs_erase(name);
	fs_erase(inner);
}

void fs_scratchpad(const char *name, int raw, int high, int low, int config, const char *verdict)
{
	uint8_t pad[9] = {(uint8_t)raw,
	                  (uint8_t)(raw >> 8),
	                  (uint8_t)high,
	                  (uint8_t)low,
	                  (uint8_t)config,
	                  0xff,
	                  (uint8_t)(16 - (raw & 15)),
	                  0x10,
	                  0};
	char line[120];
	size_t n = 0;

	if (raw == 0x550)
		pad[6] = 0x0c;
	pad[8] = rom_crc8(pad, 8);
	for (int i = 0; i < 9; i++)
		n += (size_t)snprintf(line + n, sizeof(line) - n, "%02x ", pad[i]);
	snprintf(line + n, sizeof(line) - n, ": crc=%02x %s\nt=0\n", pad[8], verdict);
	fs_text(name, "w1_slave", line);
}

void fs_thermometer(const char *name, int raw)
{
	fs_slave(name);
	fs_scratchpad(name, raw, 75, 70, 0x7f, "YES");
	fs_text(name, "alarms", "70 75\n");
	fs_text(name, "resolution", "12\n");
	fs_text(name, "ext_power", "1\n");
}

void fs_begin(void)
{
	host_init_virtual(&fs.host);
	fs.next_id = 0;
	snprintf(fs.root, sizeof(fs.root), "/tmp/owsd-w1-XXXXXX");
	TEST_ASSERT_NOT_NULL(mkdtemp(fs.root));
}

void fs_end(void)
{
	bus_destroy(fs.bus);
	fs.bus = NULL;
	fs_erase("");
}

void fs_start(void)
{
	char target[100];

	fs_text("w1_bus_master1", "uevent", "");
	snprintf(target, sizeof(target), "w1:root=%s", fs.root);
	fs.bus = host_bus(&fs.host, target);
	TEST_ASSERT_TRUE(host_run_events(&fs.host, fs.bus, 1, fs.host.now + HOST_S));
}

uint32_t fs_ask(enum bus_op op, const char *what, const void *value, size_t n)
{
	uint32_t id = fs.next_id++;

	snprintf(fs.path[id], sizeof(fs.path[id]), "%s", what);
	fs.req[id] = (struct bus_req){.id = id,
	                              .op = (uint8_t)op,
	                              .prio = BUS_INPUT,
	                              .fresh = true,
	                              .path = fs.path[id],
	                              .data = fs.data[id],
	                              .len = op == BUS_WRITE ? (uint32_t)n : 4095,
	                              .offset = op == BUS_WRITE ? fs.write_offset : 0,
	                              .deadline_ns = fs.host.now + 20 * HOST_S};
	memset(fs.data[id], 0, sizeof(fs.data[id]));
	if (op == BUS_WRITE)
		memcpy(fs.data[id], value, n);
	TEST_ASSERT_EQUAL_INT(0, bus_submit(fs.bus, &fs.req[id]));
	return id;
}

int fs_result(uint32_t id)
{
	int64_t until = fs.host.now + 21 * HOST_S;

	while (!host_answer(&fs.host, id) && fs.host.now < until)
		host_run(&fs.host, fs.bus, fs.host.now + HOST_MS * 10);
	TEST_ASSERT_EQUAL_UINT(1, host_answers(&fs.host, id));
	return host_answer(&fs.host, id)->err;
}

void fs_reads(const char *expected, const char *what)
{
	uint32_t id = fs_ask(BUS_READ, what, NULL, 0);

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, fs_result(id), what);
	TEST_ASSERT_EQUAL_STRING_MESSAGE(expected, (char *)fs.data[id], what);
}

void fs_fails(int err, const char *what)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(err, fs_result(fs_ask(BUS_READ, what, NULL, 0)), what);
}

int fs_writes_at(uint32_t offset, const char *what, const char *value)
{
	int err;

	fs.write_offset = offset;
	err = fs_writes(what, value);
	fs.write_offset = 0;
	return err;
}

int fs_writes(const char *what, const char *value)
{
	return fs_result(fs_ask(BUS_WRITE, what, value, strlen(value)));
}

void fs_lists(const char *expected, const char *what)
{
	uint32_t id = fs_ask(BUS_DIR, what, NULL, 0);

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, fs_result(id), what);
	TEST_ASSERT_EQUAL_STRING_MESSAGE(expected, (char *)fs.data[id], what);
}

bool fs_told(enum bus_news news, const char *part)
{
	for (unsigned i = 0; i < fs.host.events; i++)
		if (fs.host.event[i].news == news && strstr(fs.host.event[i].text, part))
			return true;
	return false;
}

void fs_board(int state, int control)
{
	fs_slave(BOARD);
	fs_byte(BOARD, "state", state);
	fs_byte(BOARD, "output", 0xff);
	fs_byte(BOARD, "activity", 0x05);
	fs_byte(BOARD, "cond_search_mask", 0x0f);
	fs_byte(BOARD, "cond_search_polarity", 0x01);
	fs_byte(BOARD, "status_control", control);
}
