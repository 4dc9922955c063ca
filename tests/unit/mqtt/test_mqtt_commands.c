/* SPDX-License-Identifier: MIT */
/* Tests of how long a refused command counts as what is wrong now. */
#include <errno.h>

#include "unity.h"

#include "src/faces/mqtt/commands.h"
#include "src/faces/mqtt/stream.h"

#define START (100 * NS_PER_S)

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_a_refused_command_is_trouble_for_a_minute(void)
{
	static struct stream stream;
	static struct broker_message empty = {.topic = "o/pi/relay/set", .text = ""};
	static struct commands c = {.stream = &stream};

	TEST_ASSERT_EQUAL_STRING("", commands_trouble(&c, START));
	c.log = log_create(LOG_LEVEL_ERR);
	TEST_ASSERT_EQUAL_INT(
		-EINVAL, commands_take(&c, "relay", true, COMMANDS_VALUE, &empty, "mqtt:x", START));
	TEST_ASSERT_EQUAL_STRING("command to \"relay\" refused: it is empty",
	                         commands_trouble(&c, START));
	TEST_ASSERT_EQUAL_STRING("command to \"relay\" refused: it is empty",
	                         commands_trouble(&c, START + COMMANDS_TROUBLE_NS - 1));
	TEST_ASSERT_EQUAL_STRING("", commands_trouble(&c, START + COMMANDS_TROUBLE_NS));
	TEST_ASSERT_EQUAL_UINT64(1, c.refused);
	log_destroy(c.log);
}

static void test_a_topic_of_a_stranger_stays_between_its_quotes(void)
{
	static struct commands c;

	c.log = log_create(LOG_LEVEL_ERR);
	commands_refuse(&c, "x\" is on fire, run \"y", "there is no such signal", START);
	TEST_ASSERT_EQUAL_STRING(
		"command to \"x' is on fire, run 'y\" refused: there is no such signal",
		commands_trouble(&c, START));
	log_destroy(c.log);
}

static void test_who_has_a_signal_read_need_send_nothing(void)
{
	static struct stream stream;
	static struct broker_message message = {.topic = "o/pi/room/read", .text = ""};
	static struct commands c = {.stream = &stream};

	c.log = log_create(LOG_LEVEL_ERR);
	/* there is no owsd */
	TEST_ASSERT_EQUAL_INT(
		-ESTALE, commands_take(&c, "room", true, COMMANDS_READ, &message, "mqtt:x", START));
	TEST_ASSERT_NULL(c.ask.value);
	message.text = "{\"id\":7}";
	message.len = 8;
	TEST_ASSERT_EQUAL_INT(
		-ESTALE, commands_take(&c, "room", true, COMMANDS_READ, &message, "mqtt:x", START));
	TEST_ASSERT_NOT_NULL(c.ask.id);
	message.retained = true;
	TEST_ASSERT_EQUAL_INT(
		-EINVAL, commands_take(&c, "room", true, COMMANDS_READ, &message, "mqtt:x", START));
	log_destroy(c.log);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_refused_command_is_trouble_for_a_minute);
	RUN_TEST(test_a_topic_of_a_stranger_stays_between_its_quotes);
	RUN_TEST(test_who_has_a_signal_read_need_send_nothing);
	return UNITY_END();
}
