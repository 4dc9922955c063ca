/* SPDX-License-Identifier: MIT */
/* Whose listener the kernel's files name, of recorded ones and of this machine. */
#include <arpa/inet.h>
#include <errno.h>
#include <net/if.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "unity.h"

#include "hal/owserver/listener.h"

#define HEAD "  sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid\n"
#define FROM_TO(local, remote, state, uid, inode) \
	"   0: " local " " remote " " state " 00000000:00000000 00:00000000 00000000 " uid \
	"        0 " inode " 1 0 100 0 0 10 0\n"
#define ROW(local, state, uid) FROM_TO(local, "00000000:0000", state, uid, "35772704")

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

static void make_address(const char *address, unsigned port, struct sockaddr_storage *at)
{
	struct sockaddr_in v4 = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
	struct sockaddr_in6 v6 = {.sin6_family = AF_INET6, .sin6_port = htons((uint16_t)port)};

	if (inet_pton(AF_INET, address, &v4.sin_addr) == 1)
		memcpy(at, &v4, sizeof(v4));
	else if (inet_pton(AF_INET6, address, &v6.sin6_addr) == 1)
		memcpy(at, &v6, sizeof(v6));
	else
		TEST_FAIL_MESSAGE(address);
}

/* The port of all of them is 4304, 10D0, and that of who asks 40000, 9C40. */
static int user_at(const char *address)
{
	struct sockaddr_storage at, from;
	uid_t user = 0;
	int err;

	make_address(address, 4304, &at);
	make_address(address, 40000, &from);
	err = listener_user(folder, (struct sockaddr *)&at, (struct sockaddr *)&from, &user);
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

static void test_a_mapped_address_is_that_of_the_fourth_version(void)
{
	write_file("tcp", ROW("0100007F:10D0", "0A", "1001"));
	TEST_ASSERT_EQUAL(1001, user_at("::ffff:127.0.0.1"));
}

static void test_who_has_taken_the_connection_and_listens_no_more_counts(void)
{
	write_file("tcp",
	           ROW("0100007F:1234", "0A", "5") FROM_TO("0100007F:10D0", "0100007F:9C41", "01",
	                                                   "7", "12")
	                   FROM_TO("0100007F:9C40", "0100007F:10D0", "01", "8", "13")
	                           FROM_TO("0100007F:10D0", "0100007F:9C40", "01", "1001", "14"));
	TEST_ASSERT_EQUAL(1001, user_at("127.0.0.1"));
	/* a socket that has answered and is closed has no user any more */
	write_file("tcp", FROM_TO("0100007F:10D0", "0100007F:9C40", "05", "0", "0"));
	TEST_ASSERT_EQUAL(-ECONNREFUSED, user_at("127.0.0.1"));
	write_file("tcp6", FROM_TO("00000000000000000000000001000000:10D0",
	                           "00000000000000000000000001000000:9C40", "01", "1002", "15"));
	TEST_ASSERT_EQUAL(1002, user_at("::1"));
	/* nobody has taken it yet: who listens will */
	write_file("tcp", ROW("0100007F:10D0", "0A", "6")
	                          FROM_TO("0100007F:10D0", "0100007F:9C40", "01", "0", "0"));
	TEST_ASSERT_EQUAL(6, user_at("127.0.0.1"));
}

#endif

static void test_behind_too_many_sockets_nobody_is_believed(void)
{
	static char many[20000 * sizeof(ROW("0200007F:2222", "0A", "1001"))];
	const char row[] = ROW("0200007F:2222", "0A", "1001");

	for (size_t i = 0; i < 20000; i++)
		memcpy(many + i * (sizeof(row) - 1), row, sizeof(row));
	write_file("tcp", many);
	TEST_ASSERT_EQUAL(-ECONNREFUSED, user_at("127.0.0.1"));
}

static void test_only_who_listens_counts(void)
{
	write_file("tcp", ROW("0100007F:10D0", "01", "1001"));
	write_file("tcp6", "nothing of this form\n");
	TEST_ASSERT_EQUAL(-ENOENT, user_at("127.0.0.1"));
	TEST_ASSERT_EQUAL(-ENOENT, user_at("::1"));
}

static void test_another_machine_has_no_user_here_and_a_socket_to_itself_is_nobody(void)
{
	struct sockaddr_storage at, from;
	uid_t user;

	write_file("tcp", ROW("00000000:10D0", "0A", "1001"));
	make_address("192.0.2.7", 4304, &at);
	make_address("192.0.2.8", 40000, &from);
	TEST_ASSERT_EQUAL(-ENOENT, listener_user(folder, (struct sockaddr *)&at,
	                                         (struct sockaddr *)&from, &user));
	TEST_ASSERT_EQUAL(1001, user_at("192.0.2.7"));
	/* the kernel's choice for all that begin with 127 */
	make_address("127.0.0.5", 4304, &at);
	make_address("127.0.0.1", 40000, &from);
	TEST_ASSERT_EQUAL(
		0, listener_user(folder, (struct sockaddr *)&at, (struct sockaddr *)&from, &user));
	TEST_ASSERT_EQUAL(-ECONNREFUSED, listener_user(folder, (struct sockaddr *)&at,
	                                               (struct sockaddr *)&at, &user));
}

static void test_without_the_files_nobody_is_known(void)
{
	TEST_ASSERT_EQUAL(-ENOENT, user_at("127.0.0.1"));
}

/* Thousands of sockets of whatever else is tested here would hide this one. */
static void enter_own_network(void)
{
	struct ifreq lo = {.ifr_name = "lo", .ifr_flags = IFF_UP};
	int fd;

	if (unshare(CLONE_NEWNET))
		return; /* not root: among all others */
	fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
	TEST_ASSERT_EQUAL(0, ioctl(fd, SIOCSIFFLAGS, &lo));
	close(fd);
}

static void test_a_connection_to_this_program_is_its_users_also_without_the_listener(void)
{
	struct sockaddr_in at = {.sin_family = AF_INET, .sin_addr = {htonl(INADDR_LOOPBACK)}}, from;
	socklen_t len = sizeof(at), from_len = sizeof(from);
	struct sockaddr *there = (struct sockaddr *)&at, *here = (struct sockaddr *)&from;
	uid_t user = 12345;
	int fd, client, taken;

	enter_own_network();
	fd = socket(AF_INET, SOCK_STREAM, 0);
	client = socket(AF_INET, SOCK_STREAM, 0);
	TEST_ASSERT_EQUAL(0, bind(fd, there, len));
	TEST_ASSERT_EQUAL(0, listen(fd, 1));
	TEST_ASSERT_EQUAL(0, getsockname(fd, there, &len));
	TEST_ASSERT_EQUAL(0, connect(client, there, len));
	TEST_ASSERT_EQUAL(0, getsockname(client, here, &from_len));
	TEST_ASSERT_EQUAL(0, listener_user("/proc/self/net", there, here, &user));
	TEST_ASSERT_EQUAL(geteuid(), user);
	taken = accept(fd, NULL, NULL);
	close(fd);
	user = 12345;
	TEST_ASSERT_EQUAL(0, listener_user("/proc/self/net", there, here, &user));
	TEST_ASSERT_EQUAL(geteuid(), user);
	close(taken);
	TEST_ASSERT_EQUAL(-ECONNREFUSED, listener_user("/proc/self/net", there, here, &user));
	close(client);
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
	RUN_TEST(test_a_mapped_address_is_that_of_the_fourth_version);
	RUN_TEST(test_who_has_taken_the_connection_and_listens_no_more_counts);
#endif
	RUN_TEST(test_only_who_listens_counts);
	RUN_TEST(test_another_machine_has_no_user_here_and_a_socket_to_itself_is_nobody);
	RUN_TEST(test_without_the_files_nobody_is_known);
	RUN_TEST(test_behind_too_many_sockets_nobody_is_believed);
	RUN_TEST(test_a_connection_to_this_program_is_its_users_also_without_the_listener);
	RUN_TEST(test_people_are_not_trusted);
	return UNITY_END();
}
