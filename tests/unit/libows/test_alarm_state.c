/* SPDX-License-Identifier: MIT */
/* How the alarms of a signal stand, as a consumer sees it, and its acknowledgement. */
#include <errno.h>

#include "unity.h"

#include "tests/unit/aid/instance.h"

static const struct instance_signal signals[] = {
	{"room1", "/28.1/temperature", OWS_DOUBLE, false, 0},
	{"door", "/29.1/sensed.BYTE", OWS_BYTE, false, 0},
};
enum { ROOM = 1, DOOR };

static struct instance in;
static struct ows *h;

void setUp(void)
{
	instance_start(&in, "state", signals, 2);
	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_CONTROL, &h));
}

void tearDown(void)
{
	ows_close(h);
	instance_end(&in);
}

static void publish(uint32_t record, const struct ows_attrs *attrs)
{
	struct ows_sample sample = {.quality = OWS_Q_GOOD};

	image_publish(&in.image, record, &sample, attrs, NULL);
}

static void test_a_signal_without_alarms_has_nothing_to_tell(void)
{
	struct ows_alarm_state state;

	publish(ROOM, &(struct ows_attrs){0});
	TEST_ASSERT_EQUAL(0, ows_alarm_state(h, ows_find(h, "room1"), &state));
	TEST_ASSERT_EQUAL(0, state.occurrences);
	TEST_ASSERT_FALSE(state.item || state.stands || state.polled || state.limits ||
	                  state.unarmed);
	TEST_ASSERT_EQUAL(OWS_LIMIT_NORMAL, state.limit_state);
	TEST_ASSERT_EQUAL(0, state.limit_kind);
}

static void test_the_state_is_told_as_it_was_published(void)
{
	struct ows_alarm_state state;

	publish(DOOR, &(struct ows_attrs){
			      .alarms = 7,
			      .flags = OWS_ATTR_LIMITS | OWS_ATTR_ALARM_STANDS |
	                               OWS_ATTR_ALARM_POLLED | OWS_ATTR_ALARM_UNARMED,
			      .limit_state = OWS_LIMIT_RETURNED,
			      .limit_condition = OWS_ALARM_LL,
		      });
	TEST_ASSERT_EQUAL(0, ows_alarm_state(h, ows_find(h, "door_Age"), &state));
	TEST_ASSERT_EQUAL(7, state.occurrences);
	TEST_ASSERT_TRUE(state.limits && state.stands && state.polled && state.unarmed &&
	                 !state.item);
	TEST_ASSERT_EQUAL(OWS_LIMIT_RETURNED, state.limit_state);
	TEST_ASSERT_EQUAL(OWS_ALARM_LL, state.limit_kind);
}

static void test_owsd_itself_has_no_alarms(void)
{
	struct ows_alarm_state state;
	int driver = ows_find(h, "_TRANSACTIONS");

	TEST_ASSERT_GREATER_OR_EQUAL(0, driver);
	TEST_ASSERT_EQUAL(-ENOENT, ows_alarm_state(h, driver, &state));
	TEST_ASSERT_EQUAL(-ENOENT, ows_acknowledge(h, driver));
	TEST_ASSERT_EQUAL(-ENOENT, ows_acknowledge(h, 99));
	TEST_ASSERT_EQUAL(-ENOENT, ows_acknowledge(h, -1));
}

static void test_an_acknowledgement_reaches_the_engines_side(void)
{
	struct controller_command command;

	TEST_ASSERT_EQUAL(0, ows_acknowledge(h, ows_find(h, "door")));
	TEST_ASSERT_TRUE(controller_marked(instance_controller(&in, 0)));
	TEST_ASSERT_EQUAL(DOOR, controller_next_dirty(instance_controller(&in, 0), 0));
	TEST_ASSERT_EQUAL(-1, controller_next_dirty(instance_controller(&in, 0), 0));
	command = instance_command(&in, 0, DOOR);
	TEST_ASSERT_TRUE(command.acknowledged);
	TEST_ASSERT_EQUAL(0, command.stamp);
	TEST_ASSERT_FALSE(instance_command(&in, 0, ROOM).acknowledged);
	TEST_ASSERT_FALSE(instance_command(&in, 0, DOOR).acknowledged);
	TEST_ASSERT_EQUAL(0, ows_acknowledge(h, ows_find(h, "door")));
	TEST_ASSERT_TRUE(instance_command(&in, 0, DOOR).acknowledged);
}

static void test_who_may_only_look_acknowledges_nothing(void)
{
	struct ows *reader;

	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_READ, &reader));
	TEST_ASSERT_EQUAL(-EACCES, ows_acknowledge(reader, ows_find(reader, "door")));
	ows_close(reader);
}

static void test_what_came_too_late_is_said(void)
{
	struct ows_alarm_state state;

	publish(ROOM, &(struct ows_attrs){.flags = OWS_ATTR_LIMITS});
	image_state(&in.image, OWS_STATE_RETIRED);
	controller_state(instance_controller(&in, 0), OWS_STATE_RETIRED);
	TEST_ASSERT_EQUAL(-ESTALE, ows_acknowledge(h, ows_find(h, "door")));
	TEST_ASSERT_EQUAL(-ESTALE, ows_alarm_state(h, ows_find(h, "room1"), &state));
	TEST_ASSERT_TRUE(state.limits);
}

static void test_every_state_has_a_word(void)
{
	TEST_ASSERT_EQUAL_STRING("normal", ows_limit_state_text(OWS_LIMIT_NORMAL));
	TEST_ASSERT_EQUAL_STRING("unacknowledged", ows_limit_state_text(OWS_LIMIT_UNACKNOWLEDGED));
	TEST_ASSERT_EQUAL_STRING("acknowledged", ows_limit_state_text(OWS_LIMIT_ACKNOWLEDGED));
	TEST_ASSERT_EQUAL_STRING("returned to normal unacknowledged",
	                         ows_limit_state_text(OWS_LIMIT_RETURNED));
	TEST_ASSERT_EQUAL_STRING("unknown", ows_limit_state_text(4));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_signal_without_alarms_has_nothing_to_tell);
	RUN_TEST(test_the_state_is_told_as_it_was_published);
	RUN_TEST(test_owsd_itself_has_no_alarms);
	RUN_TEST(test_an_acknowledgement_reaches_the_engines_side);
	RUN_TEST(test_who_may_only_look_acknowledges_nothing);
	RUN_TEST(test_what_came_too_late_is_said);
	RUN_TEST(test_every_state_has_a_word);
	return UNITY_END();
}
