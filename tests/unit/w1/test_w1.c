/* SPDX-License-Identifier: MIT */
/* The w1 bus: masters and slaves that come and go, other chips, rights. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/bus/backends.h"
#include "hal/native/state.h"
#include "unity.h"

#include "hal/native/native.h"
#include "hal/owfs/path.h"
#include "hal/w1/master.h"
#include "hal/w1/name.h"
#include "hal/w1/state.h"
#include "tests/unit/aid/fs_scene.h"

void setUp(void)
{
	fs_begin();
}

void tearDown(void)
{
	fs_end();
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
	static const char *const wrong[] = {
		"w1:x",     "w1:w1_bus_master", "w1:w1_bus_master0", "w1:w1_bus_master1x",
		"w1:root=", "w1:root=here"};
	struct bus *none = NULL;
	char why[200];

	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
		why[0] = '\0';
		TEST_ASSERT_EQUAL_INT_MESSAGE(
			-EINVAL, bus_create(wrong[i], &fs.host.env, &none, why, sizeof(why)),
			wrong[i]);
		TEST_ASSERT_NOT_EQUAL_CHAR('\0', why[0]);
	}
	fs.bus = host_bus(&fs.host, "w1:w1_bus_master2");
}

static void test_without_a_master_the_target_is_down_until_one_comes(void)
{
	char target[100];

	snprintf(target, sizeof(target), "w1:root=%s", fs.root);
	fs.bus = host_bus(&fs.host, target);
	host_run(&fs.host, fs.bus, fs.host.now + 10 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, fs.host.events);
	TEST_ASSERT_TRUE(fs_told(BUS_DOWN, "modprobe"));
	fs_fails(-ENOTCONN, WARM_OW "/temperature");
	fs_thermometer(WARM, 0x151);
	host_run(&fs.host, fs.bus, fs.host.now + 10 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&fs.host, BUS_UP));
	TEST_ASSERT_EQUAL_UINT(1, host_events(&fs.host, BUS_FOUND));
	fs_reads("     21.0625", WARM_OW "/temperature");
}

static void test_the_last_master_that_goes_takes_the_target_down(void)
{
	fs_thermometer(WARM, 0x151);
	fs_start();
	host_run(&fs.host, fs.bus, fs.host.now + HOST_S);
	fs_erase("*");
	host_run(&fs.host, fs.bus, fs.host.now + 20 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&fs.host, BUS_DOWN));
}

static void test_a_master_that_comes_later_is_one_more_bus(void)
{
	fs_thermometer(WARM, 0x151);
	fs_start();
	host_run(&fs.host, fs.bus, fs.host.now + HOST_S);
	fs_slave_of("w1_bus_master3", BOARD);
	fs_byte(BOARD, "output", 0xff);
	host_run(&fs.host, fs.bus, fs.host.now + 12 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(2, host_events(&fs.host, BUS_FOUND));
	TEST_ASSERT_EQUAL_UINT(0, host_events(&fs.host, BUS_DOWN));
	fs_lists("/bus.1" BOARD_OW "\n/bus.1/interface\n/bus.1/simultaneous\n/bus.1/alarm\n",
	         "/bus.1");
	TEST_ASSERT_EQUAL_UINT(1, ((struct native *)fs.bus)->channel[1].wire);
}

static void test_slaves_that_come_and_go_are_told(void)
{
	fs_start();
	host_run(&fs.host, fs.bus, fs.host.now + HOST_S);
	TEST_ASSERT_EQUAL_UINT(0, host_events(&fs.host, BUS_FOUND));
	fs_thermometer(WARM, 0x151);
	host_run(&fs.host, fs.bus, fs.host.now + 12 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&fs.host, BUS_FOUND));
	fs_gone(WARM);
	host_run(&fs.host, fs.bus, fs.host.now + 20 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&fs.host, BUS_LOST));
	fs_fails(-ENODEV, WARM_OW "/temperature");
}

/* A datagram as the kernel sends it, on another kind of socket. */
static void uevent(int fd, const char *subsystem)
{
	char message[200];
	int n = snprintf(message, sizeof(message),
	                 "add@/devices/w1_bus_master1/x%cACTION=add%c"
	                 "SUBSYSTEM=%s%cSEQNUM=1",
	                 0, 0, subsystem, 0);

	TEST_ASSERT_EQUAL_INT(n + 1, send(fd, message, (size_t)n + 1, 0));
}

