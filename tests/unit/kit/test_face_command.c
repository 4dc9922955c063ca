/* SPDX-License-Identifier: MIT */
/* Tests of how old a command may be, of what it sets, and of the words of a refusal. */
#include <errno.h>
#include <math.h>
#include <string.h>

#include "unity.h"

#include "src/faces/kit/command.h"
#include "src/ground/service/command_age.h"
#include "src/ground/signal/value.h"
#include "tests/unit/aid/instance.h"

static const struct instance_signal signals[] = {
	{"relay", "/29.1/PIO.0", OWS_BOOL, true, 0, "29.000000000001"},
	{"setting", "/29.1/set", OWS_DOUBLE, true, 0, NULL},
};
enum { RELAY, SETTING, COUNT };

static struct instance in;
static struct ows *ows;
static struct face_command command;
static struct ows_info info;

void setUp(void)
{
	instance_start(&in, "face_command", signals, COUNT);
	TEST_ASSERT_EQUAL_INT(0, ows_open_as(in.name, OWS_CONTROL, "test", &ows));
	memset(&info, 0, sizeof(info));
	command = (struct face_command){.program = "owsd-test",
	                                .instance = in.name,
	                                .name = "relay",
	                                .text = "1",
	                                .person = "anna",
	                                .came_ns = ows_now()};
}

void tearDown(void)
{
	ows_close(ows);
	instance_end(&in);
}

static int give(void)
{
	int id = face_command_find(ows, &command, &info);

	return id < 0 ? id : face_command_set(ows, &command, id, &info, NULL);
}

static void test_a_command_of_now_is_set_and_one_that_waited_is_not(void)
{
	int id;

	TEST_ASSERT_EQUAL_INT(0, give());
	TEST_ASSERT_EQUAL_INT64(1, instance_command(&in, 0, RELAY + 1).value);
	command.text = "0";
	command.came_ns = ows_now() - COMMAND_OLD_NS - 1;
	TEST_ASSERT_EQUAL_INT(-ETIME, give());
	command.came_ns = 0; /* not known */
	TEST_ASSERT_EQUAL_INT(-ETIME, give());
	TEST_ASSERT_EQUAL_INT64(1, instance_command(&in, 0, RELAY + 1).value);
	/* it waited behind the search */
	command.came_ns = ows_now();
	id = face_command_find(ows, &command, &info);
	command.came_ns = ows_now() - COMMAND_OLD_NS - 1;
	TEST_ASSERT_EQUAL_INT(-ETIME, face_command_set(ows, &command, id, &info, NULL));
	TEST_ASSERT_EQUAL_INT64(1, instance_command(&in, 0, RELAY + 1).value);
}

static void test_a_signal_is_read_each_time_that_somebody_asks(void)
{
	const struct ows_command_slot *slot = instance_slot(&in, 0, RELAY + 1);

	command.reads = true;
	command.text = NULL;
	TEST_ASSERT_EQUAL_INT(0, give());
	TEST_ASSERT_EQUAL_UINT32(OWS_STEP_READ, slot->dgn_reset);
	TEST_ASSERT_EQUAL_INT(0, give());
	TEST_ASSERT_EQUAL_UINT32(2 * OWS_STEP_READ, slot->dgn_reset);
	TEST_ASSERT_EQUAL_UINT32(0, slot->stamp);
	command.came_ns = ows_now() - COMMAND_OLD_NS - 1;
	TEST_ASSERT_EQUAL_INT(-ETIME, give());
	TEST_ASSERT_EQUAL_UINT32(2 * OWS_STEP_READ, slot->dgn_reset);
}

static void test_what_is_no_value_or_no_signal_is_refused(void)
{
	static const char *const wrong[] = {"", "2", "toggle", "1.5", "nan", NULL};

	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
		command.text = wrong[i];
		TEST_ASSERT_TRUE(give() == -EINVAL || give() == -ERANGE);
	}
	command.text = "1";
	command.name = "relay_WriteEnable";
	TEST_ASSERT_EQUAL_INT(-ENOENT, give());
	command.name = "nobody";
	TEST_ASSERT_EQUAL_INT(-ENOENT, give());
	command.name = "setting";
	TEST_ASSERT_EQUAL_INT(0, give());
}

/* Of a setting one more, and of the relay none that is 0. */
static int fit(void *ctx, int id, const struct ows_info *of, struct face_command *given)
{
	TEST_ASSERT_EQUAL_PTR(&in, ctx);
	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, id);
	if (of->type == OWS_DOUBLE)
		given->text = "4";
	return of->type == OWS_BOOL && *given->text == '0' ? -EDQUOT : 0;
}

