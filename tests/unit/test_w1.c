/* SPDX-License-Identifier: MIT */
/* The w1 bus on a directory that looks like /sys/bus/w1/devices. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/path.h"
#include "hal/w1/w1.h"
#include "tests/unit/host.h"
#include "unity.h"

#define WARM "28-0000000000a1"
#define WARM_OW "/28.A10000000000"
#define BOARD "29-0000000000b1"
#define BOARD_OW "/29.B10000000000"

static struct host host;
static struct bus *bus;
static char root[64];
static struct bus_req req[64];
static uint8_t data[64][4096];
static char path[64][96];
static uint32_t next_id;

/* rm -r ROOT/WHAT */
static void erase(const char *what)
{
	char line[200];

	snprintf(line, sizeof(line), "rm -rf %s/%s", root, what);
	TEST_ASSERT_EQUAL_INT(0, system(line));
}

static void put(const char *directory, const char *name, const void *bytes, size_t n)
{
	char full[200];

	snprintf(full, sizeof(full), "%s/%s", root, directory);
	mkdir(full, 0755);
	snprintf(full, sizeof(full), "%s/%s/%s", root, directory, name);
	FILE *file = fopen(full, "w");
	TEST_ASSERT_NOT_NULL(file);
	TEST_ASSERT_EQUAL_size_t(n, fwrite(bytes, 1, n, file));
	fclose(file);
}

static void text(const char *directory, const char *name, const char *what)
{
	put(directory, name, what, strlen(what));
}

static void byte(const char *directory, const char *name, int value)
{
	uint8_t one = (uint8_t)value;

	put(directory, name, &one, 1);
}

/* The attribute fails with EIO. */
static void broken(const char *directory, const char *name)
{
	char full[200];

	snprintf(full, sizeof(full), "%s/%s/%s", root, directory, name);
	unlink(full);
	TEST_ASSERT_EQUAL_INT(0, symlink("/proc/self/mem", full));
}

static const char *now_in(const char *directory, const char *name)
{
	static char content[600];
	char full[200];

	snprintf(full, sizeof(full), "%s/%s/%s", root, directory, name);
	FILE *file = fopen(full, "r");
	TEST_ASSERT_NOT_NULL(file);
	content[fread(content, 1, sizeof(content) - 1, file)] = '\0';
	fclose(file);
	return content;
}

/* As in sysfs, a slave is a directory of its master, and another name leads there. */
static void slave_of(const char *master, const char *name)
{
	char inner[80], outer[200];

	text(master, "uevent", "");
	snprintf(inner, sizeof(inner), "%s/%s", master, name);
	text(inner, "name", name);
	snprintf(outer, sizeof(outer), "%s/%s", root, name);
	TEST_ASSERT_EQUAL_INT(0, symlink(inner, outer));
}

static void slave(const char *name)
{
	slave_of("w1_bus_master1", name);
}

static void gone(const char *name)
{
	char inner[80];

	snprintf(inner, sizeof(inner), "w1_bus_master*/%s", name);
	erase(name);
	erase(inner);
}

static void scratchpad(const char *name, int raw, int high, int low, int config,
                       const char *verdict)
{
	uint8_t pad[9] = {(uint8_t)raw, (uint8_t)(raw >> 8), (uint8_t)high, (uint8_t)low,
	                  (uint8_t)config, 0xff, (uint8_t)(16 - (raw & 15)), 0x10, 0};
	char line[120];
	size_t n = 0;

	if (raw == 0x550)
		pad[6] = 0x0c;
	pad[8] = rom_crc8(pad, 8);
	for (int i = 0; i < 9; i++)
		n += (size_t)snprintf(line + n, sizeof(line) - n, "%02x ", pad[i]);
	snprintf(line + n, sizeof(line) - n, ": crc=%02x %s\nt=0\n", pad[8], verdict);
	text(name, "w1_slave", line);
}

static void thermometer(const char *name, int raw)
{
	slave(name);
	scratchpad(name, raw, 75, 70, 0x7f, "YES");
	text(name, "alarms", "70 75\n");
	text(name, "resolution", "12\n");
	text(name, "ext_power", "1\n");
}

void setUp(void)
{
	host_init_virtual(&host);
	next_id = 0;
	snprintf(root, sizeof(root), "/tmp/owsd-w1-XXXXXX");
	TEST_ASSERT_NOT_NULL(mkdtemp(root));
}

void tearDown(void)
{
	bus_destroy(bus);
	bus = NULL;
	erase("");
}

static void start(void)
{
	char target[100];

	text("w1_bus_master1", "uevent", "");
	snprintf(target, sizeof(target), "w1:root=%s", root);
	bus = host_bus(&host, target);
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host.now + HOST_S));
}

static uint32_t ask(enum bus_op op, const char *what, const void *value, size_t n)
{
	uint32_t id = next_id++;

	snprintf(path[id], sizeof(path[id]), "%s", what);
	req[id] = (struct bus_req){.id = id, .op = (uint8_t)op, .prio = BUS_INPUT, .fresh = true,
	                           .path = path[id], .data = data[id],
	                           .len = op == BUS_WRITE ? (uint32_t)n : 4095,
	                           .deadline_ns = host.now + 20 * HOST_S};
	memset(data[id], 0, sizeof(data[id]));
	if (op == BUS_WRITE)
		memcpy(data[id], value, n);
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req[id]));
	return id;
}

static int result(uint32_t id)
{
	int64_t until = host.now + 21 * HOST_S;

	while (!host_answer(&host, id) && host.now < until)
		host_run(&host, bus, host.now + HOST_MS * 10);
	TEST_ASSERT_EQUAL_UINT(1, host_answers(&host, id));
	return host_answer(&host, id)->err;
}