static void test_a_uevent_of_the_kernel_makes_it_look_at_once(void)
{
	int ends[2];

	fs_start();
	host_run(&fs.host, fs.bus, fs.host.now + HOST_S);
	TEST_ASSERT_EQUAL_INT(0, socketpair(AF_UNIX, SOCK_DGRAM, 0, ends));
	((struct w1_master *)((struct native *)fs.bus)->master)->uevents = ends[0];
	fs_thermometer(WARM, 0x151);
	uevent(ends[1], "usb");
	uevent(ends[1], "w1_family");
	host_run(&fs.host, fs.bus, fs.host.now + HOST_S);
	TEST_ASSERT_EQUAL_UINT(0, host_events(&fs.host, BUS_FOUND));
	uevent(ends[1], "w1");
	host_run(&fs.host, fs.bus, fs.host.now + HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&fs.host, BUS_FOUND));
	fs_gone(WARM);
	uevent(ends[1], "w1");
	host_run(&fs.host, fs.bus, fs.host.now + 2 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&fs.host, BUS_LOST));
	fs_slave_of("w1_bus_master3", BOARD);
	fs_byte(BOARD, "output", 0xff);
	uevent(ends[1], "w1");
	host_run(&fs.host, fs.bus, fs.host.now + HOST_S);
	TEST_ASSERT_EQUAL_UINT(2, host_events(&fs.host, BUS_FOUND));
	close(ends[1]);
}

/* In the kernel's own folder there is none of that number. */
static void test_without_a_master_nobody_listens_to_uevents(void)
{
	struct link_master *master;
	char why[160];

	TEST_ASSERT_EQUAL_INT(
		0, w1_master.create("w1_bus_master9998", &fs.host.env, &master, why, sizeof(why)));
	TEST_ASSERT_EQUAL_INT(-ENODEV, w1_master.open(master, why, sizeof(why)));
	TEST_ASSERT_EQUAL_INT(-1, ((struct w1_master *)master)->uevents);
	w1_master.destroy(master);
}

static void test_a_slave_that_has_just_gone_is_no_device(void)
{
	fs_thermometer(WARM, 0x151);
	fs_start();
	fs_reads("     21.0625", WARM_OW "/temperature");
	fs_gone(WARM);
	fs_fails(-ENODEV, WARM_OW "/temperature");
	TEST_ASSERT_EQUAL_UINT(1, host_events(&fs.host, BUS_LOST));
}

static void test_identity_needs_no_attribute(void)
{
	fs_slave("28-000003df1d55");
	fs_start();
	fs_reads("000003DF1D55", "/28.551DDF030000/r_id");
	fs_reads("551DDF030000", "/28.551DDF030000/id");
	fs_reads("28", "/28.551DDF030000/family");
}

/* --- Others --- */

