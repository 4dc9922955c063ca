/* SPDX-License-Identifier: MIT */
/* Tests of the profile homie5: its description, the order of states, values, alerts. */
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/published.h"

static const struct instance_signal signals[] = {
	{"room", "/28.000000000001/temperature", OWS_DOUBLE, false, 4 * INSTANCE_S,
         "28.000000000001"},
	{"level", "/28.1/x", OWS_SHORT, true, 0, ""},
	{"lamp", "/29.000000000001/PIO.0", OWS_BOOL, true, 0, "29.000000000001"},
	{"title", "/29.1/type", OWS_STRING, false, 0, ""},
};
enum { ROOM, LEVEL, LAMP, TITLE, COUNT };
#define AT "homie/5/owsd-pi/"
#define DESCRIPTION AT "$description"

static struct published p;

void setUp(void)
{
	published_start(&p, signals, COUNT, &profile_homie5);
}

void tearDown(void)
{
	published_end(&p);
}

/* The part of the description that is of a signal. */
static const char *property(const char *name)
{
	static char text[400];
	char key[80];
	const char *all, *at;

	stream_begin(&p.s);
	published_pump(&p);
	all = published_at(&p, DESCRIPTION);
	TEST_ASSERT_NOT_NULL(all);
	snprintf(key, sizeof(key), "\"%s\":{\"name\"", name);
	at = strstr(all, key);
	TEST_ASSERT_NOT_NULL_MESSAGE(at, all);
	snprintf(text, sizeof(text), "%.*s", (int)strcspn(at, "}"), at);
	return text;
}

static void says(const char *name, const char *words)
{
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(property(name), words), property(name));
}

static void test_a_birth_is_init_then_the_description_then_values_then_ready(void)
{
	const char *said, *init, *description, *value, *ready;

	instance_put_double(&p.in, ROOM + 1, 21.5, ows_now());
	said = published_pump(&p);
	init = strstr(said, AT "$state init\n");
	description = strstr(said, DESCRIPTION " {\"homie\":\"5.0\",\"name\":\"owsd pi\"");
	value = strstr(said, "/temperature 21.5\n");
	ready = strstr(said, AT "$state ready\n");
	TEST_ASSERT_EQUAL_PTR(said, init);
	TEST_ASSERT_TRUE(init < description && description < value && value < ready);
	TEST_ASSERT_EQUAL_STRING("", ready + strlen(AT "$state ready\n"));
}

static void test_a_birth_that_has_no_room_goes_on_where_it_stopped(void)
{
	p.room = 1;
	TEST_ASSERT_EQUAL_STRING(AT "$state init\n", published_pump(&p));
	TEST_ASSERT_EQUAL_STRING("", published_pump(&p));
	p.room = 1;
	published_pump(&p);
	TEST_ASSERT_NOT_NULL(published_at(&p, DESCRIPTION));
	TEST_ASSERT_NULL(published_at(&p, AT "$state"));
	p.room = 100;
	published_pump(&p);
	TEST_ASSERT_NULL(published_at(&p, DESCRIPTION));
	TEST_ASSERT_EQUAL_STRING("ready", published_at(&p, AT "$state"));
}

static void test_types_are_those_of_homie(void)
{
	says("temperature", "\"datatype\":\"float\"");
	says("28-1-x", "\"datatype\":\"integer\"");
	says("pio-0", "\"datatype\":\"boolean\"");
	says("29-1-type", "\"datatype\":\"string\"");
}

static void test_an_output_is_settable_where_commands_are_taken_alone(void)
{
	says("temperature", "\"settable\":false,\"retained\":true");
	says("pio-0", "\"settable\":true");
	p.s.write = false;
	stream_announce(&p.s, true);
	says("pio-0", "\"settable\":false");
}

/* A bound that is not configured is that of the type, of whole numbers that are set alone. */
static void test_a_format_has_the_bounds_that_hold(void)
{
	TEST_ASSERT_NULL(strstr(property("temperature"), "\"format\""));
	says("28-1-x", "\"format\":\"-32768:32767\"");
	TEST_ASSERT_NULL(strstr(property("pio-0"), "\"format\""));
	p.s.rows[ROOM].info.min = -10.5;
	says("temperature", "\"format\":\"-10.5:\"");
	p.s.rows[ROOM].info.max = 1e20;
	/* Homie has no sign '+' in an exponent */
	says("temperature", "\"format\":\"-10.5:1e20\"");
	p.s.rows[ROOM].info.min = 0;
	p.s.rows[ROOM].info.max = 1e14;
	says("temperature", "\"format\":\"0:100000000000000\"");
	p.s.rows[LEVEL].info.max = 100;
	says("28-1-x", "\"format\":\"-32768:100\"");
	p.s.write = false;
	says("28-1-x", "\"format\":\":100\"");
}

static void test_a_chip_is_a_node_and_what_has_none_stands_in_one_of_its_own(void)
{
	const char *all;

	published_pump(&p);
	all = published_at(&p, DESCRIPTION);
	TEST_ASSERT_NOT_NULL(strstr(all,
	                            "\"28-000000000001\":{\"name\":\"DS18B20 28.000000000001\","
	                            "\"type\":\"DS18B20\",\"properties\":{\"temperature\":"));
	TEST_ASSERT_NOT_NULL(strstr(all, "\"signals\":{\"name\":"));
	TEST_ASSERT_EQUAL_STRING(AT "signals/28-1-x", p.s.rows[LEVEL].topic);
	TEST_ASSERT_EQUAL_STRING(AT "28-000000000001/temperature", p.s.rows[ROOM].topic);
}