static void reads(const char *expected, const char *what)
{
	uint32_t id = ask(BUS_READ, what, NULL, 0);

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, result(id), what);
	TEST_ASSERT_EQUAL_STRING_MESSAGE(expected, (char *)data[id], what);
}

static void fails(int err, const char *what)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(err, result(ask(BUS_READ, what, NULL, 0)), what);
}

static int writes(const char *what, const char *value)
{
	return result(ask(BUS_WRITE, what, value, strlen(value)));
}

static void lists(const char *expected, const char *what)
{
	uint32_t id = ask(BUS_DIR, what, NULL, 0);

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, result(id), what);
	TEST_ASSERT_EQUAL_STRING_MESSAGE(expected, (char *)data[id], what);
}

static bool told(enum bus_news news, const char *part)
{
	for (unsigned i = 0; i < host.events; i++)
		if (host.event[i].news == news && strstr(host.event[i].text, part))
			return true;
	return false;
}

/* --- Names and targets --- */

static void test_a_device_has_one_name_in_owfs_and_one_in_the_kernel(void)
{
	static const uint8_t rom[8] = {0x28, 0x55, 0x1d, 0xdf, 0x03, 0x00, 0x00, 0x00};
	uint8_t back[8];
	char name[W1_NAME_MAX];

	w1_name(rom, name);
	TEST_ASSERT_EQUAL_STRING("28-000003df1d55", name);
	TEST_ASSERT_TRUE(w1_name_parse(name, strlen(name), back));
	TEST_ASSERT_EQUAL_MEMORY(rom, back, 7);
	TEST_ASSERT_EQUAL_UINT8(rom_crc8(back, 7), back[7]);
	TEST_ASSERT_FALSE(w1_name_parse("not found.", 10, back));
	TEST_ASSERT_FALSE(w1_name_parse("00-000003df1d55", 15, back));
	TEST_ASSERT_FALSE(w1_name_parse("28-000003DF1d5g", 15, back));
}

static void test_names_go_there_and_back_for_random_ids(void)
{
	unsigned seed = 4711;

	for (int i = 0; i < 1000; i++) {
		uint8_t rom[8], back[8];
		char name[W1_NAME_MAX];

		for (int b = 0; b < 7; b++) {
			seed = seed * 1103515245 + 12345;
			rom[b] = (uint8_t)(seed >> 16);
		}
		rom[0] |= 1;
		rom[7] = rom_crc8(rom, 7);
		w1_name(rom, name);
		TEST_ASSERT_TRUE(w1_name_parse(name, strlen(name), back));
		TEST_ASSERT_EQUAL_MEMORY(rom, back, 8);
	}
}

static void test_a_target_names_nothing_or_a_master(void)
{
	static const char *const wrong[] = {"w1:x", "w1:w1_bus_master", "w1:w1_bus_master0",
	                                    "w1:w1_bus_master1x", "w1:root=", "w1:root=here"};
	struct bus *none = NULL;
	char why[200];

	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
		why[0] = '\0';
		TEST_ASSERT_EQUAL_INT_MESSAGE(
			-EINVAL, bus_create(wrong[i], &host.env, &none, why, sizeof(why)), wrong[i]);
		TEST_ASSERT_NOT_EQUAL_CHAR('\0', why[0]);
	}
	bus = host_bus(&host, "w1:w1_bus_master2");
}

static void test_without_a_master_the_target_is_down_until_one_comes(void)
{
	char target[100];

	snprintf(target, sizeof(target), "w1:root=%s", root);
	bus = host_bus(&host, target);
	host_run(&host, bus, host.now + 10 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host.events);
	TEST_ASSERT_TRUE(told(BUS_DOWN, "modprobe"));
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, result(ask(BUS_READ, WARM_OW "/temperature", NULL, 0)));
	thermometer(WARM, 0x151);
	host_run(&host, bus, host.now + 10 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_UP));
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_FOUND));
	reads("     21.0625", WARM_OW "/temperature");
}

static void test_the_last_master_that_goes_takes_the_target_down(void)
{
	thermometer(WARM, 0x151);
	start();
	host_run(&host, bus, host.now + HOST_S);
	erase("*");
	host_run(&host, bus, host.now + 20 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_DOWN));
}

static void test_a_master_that_comes_later_is_one_more_bus(void)
{
	thermometer(WARM, 0x151);
	start();
	host_run(&host, bus, host.now + HOST_S);
	slave_of("w1_bus_master3", BOARD);
	byte(BOARD, "output", 0xff);
	host_run(&host, bus, host.now + 12 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(2, host_events(&host, BUS_FOUND));
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
	lists("/bus.1" BOARD_OW "\n/bus.1/interface\n/bus.1/simultaneous\n/bus.1/alarm\n", "/bus.1");
}

static void test_slaves_that_come_and_go_are_told(void)
{
	start();
	host_run(&host, bus, host.now + HOST_S);
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_FOUND));
	thermometer(WARM, 0x151);
	host_run(&host, bus, host.now + 12 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_FOUND));
	gone(WARM);
	host_run(&host, bus, host.now + 20 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_LOST));
	fails(-ENODEV, WARM_OW "/temperature");
}

/* A datagram as the kernel sends it, on another kind of socket. */
static void uevent(int fd, const char *subsystem)
{
	char message[200];
	int n = snprintf(message, sizeof(message), "add@/devices/w1_bus_master1/x%cACTION=add%c"
	                 "SUBSYSTEM=%s%cSEQNUM=1", 0, 0, subsystem, 0);

	TEST_ASSERT_EQUAL_INT(n + 1, send(fd, message, (size_t)n + 1, 0));
}

