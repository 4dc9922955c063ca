/* SPDX-License-Identifier: MIT */
/* Tests of the profile wirenboard: what a control says of itself, its error, its alarm. */
#include <math.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/published.h"

static const struct instance_signal signals[] = {
	{"room", "/28.1/temperature", OWS_DOUBLE, false, 4 * INSTANCE_S, "28.000000000001"},
	{"level", "/28.1/x", OWS_SHORT, true, 0, ""},
	{"lamp", "/29.1/PIO.0", OWS_BOOL, true, 0, "29.000000000001"},
	{"title", "/29.1/type", OWS_STRING, false, 0, ""},
};
enum { ROOM, LEVEL, LAMP, TITLE, COUNT };
#define AT "/devices/owsd_pi/"
#define CONTROL AT "controls/"

static struct published p;

void setUp(void)
{
	published_start(&p, signals, COUNT, &profile_wirenboard);
}

void tearDown(void)
{
	published_end(&p);
}

static void says(const char *name, const char *meta)
{
	char topic[80];

	snprintf(topic, sizeof(topic), CONTROL "%s/meta", name);
	stream_begin(&p.s);
	published_pump(&p);
	TEST_ASSERT_EQUAL_STRING(meta, published_at(&p, topic));
}

static void test_each_signal_is_a_control_in_the_order_of_the_file(void)
{
	says("room",
	     "{\"type\":\"value\",\"order\":1,\"readonly\":true,\"title\":{\"en\":\"room\"}}");
	says("level", "{\"type\":\"value\",\"precision\":1,\"order\":2,\"readonly\":false,"
	              "\"title\":{\"en\":\"level\"}}");
	says("lamp",
	     "{\"type\":\"switch\",\"order\":3,\"readonly\":false,\"title\":{\"en\":\"lamp\"}}");
	says("title",
	     "{\"type\":\"text\",\"order\":4,\"readonly\":true,\"title\":{\"en\":\"title\"}}");
	p.s.write = false;
	says("lamp",
	     "{\"type\":\"switch\",\"order\":3,\"readonly\":true,\"title\":{\"en\":\"lamp\"}}");
}

static void test_members_of_meta_have_topics_of_their_own_if_that_is_wanted(void)
{
	p.s.old_readers = true;
	says("level", "{\"type\":\"value\",\"precision\":1,\"order\":2,\"readonly\":false,"
	              "\"title\":{\"en\":\"level\"}}");
	TEST_ASSERT_EQUAL_STRING("value", published_at(&p, CONTROL "level/meta/type"));
	TEST_ASSERT_EQUAL_STRING("1", published_at(&p, CONTROL "level/meta/precision"));
	TEST_ASSERT_EQUAL_STRING("2", published_at(&p, CONTROL "level/meta/order"));
	TEST_ASSERT_EQUAL_STRING("0", published_at(&p, CONTROL "level/meta/readonly"));
	TEST_ASSERT_EQUAL_STRING("1", published_at(&p, CONTROL "room/meta/readonly"));
	TEST_ASSERT_EQUAL_STRING("owsd pi", published_at(&p, AT "meta/name"));
	/* they stay as long as they are wanted */
	profiles_kept(&p.s, CONTROL "level/meta/type", "value");
	profiles_kept(&p.s, AT "meta/name", "owsd pi");
	TEST_ASSERT_EQUAL_STRING("", published_pump(&p));
	/* and no longer: a member that the control has no more, or never had */
	profiles_kept(&p.s, CONTROL "level/meta/units", "V");
	TEST_ASSERT_EQUAL_STRING(CONTROL "level/meta/units \n", published_pump(&p));
	profiles_kept(&p.s, CONTROL "lamp/meta/precision", "1");
	TEST_ASSERT_EQUAL_STRING(CONTROL "lamp/meta/precision \n", published_pump(&p));
	profiles_kept(&p.s, CONTROL "level/meta/title", "level");
	TEST_ASSERT_EQUAL_STRING(CONTROL "level/meta/title \n", published_pump(&p));
	profiles_kept(&p.s, AT "meta/driver", "owsd");
	TEST_ASSERT_EQUAL_STRING(AT "meta/driver \n", published_pump(&p));
	p.s.old_readers = false;
	profiles_kept(&p.s, CONTROL "level/meta/type", "value");
	TEST_ASSERT_EQUAL_STRING(CONTROL "level/meta/type \n", published_pump(&p));
	profiles_kept(&p.s, AT "meta/name", "owsd pi");
	TEST_ASSERT_EQUAL_STRING(AT "meta/name \n", published_pump(&p));
	profiles_kept(&p.s, CONTROL "level/meta/error", "r");
	profiles_kept(&p.s, AT "meta/error", "r");
	TEST_ASSERT_EQUAL_STRING("", published_pump(&p));
}