static void test_an_empty_text_is_a_byte_0_as_an_empty_message_would_empty_the_topic(void)
{
	instance_put_text(&p.in, TITLE + 1, "", ows_now());
	published_pump(&p);
	/* the byte ends what the outlet kept of it as text */
	TEST_ASSERT_NOT_NULL(published_at(&p, AT "signals/29-1-type"));
	TEST_ASSERT_TRUE(p.s.rows[TITLE].good);
}

static void test_a_bad_value_empties_its_topic_and_an_alert_says_why_until_it_is_good(void)
{
	instance_put_double(&p.in, ROOM + 1, 21.5, ows_now());
	published_pump(&p);
	TEST_ASSERT_EQUAL_STRING("", published_at(&p, AT "$alert/room"));
	instance_put_double(&p.in, ROOM + 1, 85, ows_now() - 10 * INSTANCE_S);
	TEST_ASSERT_EQUAL_STRING(AT "28-000000000001/temperature \n" AT "$alert/room room: stale\n",
	                         published_change(&p, ROOM));
	TEST_ASSERT_EQUAL_STRING("", published_change(&p, ROOM));
	instance_put_double(&p.in, ROOM + 1, 22, ows_now());
	TEST_ASSERT_EQUAL_STRING(AT "28-000000000001/temperature 22\n" AT "$alert/room \n",
	                         published_change(&p, ROOM));
}

static void test_an_output_that_nobody_has_set_yet_has_no_alert(void)
{
	struct ows_sample sample = {.quality = OWS_Q_INITIAL};
	struct ows_attrs attrs = {0};

	image_publish(&p.in.image, LAMP + 1, &sample, &attrs, NULL);
	published_pump(&p);
	TEST_ASSERT_EQUAL_STRING("", published_at(&p, AT "$alert/lamp"));
	TEST_ASSERT_EQUAL_STRING("", published_at(&p, AT "29-000000000001/pio-0"));
}

static void test_a_bool_is_true_or_false(void)
{
	instance_put(&p.in, LAMP + 1, 1, ows_now());
	published_pump(&p);
	TEST_ASSERT_EQUAL_STRING("true", published_at(&p, AT "29-000000000001/pio-0"));
	instance_put(&p.in, LAMP + 1, 0, ows_now());
	published_change(&p, LAMP);
	TEST_ASSERT_EQUAL_STRING("false", published_at(&p, AT "29-000000000001/pio-0"));
}

static void test_the_state_tells_an_owsd_that_is_lost_from_an_end(void)
{
	static const struct {
		enum stream_node node;
		const char *state;
	} states[] = {{STREAM_THERE, "ready"},
	              {STREAM_LOST, "lost"},
	              {STREAM_KILLED, "lost"},
	              {STREAM_ENDED, "disconnected"}};

	for (unsigned i = 0; i < sizeof(states) / sizeof(states[0]); i++) {
		p.said[0] = '\0';
		TEST_ASSERT_TRUE(p.s.profile->state(&p.s, states[i].node));
		TEST_ASSERT_EQUAL_STRING(states[i].state, published_at(&p, AT "$state"));
	}
}

static void test_of_what_the_broker_keeps_what_is_there_now_is_left(void)
{
	static const struct {
		const char *topic;
		bool ours;
	} kept[] = {{AT "$state", true},
	            {DESCRIPTION, true},
	            {AT "$alert/room", true},
	            {AT "$alert/gone", false},
	            {AT "$alert/roo", false},
	            {AT "28-000000000001/temperature", true},
	            {AT "28-000000000001/gone", false},
	            {AT "29-000000000001/room", false}};

	for (unsigned i = 0; i < sizeof(kept) / sizeof(kept[0]); i++)
		TEST_ASSERT_EQUAL_MESSAGE(
			kept[i].ours,
			p.s.profile->writes(&p.s, kept[i].topic, kept[i].topic + strlen(AT)),
			kept[i].topic);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_birth_is_init_then_the_description_then_values_then_ready);
	RUN_TEST(test_a_birth_that_has_no_room_goes_on_where_it_stopped);
	RUN_TEST(test_types_are_those_of_homie);
	RUN_TEST(test_an_output_is_settable_where_commands_are_taken_alone);
	RUN_TEST(test_a_format_has_the_bounds_that_hold);
	RUN_TEST(test_a_chip_is_a_node_and_what_has_none_stands_in_one_of_its_own);
	RUN_TEST(test_an_empty_text_is_a_byte_0_as_an_empty_message_would_empty_the_topic);
	RUN_TEST(test_a_bad_value_empties_its_topic_and_an_alert_says_why_until_it_is_good);
	RUN_TEST(test_an_output_that_nobody_has_set_yet_has_no_alert);
	RUN_TEST(test_a_bool_is_true_or_false);
	RUN_TEST(test_the_state_tells_an_owsd_that_is_lost_from_an_end);
	RUN_TEST(test_of_what_the_broker_keeps_what_is_there_now_is_left);
	return UNITY_END();
}
