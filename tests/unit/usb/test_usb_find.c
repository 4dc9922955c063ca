/* SPDX-License-Identifier: MIT */
/* The adapters that are plugged in, by files like those of the kernel; and what one says. */
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "unity.h"

#include "hal/usb/ds2490.h"
#include "hal/usb/find.h"
#include "hal/usb/libusb.h"

static char folder[64];
static struct usb_place places[USB_PLACES];

void setUp(void)
{
	snprintf(folder, sizeof(folder), "/tmp/usb-XXXXXX");
	TEST_ASSERT_NOT_NULL(mkdtemp(folder));
}

static int remove_one(const char *path, const struct stat *st, int type, struct FTW *ftw)
{
	(void)st, (void)type, (void)ftw;
	return remove(path);
}

void tearDown(void)
{
	TEST_ASSERT_EQUAL_INT(0, nftw(folder, remove_one, 4, FTW_DEPTH | FTW_PHYS));
}

static void add(const char *name, const char *uevent)
{
	char path[128];
	FILE *file;

	snprintf(path, sizeof(path), "%s/%s", folder, name);
	TEST_ASSERT_EQUAL_INT(0, mkdir(path, 0700));
	snprintf(path, sizeof(path), "%s/%s/uevent", folder, name);
	file = fopen(path, "w");
	TEST_ASSERT_NOT_NULL(file);
	fputs(uevent, file);
	TEST_ASSERT_EQUAL_INT(0, fclose(file));
}

static void test_adapters_are_listed_with_their_files_and_drivers(void)
{
	add("1-1.10", "MAJOR=189\nMINOR=5\nDEVNAME=bus/usb/001/006\nDEVTYPE=usb_device\n"
	              "DRIVER=usb\nPRODUCT=4fa/2490/2\nTYPE=255/255/255\nBUSNUM=001\n");
	add("1-1.10:1.0", "DEVTYPE=usb_interface\nDRIVER=DS9490R\nPRODUCT=4fa/2490/2\n");
	add("1-1.4", "DEVNAME=bus/usb/001/005\nDEVTYPE=usb_device\nPRODUCT=4fa/2490/2");
	add("1-1.4:1.0", "DEVTYPE=usb_interface\nPRODUCT=4fa/2490/2\n");
	add("1-1.5", "DEVNAME=bus/usb/001/007\nDEVTYPE=usb_device\nPRODUCT=4fa/2491/2\n");
	add("1-1.6", "DEVNAME=bus/usb/001/008\nDEVTYPE=usb_device\nPRODUCT=14fa/2490/2\n");
	add("1-1.7", "PRODUCT=4fa/2490/2\n");
	add("1-1.8", "");
	add("usb1", "DEVNAME=bus/usb/001/001\nPRODUCT=4fa/2490/2\n");
	TEST_ASSERT_EQUAL_UINT(2, usb_find(folder, places));
	TEST_ASSERT_EQUAL_STRING("1-1.4", places[0].name);
	TEST_ASSERT_EQUAL_STRING("/dev/bus/usb/001/005", places[0].device);
	TEST_ASSERT_EQUAL_STRING("", places[0].driver);
	TEST_ASSERT_EQUAL_STRING("1-1.10", places[1].name);
	TEST_ASSERT_EQUAL_STRING("/dev/bus/usb/001/006", places[1].device);
	TEST_ASSERT_EQUAL_STRING("DS9490R", places[1].driver);
}

static void test_there_may_be_none_no_usb_or_more_than_anybody_has(void)
{
	char name[16];

	TEST_ASSERT_EQUAL_UINT(0, usb_find(folder, places));
	TEST_ASSERT_EQUAL_UINT(0, usb_find("/nowhere", places));
	for (unsigned i = 1; i <= USB_PLACES + 2; i++) {
		snprintf(name, sizeof(name), "1-%u", i);
		add(name, "DEVNAME=bus/usb/001/005\nPRODUCT=4fa/2490/2\n");
	}
	TEST_ASSERT_EQUAL_UINT(USB_PLACES, usb_find(folder, places));
}