static void test_a_uevent_of_the_kernel_makes_it_look_at_once(void)
{
	int ends[2];

	start();
	host_run(&host, bus, host.now + HOST_S);
	TEST_ASSERT_EQUAL_INT(0, socketpair(AF_UNIX, SOCK_DGRAM, 0, ends));
	((struct w1_master *)((struct native *)bus)->master)->uevents = ends[0];
	thermometer(WARM, 0x151);
	uevent(ends[1], "usb");
	uevent(ends[1], "w1_family");
	host_run(&host, bus, host.now + HOST_S);
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_FOUND));
	uevent(ends[1], "w1");
	host_run(&host, bus, host.now + HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_FOUND));
	gone(WARM);
	uevent(ends[1], "w1");
	host_run(&host, bus, host.now + 2 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_LOST));
	slave_of("w1_bus_master3", BOARD);
	byte(BOARD, "output", 0xff);
	uevent(ends[1], "w1");
	host_run(&host, bus, host.now + HOST_S);
	TEST_ASSERT_EQUAL_UINT(2, host_events(&host, BUS_FOUND));
	close(ends[1]);
}

static void test_a_slave_that_has_just_gone_is_no_device(void)
{
	thermometer(WARM, 0x151);
	start();
	reads("     21.0625", WARM_OW "/temperature");
	gone(WARM);
	fails(-ENODEV, WARM_OW "/temperature");
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_LOST));
}

static void test_identity_needs_no_attribute(void)
{
	slave("28-000003df1d55");
	start();
	reads("000003DF1D55", "/28.551DDF030000/r_id");
	reads("551DDF030000", "/28.551DDF030000/id");
	reads("28", "/28.551DDF030000/family");
}

/* --- Thermometers --- */

static void test_a_thermometer_reads_as_elsewhere(void)
{
	thermometer(WARM, 0x151);
	start();
	reads("     21.0625", WARM_OW "/temperature");
	reads("     21.0625", WARM_OW "/temperature12");
	reads("     21.0625", WARM_OW "/latesttemp");
	reads("          75", WARM_OW "/temphigh");
	reads("          70", WARM_OW "/templow");
	reads("          12", WARM_OW "/tempres");
	reads("1", WARM_OW "/power");
	reads("1", WARM_OW "/present");
	reads("DS18B20", WARM_OW "/type");
	fails(-ENOENT, WARM_OW "/errata/trim");
	fails(-ENOENT, WARM_OW "/volt");
}

static void test_below_zero_too(void)
{
	thermometer(WARM, (uint16_t)-162);
	start();
	reads("     -10.125", WARM_OW "/temperature");
}

static void test_the_value_alone_is_brought_back_to_sixteenths(void)
{
	slave(WARM);
	text(WARM, "temperature", "21062\n");
	slave("10-0000000000c1");
	text("10-0000000000c1", "temperature", "25375\n");
	start();
	reads("     21.0625", WARM_OW "/temperature");
	reads("      25.375", "/10.C10000000000/temperature");
	text(WARM, "temperature", "-10125\n");
	text("10-0000000000c1", "temperature", "-7312\n");
	reads("     -10.125", WARM_OW "/temperature");
	reads("     -7.3125", "/10.C10000000000/temperature");
}

static void test_a_number_that_no_chip_can_have_is_a_failed_reading(void)
{
	slave(WARM);
	text(WARM, "temperature", "99999999999999999999\n");
	start();
	fails(-EIO, WARM_OW "/temperature");
	text(WARM, "temperature", "-2147483648\n");
	fails(-EIO, WARM_OW "/temperature");
	text(WARM, "temperature", "21062\n");
	text(WARM, "alarms", "-10 700\n");
	fails(-EIO, WARM_OW "/temphigh");
	text(WARM, "alarms", "-10\n");
	fails(-EIO, WARM_OW "/templow");
	text(WARM, "alarms", "-10 70\n");
	reads("         -10", WARM_OW "/templow");
}

static void test_an_empty_file_is_a_failed_reading(void)
{
	thermometer(WARM, 0x151);
	start();
	text(WARM, "w1_slave", "");
	fails(-EIO, WARM_OW "/temperature");
	broken(WARM, "w1_slave");
	fails(-EIO, WARM_OW "/temperature");
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_LOST));
}

static void test_a_wrong_checksum_is_told(void)
{
	thermometer(WARM, 0x151);
	start();
	scratchpad(WARM, 0x151, 75, 70, 0x7f, "NO");
	fails(-EBADMSG, WARM_OW "/temperature");
	text(WARM, "w1_slave", "garbage\n");
	fails(-EIO, WARM_OW "/temperature");
}

static int on_link(struct link *link, uint8_t command, uint8_t *answer, size_t n)
{
	uint8_t out[10] = {0x55, 0x28, 0xa1};
	int err;

	out[8] = rom_crc8(out + 1, 7);
	out[9] = command;
	err = link->ops->reset(link);
	if (err >= 0)
		err = link->ops->write(link, out, sizeof(out), LINK_IDLE);
	return err < 0 || !n ? err : link->ops->read(link, answer, n);
}

/* Whoever asks again, and not for a conversion, gets none of the values before it. */
static void test_a_reading_that_failed_is_not_made_up_by_the_one_before(void)
{
	uint8_t pad[9];

	thermometer(WARM, 0x151);
	start();
	struct link *link = &((struct w1_master *)((struct native *)bus)->master)->links[0].link;
	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, on_link(link, 0x44, NULL, 0));
	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, on_link(link, 0xbe, pad, sizeof(pad)));
	TEST_ASSERT_EQUAL_HEX8(0x51, pad[0]);
	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, on_link(link, 0x44, NULL, 0));
	text(WARM, "w1_slave", "");
	TEST_ASSERT_EQUAL_INT(-EIO, on_link(link, 0xbe, pad, sizeof(pad)));
	TEST_ASSERT_EQUAL_INT(-EIO, on_link(link, 0xbe, pad, sizeof(pad)));
	scratchpad(WARM, 0x161, 75, 70, 0x7f, "YES");
	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, on_link(link, 0xbe, pad, sizeof(pad)));
	TEST_ASSERT_EQUAL_HEX8(0x61, pad[0]);
}

