/* SPDX-License-Identifier: MIT */
/*
 * Which board, and what is missing there: trees of files as the firmware and the kernel make them.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "src/ground/board/board.h"
#include "src/ground/board/data.h"
#include "src/ground/board/look.h"
#include "src/ground/board/report.h"

#define DATA "board/boards"

static char root[64];
static struct board_report report;
static char why[900];

/* All folders on the way to root/path. */
static void folders(const char *path)
{
	char at[400];

	snprintf(at, sizeof(at), "%s%s", root, path);
	for (char *slash = at + strlen(root) + 1; (slash = strchr(slash, '/')); slash++) {
		*slash = '\0';
		if (mkdir(at, 0755))
			TEST_ASSERT_EQUAL(EEXIST, errno);
		*slash = '/';
	}
}

static void put(const char *path, const void *data, size_t len)
{
	char at[400];
	FILE *out;

	folders(path);
	snprintf(at, sizeof(at), "%s%s", root, path);
	out = fopen(at, "we");
	TEST_ASSERT_NOT_NULL_MESSAGE(out, at);
	TEST_ASSERT_EQUAL(len, fwrite(data, 1, len, out));
	fclose(out);
}

static void text(const char *path, const char *data)
{
	put(path, data, strlen(data) + 1);
}

static void claimed(const char *client, const char *driver)
{
	char at[400], to[200];

	snprintf(at, sizeof(at), "/sys/bus/i2c/devices/%s/driver", client);
	folders(at);
	snprintf(at, sizeof(at), "%s/sys/bus/i2c/devices/%s/driver", root, client);
	snprintf(to, sizeof(to), "../../../../bus/i2c/drivers/%s", driver);
	TEST_ASSERT_EQUAL(0, symlink(to, at));
}

static void adapter(unsigned number, unsigned hz)
{
	unsigned char cell[4] = {(unsigned char)(hz >> 24), (unsigned char)(hz >> 16),
	                         (unsigned char)(hz >> 8), (unsigned char)hz};
	char path[120];

	snprintf(path, sizeof(path), "/sys/bus/i2c/devices/i2c-%u/of_node/clock-frequency", number);
	put(path, cell, sizeof(cell));
}

static void device(unsigned number, mode_t mode)
{
	char path[120], at[300];

	snprintf(path, sizeof(path), "/dev/i2c-%u", number);
	put(path, "", 0);
	snprintf(at, sizeof(at), "%s%s", root, path);
	TEST_ASSERT_EQUAL(0, chmod(at, mode));
}

static void no_device(unsigned number)
{
	char at[300];

	snprintf(at, sizeof(at), "%s/dev/i2c-%u", root, number);
	TEST_ASSERT_EQUAL(0, unlink(at));
}

/* A Raspberry Pi 4 on which nothing is missing. */
static void good_pi(void)
{
	text("/proc/device-tree/model", "Raspberry Pi 4 Model B Rev 1.1");
	text("/boot/firmware/config.txt", "");
	adapter(1, 400000);
	device(1, 0666);
}

static void look(void)
{
	TEST_ASSERT_EQUAL_MESSAGE(0, board_look(root, DATA, NULL, &report, why, sizeof(why)), why);
}

static const struct board_line *line_with(const char *words)
{
	for (unsigned i = 0; i < report.count; i++)
		if (strstr(report.line[i].text, words))
			return &report.line[i];
	return NULL;
}

static void expect(enum board_kind kind, const char *words, const char *remedy)
{
	const struct board_line *line = line_with(words);

	if (!line) {
		board_print(&report, stdout);
		TEST_FAIL_MESSAGE(words);
		return;
	}
	TEST_ASSERT_EQUAL_MESSAGE(kind, line->kind, line->text);
	if (remedy && !strstr(line->remedy, remedy))
		TEST_FAIL_MESSAGE(line->remedy);
}

static void expect_not(const char *words)
{
	TEST_ASSERT_NULL_MESSAGE(line_with(words), words);
}

void setUp(void)
{
	strcpy(root, "/tmp/board-XXXXXX");
	TEST_ASSERT_NOT_NULL(mkdtemp(root));
	TEST_ASSERT_EQUAL(0, chmod(root, 0755));
}