static void test_a_face_may_fit_a_command_to_its_signal_or_refuse_it(void)
{
	struct face_way way = {0};

	TEST_ASSERT_EQUAL_INT(0, face_command_give(&way, &command, &info, fit, &in));
	TEST_ASSERT_EQUAL_INT64(1, instance_command(&in, 1, RELAY + 1).value);
	command.text = "0";
	TEST_ASSERT_EQUAL_INT(-EDQUOT, face_command_give(&way, &command, &info, fit, &in));
	TEST_ASSERT_EQUAL_INT64(1, instance_command(&in, 1, RELAY + 1).value);
	command.name = "setting";
	command.text = "3";
	TEST_ASSERT_EQUAL_INT(0, face_command_give(&way, &command, &info, fit, &in));
	TEST_ASSERT_EQUAL_STRING("3", command.text);
	TEST_ASSERT_EQUAL_INT64(value_of_double(4), instance_command(&in, 1, SETTING + 1).value);
	TEST_ASSERT_NOT_NULL(way.h);
	face_way_close(&way);
	TEST_ASSERT_NULL(way.h);
}

static void test_the_way_to_owsd_is_found_again_and_not_tried_all_the_time(void)
{
	struct face_way way = {0};

	TEST_ASSERT_EQUAL_INT(0, face_command_give(&way, &command, &info, NULL, NULL));
	instance_reload(&in, signals, COUNT);
	command.came_ns = ows_now();
	TEST_ASSERT_EQUAL_INT(0, face_command_give(&way, &command, &info, NULL, NULL));
	TEST_ASSERT_NOT_NULL(way.h);
	face_way_close(&way);
	command.instance = "nobody-has-this-name";
	way.open_ns = 0;
	TEST_ASSERT_EQUAL_INT(-ESTALE, face_command_give(&way, &command, &info, NULL, NULL));
	TEST_ASSERT_GREATER_THAN_INT64(ows_now(), way.open_ns);
	command.instance = in.name;
	TEST_ASSERT_EQUAL_INT(-ESTALE, face_command_give(&way, &command, &info, NULL, NULL));
	way.open_ns = 0;
	command.came_ns = ows_now();
	TEST_ASSERT_EQUAL_INT(0, face_command_give(&way, &command, &info, NULL, NULL));
	face_way_close(&way);
}

static void is(const char *expected, int err)
{
	char words[FACE_REFUSAL];

	TEST_ASSERT_EQUAL_STRING(expected, face_refusal(&command, &info, err, words));
}

static void test_a_refusal_has_what_was_sent_and_what_holds(void)
{
	command.text = "toggle";
	is("\"toggle\" is no value for it: expected another", -EINVAL);
	info = (struct ows_info){.name = "relay", .type = OWS_BOOL, .min = NAN, .max = NAN};
	is("\"toggle\" is no value for it: expected 0 or 1", -EINVAL);
	info = (struct ows_info){.name = "dial", .type = OWS_BYTE, .min = NAN, .max = 200};
	command.text = "201";
	is("\"201\" is no value for it: expected 0 to 200", -ERANGE);
	command.text = NULL;
	is("\"\" is no value for it: expected 0 to 200", -EINVAL);
}

static void test_each_other_refusal_has_its_remedy(void)
{
	is("owsd refuses owsd-test: add its user to the group owsd-control and start it again, or "
	   "name it in ControlAllow",
	   -EACCES);
	is("it may have waited for longer than 2 seconds: give it again", -ETIME);
	is("owsd does not answer: does it run?", -ESTALE);
	is("owsd does not answer: does it run?", -ETIMEDOUT);
	is("there is no such signal", -ENOENT);
	is("it is an input: Writable is off in the configuration", -EROFS);
	is("too many commands or programs: try again in a second", -EAGAIN);
	is("the wire is short: data is held at ground: unplug branches until the wire lives again",
	   -ECOMM);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_command_of_now_is_set_and_one_that_waited_is_not);
	RUN_TEST(test_a_signal_is_read_each_time_that_somebody_asks);
	RUN_TEST(test_what_is_no_value_or_no_signal_is_refused);
	RUN_TEST(test_a_face_may_fit_a_command_to_its_signal_or_refuse_it);
	RUN_TEST(test_the_way_to_owsd_is_found_again_and_not_tried_all_the_time);
	RUN_TEST(test_a_refusal_has_what_was_sent_and_what_holds);
	RUN_TEST(test_each_other_refusal_has_its_remedy);
	return UNITY_END();
}