static void test_power_faults_are_never_good(void)
{
	thermometer(WARM, 0x550);
	start();
	fails(-ERANGE, WARM_OW "/temperature");
	scratchpad(WARM, 0x7ff, 75, 70, 0x7f, "YES");
	fails(-ERANGE, WARM_OW "/temperature");
	scratchpad(WARM, 0x551, 75, 70, 0x7f, "YES");
	reads("     85.0625", WARM_OW "/temperature");
}

static void test_a_resolution_is_written_when_it_differs(void)
{
	thermometer(WARM, 0x151);
	start();
	reads("     21.0625", WARM_OW "/temperature12");
	TEST_ASSERT_EQUAL_STRING("12\n", now_in(WARM, "resolution"));
	scratchpad(WARM, 0x150, 75, 70, 0x1f, "YES");
	reads("          21", WARM_OW "/temperature9");
	TEST_ASSERT_EQUAL_STRING_LEN("9\n", now_in(WARM, "resolution"), 2);
}

static void test_limits_are_written_and_saved(void)
{
	thermometer(WARM, 0x151);
	text(WARM, "eeprom_cmd", "");
	start();
	TEST_ASSERT_EQUAL_INT(0, writes(WARM_OW "/temphigh", "30"));
	TEST_ASSERT_EQUAL_STRING("70 30\n", now_in(WARM, "alarms"));
	TEST_ASSERT_EQUAL_STRING("save\n", now_in(WARM, "eeprom_cmd"));
	reads("          30", WARM_OW "/temphigh");
	TEST_ASSERT_EQUAL_INT(-EINVAL, writes(WARM_OW "/temphigh", "300"));
}

static void test_all_that_are_due_convert_at_once(void)
{
	uint32_t ids[3];

	thermometer(WARM, 0x151);
	thermometer("28-0000000000a2", 0x10);
	thermometer("28-0000000000a3", 0x20);
	text("w1_bus_master1", "therm_bulk_read", "0\n");
	start();
	ids[0] = ask(BUS_READ, WARM_OW "/temperature", NULL, 0);
	ids[1] = ask(BUS_READ, "/28.A20000000000/temperature", NULL, 0);
	ids[2] = ask(BUS_READ, "/28.A30000000000/temperature", NULL, 0);
	for (int i = 0; i < 3; i++)
		TEST_ASSERT_EQUAL_INT(0, result(ids[i]));
	TEST_ASSERT_EQUAL_STRING("trigger\n", now_in("w1_bus_master1", "therm_bulk_read"));
	TEST_ASSERT_EQUAL_STRING("           2", (char *)data[ids[2]]);
	size_t n;
	const struct bus_counter *counters = bus_counters(bus, &n);
	for (size_t i = 0; i < n; i++)
		if (strcmp(counters[i].name, "conversions") == 0)
			TEST_ASSERT_EQUAL_UINT64(1, bus_counted(&counters[i]));
}

static void test_a_refusal_to_convert_all_at_once_is_remembered(void)
{
	thermometer(WARM, 0x151);
	text("w1_bus_master1", "therm_bulk_read", "0\n");
	broken("w1_bus_master1", "therm_bulk_read");
	start();
	reads("     21.0625", WARM_OW "/temperature");
	erase("w1_bus_master1/therm_bulk_read");
	text("w1_bus_master1", "therm_bulk_read", "0\n");
	reads("     21.0625", WARM_OW "/temperature");
	TEST_ASSERT_EQUAL_STRING("0\n", now_in("w1_bus_master1", "therm_bulk_read"));
	host_run(&host, bus, host.now + 61 * HOST_S);
	reads("     21.0625", WARM_OW "/temperature");
	TEST_ASSERT_EQUAL_STRING("trigger\n", now_in("w1_bus_master1", "therm_bulk_read"));
}

static bool triggered(void)
{
	bool yes = strcmp(now_in("w1_bus_master1", "therm_bulk_read"), "trigger\n") == 0;

	text("w1_bus_master1", "therm_bulk_read", "0\n");
	return yes;
}

/* The driver of 6.1 dies of a slave of another kind that is attached meanwhile. */
static void test_all_convert_at_once_only_where_nothing_else_can_come(void)
{
	thermometer(WARM, 0x151);
	text("w1_bus_master1", "therm_bulk_read", "0\n");
	text("w1_bus_master1", "w1_master_search", "-1\n");
	text("w1_bus_master1", "w1_master_attempts", "1\n");
	start();
	reads("     21.0625", WARM_OW "/temperature");
	TEST_ASSERT_FALSE(triggered());
	text("w1_bus_master1", "w1_master_attempts", "2\n");
	reads("     21.0625", WARM_OW "/temperature");
	TEST_ASSERT_TRUE(triggered());
	slave("12-0000000000e1");
	host_run(&host, bus, host.now + 12 * HOST_S);
	reads("     21.0625", WARM_OW "/temperature");
	TEST_ASSERT_FALSE(triggered());
}

/* The driver feeds those that have no supply of their own. */
static void test_one_that_the_wire_feeds_converts_with_the_others(void)
{
	thermometer(WARM, 0x151);
	thermometer("28-0000000000a2", 0x10);
	thermometer("28-0000000000a3", 0x20);
	text("28-0000000000a3", "ext_power", "0\n");
	text("w1_bus_master1", "therm_bulk_read", "0\n");
	start();
	reads("0", "/28.A30000000000/power");
	reads("1", WARM_OW "/power");
	uint32_t one = ask(BUS_READ, WARM_OW "/temperature", NULL, 0);
	uint32_t two = ask(BUS_READ, "/28.A20000000000/temperature", NULL, 0);
	TEST_ASSERT_EQUAL_INT(0, result(one));
	TEST_ASSERT_EQUAL_INT(0, result(two));
	TEST_ASSERT_EQUAL_STRING("trigger\n", now_in("w1_bus_master1", "therm_bulk_read"));
}

