/* SPDX-License-Identifier: MIT */
/*
 * Tests of an edge node whose broker takes messages now and then, of what it makes of commands, and
 * of texts that are no UTF-8. The judge of whole payloads is tests/system/test_mqtt_sparkplug.py.
 */
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/faces/mqtt/profiles.h"
#include "tests/unit/aid/instance.h"

#define S INSTANCE_S
#define GROUP "spBv1.0/plant/"
#define LAST 0x18 /* of a message: the tag of seq, the last field */

static const struct instance_signal signals[] = {
	{"room", "/28.000000000001/temperature", OWS_DOUBLE, false, 4 * S, "28.000000000001"},
	{"title", "/29.000000000001/type", OWS_STRING, false, 0, "29.000000000001"},
	{"relay", "/29000000000001/PIO", OWS_BOOL, true, 0, "29000000000001"},
	{"setting", "/settings/x", OWS_DOUBLE, false, 0, NULL},
};
enum { ROOM, TITLE, RELAY, SETTING, COUNT };

static struct instance in;
static struct ows *ows;
static struct stream s;
static char said[8192]; /* "TOPIC SEQ\n" of each message, without the prefix */
static char raw[8192];  /* the last message */
static size_t raw_len;
static char prefix[TOPIC_SIZE];
static int room; /* how many messages the outlet takes */
static bool dying;
static char taken[1024];

static bool put(void *ctx, const char *topic, const char *text, size_t len, bool retain)
{
	size_t at = strlen(said);
	unsigned seq = 0;

	(void)ctx;
	if (!room)
		return false;
	room--;
	if (retain) {
		snprintf(said + at, sizeof(said) - at, "%s emptied\n", topic);
		TEST_ASSERT_EQUAL_INT(0, len);
		return true;
	}
	TEST_ASSERT_TRUE(len > 3 && len < sizeof(raw));
	memcpy(raw, text, len);
	raw_len = len;
	if (dying) { /* it has no number */
	} else if (text[len - 2] == LAST) {
		seq = (unsigned char)text[len - 1];
	} else {
		TEST_ASSERT_EQUAL_UINT8(LAST, text[len - 3]);
		seq = ((unsigned char)text[len - 2] & 0x7fu) | (unsigned char)text[len - 1] << 7;
	}
	TEST_ASSERT_EQUAL_STRING_LEN(GROUP, topic, strlen(GROUP));
	snprintf(said + at, sizeof(said) - at, "%s %u\n", topic + strlen(GROUP), seq);
	return true;
}

void setUp(void)
{
	instance_start(&in, "sparkplug", signals, COUNT);
	TEST_ASSERT_EQUAL_INT(0, ows_open(in.name, OWS_READ, &ows));
	s = (struct stream){.profile = &profile_sparkplug,
	                    .outlet.put = put,
	                    .prefix = prefix,
	                    .topic = "plant",
	                    .node = "pi",
	                    .discovery = "ha"};
	profiles_prefix(s.profile, s.topic, s.node, prefix);
	room = 100;
	said[0] = '\0';
	TEST_ASSERT_EQUAL_INT(0, stream_open(&s));
	TEST_ASSERT_EQUAL_INT(0, stream_make(&s, ows));
	stream_live(&s, true);
	instance_put_double(&in, ROOM + 1, 21.5, ows_now());
	instance_put_text(&in, TITLE + 1, "x", ows_now());
}

void tearDown(void)
{
	stream_close(&s);
	ows_close(ows);
	instance_end(&in);
}

static const char *pump(void)
{
	said[0] = '\0';
	stream_pump(&s);
	return said;
}

static void change(int signal, double value)
{
	instance_put_double(&in, (uint32_t)signal + 1, value, ows_now());
	stream_changes(&s, &signal, 1);
}

