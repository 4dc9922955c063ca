/* SPDX-License-Identifier: MIT */
/* Tests of switches over the kernel's 1-Wire drivers. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <sys/stat.h>

#include "unity.h"

#include "tests/unit/aid/fs_scene.h"

void setUp(void)
{
	fs_begin();
}

void tearDown(void)
{
	fs_end();
}

static void test_a_ds2408_reads_its_registers(void)
{
	fs_board(0xbd, 0x88);
	fs_start();
	fs_reads("         189", BOARD_OW "/sensed.BYTE");
	fs_reads("1,0,1,1,1,1,0,1", BOARD_OW "/sensed.ALL");
	fs_reads("0", BOARD_OW "/sensed.1");
	fs_reads("           0", BOARD_OW "/PIO.BYTE");
	fs_reads("           5", BOARD_OW "/latch.BYTE");
	fs_reads("1", BOARD_OW "/por");
	fs_reads("1", BOARD_OW "/power");
	fs_reads("0", BOARD_OW "/strobe");
	fs_reads("        2223", BOARD_OW "/set_alarm");
	fs_fails(-ENOENT, BOARD_OW "/temperature");
}

static void test_a_ds2408_is_written_and_read_back(void)
{
	fs_board(0xbd, 0x88);
	fs_start();
	TEST_ASSERT_EQUAL_INT(0, fs_writes(BOARD_OW "/PIO.3", "1"));
	TEST_ASSERT_EQUAL_HEX8(0xf7, (uint8_t)fs_now_in(BOARD, "output")[0]);
	fs_reads("           8", BOARD_OW "/PIO.BYTE");
	TEST_ASSERT_EQUAL_INT(-EINVAL, fs_writes(BOARD_OW "/PIO.BYTE", "256"));
	TEST_ASSERT_EQUAL_INT(-EINVAL, fs_writes(BOARD_OW "/PIO.BYTE", "12abc"));
	TEST_ASSERT_EQUAL_INT(-EINVAL, fs_writes(BOARD_OW "/set_alarm", "100002224"));
	TEST_ASSERT_EQUAL_HEX8(0xf7, (uint8_t)fs_now_in(BOARD, "output")[0]);
	TEST_ASSERT_EQUAL_INT(0, fs_writes(BOARD_OW "/por", "0"));
	TEST_ASSERT_EQUAL_HEX8(0x80, (uint8_t)fs_now_in(BOARD, "status_control")[0]);
	TEST_ASSERT_EQUAL_INT(0, fs_writes(BOARD_OW "/latch.BYTE", "0"));
	TEST_ASSERT_EQUAL_HEX8(0xff, (uint8_t)fs_now_in(BOARD, "activity")[0]);
	TEST_ASSERT_EQUAL_INT(0, fs_writes(BOARD_OW "/set_alarm", "100002223"));
	TEST_ASSERT_EQUAL_HEX8(0x81, (uint8_t)fs_now_in(BOARD, "status_control")[0]);
}

/* The attribute has no checksum: what it shows is no proof of what the chip holds. */
static void test_a_bit_that_a_ds2408_shows_already_is_written_all_the_same(void)
{
	static const struct timespec long_ago[2] = {{.tv_sec = 1}, {.tv_sec = 1}};
	char path[128];
	struct stat now;

	fs_board(0xbd, 0x88);
	fs_start();
	TEST_ASSERT_EQUAL_INT(0, fs_writes(BOARD_OW "/PIO.3", "1"));
	snprintf(path, sizeof(path), "%s/" BOARD "/output", fs.root);
	TEST_ASSERT_EQUAL_INT(0, utimensat(AT_FDCWD, path, long_ago, 0));
	TEST_ASSERT_EQUAL_INT(0, fs_writes(BOARD_OW "/PIO.3", "1"));
	TEST_ASSERT_EQUAL_INT(0, stat(path, &now));
	TEST_ASSERT_GREATER_THAN_INT64(1, now.st_mtim.tv_sec);
	TEST_ASSERT_EQUAL_HEX8(0xf7, (uint8_t)fs_now_in(BOARD, "output")[0]);
}