static void test_a_ds2438_measures(void)
{
	static const char name[] = "26-000000000011";
	uint8_t page[8] = {0x09, 0x80, 0x16, 0xf4, 0x01, 0x29, 0x00, 0x00};

	fs_slave(name);
	fs_put(name, "page0", page, 8);
	fs_text(name, "temperature", "5760\n");
	fs_text(name, "vdd", "500\n");
	fs_text(name, "vad", "230\n");
	fs_text(name, "iad", "41\n");
	fs_start();
	fs_reads("        22.5", "/26.110000000000/temperature");
	fs_reads("           5", "/26.110000000000/VDD");
	fs_reads("   0.0100081", "/26.110000000000/vis");
	fs_reads("1", "/26.110000000000/IAD");
	fs_fails(-ENOENT, "/26.110000000000/date");
	fs_fails(-ENOENT, "/26.110000000000/pages/page.3");
	/* Page 0 stays as it is here: the input's voltage is not what was asked for. */
	fs_fails(-EIO, "/26.110000000000/VAD");
	page[0] = 0x01;
	page[3] = 230;
	page[4] = 0;
	fs_put(name, "page0", page, 8);
	fs_reads("         2.3", "/26.110000000000/VAD");
	TEST_ASSERT_EQUAL_INT(0, fs_writes("/26.110000000000/IAD", "0"));
	TEST_ASSERT_EQUAL_HEX8(0, (uint8_t)fs_now_in(name, "iad")[0]);
	fs_broken(name, "page0");
	fs_fails(-EIO, "/26.110000000000/temperature");
}

/* What the driver gives where a TMP1826's checksum happens to fit; it reads each page so. */
static void test_the_values_of_a_ds2438s_driver_that_has_a_tmp1826_are_refused(void)
{
	static const char name[] = "26-000000000012";
	static const uint8_t page[] = {0x01, 0x38, 0xff, 0x70, 0x80, 0x00, 0xff, 0x5a};
	static const uint8_t again[] = {0x01, 0x30, 0xff, 0x70, 0x80, 0x00, 0xff, 0x91};
	static const uint8_t clock[] = {0x01, 0x30, 0x02, 0x00, 0x80, 0x00, 0x00, 0x00};

	fs_slave(name);
	fs_put(name, "page0", page, 8);
	fs_text(name, "temperature", "5760\n");
	fs_start();
	fs_fails(-EIO, "/26.120000000000/temperature");
	fs_fails(-EIO, "/26.120000000000/latesttemp");
	fs_put(name, "page1", again, 8);
	fs_fails(-EIO, "/26.120000000000/temperature");
	fs_fails(-EIO, "/26.120000000000/pages/page.0");
	/* Of a DS2438 the same page 0 is a temperature below zero, and page 1 is another. */
	fs_put(name, "page1", clock, 8);
	fs_reads("    -0.78125", "/26.120000000000/latesttemp");
}

static void test_a_ds2423_counts(void)
{
	static const char name[] = "1d-000000000021";

	fs_slave(name);
	fs_text(name, "w1_slave",
	        "00 01 crc=YES c=12\n00 01 crc=YES c=13\n00 01 crc=YES c=1400\n"
	        "00 01 crc=YES c=-2\n");
	fs_start();
	fs_reads("        1400,  4294967294", "/1D.210000000000/counter.ALL");
	fs_reads("        1400", "/1D.210000000000/mincount");
	fs_reads("          12", "/1D.210000000000/pages/count.12");
	fs_fails(-ENOENT, "/1D.210000000000/pages/count.3");
	fs_fails(-ENOENT, "/1D.210000000000/memory");
	fs_text(name, "w1_slave", "00 crc=YES c=12\n00 crc=YES c=13\n00 crc=NO\n00 crc=YES c=2\n");
	fs_fails(-EBADMSG, "/1D.210000000000/counter.A");
	fs_text(name, "w1_slave", "Connection error");
	fs_fails(-EIO, "/1D.210000000000/counter.A");
	fs_text(name, "w1_slave", "crc=YES c=12\ncrc=YES c=13\ncrc=YES c=\n");
	fs_fails(-EIO, "/1D.210000000000/counter.A");
	fs_fails(-EIO, "/1D.210000000000/counter.B");
}

