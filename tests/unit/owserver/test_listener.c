/* SPDX-License-Identifier: MIT */
/* Whose listener the kernel's files name, of recorded ones and of this machine. */
#include <arpa/inet.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "hal/owserver/listener.h"

#define HEAD "  sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid\n"
#define ROW(local, state, uid) \
	"   0: " local " 00000000:0000 " state " 00000000:00000000 00:00000000 00000000 " uid \
	"        0 35772704 1 0 100 0 0 10 0\n"

static char folder[] = "/tmp/listener.XXXXXX";

static void write_file(const char *name, const char *text)
{
	char path[64];
	FILE *file;

	snprintf(path, sizeof(path), "%s/%s", folder, name);
	file = fopen(path, "w");
	TEST_ASSERT_NOT_NULL(file);
	fputs(HEAD, file);
	fputs(text, file);
	TEST_ASSERT_EQUAL(0, fclose(file));
}

/* The port of all of them is 4304, 10D0. */
static int user_at(const char *address)
{
	struct sockaddr_in v4 = {.sin_family = AF_INET, .sin_port = htons(4304)};
	struct sockaddr_in6 v6 = {.sin6_family = AF_INET6, .sin6_port = htons(4304)};
	uid_t user = 0;
	int err;

	if (inet_pton(AF_INET, address, &v4.sin_addr) == 1)
		err = listener_user(folder, (struct sockaddr *)&v4, &user);
	else if (inet_pton(AF_INET6, address, &v6.sin6_addr) == 1)
		err = listener_user(folder, (struct sockaddr *)&v6, &user);
	else
		return -EINVAL;
	return err ? err : (int)user;
}

void setUp(void)
{
	strcpy(folder + strlen(folder) - 6, "XXXXXX");
	TEST_ASSERT_NOT_NULL(mkdtemp(folder));
}

void tearDown(void)
{
	char path[64];

	for (int i = 0; i < 2; i++) {
		snprintf(path, sizeof(path), "%s/%s", folder, i ? "tcp6" : "tcp");
		unlink(path);
	}
	rmdir(folder);
}

/* The addresses are words of the machine. */
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__

static void test_the_listener_at_the_address_has_its_user(void)
{
	write_file("tcp", ROW("0100007F:10D1", "0A", "7") ROW("0200007F:10D0", "0A", "8")
	                          ROW("0100007F:10D0", "0A", "1001"));
	TEST_ASSERT_EQUAL(1001, user_at("127.0.0.1"));
	TEST_ASSERT_EQUAL(8, user_at("127.0.0.2"));
	TEST_ASSERT_EQUAL(-ENOENT, user_at("127.0.0.3"));
}

static void test_a_listener_at_all_addresses_counts_where_none_is_at_this_one(void)
{
	write_file("tcp", ROW("00000000:10D0", "0A", "5") ROW("0100007F:10D0", "0A", "6"));
	TEST_ASSERT_EQUAL(6, user_at("127.0.0.1"));
	TEST_ASSERT_EQUAL(5, user_at("127.0.0.2"));
}

static void test_a_listener_of_the_sixth_version_takes_the_fourth_too(void)
{
	write_file("tcp", "");
	write_file("tcp6", ROW("00000000000000000000000000000000:10D0", "0A", "9"));
	TEST_ASSERT_EQUAL(9, user_at("127.0.0.1"));
	TEST_ASSERT_EQUAL(9, user_at("::1"));
	write_file("tcp6", ROW("0000000000000000FFFF00000100007F:10D0", "0A", "10"));
	TEST_ASSERT_EQUAL(10, user_at("127.0.0.1"));
	write_file("tcp6", ROW("00000000000000000000000001000000:10D0", "0A", "11"));
	TEST_ASSERT_EQUAL(11, user_at("::1"));
	TEST_ASSERT_EQUAL(-ENOENT, user_at("127.0.0.1"));
}

#endif

static void test_only_who_listens_counts(void)
{
	write_file("tcp", ROW("0100007F:10D0", "01", "1001"));
	write_file("tcp6", "nothing of this form\n");
	TEST_ASSERT_EQUAL(-ENOENT, user_at("127.0.0.1"));
	TEST_ASSERT_EQUAL(-ENOENT, user_at("::1"));
}

static void test_without_the_files_nobody_is_known(void)
{
	TEST_ASSERT_EQUAL(-ENOENT, user_at("127.0.0.1"));
}

static void test_a_socket_of_this_program_is_its_users(void)
{
	struct sockaddr_in at = {.sin_family = AF_INET, .sin_addr = {htonl(INADDR_LOOPBACK)}};
	socklen_t len = sizeof(at);
	int fd = socket(AF_INET, SOCK_STREAM, 0);
	uid_t user = 12345;

	TEST_ASSERT_EQUAL(0, bind(fd, (struct sockaddr *)&at, len));
	TEST_ASSERT_EQUAL(0, listen(fd, 1));
	TEST_ASSERT_EQUAL(0, getsockname(fd, (struct sockaddr *)&at, &len));
	TEST_ASSERT_EQUAL(0, listener_user("/proc/self/net", (struct sockaddr *)&at, &user));
	TEST_ASSERT_EQUAL(geteuid(), user);
	close(fd);
	TEST_ASSERT_EQUAL(-ENOENT, listener_user("/proc/self/net", (struct sockaddr *)&at, &user));
}

static void test_people_are_not_trusted(void)
{
	TEST_ASSERT_TRUE(listener_is_trusted(0));
	TEST_ASSERT_TRUE(listener_is_trusted(999));
	TEST_ASSERT_TRUE(listener_is_trusted(61184));
	TEST_ASSERT_TRUE(listener_is_trusted(geteuid()));
	TEST_ASSERT_FALSE(listener_is_trusted(geteuid() == 1000 ? 1001 : 1000));
	TEST_ASSERT_TRUE(listener_is_trusted(65534));
	TEST_ASSERT_FALSE(listener_is_trusted(65533));
}

int main(void)
{
	UNITY_BEGIN();
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
	RUN_TEST(test_the_listener_at_the_address_has_its_user);
	RUN_TEST(test_a_listener_at_all_addresses_counts_where_none_is_at_this_one);
	RUN_TEST(test_a_listener_of_the_sixth_version_takes_the_fourth_too);
#endif
	RUN_TEST(test_only_who_listens_counts);
	RUN_TEST(test_without_the_files_nobody_is_known);
	RUN_TEST(test_a_socket_of_this_program_is_its_users);
	RUN_TEST(test_people_are_not_trusted);
	return UNITY_END();
}