/* --- Switches --- */

static void board(int state, int control)
{
	slave(BOARD);
	byte(BOARD, "state", state);
	byte(BOARD, "output", 0xff);
	byte(BOARD, "activity", 0x05);
	byte(BOARD, "cond_search_mask", 0x0f);
	byte(BOARD, "cond_search_polarity", 0x01);
	byte(BOARD, "status_control", control);
}

static void test_a_ds2408_reads_its_registers(void)
{
	board(0xbd, 0x88);
	start();
	reads("         189", BOARD_OW "/sensed.BYTE");
	reads("1,0,1,1,1,1,0,1", BOARD_OW "/sensed.ALL");
	reads("0", BOARD_OW "/sensed.1");
	reads("           0", BOARD_OW "/PIO.BYTE");
	reads("           5", BOARD_OW "/latch.BYTE");
	reads("1", BOARD_OW "/por");
	reads("1", BOARD_OW "/power");
	reads("0", BOARD_OW "/strobe");
	reads("        2223", BOARD_OW "/set_alarm");
	fails(-ENOENT, BOARD_OW "/temperature");
}

static void test_a_ds2408_is_written_and_read_back(void)
{
	board(0xbd, 0x88);
	start();
	TEST_ASSERT_EQUAL_INT(0, writes(BOARD_OW "/PIO.3", "1"));
	TEST_ASSERT_EQUAL_HEX8(0xf7, (uint8_t)now_in(BOARD, "output")[0]);
	reads("           8", BOARD_OW "/PIO.BYTE");
	TEST_ASSERT_EQUAL_INT(0, writes(BOARD_OW "/por", "0"));
	TEST_ASSERT_EQUAL_HEX8(0x80, (uint8_t)now_in(BOARD, "status_control")[0]);
	TEST_ASSERT_EQUAL_INT(0, writes(BOARD_OW "/latch.BYTE", "0"));
	TEST_ASSERT_EQUAL_HEX8(0xff, (uint8_t)now_in(BOARD, "activity")[0]);
	TEST_ASSERT_EQUAL_INT(0, writes(BOARD_OW "/set_alarm", "100002223"));
	TEST_ASSERT_EQUAL_HEX8(0x81, (uint8_t)now_in(BOARD, "status_control")[0]);
}

static void test_a_ds2408_that_restarted_is_told(void)
{
	board(0xbd, 0x80);
	start();
	reads("0", BOARD_OW "/por");
	byte(BOARD, "status_control", 0x88);
	reads("1", BOARD_OW "/por");
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_POR));
}

static void test_a_ds2408_that_is_silent_has_no_value(void)
{
	board(0xff, 0xff);
	start();
	fails(-EBADMSG, BOARD_OW "/sensed.BYTE");
	broken(BOARD, "state");
	fails(-EIO, BOARD_OW "/sensed.BYTE");
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
}

static void test_a_ds2413_reads_whole_bytes_and_halves(void)
{
	slave("3a-0000000000d1");
	byte("3a-0000000000d1", "state", 0x4b);
	byte("3a-0000000000d1", "output", 0);
	start();
	reads("1,0", "/3A.D10000000000/sensed.ALL");
	reads("0,0", "/3A.D10000000000/PIO.ALL");
	byte("3a-0000000000d1", "state", 0x0b);
	reads("1,0", "/3A.D10000000000/sensed.ALL");
	/* The pins do not follow: the write is found out. */
	TEST_ASSERT_EQUAL_INT(-EIO, writes("/3A.D10000000000/PIO.A", "1"));
	TEST_ASSERT_EQUAL_HEX8(0xfe, (uint8_t)now_in("3a-0000000000d1", "output")[0]);
}

static void test_a_ds2406_has_its_switches(void)
{
	slave("12-0000000000e1");
	text("12-0000000000e1", "state", "1");
	text("12-0000000000e1", "output", "3");
	start();
	reads("0,1", "/12.E10000000000/PIO.ALL");
	reads("1,0", "/12.E10000000000/flipflop.ALL");
	fails(-ENOENT, "/12.E10000000000/sensed.A");
	TEST_ASSERT_EQUAL_INT(0, writes("/12.E10000000000/PIO.ALL", "0,1"));
	TEST_ASSERT_EQUAL_STRING("1", now_in("12-0000000000e1", "output"));
	text("12-0000000000e1", "state", "x");
	fails(-EIO, "/12.E10000000000/PIO.A");
}

static void test_a_ds2405_has_its_switch_and_pin(void)
{
	slave("05-0000000000f1");
	text("05-0000000000f1", "state", "1");
	text("05-0000000000f1", "output", "1");
	start();
	reads("0", "/05.F10000000000/PIO");
	reads("1", "/05.F10000000000/sensed");
	lists("", "/alarm");
	TEST_ASSERT_EQUAL_INT(0, writes("/05.F10000000000/PIO", "1"));
	reads("1", "/05.F10000000000/PIO");
	lists("/alarm/05.F10000000000\n", "/alarm");
}

/* --- Others --- */