static void test_a_ds2408_that_restarted_is_told(void)
{
	fs_board(0xbd, 0x80);
	fs_start();
	fs_reads("0", BOARD_OW "/por");
	fs_byte(BOARD, "status_control", 0x88);
	fs_reads("1", BOARD_OW "/por");
	TEST_ASSERT_EQUAL_UINT(1, host_events(&fs.host, BUS_POR));
}

static void test_a_ds2408_that_is_silent_has_no_value(void)
{
	fs_board(0xff, 0xff);
	fs_start();
	fs_fails(-EBADE, BOARD_OW "/sensed.BYTE");
	fs_broken(BOARD, "state");
	fs_fails(-EIO, BOARD_OW "/sensed.BYTE");
	TEST_ASSERT_EQUAL_UINT(0, host_events(&fs.host, BUS_DOWN));
}

static void test_a_ds2413_reads_whole_bytes_and_halves(void)
{
	fs_slave("3a-0000000000d1");
	fs_byte("3a-0000000000d1", "state", 0x4b);
	fs_byte("3a-0000000000d1", "output", 0);
	fs_start();
	fs_reads("1,0", "/3A.D10000000000/sensed.ALL");
	fs_reads("0,0", "/3A.D10000000000/PIO.ALL");
	fs_byte("3a-0000000000d1", "state", 0x0b);
	fs_reads("1,0", "/3A.D10000000000/sensed.ALL");
	/* The pins do not follow: the write is found out. */
	TEST_ASSERT_EQUAL_INT(-EIO, fs_writes("/3A.D10000000000/PIO.A", "1"));
	TEST_ASSERT_EQUAL_HEX8(0xfe, (uint8_t)fs_now_in("3a-0000000000d1", "output")[0]);
}

static void test_a_ds2406_has_its_switches(void)
{
	fs_slave("12-0000000000e1");
	fs_text("12-0000000000e1", "state", "1");
	fs_text("12-0000000000e1", "output", "3");
	fs_start();
	fs_reads("0,1", "/12.E10000000000/PIO.ALL");
	fs_reads("1,0", "/12.E10000000000/flipflop.ALL");
	fs_fails(-ENOENT, "/12.E10000000000/sensed.A");
	TEST_ASSERT_EQUAL_INT(0, fs_writes("/12.E10000000000/PIO.ALL", "0,1"));
	TEST_ASSERT_EQUAL_STRING("1", fs_now_in("12-0000000000e1", "output"));
	fs_text("12-0000000000e1", "state", "x");
	fs_fails(-EIO, "/12.E10000000000/PIO.A");
}

static void test_a_ds2405_has_its_switch_and_pin(void)
{
	fs_slave("05-0000000000f1");
	fs_text("05-0000000000f1", "state", "1");
	fs_text("05-0000000000f1", "output", "1");
	fs_start();
	fs_reads("0", "/05.F10000000000/PIO");
	fs_reads("1", "/05.F10000000000/sensed");
	fs_lists("", "/alarm");
	TEST_ASSERT_EQUAL_INT(0, fs_writes("/05.F10000000000/PIO", "1"));
	fs_reads("1", "/05.F10000000000/PIO");
	fs_lists("/alarm/05.F10000000000\n", "/alarm");
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_ds2408_reads_its_registers);
	RUN_TEST(test_a_ds2408_is_written_and_read_back);
	RUN_TEST(test_a_bit_that_a_ds2408_shows_already_is_written_all_the_same);
	RUN_TEST(test_a_ds2408_that_restarted_is_told);
	RUN_TEST(test_a_ds2408_that_is_silent_has_no_value);
	RUN_TEST(test_a_ds2413_reads_whole_bytes_and_halves);
	RUN_TEST(test_a_ds2406_has_its_switches);
	RUN_TEST(test_a_ds2405_has_its_switch_and_pin);
	return UNITY_END();
}