static void test_births_go_before_data_and_nothing_goes_twice(void)
{
	TEST_ASSERT_EQUAL_STRING("NBIRTH/pi 0\n"
	                         "DBIRTH/pi/28.000000000001 1\n"
	                         "DBIRTH/pi/29.000000000001 2\n",
	                         pump());
	TEST_ASSERT_EQUAL_STRING("", pump());
	stream_changes(&s, NULL, 0);
	TEST_ASSERT_EQUAL_STRING("", pump());
	change(SETTING, 1);
	TEST_ASSERT_EQUAL_STRING("NDATA/pi 3\n", pump());
}

static void test_health_goes_out_when_it_changes(void)
{
	pump();
	said[0] = '\0';
	TEST_ASSERT_TRUE(s.profile->numbers(&s));
	TEST_ASSERT_EQUAL_STRING("", said);
	instance_put(&in, RELAY + 1, 1, ows_now());
	room = 0;
	TEST_ASSERT_FALSE(s.profile->numbers(&s));
	room = 1;
	TEST_ASSERT_TRUE(s.profile->numbers(&s));
	TEST_ASSERT_TRUE(s.profile->numbers(&s));
	TEST_ASSERT_EQUAL_STRING("NDATA/pi 3\n", said);
}

static void test_what_was_is_sent_of_a_chip_that_is_away_too(void)
{
	struct past_value was[] = {
		{.row = &s.rows[ROOM], .wall_us = 1700000000000000, .v = {.quality = OWS_Q_DEVICE}},
		{.row = &s.rows[ROOM], .wall_us = 1700000001000000, .v = {.quality = OWS_Q_GOOD}},
	};

	pump();
	said[0] = '\0';
	TEST_ASSERT_TRUE(s.profile->past(&s, was, 2));
	TEST_ASSERT_EQUAL_STRING("DDATA/pi/28.000000000001 3\n", said);
	TEST_ASSERT_NOT_NULL(memmem(raw, raw_len, "\x28\x01\x38\x01", 4)); /* of then, and null */
	stream_live(&s, false);
	pump();
	said[0] = '\0';
	TEST_ASSERT_TRUE(s.profile->past(&s, was, 1));
	TEST_ASSERT_EQUAL_STRING("", said);
	room = 1;
	TEST_ASSERT_FALSE(s.profile->past(&s, was, 2));
	room = 100;
	TEST_ASSERT_TRUE(s.profile->past(&s, was, 2));
	TEST_ASSERT_EQUAL_STRING("DBIRTH/pi/28.000000000001 9\n"
	                         "DDATA/pi/28.000000000001 10\n",
	                         said);
	TEST_ASSERT_EQUAL_STRING("", pump());
	TEST_ASSERT_TRUE(stream_chip(&s, "28.000000000001")->lent);
	change(ROOM, 1);
	TEST_ASSERT_EQUAL_STRING("DDEATH/pi/28.000000000001 11\n", pump());
}

static void test_the_rows_of_a_chip_go_together(void)
{
	int both[] = {RELAY, TITLE};

	pump();
	instance_put_text(&in, TITLE + 1, "y", ows_now());
	instance_put(&in, RELAY + 1, 1, ows_now());
	stream_changes(&s, both, 2);
	TEST_ASSERT_EQUAL_STRING("DDATA/pi/29.000000000001 3\n", pump());
	TEST_ASSERT_EQUAL_STRING("", pump());
}

static void test_what_is_not_taken_comes_again_with_the_number_it_had(void)
{
	char all[sizeof(said)] = "";

	for (int i = 0; i < 20; i++) {
		if (i == 8) {
			change(ROOM, 22);
			change(SETTING, 3);
		}
		if (i == 14)
			stream_live(&s, false);
		room = i % 2;
		strcat(all, pump());
	}
	TEST_ASSERT_EQUAL_STRING("NBIRTH/pi 0\n"
	                         "DBIRTH/pi/28.000000000001 1\n"
	                         "DBIRTH/pi/29.000000000001 2\n"
	                         "DDATA/pi/28.000000000001 3\n"
	                         "NDATA/pi 4\n"
	                         "DDATA/pi/28.000000000001 5\n"
	                         "DDEATH/pi/28.000000000001 6\n"
	                         "DDATA/pi/29.000000000001 7\n",
	                         all);
	room = 100;
	TEST_ASSERT_EQUAL_STRING("DDEATH/pi/29.000000000001 8\n"
	                         "NDATA/pi 9\n",
	                         pump());
}