static void test_units_are_those_of_the_conventions(void)
{
	static const struct {
		const char *ours, *theirs, *property;
	} units[] = {
		{"\302\260"
	         "C",
	         "deg C", "temperature"},
		{"\302\260", "deg", "temperature"},
		{"\316\251", "Ohm", "temperature"},
		{"m\302\263", "m^3", "temperature"},
		{"V", "V", "temperature"},
		{"%", "%", "temperature"},
		{"%", "%, RH", "HIH4000/humidity"},
	};
	char meta[160];

	for (unsigned i = 0; i < sizeof(units) / sizeof(units[0]); i++) {
		p.s.rows[ROOM].info.unit = units[i].ours;
		p.s.rows[ROOM].property = units[i].property;
		snprintf(meta, sizeof(meta),
		         "{\"type\":\"value\",\"units\":\"%s\",\"order\":1,\"readonly\":true,"
		         "\"title\":{\"en\":\"room\"}}",
		         units[i].theirs);
		says("room", meta);
	}
	/* of one that they do not know and cannot write nothing is said */
	p.s.rows[ROOM].info.unit = "\302\265S";
	says("room",
	     "{\"type\":\"value\",\"order\":1,\"readonly\":true,\"title\":{\"en\":\"room\"}}");
}

static void test_range_precision_and_description_go_along(void)
{
	struct ows_info *info = &p.s.rows[ROOM].info;

	info->min = -40;
	info->max = 125;
	info->decimals = 2;
	info->description = "the living room";
	says("room", "{\"type\":\"value\",\"min\":-40,\"max\":125,\"precision\":0.01,\"order\":1,"
	             "\"readonly\":true,\"title\":{\"en\":\"the living room\"}}");
	info->decimals = 0;
	info->max = NAN;
	says("room", "{\"type\":\"value\",\"min\":-40,\"precision\":1,\"order\":1,"
	             "\"readonly\":true,\"title\":{\"en\":\"the living room\"}}");
}

static void test_an_error_says_whether_it_is_of_reading_writing_or_time(void)
{
	static const struct {
		uint8_t quality;
		const char *error;
	} errors[] = {{OWS_Q_DIFFERS, "rw"},
	              {OWS_Q_NO_DEVICE, "r"},
	              {OWS_Q_INITIAL, "r"},
	              {OWS_Q_TARGET, "r"}};

	published_pump(&p);
	for (unsigned i = 0; i < sizeof(errors) / sizeof(errors[0]); i++) {
		struct ows_sample sample = {.quality = errors[i].quality, .count = 2 + i};
		struct ows_attrs attrs = {0};

		image_publish(&p.in.image, LAMP + 1, &sample, &attrs, NULL);
		published_change(&p, LAMP);
		TEST_ASSERT_EQUAL_STRING(errors[i].error,
		                         published_at(&p, CONTROL "lamp/meta/error"));
		TEST_ASSERT_NULL_MESSAGE(strstr(p.said, CONTROL "lamp 0"), p.said);
	}
	instance_put_double(&p.in, ROOM + 1, 85, ows_now() - 10 * INSTANCE_S);
	published_change(&p, ROOM);
	TEST_ASSERT_EQUAL_STRING("rp", published_at(&p, CONTROL "room/meta/error"));
}