void tearDown(void)
{
	char command[100];

	snprintf(command, sizeof(command), "rm -rf '%s'", root);
	TEST_ASSERT_EQUAL(0, system(command));
}

static void test_a_board_on_which_nothing_is_missing_says_its_adapter_and_no_more(void)
{
	good_pi();
	look();
	TEST_ASSERT_FALSE(report.missing);
	expect(BOARD_FACT, "Raspberry Pi 4 Model B Rev 1.1 (raspberry-pi-4)", NULL);
	expect(BOARD_FACT, "/dev/i2c-1 at 400 kHz", NULL);
	expect(BOARD_FACT, "gpio:pinctrl-bcm2711", NULL);
	expect_not("claimed");
	expect_not("runs at");
}

static void test_an_interface_that_is_off_names_the_command_and_the_line(void)
{
	text("/proc/device-tree/model", "Raspberry Pi 5 Model B Rev 1.0");
	text("/boot/firmware/config.txt", "#dtparam=i2c_arm=on\n[all]\n");
	adapter(13, 100000);
	device(13, 0666);
	look();
	TEST_ASSERT_TRUE(report.missing);
	expect(BOARD_MISSING, "I2C is off: there is no adapter i2c-1",
	       "sudo raspi-config nonint do_i2c 0");
	expect(BOARD_MISSING, "I2C is off", "dtparam=i2c_arm=on in /boot/firmware/config.txt");
}

static void test_an_older_system_has_its_config_txt_elsewhere(void)
{
	text("/proc/device-tree/model", "Raspberry Pi 3 Model B Plus Rev 1.3");
	text("/boot/config.txt", "");
	look();
	expect(BOARD_MISSING, "I2C is off", "dtparam=i2c_arm=on in /boot/config.txt");
}

static void test_a_line_that_is_there_and_not_in_force_wants_a_reboot(void)
{
	text("/proc/device-tree/model", "Raspberry Pi Zero 2 W Rev 1.0");
	text("/boot/firmware/config.txt", "dtparam=audio=on\ndtparam=i2c_arm=on,spi=on\n");
	look();
	expect(BOARD_MISSING, "has dtparam=i2c_arm=on", "sudo reboot");
	expect_not("is off");
}

static void test_a_line_for_another_board_is_none_of_this_one(void)
{
	text("/proc/device-tree/model", "Raspberry Pi 3 Model B Rev 1.2");
	text("/boot/firmware/config.txt", "[pi4]\ndtparam=i2c_arm=on\n[all]\ndtparam=audio=on\n");
	look();
	expect(BOARD_MISSING, "I2C is off: there is no adapter i2c-1", "sudo raspi-config");
	text("/boot/firmware/config.txt", "[pi4]\n[all]\ndtparam=i2c_arm=on\n");
	look();
	expect(BOARD_MISSING, "has dtparam=i2c_arm=on", "sudo reboot");
}

static void test_an_adapter_without_a_device_file_wants_the_module(void)
{
	good_pi();
	no_device(1);
	look();
	expect(BOARD_MISSING, "there is no /dev/i2c-1: the module i2c-dev is not loaded",
	       "sudo modprobe i2c-dev");
	expect_not("permission");
}

static void look_as_nobody(void)
{
	bool is_root = geteuid() == 0;

	if (is_root)
		TEST_ASSERT_EQUAL(0, seteuid(65534));
	look();
	if (is_root)
		TEST_ASSERT_EQUAL(0, seteuid(0));
}

static void test_a_device_file_that_one_may_not_open_names_its_remedy(void)
{
	good_pi();
	device(1, 0600);
	if (geteuid() != 0)
		device(1, 0);
	look_as_nobody();
	TEST_ASSERT_TRUE(report.missing);
	expect(BOARD_MISSING, "no permission for /dev/i2c-1", "i2c");
	expect_not("i2c-dev is not loaded");
}