static void test_a_ds2438_measures(void)
{
	static const char name[] = "26-000000000011";
	uint8_t page[8] = {0x09, 0x80, 0x16, 0xf4, 0x01, 0x29, 0x00, 0x00};

	slave(name);
	put(name, "page0", page, 8);
	text(name, "temperature", "5760\n");
	text(name, "vdd", "500\n");
	text(name, "vad", "230\n");
	text(name, "iad", "41\n");
	start();
	reads("        22.5", "/26.110000000000/temperature");
	reads("           5", "/26.110000000000/VDD");
	reads("   0.0100081", "/26.110000000000/vis");
	reads("1", "/26.110000000000/IAD");
	fails(-ENOENT, "/26.110000000000/date");
	fails(-ENOENT, "/26.110000000000/pages/page.3");
	/* Page 0 stays as it is here: the input's voltage is not what was asked for. */
	fails(-EIO, "/26.110000000000/VAD");
	page[0] = 0x01;
	page[3] = 230;
	page[4] = 0;
	put(name, "page0", page, 8);
	reads("         2.3", "/26.110000000000/VAD");
	TEST_ASSERT_EQUAL_INT(0, writes("/26.110000000000/IAD", "0"));
	TEST_ASSERT_EQUAL_HEX8(0, (uint8_t)now_in(name, "iad")[0]);
	broken(name, "page0");
	fails(-EIO, "/26.110000000000/temperature");
}

static void test_a_ds2423_counts(void)
{
	static const char name[] = "1d-000000000021";

	slave(name);
	text(name, "w1_slave", "00 01 crc=YES c=12\n00 01 crc=YES c=13\n00 01 crc=YES c=1400\n"
	                       "00 01 crc=YES c=-2\n");
	start();
	reads("        1400,  4294967294", "/1D.210000000000/counter.ALL");
	reads("        1400", "/1D.210000000000/mincount");
	reads("          12", "/1D.210000000000/pages/count.12");
	fails(-ENOENT, "/1D.210000000000/pages/count.3");
	fails(-ENOENT, "/1D.210000000000/memory");
	text(name, "w1_slave", "00 crc=YES c=12\n00 crc=YES c=13\n00 crc=NO\n00 crc=YES c=2\n");
	fails(-EBADMSG, "/1D.210000000000/counter.A");
	text(name, "w1_slave", "Connection error");
	fails(-EIO, "/1D.210000000000/counter.A");
	text(name, "w1_slave", "crc=YES c=12\ncrc=YES c=13\ncrc=YES c=\n");
	fails(-EIO, "/1D.210000000000/counter.A");
	fails(-EIO, "/1D.210000000000/counter.B");
}

static void test_eeproms_are_read_and_written(void)
{
	static const struct {
		const char *name, *memory, *page;
		unsigned size;
	} chips[] = {{"14-000000000031", "/14.310000000000/memory", NULL, 32},
	             {"23-000000000032", "/23.320000000000/memory",
	              "/23.320000000000/pages/page.2", 512},
	             {"2d-000000000033", "/2D.330000000000/memory",
	              "/2D.330000000000/pages/page.2", 128}};
	char bytes[512];

	memset(bytes, 'a', sizeof(bytes));
	for (int i = 0; i < 3; i++) {
		slave(chips[i].name);
		put(chips[i].name, "eeprom", bytes, chips[i].size);
	}
	start();
	for (int i = 0; i < 3; i++) {
		uint32_t id = ask(BUS_READ, chips[i].memory, NULL, 0);

		TEST_ASSERT_EQUAL_INT(0, result(id));
		TEST_ASSERT_EQUAL_UINT32(chips[i].size, host_answer(&host, id)->len);
		TEST_ASSERT_EQUAL_INT(0, writes(chips[i].memory, "xyz"));
		TEST_ASSERT_EQUAL_STRING_LEN("xyzaa", now_in(chips[i].name, "eeprom"), 5);
		if (!chips[i].page)
			continue;
		TEST_ASSERT_EQUAL_INT(0, writes(chips[i].page, "page"));
		TEST_ASSERT_EQUAL_STRING_LEN("apagea", now_in(chips[i].name, "eeprom") + 63, 6);
	}
	put(chips[2].name, "eeprom", bytes, 100);
	fails(-EIO, chips[2].memory);
}

/* What is written to the file is as long as what is changed, so that no other row wears out. */
static void test_an_eeprom_is_written_row_by_row(void)
{
	static const char name[] = "2d-000000000033";
	char bytes[128], full[200];

	memset(bytes, 'a', sizeof(bytes));
	slave(name);
	put(name, "eeprom", bytes, sizeof(bytes));
	start();
	TEST_ASSERT_EQUAL_INT(0, writes("/2D.330000000000/pages/page.1", "aaaaaaaaaaxa"));
	TEST_ASSERT_EQUAL_STRING_LEN("aaxaa", now_in(name, "eeprom") + 40, 5);
	/* Rows as they are need no right to write. */
	snprintf(full, sizeof(full), "%s/%s/eeprom", root, name);
	TEST_ASSERT_EQUAL_INT(0, chmod(full, 0444));
	chmod(root, 0755);
	uid_t user = geteuid();
	if (user == 0)
		TEST_ASSERT_EQUAL_INT(0, seteuid(65534));
	int same = writes("/2D.330000000000/pages/page.1", "aaaaaaaaaaxa");
	int other = writes("/2D.330000000000/pages/page.1", "aaaaaaaaaaxb");
	if (user == 0)
		TEST_ASSERT_EQUAL_INT(0, seteuid(0));
	TEST_ASSERT_EQUAL_INT(0, same);
	TEST_ASSERT_EQUAL_INT(-EACCES, other);
	/* The last page of a file that is too short. */
	TEST_ASSERT_EQUAL_INT(0, chmod(full, 0644));
	put(name, "eeprom", bytes, 120);
	reads("aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa", "/2D.330000000000/pages/page.0");
	fails(-EIO, "/2D.330000000000/pages/page.3");
}