static void test_one_that_has_gone_or_gives_no_rights_is_explained(void)
{
	const struct usb_place gone = {"1-1.4", "/dev/bus/usb/999/999", ""};
	struct sockaddr_un at = {.sun_family = AF_UNIX};
	int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
	struct usb_place away = {"1-1.4", "", ""};
	const struct usb_place none = {"1-1.4", "/dev/null", ""};
	struct usb_port *port;
	char why[256];

	int err = usb_linux.open(&gone, &port, why, sizeof(why));

	TEST_ASSERT_TRUE_MESSAGE(err == -ENODEV || err == -EOPNOTSUPP, why);
	TEST_ASSERT_NOT_NULL_MESSAGE(
		strstr(why, err == -ENODEV ? "USB 1-1.4 is gone" : "libusb-1.0-0-dev"), why);
	usb_linux.give_back(&gone);
	/* as of a driver that was unloaded: open() returns the same of a socket */
	snprintf(at.sun_path, sizeof(at.sun_path), "%s/socket", folder);
	TEST_ASSERT_EQUAL_INT(0, bind(fd, (const struct sockaddr *)&at, sizeof(at)));
	close(fd);
	snprintf(away.device, sizeof(away.device), "%.40s", at.sun_path);
	TEST_ASSERT_EQUAL_INT(err, usb_linux.open(&away, &port, why, sizeof(why)));
	TEST_ASSERT_NOT_NULL_MESSAGE(
		strstr(why, err == -ENODEV ? "USB 1-1.4 is gone" : "libusb-1.0-0-dev"), why);
	TEST_ASSERT_NOT_EQUAL_INT(0, usb_linux.open(&none, &port, why, sizeof(why)));
	usb_linux.give_back(&none);
}

static void test_a_state_is_read_from_its_packet_and_a_device_that_arrives_is_no_result(void)
{
	uint8_t bytes[20] = {
		[1] = 1, [8] = 0xB9, [11] = 2, [12] = 64, [13] = 19, [16] = 0xA5, [17] = 0x02};
	struct ds2490_state state;

	TEST_ASSERT_EQUAL_INT(-EIO, ds2490_parse(bytes, 15, &state));
	TEST_ASSERT_EQUAL_INT(0, ds2490_parse(bytes, 16, &state));
	TEST_ASSERT_FALSE(state.told);
	TEST_ASSERT_EQUAL_HEX8(PULLED_UP | HALTED | IDLE | OVERRUN | 0x08, state.flags);
	TEST_ASSERT_EQUAL_UINT(2, state.commands);
	TEST_ASSERT_EQUAL_UINT(64, state.out);
	TEST_ASSERT_EQUAL_UINT(19, state.in);
	TEST_ASSERT_EQUAL_INT(0, ds2490_parse(bytes, 17, &state));
	TEST_ASSERT_FALSE(state.told);
	TEST_ASSERT_EQUAL_INT(0, ds2490_parse(bytes, 19, &state));
	TEST_ASSERT_TRUE(state.told);
	TEST_ASSERT_EQUAL_HEX8(SHORT, state.results);
}

/* As the kernel has it in the device file, with more descriptors after it. */
static void test_a_device_file_is_that_of_an_adapter_by_its_descriptor(void)
{
	const uint16_t adapter[12] = {[4] = 0x04fa, [5] = 0x2490},
		       other[9] = {[4] = 0x0403, [5] = 0x2490},
		       old[9] = {[4] = 0x04fa, [5] = 0x2491};
	char path[80];
	int fd;

	snprintf(path, sizeof(path), "%s/001", folder);
	fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, fd);
	TEST_ASSERT_FALSE(usb_is_adapter(fd));
	TEST_ASSERT_EQUAL(sizeof(other), pwrite(fd, other, sizeof(other), 0));
	TEST_ASSERT_FALSE(usb_is_adapter(fd));
	TEST_ASSERT_EQUAL(sizeof(old), pwrite(fd, old, sizeof(old), 0));
	TEST_ASSERT_FALSE(usb_is_adapter(fd));
	TEST_ASSERT_EQUAL(sizeof(adapter), pwrite(fd, adapter, sizeof(adapter), 0));
	TEST_ASSERT_TRUE(usb_is_adapter(fd));
	TEST_ASSERT_EQUAL(0, close(fd));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_state_is_read_from_its_packet_and_a_device_that_arrives_is_no_result);
	RUN_TEST(test_adapters_are_listed_with_their_files_and_drivers);
	RUN_TEST(test_there_may_be_none_no_usb_or_more_than_anybody_has);
	RUN_TEST(test_a_device_file_is_that_of_an_adapter_by_its_descriptor);
	RUN_TEST(test_one_that_has_gone_or_gives_no_rights_is_explained);
	return UNITY_END();
}