static void test_a_file_of_a_group_names_the_group_to_join(void)
{
	char at[300];

	if (geteuid() != 0)
		TEST_IGNORE_MESSAGE("only root gives files to a group");
	good_pi();
	device(1, 0660);
	snprintf(at, sizeof(at), "%s/dev/i2c-1", root);
	TEST_ASSERT_EQUAL(0, chown(at, 0, 1));
	look_as_nobody();
	expect(BOARD_MISSING, "no permission for /dev/i2c-1", "sudo adduser");
	expect(BOARD_MISSING, "no permission for /dev/i2c-1", " daemon ");
}

static void test_a_chip_of_the_kernel_is_a_note_with_the_line_that_frees_it(void)
{
	good_pi();
	claimed("1-0018", "ds2482");
	claimed("1-001a", "jc42");
	look();
	TEST_ASSERT_FALSE(report.missing);
	expect(BOARD_NOTE, "the chip at 0x18 of i2c-1 is claimed",
	       "echo 1-0018 | sudo tee /sys/bus/i2c/drivers/ds2482/unbind");
	expect_not("0x1a");
}

static void test_a_slow_adapter_is_a_note_with_the_line_for_config_txt(void)
{
	good_pi();
	adapter(1, 100000);
	look();
	TEST_ASSERT_FALSE(report.missing);
	expect(BOARD_NOTE, "I2C runs at 100 kHz",
	       "dtparam=i2c_arm_baudrate=400000 | sudo tee -a /boot/firmware/config.txt");
}

static void test_what_is_missing_stands_before_the_notes(void)
{
	good_pi();
	adapter(1, 100000);
	no_device(1);
	look();
	for (unsigned i = 1; i < report.count; i++)
		TEST_ASSERT_FALSE(report.line[i - 1].kind == BOARD_NOTE &&
		                  report.line[i].kind != BOARD_NOTE);
}

static void test_the_first_revision_has_its_header_on_the_other_adapter(void)
{
	text("/proc/device-tree/model", "Raspberry Pi Model B Rev 1");
	adapter(0, 400000);
	device(0, 0666);
	look();
	TEST_ASSERT_FALSE(report.missing);
	expect(BOARD_FACT, "(raspberry-pi-1-rev-1)", NULL);
	expect(BOARD_FACT, "/dev/i2c-0", NULL);
}

static void test_a_hat_is_known_by_what_its_eeprom_says(void)
{
	good_pi();
	text("/proc/device-tree/hat/vendor", "REX Controls");
	text("/proc/device-tree/hat/product", "Monarco HAT");
	claimed("1-0018", "ds2482");
	look();
	expect(BOARD_FACT, "on it: Monarco HAT (monarco-hat), 0x18 DS2482-100", NULL);
	text("/proc/device-tree/hat/product", "Relay\033[2J HAT");
	look();
	expect(BOARD_FACT, "on it: Relay?[2J HAT of REX Controls, of which there is no data", NULL);
}

static void test_another_program_on_the_adapter_is_a_note(void)
{
	char at[300];

	good_pi();
	text("/proc/109/comm", "owserver\n");
	folders("/proc/109/fd/7");
	snprintf(at, sizeof(at), "%s/proc/109/fd/7", root);
	TEST_ASSERT_EQUAL(0, symlink("/dev/null", at));
	snprintf(at, sizeof(at), "%s/dev/i2c-1", root);
	look();
	for (unsigned i = 0; i < report.count; i++)
		TEST_ASSERT_NULL_MESSAGE(strstr(report.line[i].text, "owserver"),
		                         report.line[i].text);
	/* the adapter is the device that it has open */
	TEST_ASSERT_EQUAL(0, unlink(at));
	TEST_ASSERT_EQUAL(0, symlink("/dev/null", at));
	look();
	TEST_ASSERT_FALSE(report.missing);
	expect(BOARD_RIVAL, "i2c-1 is open in owserver, process 109",
	       "sudo systemctl disable --now owserver.socket");
}

static void test_a_board_that_does_not_tell_is_named(void)
{
	good_pi();
	TEST_ASSERT_EQUAL(0, board_look(root, DATA, "unipi-1.1", &report, why, sizeof(why)));
	expect(BOARD_FACT, "on it: UniPi 1.1 (unipi-1.1)", NULL);
	TEST_ASSERT_EQUAL(-ENOENT, board_look(root, DATA, "unipi", &report, why, sizeof(why)));
	TEST_ASSERT_NOT_NULL(strstr(why, "unipi-1.1"));
}