static void test_eeproms_are_read_and_written(void)
{
	static const struct {
		const char *name, *memory, *page;
		unsigned size;
	} chips[] = {{"14-000000000031", "/14.310000000000/memory", NULL, 32},
	             {"23-000000000032", "/23.320000000000/memory", "/23.320000000000/pages/page.2",
	              512},
	             {"2d-000000000033", "/2D.330000000000/memory", "/2D.330000000000/pages/page.2",
	              128}};
	char bytes[512];

	memset(bytes, 'a', sizeof(bytes));
	for (int i = 0; i < 3; i++) {
		fs_slave(chips[i].name);
		fs_put(chips[i].name, "eeprom", bytes, chips[i].size);
	}
	fs_start();
	for (int i = 0; i < 3; i++) {
		uint32_t id = fs_ask(BUS_READ, chips[i].memory, NULL, 0);

		TEST_ASSERT_EQUAL_INT(0, fs_result(id));
		TEST_ASSERT_EQUAL_UINT32(chips[i].size, host_answer(&fs.host, id)->len);
		TEST_ASSERT_EQUAL_INT(0, fs_writes(chips[i].memory, "xyz"));
		TEST_ASSERT_EQUAL_STRING_LEN("xyzaa", fs_now_in(chips[i].name, "eeprom"), 5);
		if (!chips[i].page)
			continue;
		TEST_ASSERT_EQUAL_INT(0, fs_writes(chips[i].page, "page"));
		TEST_ASSERT_EQUAL_STRING_LEN("apagea", fs_now_in(chips[i].name, "eeprom") + 63, 6);
		TEST_ASSERT_EQUAL_INT(0, fs_writes_at(6, chips[i].page, "part"));
		TEST_ASSERT_EQUAL_STRING_LEN("apageaaparta",
		                             fs_now_in(chips[i].name, "eeprom") + 63, 12);
		TEST_ASSERT_EQUAL_INT(0, fs_writes_at(30, chips[i].page, "more than fits"));
		TEST_ASSERT_EQUAL_STRING_LEN("amoa", fs_now_in(chips[i].name, "eeprom") + 93, 4);
		TEST_ASSERT_EQUAL_INT(0, fs_writes_at(29, chips[i].memory, "two rows"));
		TEST_ASSERT_EQUAL_STRING_LEN("atwo rowsa", fs_now_in(chips[i].name, "eeprom") + 28,
		                             10);
	}
	fs_put(chips[2].name, "eeprom", bytes, 100);
	fs_fails(-EIO, chips[2].memory);
}

static void test_a_ds28e04_has_its_pages(void)
{
	char bytes[512];

	memset(bytes, 'a', sizeof(bytes));
	fs_slave("1c-000000000034");
	fs_put("1c-000000000034", "eeprom", bytes, sizeof(bytes));
	fs_start();
	TEST_ASSERT_EQUAL_INT(0, fs_writes("/1C.340000000000/pages/page.15", "last"));
	TEST_ASSERT_EQUAL_STRING_LEN("alasta", fs_now_in("1c-000000000034", "eeprom") + 479, 6);
	fs_fails(-ENOENT, "/1C.340000000000/memory");
	fs_fails(-ENOENT, "/1C.340000000000/PIO.BYTE");
}

/* What is written to the file is as long as what is changed, so that no other row wears out. */
static void test_an_eeprom_is_written_row_by_row(void)
{
	static const char name[] = "2d-000000000033";
	char bytes[128], full[200];

	memset(bytes, 'a', sizeof(bytes));
	fs_slave(name);
	fs_put(name, "eeprom", bytes, sizeof(bytes));
	fs_start();
	TEST_ASSERT_EQUAL_INT(0, fs_writes("/2D.330000000000/pages/page.1", "aaaaaaaaaaxa"));
	TEST_ASSERT_EQUAL_STRING_LEN("aaxaa", fs_now_in(name, "eeprom") + 40, 5);
	/* Rows as they are need no right to write. */
	snprintf(full, sizeof(full), "%s/%s/eeprom", fs.root, name);
	TEST_ASSERT_EQUAL_INT(0, chmod(full, 0444));
	chmod(fs.root, 0755);
	uid_t user = geteuid();
	if (user == 0)
		TEST_ASSERT_EQUAL_INT(0, seteuid(65534));
	int same = fs_writes("/2D.330000000000/pages/page.1", "aaaaaaaaaaxa");
	int other = fs_writes("/2D.330000000000/pages/page.1", "aaaaaaaaaaxb");
	if (user == 0)
		TEST_ASSERT_EQUAL_INT(0, seteuid(0));
	TEST_ASSERT_EQUAL_INT(0, same);
	TEST_ASSERT_EQUAL_INT(-EACCES, other);
	/* The last page of a file that is too short. */
	TEST_ASSERT_EQUAL_INT(0, chmod(full, 0644));
	fs_put(name, "eeprom", bytes, 120);
	fs_reads("aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa", "/2D.330000000000/pages/page.0");
	fs_fails(-EIO, "/2D.330000000000/pages/page.3");
}