static void test_numbers_end_at_255_and_a_birth_begins_at_0(void)
{
	pump();
	for (int i = 3; i < 256; i++) {
		room = 1;
		change(ROOM, i);
		pump();
	}
	TEST_ASSERT_EQUAL_STRING("DDATA/pi/28.000000000001 255\n", said);
	room = 100;
	change(ROOM, 1);
	TEST_ASSERT_EQUAL_STRING("DDATA/pi/28.000000000001 0\n", pump());
	stream_announce(&s, true);
	TEST_ASSERT_EQUAL_STRING_LEN("NBIRTH/pi 0\nDBIRTH/pi/28.000000000001 1\n", pump(), 40);
}

static void test_what_other_profiles_have_left_is_emptied_and_nothing_else(void)
{
	static const char *const theirs[] = {"plant/pi2/room", "spBv1.0/plant/NBIRTH/pi",
	                                     "spBv1.0/plant/pi/room", "homie/5/pi/$state"};
	static const char *const left[] = {"plant/pi/room", "plant/pi/chip/28.000000000001/state",
	                                   "homie/5/owsd-pi/$state",
	                                   "/devices/owsd_pi/controls/room"};
	char topic[TOPIC_SIZE], line[TOPIC_SIZE];

	pump();
	s.settled = true;
	/* behind the two places of births */
	profiles_place(&s, 2, topic);
	TEST_ASSERT_EQUAL_STRING("plant/pi/+", topic);
	for (size_t i = 0; i < sizeof(theirs) / sizeof(theirs[0]); i++)
		profiles_kept(&s, theirs[i], "x");
	TEST_ASSERT_EQUAL_STRING("", pump());
	for (size_t i = 0; i < sizeof(left) / sizeof(left[0]); i++) {
		profiles_kept(&s, left[i], "x");
		snprintf(line, sizeof(line), "%s emptied\n", left[i]);
		TEST_ASSERT_EQUAL_STRING(line, pump());
	}
	profiles_kept(&s, "ha/device/owsd_28_000000000001/config",
	              "{\"dev\":{\"via_device\":\"owsd_pi\"}}");
	TEST_ASSERT_EQUAL_STRING("ha/device/owsd_28_000000000001/config emptied\n", pump());
}

static void test_only_the_will_and_the_end_are_the_death_of_the_node(void)
{
	static const char death[] = "NDEATH/pi 0\n";

	pump();
	said[0] = '\0';
	TEST_ASSERT_TRUE(s.profile->state(&s, STREAM_THERE));
	TEST_ASSERT_TRUE(s.profile->state(&s, STREAM_LOST));
	TEST_ASSERT_EQUAL_STRING("", said);
	dying = true;
	TEST_ASSERT_TRUE(s.profile->state(&s, STREAM_KILLED));
	TEST_ASSERT_EQUAL_STRING(death, said);
	said[0] = '\0';
	TEST_ASSERT_TRUE(s.profile->state(&s, STREAM_ENDED));
	dying = false;
	TEST_ASSERT_EQUAL_STRING(death, said);
}

static void test_a_simulated_value_has_a_property_that_says_so(void)
{
	pump();
	change(ROOM, 22);
	pump();
	TEST_ASSERT_NULL(memmem(raw, raw_len, "Simulated", 9));
	in.detail = OWS_DETAIL_SIMULATED;
	change(ROOM, 22);
	TEST_ASSERT_EQUAL_STRING("DDATA/pi/28.000000000001 4\n", pump());
	TEST_ASSERT_NOT_NULL(memmem(raw, raw_len, "Simulated", 9));
}