static void test_raw_access_serves_the_rest(void)
{
	static const char name[] = "23-000000000041";
	char bytes[40];

	memset(bytes, 'a', sizeof(bytes));
	slave(name);
	put(name, "rw", bytes, sizeof(bytes));
	slave("01-000000000042");
	start();
	/* A file gives back the command, Read Memory from 40h on, and what was behind it. */
	uint32_t id = ask(BUS_READ, "/23.410000000000/pages/page.2", NULL, 0);
	TEST_ASSERT_EQUAL_INT(0, result(id));
	TEST_ASSERT_EQUAL_MEMORY("\xf0\x40\x00" "aaaa", data[id], 7);
	text(name, "rw", "");
	fails(-EIO, "/23.410000000000/memory");
	reads("DS2401", "/01.420000000000/type");
	reads("1", "/01.420000000000/present");
}

static void test_a_slave_without_driver_is_told_once(void)
{
	slave(WARM);
	start();
	fails(-ENOENT, WARM_OW "/temphigh");
	fails(-ENOENT, WARM_OW "/templow");
	TEST_ASSERT_TRUE(told(BUS_NOTE, WARM));
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_NOTE));
}

static void test_a_thermometer_whose_driver_was_unloaded_is_told(void)
{
	slave(WARM);
	text(WARM, "rw", "");
	start();
	fails(-ENOENT, WARM_OW "/temperature");
	TEST_ASSERT_TRUE(told(BUS_NOTE, WARM ": no driver of the kernel has it"));
}

static void test_a_directory_has_what_there_are_attributes_for(void)
{
	slave("12-0000000000e1");
	text("12-0000000000e1", "state", "1");
	text("12-0000000000e1", "output", "3");
	start();
	lists("/12.E10000000000/PIO.BYTE\n/12.E10000000000/PIO.ALL\n/12.E10000000000/PIO.A\n"
	      "/12.E10000000000/PIO.B\n/12.E10000000000/address\n/12.E10000000000/alias\n"
	      "/12.E10000000000/crc8\n/12.E10000000000/family\n/12.E10000000000/flipflop.BYTE\n"
	      "/12.E10000000000/flipflop.ALL\n/12.E10000000000/flipflop.A\n"
	      "/12.E10000000000/flipflop.B\n/12.E10000000000/id\n/12.E10000000000/locator\n"
	      "/12.E10000000000/r_address\n/12.E10000000000/r_id\n/12.E10000000000/r_locator\n"
	      "/12.E10000000000/type\n",
	      "/12.E10000000000");
}

/* --- Alarms --- */

static void test_a_thermometer_beyond_its_limits_is_in_alarm(void)
{
	thermometer(WARM, 0x151);
	thermometer("28-0000000000a2", 0x151);
	scratchpad(WARM, 0x151, 22, 20, 0x7f, "YES");
	scratchpad("28-0000000000a2", 0x151, 21, 20, 0x7f, "YES");
	start();
	lists("/alarm/28.A20000000000\n", "/alarm/28");
	scratchpad(WARM, -8 & 0xffff, 22, -1, 0x7f, "YES");
	reads("        -0.5", WARM_OW "/temperature");
	lists("/alarm" WARM_OW "\n/alarm/28.A20000000000\n", "/alarm/28");
}

static void test_thermometers_asked_for_their_alarm_convert_at_once(void)
{
	thermometer(WARM, 0x151);
	text("w1_bus_master1", "therm_bulk_read", "0\n");
	start();
	lists("/alarm" WARM_OW "\n", "/alarm/28");
	/* One alone is read. */
	TEST_ASSERT_EQUAL_STRING("0\n", now_in("w1_bus_master1", "therm_bulk_read"));
	thermometer("28-0000000000a2", 0x151);
	host_run(&host, bus, host.now + 11 * HOST_S);
	lists("/alarm" WARM_OW "\n/alarm/28.A20000000000\n", "/alarm/28");
	TEST_ASSERT_EQUAL_STRING("trigger\n", now_in("w1_bus_master1", "therm_bulk_read"));
	text("w1_bus_master1", "therm_bulk_read", "0\n");
	lists("/alarm" WARM_OW "\n/alarm/28.A20000000000\n", "/alarm/28");
	TEST_ASSERT_EQUAL_STRING("0\n", now_in("w1_bus_master1", "therm_bulk_read"));
}

static void test_a_ds2408_is_in_alarm_by_its_condition(void)
{
	static const struct {
		int state, activity, mask, polarity, control;
		bool alarm;
	} cases[] = {
		{0xff, 0x00, 0x0f, 0x00, 0x88, true},  /* power-on */
		{0xff, 0x00, 0x00, 0x00, 0x80, false}, /* nothing is selected */
		{0xff, 0x00, 0x0f, 0x00, 0x80, false},
		{0xfb, 0x00, 0x0f, 0x00, 0x80, true},  /* one pin low */
		{0xfb, 0x00, 0x0f, 0x00, 0x82, false}, /* but all are asked for */
		{0xf0, 0x00, 0x0f, 0x00, 0x82, true},
		{0xff, 0x10, 0x30, 0x30, 0x81, true}, /* a latch */
		{0x00, 0x00, 0x30, 0x30, 0x81, false},
	};

	board(0xff, 0x88);
	start();
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		byte(BOARD, "state", cases[i].state);
		byte(BOARD, "activity", cases[i].activity);
		byte(BOARD, "cond_search_mask", cases[i].mask);
		byte(BOARD, "cond_search_polarity", cases[i].polarity);
		byte(BOARD, "status_control", cases[i].control);
		host_run(&host, bus, host.now + 11 * HOST_S);
		lists(cases[i].alarm ? "/alarm" BOARD_OW "\n" : "", "/alarm/29");
	}
}

static void test_where_nothing_tells_the_alarm_it_is_not_supported(void)
{
	slave("12-0000000000e1");
	text("12-0000000000e1", "state", "1");
	text("12-0000000000e1", "output", "3");
	board(0xff, 0x88);
	start();
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, result(ask(BUS_DIR, "/alarm/29,12", NULL, 0)));
	lists("/alarm" BOARD_OW "\n", "/alarm/29");
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
}