static void test_raw_access_serves_the_rest(void)
{
	static const char name[] = "23-000000000041";
	char bytes[40];

	memset(bytes, 'a', sizeof(bytes));
	fs_slave(name);
	fs_put(name, "rw", bytes, sizeof(bytes));
	fs_slave("01-000000000042");
	fs_start();
	/* A file gives back the command, Read Memory from 40h on, and what was behind it. */
	uint32_t id = fs_ask(BUS_READ, "/23.410000000000/pages/page.2", NULL, 0);
	TEST_ASSERT_EQUAL_INT(0, fs_result(id));
	TEST_ASSERT_EQUAL_MEMORY("\xf0\x40\x00"
	                         "aaaa",
	                         fs.data[id], 7);
	fs_text(name, "rw", "");
	fs_fails(-EIO, "/23.410000000000/memory");
	fs_reads("DS2401", "/01.420000000000/type");
	fs_reads("1", "/01.420000000000/present");
}

static void test_a_slave_without_driver_is_told_once(void)
{
	fs_slave(WARM);
	fs_start();
	fs_fails(-ENOENT, WARM_OW "/temphigh");
	fs_fails(-ENOENT, WARM_OW "/templow");
	TEST_ASSERT_TRUE(fs_told(BUS_NOTE, WARM));
	TEST_ASSERT_EQUAL_UINT(1, host_events(&fs.host, BUS_NOTE));
}

static void test_a_thermometer_whose_driver_was_unloaded_is_told(void)
{
	fs_slave(WARM);
	fs_text(WARM, "rw", "");
	fs_start();
	fs_fails(-ENOENT, WARM_OW "/temperature");
	TEST_ASSERT_TRUE(fs_told(BUS_NOTE, WARM ": no driver that owsd uses has it"));
}

static void test_a_driver_that_goes_again_is_told_again(void)
{
	fs_slave(WARM);
	fs_start();
	fs_fails(-ENOENT, WARM_OW "/temphigh");
	fs_scratchpad(WARM, 0x151, 75, 70, 0x7f, "YES");
	fs_reads("     21.0625", WARM_OW "/temperature");
	TEST_ASSERT_EQUAL_UINT(1, host_events(&fs.host, BUS_NOTE));
	fs_erase(WARM "/w1_slave");
	fs_fails(-ENOENT, WARM_OW "/templow");
	TEST_ASSERT_EQUAL_UINT(2, host_events(&fs.host, BUS_NOTE));
}

static void test_a_directory_has_what_there_are_attributes_for(void)
{
	fs_slave("12-0000000000e1");
	fs_text("12-0000000000e1", "state", "1");
	fs_text("12-0000000000e1", "output", "3");
	fs_start();
	fs_lists("/12.E10000000000/PIO.BYTE\n/12.E10000000000/PIO.ALL\n/12.E10000000000/PIO.A\n"
	         "/12.E10000000000/PIO.B\n/12.E10000000000/address\n/12.E10000000000/alias\n"
	         "/12.E10000000000/crc8\n/12.E10000000000/family\n/12.E10000000000/flipflop.BYTE\n"
	         "/12.E10000000000/flipflop.ALL\n/12.E10000000000/flipflop.A\n"
	         "/12.E10000000000/flipflop.B\n/12.E10000000000/id\n/12.E10000000000/locator\n"
	         "/12.E10000000000/r_address\n/12.E10000000000/r_id\n/12.E10000000000/r_locator\n"
	         "/12.E10000000000/type\n",
	         "/12.E10000000000");
}