static void test_a_machine_without_a_device_tree_takes_any_adapter(void)
{
	look();
	expect(BOARD_FACT, "does not say which", NULL);
	expect(BOARD_MISSING, "there is no I2C adapter", NULL);
	adapter(3, 0);
	look();
	expect(BOARD_MISSING, "i2c-dev is not loaded", "sudo modprobe i2c-dev");
	adapter(4, 0);
	device(4, 0666);
	look();
	TEST_ASSERT_FALSE(report.missing);
}

static void test_no_i2c_adapter_is_missing_where_another_kind_is_plugged_in(void)
{
	static const char port[] = "/dev/serial/by-id/usb-FTDI_FT232R-if00-port0";
	char at[300];

	put(port, "", 0);
	look();
	expect(BOARD_FACT, port, NULL);
	TEST_ASSERT_FALSE(report.missing);
	snprintf(at, sizeof(at), "%s%s", root, port);
	TEST_ASSERT_EQUAL(0, unlink(at));
	look();
	TEST_ASSERT_TRUE(report.missing);
	text("/sys/bus/usb/devices/1-1/uevent", "PRODUCT=4fa/2490/2\nDEVNAME=bus/usb/001/004\n");
	look();
	expect(BOARD_FACT, "DS9490R at /dev/bus/usb/001/004 (target usb:)", NULL);
	TEST_ASSERT_FALSE(report.missing);
}

static void test_more_than_a_report_holds_leaves_its_lines_right(void)
{
	static const char *const chips[] = {"0018", "0019", "001a", "001b"};
	unsigned claims = 0;
	char client[16];

	for (unsigned n = 0; n < 8; n++) {
		adapter(n, n % 2 ? 400000 : 0);
		for (unsigned i = 0; i < 4; i++) {
			snprintf(client, sizeof(client), "%u-%s", n, chips[i]);
			claimed(client, "ds2482");
		}
	}
	look();
	TEST_ASSERT_EQUAL_UINT(BOARD_LINES, report.count);
	TEST_ASSERT_TRUE_MESSAGE(report.missing, "the module is missing, said or not");
	for (unsigned i = 0; i < report.count; i++) {
		const struct board_line *line = &report.line[i];
		unsigned number, address;

		if (sscanf(line->text, "the chip at 0x%x of i2c-%u", &address, &number) == 2) {
			snprintf(client, sizeof(client), "echo %u-%04x ", number, address);
			TEST_ASSERT_EQUAL_STRING_LEN(client, line->remedy, strlen(client));
			TEST_ASSERT_NULL_MESSAGE(strstr(line->text, " kHz"), line->text);
			claims++;
		}
	}
	TEST_ASSERT_GREATER_THAN_UINT(10, claims);
}

static void test_the_kernels_masters_are_named(void)
{
	good_pi();
	text("/sys/bus/w1/devices/w1_bus_master1/name", "");
	look();
	expect(BOARD_FACT, "w1_bus_master1 (target w1)", NULL);
}

static void test_without_data_the_machine_is_looked_at_all_the_same(void)
{
	good_pi();
	TEST_ASSERT_EQUAL(0, board_look(root, "/nowhere", NULL, &report, why, sizeof(why)));
	expect(BOARD_NOTE, "no board data: /nowhere", NULL);
	expect(BOARD_FACT, "of which there is no data", NULL);
	TEST_ASSERT_FALSE(report.missing);
}

static void reads(const char *data, int expected, const char *words)
{
	struct board_data board;
	char at[200];

	put("/x.board", data, strlen(data));
	snprintf(at, sizeof(at), "%s/x.board", root);
	TEST_ASSERT_EQUAL(expected, board_data_read(at, &board, why, sizeof(why)));
	if (expected && !strstr(why, words))
		TEST_FAIL_MESSAGE(why);
}