/* --- Rights --- */

static void test_a_slave_that_is_just_being_removed_does_not_end_the_alarm_search(void)
{
	slave(BOARD);
	start();
	lists("", "/alarm/29");
	text(BOARD, "rw", "");
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, result(ask(BUS_DIR, "/alarm/29", NULL, 0)));
}

static void test_who_may_not_write_is_told_how(void)
{
	uid_t user = geteuid();

	board(0xbd, 0x80);
	thermometer(WARM, 0x151);
	chmod(root, 0755);
	char full[200];
	snprintf(full, sizeof(full), "%s/" BOARD "/output", root);
	/* Neither the owner nor others; the group is root's own. */
	mode_t mode = user == 0 ? 0644 : 0464;
	chmod(full, mode);
	snprintf(full, sizeof(full), "%s/" WARM "/alarms", root);
	chmod(full, mode);
	start();
	reads("         189", BOARD_OW "/sensed.BYTE");
	if (user == 0)
		TEST_ASSERT_EQUAL_INT(0, seteuid(65534));
	int pio = writes(BOARD_OW "/PIO.0", "1"), high = writes(WARM_OW "/temphigh", "30");
	if (user == 0)
		TEST_ASSERT_EQUAL_INT(0, seteuid(0));
	TEST_ASSERT_EQUAL_INT(-EACCES, pio);
	TEST_ASSERT_EQUAL_INT(-EACCES, high);
	TEST_ASSERT_TRUE(told(BUS_NOTE, "udev"));
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_NOTE));
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_DOWN));
}

static void test_what_nobody_may_write_is_no_matter_of_rights(void)
{
	uid_t user = geteuid();
	char full[200];

	board(0xbd, 0x80);
	chmod(root, 0755);
	snprintf(full, sizeof(full), "%s/" BOARD "/cond_search_mask", root);
	chmod(full, 0444);
	start();
	reads("        2223", BOARD_OW "/set_alarm");
	if (user == 0)
		TEST_ASSERT_EQUAL_INT(0, seteuid(65534));
	int err = writes(BOARD_OW "/set_alarm", "222");
	if (user == 0)
		TEST_ASSERT_EQUAL_INT(0, seteuid(0));
	TEST_ASSERT_EQUAL_INT(-EACCES, err);
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_NOTE));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_device_has_one_name_in_owfs_and_one_in_the_kernel);
	RUN_TEST(test_names_go_there_and_back_for_random_ids);
	RUN_TEST(test_a_target_names_nothing_or_a_master);
	RUN_TEST(test_without_a_master_the_target_is_down_until_one_comes);
	RUN_TEST(test_the_last_master_that_goes_takes_the_target_down);
	RUN_TEST(test_a_master_that_comes_later_is_one_more_bus);
	RUN_TEST(test_slaves_that_come_and_go_are_told);
	RUN_TEST(test_a_uevent_of_the_kernel_makes_it_look_at_once);
	RUN_TEST(test_a_slave_that_has_just_gone_is_no_device);
	RUN_TEST(test_identity_needs_no_attribute);
	RUN_TEST(test_a_thermometer_reads_as_elsewhere);
	RUN_TEST(test_below_zero_too);
	RUN_TEST(test_the_value_alone_is_brought_back_to_sixteenths);
	RUN_TEST(test_a_number_that_no_chip_can_have_is_a_failed_reading);
	RUN_TEST(test_an_empty_file_is_a_failed_reading);
	RUN_TEST(test_a_wrong_checksum_is_told);
	RUN_TEST(test_a_reading_that_failed_is_not_made_up_by_the_one_before);
	RUN_TEST(test_power_faults_are_never_good);
	RUN_TEST(test_a_resolution_is_written_when_it_differs);
	RUN_TEST(test_limits_are_written_and_saved);
	RUN_TEST(test_all_that_are_due_convert_at_once);
	RUN_TEST(test_a_refusal_to_convert_all_at_once_is_remembered);
	RUN_TEST(test_all_convert_at_once_only_where_nothing_else_can_come);
	RUN_TEST(test_one_that_the_wire_feeds_converts_with_the_others);
	RUN_TEST(test_a_ds2408_reads_its_registers);
	RUN_TEST(test_a_ds2408_is_written_and_read_back);
	RUN_TEST(test_a_ds2408_that_restarted_is_told);
	RUN_TEST(test_a_ds2408_that_is_silent_has_no_value);
	RUN_TEST(test_a_ds2413_reads_whole_bytes_and_halves);
	RUN_TEST(test_a_ds2406_has_its_switches);
	RUN_TEST(test_a_ds2405_has_its_switch_and_pin);
	RUN_TEST(test_a_ds2438_measures);
	RUN_TEST(test_a_ds2423_counts);
	RUN_TEST(test_eeproms_are_read_and_written);
	RUN_TEST(test_an_eeprom_is_written_row_by_row);
	RUN_TEST(test_raw_access_serves_the_rest);
	RUN_TEST(test_a_slave_without_driver_is_told_once);
	RUN_TEST(test_a_thermometer_whose_driver_was_unloaded_is_told);
	RUN_TEST(test_a_directory_has_what_there_are_attributes_for);
	RUN_TEST(test_a_thermometer_beyond_its_limits_is_in_alarm);
	RUN_TEST(test_thermometers_asked_for_their_alarm_convert_at_once);
	RUN_TEST(test_a_ds2408_is_in_alarm_by_its_condition);
	RUN_TEST(test_where_nothing_tells_the_alarm_it_is_not_supported);
	RUN_TEST(test_a_slave_that_is_just_being_removed_does_not_end_the_alarm_search);
	RUN_TEST(test_who_may_not_write_is_told_how);
	RUN_TEST(test_what_nobody_may_write_is_no_matter_of_rights);
	return UNITY_END();
}