static void test_a_bool_is_1_or_0(void)
{
	instance_put(&p.in, LAMP + 1, 1, ows_now());
	published_pump(&p);
	TEST_ASSERT_EQUAL_STRING("1", published_at(&p, CONTROL "lamp"));
	instance_put(&p.in, LAMP + 1, 0, ows_now());
	TEST_ASSERT_EQUAL_STRING(CONTROL "lamp 0\n", published_change(&p, LAMP));
}

/* The alarms are counted behind the signals, so that they stand below them. */
static void test_a_limit_alarm_is_a_control_beside_its_signal(void)
{
	p.s.rows[ROOM].alarms = true;
	instance_put_double(&p.in, ROOM + 1, 21, ows_now());
	published_pump(&p);
	TEST_ASSERT_EQUAL_STRING("{\"type\":\"alarm\",\"order\":5,\"readonly\":true,"
	                         "\"title\":{\"en\":\"room: alarm\"}}",
	                         published_at(&p, CONTROL "room__alarm/meta"));
	TEST_ASSERT_NULL(published_at(&p, CONTROL "level__alarm/meta"));
	TEST_ASSERT_EQUAL_STRING("0", published_at(&p, CONTROL "room__alarm"));
	TEST_ASSERT_EQUAL_STRING("", published_at(&p, CONTROL "room__alarm/meta/error"));
	/* of an owsd that is away it is not known whether the alarm stands */
	stream_live(&p.s, false);
	published_pump(&p);
	TEST_ASSERT_NULL(published_at(&p, CONTROL "room__alarm"));
	TEST_ASSERT_EQUAL_STRING("r", published_at(&p, CONTROL "room__alarm/meta/error"));
	TEST_ASSERT_EQUAL_STRING("r", published_at(&p, AT "meta/error"));
	stream_live(&p.s, true);
	published_pump(&p);
	TEST_ASSERT_EQUAL_STRING("", published_at(&p, AT "meta/error"));
}

static void test_a_control_that_has_no_room_comes_whole_later(void)
{
	for (unsigned i = 0; i < 60; i++) {
		p.room = 1;
		published_pump(&p);
		if (!*p.said)
			break;
		TEST_ASSERT_LESS_THAN_UINT(59, i);
	}
	p.room = 1000;
	TEST_ASSERT_EQUAL_STRING("", published_pump(&p));
	TEST_ASSERT_TRUE(p.s.announced);
}

static void test_of_what_the_broker_keeps_what_is_there_now_is_left(void)
{
	static const struct {
		const char *topic;
		bool ours;
	} kept[] = {{AT "meta", true},
	            {AT "meta/error", true},
	            {CONTROL "room", true},
	            {CONTROL "room/meta", true},
	            {CONTROL "room/meta/error", true},
	            {CONTROL "gone/meta", false},
	            {CONTROL "room__alarm/meta", true},
	            {CONTROL "level__alarm/meta", false},
	            {CONTROL "gone__alarm", false}};

	p.s.rows[ROOM].alarms = true;
	for (unsigned i = 0; i < sizeof(kept) / sizeof(kept[0]); i++)
		TEST_ASSERT_EQUAL_MESSAGE(
			kept[i].ours,
			p.s.profile->writes(&p.s, kept[i].topic, kept[i].topic + strlen(AT)),
			kept[i].topic);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_signal_is_a_control_in_the_order_of_the_file);
	RUN_TEST(test_members_of_meta_have_topics_of_their_own_if_that_is_wanted);
	RUN_TEST(test_units_are_those_of_the_conventions);
	RUN_TEST(test_range_precision_and_description_go_along);
	RUN_TEST(test_an_error_says_whether_it_is_of_reading_writing_or_time);
	RUN_TEST(test_a_bool_is_1_or_0);
	RUN_TEST(test_a_limit_alarm_is_a_control_beside_its_signal);
	RUN_TEST(test_a_control_that_has_no_room_comes_whole_later);
	RUN_TEST(test_of_what_the_broker_keeps_what_is_there_now_is_left);
	return UNITY_END();
}