static void test_wrong_data_is_refused_with_its_line(void)
{
	char text_of_300[400] = "Name ";

	memset(text_of_300 + 5, 'x', 300);
	reads("# c\n\n  Name  a board \nI2C 1\n", 0, NULL);
	reads("Name a\nSpeed 1\n", -EINVAL, ":2: unknown key Speed");
	reads("Name a\nI2C one\n", -EINVAL, ":2: I2C: a number from 0");
	reads("Name a\nKHz 99999\n", -EINVAL, ":2: KHz");
	reads("Name a\nName b\n", -EINVAL, ":2: Name is given too often");
	reads("Name a\nPins\n", -EINVAL, ":2: Pins has no value");
	reads("Name a\nCombine all\n", -EINVAL, ":2: Combine: any or one-read");
	reads("I2C 1\n", -EINVAL, "no Name");
	reads(text_of_300, -EINVAL, ":1: longer than");
	text_of_300[200] = '\0';
	reads(text_of_300, -EINVAL, ":1: Name is longer than 119");
}

static void test_each_board_of_ours_can_be_used(void)
{
	static struct board_data data[48];
	int count = board_data_list(DATA, data, 48, why, sizeof(why));

	TEST_ASSERT_GREATER_THAN_MESSAGE(9, count, why);
	for (int i = 0; i < count; i++) {
		TEST_ASSERT_GREATER_OR_EQUAL_MESSAGE(0, data[i].i2c, data[i].id);
		for (unsigned m = 0; m < BOARD_MODELS && data[i].model[m][0]; m++) {
			TEST_ASSERT_EQUAL_PTR(&data[i], board_data_model(data, (unsigned)count,
			                                                 data[i].model[m]));
			TEST_ASSERT_TRUE_MESSAGE(data[i].enable[0] && data[i].on_line[0] &&
			                                 data[i].speed_line[0],
			                         data[i].id);
			TEST_ASSERT_EQUAL_MESSAGE(400, data[i].khz, data[i].id);
		}
	}
	TEST_ASSERT_NULL(board_data_model(data, (unsigned)count, "Radxa ROCK 5B"));
	TEST_ASSERT_EQUAL_STRING(
		"raspberry-pi-zero",
		board_data_model(data, (unsigned)count, "Raspberry Pi Zero W Rev 1.1")->id);
	TEST_ASSERT_EQUAL_STRING(
		"raspberry-pi-1",
		board_data_model(data, (unsigned)count, "Raspberry Pi Model B Plus Rev 1.2")->id);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_board_on_which_nothing_is_missing_says_its_adapter_and_no_more);
	RUN_TEST(test_an_interface_that_is_off_names_the_command_and_the_line);
	RUN_TEST(test_an_older_system_has_its_config_txt_elsewhere);
	RUN_TEST(test_a_line_that_is_there_and_not_in_force_wants_a_reboot);
	RUN_TEST(test_a_line_for_another_board_is_none_of_this_one);
	RUN_TEST(test_an_adapter_without_a_device_file_wants_the_module);
	RUN_TEST(test_a_device_file_that_one_may_not_open_names_its_remedy);
	RUN_TEST(test_a_file_of_a_group_names_the_group_to_join);
	RUN_TEST(test_a_chip_of_the_kernel_is_a_note_with_the_line_that_frees_it);
	RUN_TEST(test_a_slow_adapter_is_a_note_with_the_line_for_config_txt);
	RUN_TEST(test_what_is_missing_stands_before_the_notes);
	RUN_TEST(test_the_first_revision_has_its_header_on_the_other_adapter);
	RUN_TEST(test_a_hat_is_known_by_what_its_eeprom_says);
	RUN_TEST(test_another_program_on_the_adapter_is_a_note);
	RUN_TEST(test_a_board_that_does_not_tell_is_named);
	RUN_TEST(test_a_machine_without_a_device_tree_takes_any_adapter);
	RUN_TEST(test_no_i2c_adapter_is_missing_where_another_kind_is_plugged_in);
	RUN_TEST(test_more_than_a_report_holds_leaves_its_lines_right);
	RUN_TEST(test_the_kernels_masters_are_named);
	RUN_TEST(test_without_data_the_machine_is_looked_at_all_the_same);
	RUN_TEST(test_wrong_data_is_refused_with_its_line);
	RUN_TEST(test_each_board_of_ours_can_be_used);
	return UNITY_END();
}
