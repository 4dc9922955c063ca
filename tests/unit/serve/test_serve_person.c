/* SPDX-License-Identifier: MIT */
/* Who a client of the served protocol is, what he may write, and that his commands are his. */
#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "unity.h"

#include "src/config/read/config.h"
#include "src/daemon/serve/person.h"
#include "src/daemon/serve/signals.h"
#include "src/memory/shm/word.h"
#include "tests/unit/aid/folder.h"
#include "tests/unit/aid/instance.h"

#define RELAY 1
#define STRANGER 65533

static const struct instance_signal relay[] = {
	{.name = "relay", .path = "/29.551DDF030000/PIO.0", .type = OWS_BOOL, .output = true}};
static struct config_holder stranger = {.id = STRANGER};
static struct config_allow allows[] = {
	{.pattern = "pump_*", .holders = &stranger, .holder_count = 1},
	{.pattern = "valve", .holder_count = 0},
};
static struct config open_to_all, with = {.allows = allows, .allow_count = 2},
				  pumps = {.allows = allows, .allow_count = 1};
static struct instance in;
static struct signals *signals;
static struct signals_command given;

void setUp(void)
{
}

void tearDown(void)
{
}

static void start(void)
{
	struct ows_sample sample = {.quality = OWS_Q_GOOD, .measured_ns = ows_now()};
	struct ows_attrs attrs = {.flags = OWS_ATTR_WRITE_ENABLE};
	char name[24];

	snprintf(name, sizeof(name), "person-%d", (int)getpid());
	instance_start(&in, name, relay, 1);
	image_publish(&in.image, RELAY, &sample, &attrs, NULL);
	TEST_ASSERT_EQUAL_INT(0, signals_open(folder_dir()->path, in.name, &signals));
}

static void end(void)
{
	signals_close(signals);
	instance_end(&in);
}

static int set(const char *person, const char *name)
{
	return signals_write(signals, person, name, ows_now(), "1", 1, &given);
}

/* The first one, which owsd has still to welcome: on a busy machine one try is not enough. */
static int set_first(const char *person)
{
	int err = -EBUSY;

	for (int i = 0; i < 1000 && err == -EBUSY; i++)
		err = set(person, "relay");
	return err;
}

static void stands_for(const char *person)
{
	struct ows_command_slot *slot = instance_slot(&in, 0, RELAY);
	char text[OWS_NAME] = "";

	controller_person(instance_controller(&in, 0), word_get(&slot->person), text);
	TEST_ASSERT_EQUAL_STRING(person, text);
}

static void take(void)
{
	controller_taken(instance_controller(&in, 0), RELAY,
	                 word_get(&instance_slot(&in, 0, RELAY)->stamp), 0);
}

static void test_each_command_stands_for_the_client_that_gave_it(void)
{
	char person[OWS_NAME];

	start();
	for (int i = 0; i < 100; i++) {
		snprintf(person, sizeof(person), "10.0.0.%d", i % 40);
		TEST_ASSERT_EQUAL_INT(0, i ? set(person, "relay") : set_first(person));
		stands_for(person);
		take();
	}
	end();
}

/* owsd reads the value, then the person: a later client may not be put to an earlier value. */
static void test_a_command_waits_until_owsd_has_taken_that_of_another_client(void)
{
	start();
	TEST_ASSERT_EQUAL_INT(0, set_first("10.0.0.1"));
	TEST_ASSERT_EQUAL_INT(-EBUSY, set("10.0.0.2", "relay"));
	TEST_ASSERT_EQUAL_INT(-EBUSY, set("10.0.0.2", "relay_WriteOneShot"));
	stands_for("10.0.0.1");
	take();
	TEST_ASSERT_EQUAL_INT(0, set("10.0.0.2", "relay"));
	stands_for("10.0.0.2");
	end();
}

static void test_a_command_waits_while_owsd_has_not_welcomed_the_server(void)
{
	start();
	door_lie(in.door, DOOR_SILENT);
	TEST_ASSERT_EQUAL_INT(-EBUSY, set("10.0.0.1", "relay"));
	TEST_ASSERT_EQUAL_INT(-EBUSY, set("10.0.0.1", "relay"));
	end();
}