static void test_a_text_that_is_no_utf_8_becomes_some(void)
{
	int signal = TITLE;

	pump();
	instance_put_text(&in, TITLE + 1, "a\xc3\xa9\xff\xc3", ows_now());
	stream_changes(&s, &signal, 1);
	pump();
	TEST_ASSERT_NOT_NULL(memmem(raw, raw_len, "a\xc3\xa9??", 5));
}

static void take(void *ctx, const char *name, const char *text, const char *fault)
{
	size_t at = strlen(taken);

	(void)ctx;
	snprintf(taken + at, sizeof(taken) - at, "%s=%s%s%.12s\n", name, text, fault ? " " : "",
	         fault ? fault : "");
}

static const char *commands(const char *topic, const char *bytes, size_t len)
{
	taken[0] = '\0';
	if (s.profile->take(&s, topic, bytes, len, take, NULL))
		strcat(taken, "again\n");
	return taken;
}

static void test_a_message_that_is_no_payload_is_one_fault(void)
{
	static char big[70000], many[101 * 2];

	memset(big, 0, sizeof(big));
	for (size_t i = 0; i < sizeof(many); i += 2)
		many[i] = 0x12; /* a metric with nothing in it */
	TEST_ASSERT_EQUAL_STRING("pi= no payload o\n", commands(GROUP "NCMD/pi", "\xff\xff", 2));
	TEST_ASSERT_EQUAL_STRING("x= no payload o\n",
	                         commands(GROUP "DCMD/pi/x", big, sizeof(big)));
	TEST_ASSERT_EQUAL_STRING("pi= more than 10\n",
	                         commands(GROUP "NCMD/pi", many, sizeof(many)));
	TEST_ASSERT_EQUAL_STRING("alias 0= the last bir\n", commands(GROUP "NCMD/pi", many, 2));
	TEST_ASSERT_EQUAL_STRING("", commands(GROUP "NCMD/pi", "", 0));
}

static void test_a_command_is_of_its_device_and_of_its_type(void)
{
	static const char on[] = "\x12\x09\x0a\x05relay\x70\x01",
			  one[] = "\x12\x09\x0a\x05relay\x50\x01",
			  reboot[] = "\x12\x17\x0a\x13Node Control/Reboot\x70\x01";

	TEST_ASSERT_EQUAL_STRING("Node Control/Reboot= nothing rest\n",
	                         commands(GROUP "NCMD/pi", reboot, sizeof(reboot) - 1));
	TEST_ASSERT_EQUAL_STRING("relay=1\n",
	                         commands(GROUP "DCMD/pi/29.000000000001", on, sizeof(on) - 1));
	TEST_ASSERT_EQUAL_STRING("relay= its datatype\n",
	                         commands(GROUP "DCMD/pi/29.000000000001", one, sizeof(one) - 1));
	TEST_ASSERT_EQUAL_STRING("relay= the last bir\n",
	                         commands(GROUP "DCMD/pi/28.000000000001", on, sizeof(on) - 1));
	TEST_ASSERT_EQUAL_STRING("relay= the last bir\n",
	                         commands(GROUP "NCMD/pi", on, sizeof(on) - 1));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_births_go_before_data_and_nothing_goes_twice);
	RUN_TEST(test_health_goes_out_when_it_changes);
	RUN_TEST(test_what_was_is_sent_of_a_chip_that_is_away_too);
	RUN_TEST(test_the_rows_of_a_chip_go_together);
	RUN_TEST(test_what_is_not_taken_comes_again_with_the_number_it_had);
	RUN_TEST(test_numbers_end_at_255_and_a_birth_begins_at_0);
	RUN_TEST(test_what_other_profiles_have_left_is_emptied_and_nothing_else);
	RUN_TEST(test_only_the_will_and_the_end_are_the_death_of_the_node);
	RUN_TEST(test_a_simulated_value_has_a_property_that_says_so);
	RUN_TEST(test_a_text_that_is_no_utf_8_becomes_some);
	RUN_TEST(test_a_message_that_is_no_payload_is_one_fault);
	RUN_TEST(test_a_command_is_of_its_device_and_of_its_type);
	return UNITY_END();
}