/* --- Rights --- */

static void test_who_may_not_write_is_told_how(void)
{
	uid_t user = geteuid();

	fs_board(0xbd, 0x80);
	fs_thermometer(WARM, 0x151);
	chmod(fs.root, 0755);
	char full[200];
	snprintf(full, sizeof(full), "%s/" BOARD "/output", fs.root);
	/* Neither the owner nor others; the group is root's own. */
	mode_t mode = user == 0 ? 0644 : 0464;
	chmod(full, mode);
	snprintf(full, sizeof(full), "%s/" WARM "/alarms", fs.root);
	chmod(full, mode);
	fs_start();
	fs_reads("         189", BOARD_OW "/sensed.BYTE");
	if (user == 0)
		TEST_ASSERT_EQUAL_INT(0, seteuid(65534));
	int pio = fs_writes(BOARD_OW "/PIO.0", "1"), high = fs_writes(WARM_OW "/temphigh", "30");
	if (user == 0)
		TEST_ASSERT_EQUAL_INT(0, seteuid(0));
	TEST_ASSERT_EQUAL_INT(-EPERM, pio);
	TEST_ASSERT_EQUAL_INT(-EPERM, high);
	TEST_ASSERT_TRUE(fs_told(BUS_NOTE, "udev"));
	TEST_ASSERT_EQUAL_UINT(1, host_events(&fs.host, BUS_NOTE));
	TEST_ASSERT_EQUAL_UINT(0, host_events(&fs.host, BUS_DOWN));
}

static void test_what_nobody_may_write_is_no_matter_of_rights(void)
{
	uid_t user = geteuid();
	char full[200];

	fs_board(0xbd, 0x80);
	chmod(fs.root, 0755);
	snprintf(full, sizeof(full), "%s/" BOARD "/cond_search_mask", fs.root);
	chmod(full, 0444);
	fs_start();
	fs_reads("        2223", BOARD_OW "/set_alarm");
	if (user == 0)
		TEST_ASSERT_EQUAL_INT(0, seteuid(65534));
	int err = fs_writes(BOARD_OW "/set_alarm", "222");
	if (user == 0)
		TEST_ASSERT_EQUAL_INT(0, seteuid(0));
	TEST_ASSERT_EQUAL_INT(-EACCES, err);
	TEST_ASSERT_EQUAL_UINT(0, host_events(&fs.host, BUS_NOTE));
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
	RUN_TEST(test_without_a_master_nobody_listens_to_uevents);
	RUN_TEST(test_a_slave_that_has_just_gone_is_no_device);
	RUN_TEST(test_identity_needs_no_attribute);
	RUN_TEST(test_a_ds2438_measures);
	RUN_TEST(test_the_values_of_a_ds2438s_driver_that_has_a_tmp1826_are_refused);
	RUN_TEST(test_a_ds2423_counts);
	RUN_TEST(test_eeproms_are_read_and_written);
	RUN_TEST(test_a_ds28e04_has_its_pages);
	RUN_TEST(test_an_eeprom_is_written_row_by_row);
	RUN_TEST(test_raw_access_serves_the_rest);
	RUN_TEST(test_a_slave_without_driver_is_told_once);
	RUN_TEST(test_a_driver_that_goes_again_is_told_again);
	RUN_TEST(test_a_thermometer_whose_driver_was_unloaded_is_told);
	RUN_TEST(test_a_directory_has_what_there_are_attributes_for);
	RUN_TEST(test_who_may_not_write_is_told_how);
	RUN_TEST(test_what_nobody_may_write_is_no_matter_of_rights);
	return UNITY_END();
}