static void name_of(const char *address, const char *name)
{
	struct sockaddr_in v4 = {.sin_family = AF_INET};
	struct sockaddr_in6 v6 = {.sin6_family = AF_INET6};
	char text[OWS_NAME];

	if (inet_pton(AF_INET, address, &v4.sin_addr) == 1) {
		person_address((void *)&v4, text);
	} else {
		TEST_ASSERT_EQUAL_INT(1, inet_pton(AF_INET6, address, &v6.sin6_addr));
		person_address((void *)&v6, text);
	}
	TEST_ASSERT_EQUAL_STRING(name, text);
}

static void test_a_client_over_the_network_is_its_address(void)
{
	struct sockaddr none = {.sa_family = AF_UNSPEC};
	char text[OWS_NAME];

	name_of("192.168.1.5", "192.168.1.5");
	name_of("::1", "::1");
	name_of("::ffff:10.0.0.7", "10.0.0.7");
	name_of("2001:db8:1234:5678:9abc:def0:1234:5678", "...234:5678:9abc:def0:1234:5678");
	person_address(&none, text);
	TEST_ASSERT_EQUAL_STRING("unknown", text);
}

static void test_a_client_of_the_unix_socket_is_its_user(void)
{
	char text[OWS_NAME], expected[OWS_NAME];
	int pair[2];

	TEST_ASSERT_EQUAL_INT(0, socketpair(AF_UNIX, SOCK_STREAM, 0, pair));
	snprintf(expected, sizeof(expected), "user %lu", (unsigned long)getuid());
	person_name(pair[0], false, NULL, text);
	TEST_ASSERT_EQUAL_STRING(expected, text);
	close(pair[0]);
	close(pair[1]);
}

static void test_of_the_network_nobody_commands_what_a_pattern_fits(void)
{
	TEST_ASSERT_FALSE(person_may(&with, -1, true, "pump_1"));
	TEST_ASSERT_FALSE(person_may(&with, -1, true, "valve"));
	TEST_ASSERT_TRUE(person_may(&with, -1, true, "lamp"));
	TEST_ASSERT_TRUE(person_may(&open_to_all, -1, true, "pump_1"));
}

static void test_a_device_is_written_for_those_whom_every_entry_names(void)
{
	TEST_ASSERT_FALSE(person_may(&with, -1, true, NULL));
	TEST_ASSERT_TRUE(person_may(&open_to_all, -1, true, NULL));
}

static void test_at_the_unix_socket_the_user_counts(void)
{
	int own[2], strange[2];

	TEST_ASSERT_EQUAL_INT(0, socketpair(AF_UNIX, SOCK_STREAM, 0, own));
	TEST_ASSERT_TRUE(person_may(&with, own[0], false, "valve"));
	TEST_ASSERT_TRUE(person_may(&with, own[0], false, NULL));
	close(own[0]);
	close(own[1]);
	if (geteuid() != 0)
		return; /* only root makes a socket of somebody else */
	/* a pair has the credentials of its maker, of that moment */
	TEST_ASSERT_EQUAL_INT(0, seteuid(STRANGER));
	TEST_ASSERT_EQUAL_INT(0, socketpair(AF_UNIX, SOCK_STREAM, 0, strange));
	TEST_ASSERT_EQUAL_INT(0, seteuid(0));
	TEST_ASSERT_TRUE(person_may(&with, strange[0], false, "pump_1"));
	TEST_ASSERT_FALSE(person_may(&with, strange[0], false, "valve"));
	TEST_ASSERT_FALSE(person_may(&with, strange[0], false, NULL));
	TEST_ASSERT_TRUE(person_may(&pumps, strange[0], false, NULL));
	close(strange[0]);
	close(strange[1]);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_command_stands_for_the_client_that_gave_it);
	RUN_TEST(test_a_command_waits_until_owsd_has_taken_that_of_another_client);
	RUN_TEST(test_a_command_waits_while_owsd_has_not_welcomed_the_server);
	RUN_TEST(test_a_client_over_the_network_is_its_address);
	RUN_TEST(test_a_client_of_the_unix_socket_is_its_user);
	RUN_TEST(test_of_the_network_nobody_commands_what_a_pattern_fits);
	RUN_TEST(test_a_device_is_written_for_those_whom_every_entry_names);
	RUN_TEST(test_at_the_unix_socket_the_user_counts);
	return UNITY_END();
}
