/* SPDX-License-Identifier: MIT */
/* Tests of what is published of the signals, when, and in which order. */
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/faces/mqtt/profiles.h"
#include "tests/unit/aid/instance.h"

#define S INSTANCE_S

static const struct instance_signal signals[] = {
	{"room", "/28.000000000001/temperature", OWS_DOUBLE, false, 4 * S, "28.000000000001"},
	{"title", "/29.000000000001/type", OWS_STRING, false, 0, "29.000000000001"},
};
enum { ROOM, TITLE, COUNT };

static struct instance in;
static struct ows *ows;
static struct stream s;
static char said[8192]; /* "topic text\n" of each message */
static int room;        /* how many messages the outlet takes */

static bool put(void *ctx, const char *topic, const char *text, size_t len, bool retain)
{
	size_t at = strlen(said);

	(void)ctx;
	if (!room)
		return false;
	room--;
	snprintf(said + at, sizeof(said) - at, "%s%s %.*s\n", topic, retain ? "" : " (once)",
	         (int)len, text);
	return true;
}

static char prefix[TOPIC_SIZE];

/* As to a broker that knows nothing, with another profile. */
static void take_profile(const struct profile *profile)
{
	profiles_prefix(profile, "o", "pi", prefix);
	s.profile = profile;
	TEST_ASSERT_EQUAL_INT(0, stream_make(&s, ows));
}

void setUp(void)
{
	instance_start(&in, "mqtt", signals, COUNT);
	TEST_ASSERT_EQUAL_INT(0, ows_open(in.name, OWS_READ, &ows));
	s = (struct stream){
		.outlet.put = put, .prefix = prefix, .topic = "o", .node = "pi", .discovery = "ha"};
	room = 100;
	said[0] = '\0';
	TEST_ASSERT_EQUAL_INT(0, stream_open(&s));
	take_profile(&profile_plain);
	stream_live(&s, true);
	s.settled = true;
}

void tearDown(void)
{
	stream_close(&s);
	ows_close(ows);
	instance_end(&in);
}

#define WELL "{\"problem\":false,\"health\":\"normal\",\"why\":null,\"signal\":null,\"bad\":0}\n"

static const char *pump(void)
{
	said[0] = '\0';
	stream_pump(&s);
	return said;
}

static void test_the_birth_has_all_and_the_state_is_last(void)
{
	instance_put_double(&in, ROOM + 1, 21.5, ows_now());
	instance_put_text(&in, TITLE + 1, "a\"b", ows_now());
	TEST_ASSERT_EQUAL_STRING(
		"o/pi/chip/28.000000000001/state online\n"
		"o/pi/room {\"v\":21.5,\"good\":true,\"q\":192,\"t\":null}\n"
		"o/pi/chip/28.000000000001/problem " WELL "o/pi/chip/29.000000000001/state online\n"
		"o/pi/title {\"v\":\"a\\\"b\",\"good\":true,\"q\":192,\"t\":null}\n"
		"o/pi/chip/29.000000000001/problem " WELL "o/pi/state online\n",
		pump());
	TEST_ASSERT_EQUAL_STRING("", pump());
}

static void test_the_time_is_there_when_the_clock_is_right(void)
{
	s.clock_set = true;
	instance_put_double(&in, ROOM + 1, 21.5, ows_now());
	TEST_ASSERT_NOT_NULL(strstr(pump(), "\"t\":1"));
}

static void test_the_same_value_is_said_again_after_half_of_its_time_alone(void)
{
	int signal = ROOM;

	instance_put_double(&in, ROOM + 1, 21.5, ows_now());
	pump();
	instance_put_double(&in, ROOM + 1, 21.5, ows_now());
	stream_changes(&s, &signal, 1);
	TEST_ASSERT_EQUAL_STRING("", pump());
	s.rows[ROOM].published_ns -= 2 * S;
	stream_changes(&s, &signal, 1);
	TEST_ASSERT_NOT_NULL(strstr(pump(), "o/pi/room {\"v\":21.5"));
	instance_put_double(&in, ROOM + 1, 22, ows_now());
	stream_changes(&s, &signal, 1);
	TEST_ASSERT_NOT_NULL(strstr(pump(), "o/pi/room {\"v\":22"));
}

static void test_a_value_of_which_no_change_comes_is_said_again_by_time(void)
{
	int64_t now_ns;

	instance_put_double(&in, ROOM + 1, 21.5, ows_now());
	pump();
	instance_put_double(&in, ROOM + 1, 21.6, ows_now()); /* within Deadband: no change */
	now_ns = ows_now();
	s.rows[ROOM].published_ns = now_ns - 2 * S + 1;
	stream_repeat(&s, now_ns);
	TEST_ASSERT_EQUAL_STRING("", pump());
	s.rows[ROOM].published_ns = now_ns - 2 * S;
	stream_repeat(&s, now_ns);
	stream_repeat(&s, now_ns);
	TEST_ASSERT_EQUAL_STRING("o/pi/room {\"v\":21.6,\"good\":true,\"q\":192,\"t\":null}\n",
	                         pump());
	stream_repeat(&s, ows_now());
	TEST_ASSERT_EQUAL_STRING("", pump());
	/* what is not good now is said as that, and not again; likewise an owsd that is lost */
	s.rows[ROOM].published_ns -= 2 * S;
	instance_put_double(&in, ROOM + 1, 85, ows_now() - 10 * S);
	stream_repeat(&s, ows_now());
	TEST_ASSERT_NOT_NULL(strstr(pump(), "o/pi/room {\"v\":null,\"good\":false,"));
	s.rows[ROOM].published_ns -= 2 * S;
	stream_repeat(&s, ows_now());
	TEST_ASSERT_EQUAL_INT(0, s.queue_len);
	stream_live(&s, false);
	pump();
	s.rows[ROOM].good = true;
	stream_repeat(&s, ows_now());
	TEST_ASSERT_EQUAL_INT(0, s.queue_len);
}

static void test_a_bad_value_has_no_number(void)
{
	instance_put_double(&in, ROOM + 1, 85, ows_now() - 10 * S);
	pump();
	TEST_ASSERT_NOT_NULL(
		strstr(said, "o/pi/room {\"v\":null,\"good\":false,\"q\":20,\"why\":\""));
	TEST_ASSERT_NULL(strstr(said, "85"));
}

static void test_what_has_no_room_comes_later_with_its_newest_value_and_nothing_twice(void)
{
	int signal = ROOM;

	instance_put_double(&in, ROOM + 1, 1, ows_now());
	instance_put_text(&in, TITLE + 1, "x", ows_now());
	room = 1;
	TEST_ASSERT_EQUAL_STRING("o/pi/chip/28.000000000001/state online\n", pump());
	for (int i = 2; i < 50; i++) {
		instance_put_double(&in, ROOM + 1, i, ows_now());
		stream_changes(&s, &signal, 1);
		TEST_ASSERT_EQUAL_STRING("", pump());
	}
	room = 100;
	pump();
	TEST_ASSERT_NOT_NULL(strstr(said, "o/pi/room {\"v\":49,"));
	TEST_ASSERT_NULL(strstr(said, "\"v\":48"));
	TEST_ASSERT_NULL(strstr(said, "28.000000000001 "));
	TEST_ASSERT_NOT_NULL(strstr(said, "o/pi/title {\"v\":\"x\""));
}

static void test_a_chip_is_unknown_until_it_has_answered(void)
{
	int signal = ROOM;

	pump();
	TEST_ASSERT_NOT_NULL(strstr(said, "o/pi/chip/28.000000000001/state unknown\n"));
	TEST_ASSERT_NULL(strstr(said, "001 online\n"));
	instance_put_double(&in, ROOM + 1, 21.5, ows_now());
	stream_changes(&s, &signal, 1);
	TEST_ASSERT_EQUAL_STRING_LEN("o/pi/chip/28.000000000001/state online\n", pump(), 39);
}

static void test_of_a_chip_with_outputs_alone_a_command_shows_whether_it_is_there(void)
{
	static const struct instance_signal other[] = {
		{"relay", "/29.1/PIO.0", OWS_BOOL, true, 0, "29.000000000001"},
		{"pump", "/3A.1/PIO.A", OWS_BOOL, true, 0, "3A.000000000001"},
		{"level", "/3A.1/sensed.A", OWS_BOOL, false, 0, "3A000000000001"}};
	int signal = 2;

	instance_reload(&in, other, 3);
	TEST_ASSERT_EQUAL_INT(0, ows_reopen(ows));
	take_profile(&profile_homeassistant);
	TEST_ASSERT_NOT_NULL(strstr(pump(), "o/pi/chip/29.000000000001/state unknown\n"));
	TEST_ASSERT_NOT_NULL(strstr(said, "ha/device/owsd_29_000000000001/config"));
	/* the other one can be asked, and has not answered */
	TEST_ASSERT_NOT_NULL(strstr(said, "o/pi/chip/3A.000000000001/state unknown\n"));
	TEST_ASSERT_NULL(strstr(said, "ha/device/owsd_3A_000000000001/config"));
	instance_put(&in, 3, 1, ows_now());
	stream_changes(&s, &signal, 1);
	TEST_ASSERT_EQUAL_STRING_LEN("o/pi/chip/3A.000000000001/state online\n", pump(), 39);
	TEST_ASSERT_NOT_NULL(strstr(said, "ha/device/owsd_3A_000000000001/config"));
}

static void test_an_owsd_that_is_lost_takes_all_back(void)
{
	instance_put_double(&in, ROOM + 1, 1, ows_now());
	pump();
	stream_live(&s, false);
	TEST_ASSERT_EQUAL_STRING("o/pi/state offline\n"
	                         "o/pi/chip/28.000000000001/state offline\n"
	                         "o/pi/room {\"v\":null,\"good\":false,\"q\":26,"
	                         "\"why\":\"owsd not running\",\"t\":null}\n"
	                         "o/pi/chip/29.000000000001/state offline\n"
	                         "o/pi/title {\"v\":null,\"good\":false,\"q\":26,"
	                         "\"why\":\"owsd not running\",\"t\":null}\n",
	                         pump());
	stream_live(&s, true);
	TEST_ASSERT_NOT_NULL(strstr(pump(), "o/pi/room {\"v\":1,"));
	TEST_ASSERT_NOT_NULL(strstr(said, "o/pi/state online\n"));
}

static void test_what_the_broker_keeps_is_emptied_if_nobody_writes_it_any_more(void)
{
	static const struct instance_signal other[] = {
		{"new", "/28.000000000001/temperature", OWS_DOUBLE, false, 0, "28000000000001"}};
	static const char *const ours[] = {"o/pi/new",       "o/pi/new/set",
	                                   "o/pi/room/note", "o/pi/state",
	                                   "o/pi/health",    "o/pi/chip/28.000000000001/state",
	                                   "o/pi2/room",     "o/pi"};

	pump();
	instance_reload(&in, other, 1);
	TEST_ASSERT_EQUAL_INT(0, ows_reopen(ows));
	TEST_ASSERT_EQUAL_INT(0, stream_make(&s, ows));
	pump();
	for (size_t i = 0; i < sizeof(ours) / sizeof(ours[0]); i++)
		profiles_kept(&s, ours[i], "x");
	profiles_kept(&s, "o/pi/room", NULL);
	TEST_ASSERT_EQUAL_STRING("", pump());
	profiles_kept(&s, "o/pi/room", "x");
	pump();
	TEST_ASSERT_EQUAL_STRING_LEN("o/pi/room {\"v\":null,", said, 20);
	TEST_ASSERT_NOT_NULL(strstr(said, "}\no/pi/room \n"));
	profiles_kept(&s, "o/pi/chip/29.000000000001/state", "online");
	TEST_ASSERT_EQUAL_STRING("o/pi/chip/29.000000000001/state \n", pump());
	profiles_kept(&s, "o/pi/new/alarm", "x");
	TEST_ASSERT_EQUAL_STRING("o/pi/new/alarm \n", pump());
	/* nothing is known of what there is while owsd is away */
	stream_live(&s, false);
	pump();
	profiles_kept(&s, "o/pi/room", "x");
	TEST_ASSERT_EQUAL_STRING("", pump());
}

/* All places, one a line. */
static const char *places(void)
{
	char topic[TOPIC_SIZE] = "x";

	said[0] = '\0';
	for (int i = 0; *topic; i++) {
		profiles_place(&s, i, topic);
		snprintf(said + strlen(said), sizeof(said) - strlen(said), "%s\n", topic);
	}
	return said;
}

static void test_the_topics_of_all_profiles_are_looked_at_our_own_first(void)
{
	TEST_ASSERT_EQUAL_STRING(
		"o/pi/+\no/pi/+/alarm\no/pi/chip/+/state\no/pi/chip/+/problem\n"
		"ha/device/+/config\nha/+/owsd_pi/+/config\n"
		"homie/5/owsd-pi/+\nhomie/5/owsd-pi/+/+\n"
		"/devices/owsd_pi/meta\n/devices/owsd_pi/meta/+\n/devices/owsd_pi/controls/+\n"
		"/devices/owsd_pi/controls/+/meta\n/devices/owsd_pi/controls/+/meta/+\n\n",
		places());
	take_profile(&profile_homie5);
	TEST_ASSERT_EQUAL_STRING(
		"homie/5/owsd-pi/+\nhomie/5/owsd-pi/+/+\n"
		"ha/device/+/config\nha/+/owsd_pi/+/config\n"
		"o/pi/+\no/pi/+/alarm\no/pi/chip/+/state\no/pi/chip/+/problem\n"
		"/devices/owsd_pi/meta\n/devices/owsd_pi/meta/+\n/devices/owsd_pi/controls/+\n"
		"/devices/owsd_pi/controls/+/meta\n/devices/owsd_pi/controls/+/meta/+\n\n",
		places());
}

#define PROFILE_NAME(name) #name,

/* Is there a topic that both take? Neither has '#'. */
static bool overlap(const char *a, const char *b)
{
	size_t n = strcspn(a, "/"), m = strcspn(b, "/");
	bool wild = (n == 1 && *a == '+') || (m == 1 && *b == '+');

	if (!wild && (n != m || strncmp(a, b, n) != 0))
		return false;
	return a[n] && b[m] ? overlap(a + n + 1, b + m + 1) : a[n] == b[m];
}

/* A broker hands a message out once for each filter that it fits. */
static void test_no_command_or_question_stands_where_the_broker_is_asked_what_it_keeps(void)
{
	static const char *const names[] = {MQTT_PROFILES(PROFILE_NAME)};
	char filters[40][TOPIC_SIZE];

	TEST_ASSERT_TRUE(overlap("a/+/c", "a/b/+"));
	TEST_ASSERT_FALSE(overlap("a/+/c", "a/b/d") || overlap("a/+", "a/b/c"));
	for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
		int n = 0, place = 0;

		take_profile(profiles_find(names[i]));
		s.host = s.profile->listen_host ? "scada" : NULL;
		do
			profiles_listen(&s, true, n, filters[n]);
		while (*filters[n] && ++n);
		TEST_ASSERT_TRUE(n > 0 && n <= 6);
		do
			profiles_place(&s, place, filters[n + place]);
		while (*filters[n + place] && ++place);
		n += place;
		for (int a = 0; a < n; a++)
			for (int b = 0; b < a; b++)
				TEST_ASSERT_FALSE_MESSAGE(overlap(filters[a], filters[b]),
				                          filters[a]);
	}
}

static void test_what_another_profile_has_left_is_emptied_if_it_is_of_this_node(void)
{
	static const char *const theirs[] = {"o/pi2/room", "ha/device/owsd_x/config",
	                                     "homie/5/pi/$state"};
	static const char *const left[] = {"o/pi/room", "o/pi/state",
	                                   "/devices/owsd_pi/controls/room"};

	take_profile(&profile_homie5);
	pump();
	for (size_t i = 0; i < sizeof(theirs) / sizeof(theirs[0]); i++)
		profiles_kept(&s, theirs[i], "{\"dev\":{\"via_device\":\"owsd_pi2\"}}");
	TEST_ASSERT_EQUAL_STRING("", pump());
	for (size_t i = 0; i < sizeof(left) / sizeof(left[0]); i++) {
		char line[TOPIC_SIZE];

		profiles_kept(&s, left[i], "x");
		snprintf(line, sizeof(line), "%s \n", left[i]);
		TEST_ASSERT_EQUAL_STRING(line, pump());
	}
	/* of a chip that is still there, too */
	profiles_kept(&s, "ha/device/owsd_28_000000000001/config",
	              "{\"dev\":{\"via_device\":\"owsd_pi\"}}");
	TEST_ASSERT_EQUAL_STRING("ha/device/owsd_28_000000000001/config \n", pump());
}

static void test_a_node_with_the_slug_of_another_empties_nothing_of_it(void)
{
	const char *left = "/devices/owsd_pi/controls/room";

	s.node = "Pi";
	TEST_ASSERT_NULL(strstr(places(), "owsd_pi"));
	TEST_ASSERT_NULL(strstr(places(), "owsd-pi"));
	pump();
	profiles_kept(&s, left, "x");
	TEST_ASSERT_EQUAL_STRING("", pump());
	/* what the present profile publishes there is its own in any case */
	take_profile(&profile_wirenboard);
	TEST_ASSERT_NOT_NULL(strstr(places(), "/devices/owsd_pi/controls/+\n"));
}

static void test_homie_has_no_value_that_is_bad_and_an_alert_instead(void)
{
	int signal = ROOM;

	take_profile(&profile_homie5);
	instance_put_double(&in, ROOM + 1, 1e20, ows_now());
	instance_put_text(&in, TITLE + 1, "", ows_now());
	pump();
	TEST_ASSERT_EQUAL_STRING_LEN("homie/5/owsd-pi/$state init\n"
	                             "homie/5/owsd-pi/$description {\"homie\":\"5.0\",",
	                             said, 72);
	TEST_ASSERT_NOT_NULL(strstr(said, "/28-000000000001/temperature 1e20\n"
	                                  "homie/5/owsd-pi/$alert/room \n"));
	TEST_ASSERT_NOT_NULL(strstr(said, "/29-000000000001/type "));
	TEST_ASSERT_EQUAL_STRING("homie/5/owsd-pi/$state ready\n",
	                         strstr(said, "homie/5/owsd-pi/$state r"));
	instance_put_double(&in, ROOM + 1, 85, ows_now() - 10 * S);
	stream_changes(&s, &signal, 1);
	TEST_ASSERT_EQUAL_STRING("homie/5/owsd-pi/28-000000000001/temperature \n"
	                         "homie/5/owsd-pi/$alert/room room: stale\n",
	                         pump());
	instance_put_double(&in, ROOM + 1, 21, ows_now());
	stream_changes(&s, &signal, 1);
	TEST_ASSERT_EQUAL_STRING("homie/5/owsd-pi/28-000000000001/temperature 21\n"
	                         "homie/5/owsd-pi/$alert/room \n",
	                         pump());
}

static void test_another_description_has_a_higher_version_and_the_same_the_same(void)
{
	static const struct instance_signal other[] = {
		{"new", "/28.000000000001/temperature", OWS_DOUBLE, false, 0, "28000000000001"}};
	int64_t first;

	take_profile(&profile_homie5);
	pump();
	first = s.description;
	stream_begin(&s);
	pump();
	TEST_ASSERT_EQUAL_INT64(first, s.description);
	/* though the clock goes back */
	s.description = first += 1000;
	instance_reload(&in, other, 1);
	TEST_ASSERT_EQUAL_INT(0, ows_reopen(ows));
	TEST_ASSERT_EQUAL_INT(0, stream_make(&s, ows));
	pump();
	TEST_ASSERT_EQUAL_INT64(first + 1, s.description);
}

static void test_wirenboard_keeps_the_last_value_and_never_without_its_error(void)
{
	int signal = ROOM;

	take_profile(&profile_wirenboard);
	instance_put_double(&in, ROOM + 1, 20, ows_now());
	pump();
	TEST_ASSERT_EQUAL_STRING_LEN("/devices/owsd_pi/meta {\"driver\":\"owsd\"", said, 38);
	TEST_ASSERT_NOT_NULL(strstr(said, "/devices/owsd_pi/controls/title/meta/error r\n"));
	instance_put_double(&in, ROOM + 1, 85, ows_now() - 10 * S);
	stream_changes(&s, &signal, 1);
	TEST_ASSERT_EQUAL_STRING("/devices/owsd_pi/controls/room/meta/error rp\n", pump());
	instance_put_double(&in, ROOM + 1, 21, ows_now());
	stream_changes(&s, &signal, 1);
	TEST_ASSERT_EQUAL_STRING("/devices/owsd_pi/controls/room 21\n"
	                         "/devices/owsd_pi/controls/room/meta/error \n"
	                         "/devices/owsd_pi/controls/room 21\n",
	                         pump());
	instance_put_double(&in, ROOM + 1, 22, ows_now());
	stream_changes(&s, &signal, 1);
	TEST_ASSERT_EQUAL_STRING("/devices/owsd_pi/controls/room 22\n", pump());
	profiles_kept(&s, "/devices/owsd_pi/controls/room/meta", "x");
	profiles_kept(&s, "/devices/owsd_pi/controls/old/meta", "x");
	TEST_ASSERT_EQUAL_STRING("/devices/owsd_pi/controls/old/meta \n", pump());
}

static void test_a_simulated_value_is_no_value_of_a_plant_in_any_profile(void)
{
	int signal = ROOM;

	in.detail = OWS_DETAIL_SIMULATED;
	instance_put_double(&in, ROOM + 1, 21, ows_now());
	TEST_ASSERT_NOT_NULL(strstr(pump(), "{\"v\":21,\"good\":true,\"q\":192,"
	                                    "\"simulated\":true,\"t\":null}\n"));
	/* the same of a target that is there is another */
	in.detail = 0;
	instance_put_double(&in, ROOM + 1, 21, ows_now());
	stream_changes(&s, &signal, 1);
	TEST_ASSERT_EQUAL_STRING("o/pi/room {\"v\":21,\"good\":true,\"q\":192,\"t\":null}\n"
	                         "o/pi/chip/28.000000000001/problem " WELL,
	                         pump());

	in.detail = OWS_DETAIL_SIMULATED;
	instance_put_double(&in, ROOM + 1, 21, ows_now());
	take_profile(&profile_homie5);
	TEST_ASSERT_NOT_NULL(strstr(pump(), "/$alert/room room: simulated\n"));
	in.detail = 0;
	instance_put_double(&in, ROOM + 1, 21, ows_now());
	stream_changes(&s, &signal, 1);
	TEST_ASSERT_EQUAL_STRING("homie/5/owsd-pi/28-000000000001/temperature 21\n"
	                         "homie/5/owsd-pi/$alert/room \n",
	                         pump());

	take_profile(&profile_wirenboard);
	TEST_ASSERT_NULL(strstr(pump(), "simulated"));
	in.detail = OWS_DETAIL_SIMULATED;
	instance_put_double(&in, ROOM + 1, 22, ows_now());
	stream_changes(&s, &signal, 1);
	TEST_ASSERT_NOT_NULL(strstr(pump(), "{\"en\":\"room (simulated)\"}}\n"
	                                    "/devices/owsd_pi/controls/room 22\n"));
}

static void test_names_of_one_slug_have_ids_of_their_own_and_commands_find_them(void)
{
	static const struct instance_signal names[] = {
		{"pump_1", "/28.000000000001/a", OWS_DOUBLE, false, 0, "28.000000000001"},
		{"Pump-1", "/28.000000000001/b", OWS_DOUBLE, false, 0, "28.000000000001"},
		{"pump-1", "/28.000000000001/c", OWS_DOUBLE, false, 0, "28.000000000001"},
		{"Meta", "/28.000000000001/d", OWS_DOUBLE, false, 0, "28.000000000001"}};
	static const struct profile *const profiles[] = {&profile_homie5, &profile_wirenboard,
	                                                 &profile_plain};
	char topic[TOPIC_SIZE + 8], name[TOPIC_SIZE];
	const struct row *row;

	instance_reload(&in, names, 4);
	TEST_ASSERT_EQUAL_INT(0, ows_reopen(ows));
	for (size_t p = 0; p < 3; p++) {
		const char *last = strrchr(profiles[p]->commands, '/');

		take_profile(profiles[p]);
		for (int i = 0; i < 4; i++) {
			TEST_ASSERT_EQUAL_PTR(&s.rows[i], stream_row(&s, s.rows[i].topic,
			                                             strlen(s.rows[i].topic)));
			snprintf(topic, sizeof(topic), "%s%s", s.rows[i].topic, last);
			TEST_ASSERT_TRUE(stream_command(&s, topic, &row, name));
			TEST_ASSERT_EQUAL_PTR(&s.rows[i], row);
			TEST_ASSERT_EQUAL_STRING(names[i].name, name);
			/* it is published, so it is no leftover */
			profiles_kept(&s, s.rows[i].topic, "x");
		}
		TEST_ASSERT_EQUAL_INT(0, s.gone_count);
		TEST_ASSERT_FALSE(stream_command(&s, s.rows[0].topic, &row, name));
		snprintf(topic, sizeof(topic), "%s/nobody%s", s.prefix, last);
		TEST_ASSERT_TRUE(stream_command(&s, topic, &row, name));
		TEST_ASSERT_NULL(row);
		TEST_ASSERT_EQUAL_STRING("nobody", name);
	}
	take_profile(&profile_homie5);
	TEST_ASSERT_EQUAL_STRING("pump-1", s.rows[2].level);
	TEST_ASSERT_EQUAL_STRING("meta", s.rows[3].level);
	TEST_ASSERT_EQUAL_STRING_LEN("pump-1--", s.rows[0].level, 8);
}

static void test_signals_of_one_property_are_told_apart_and_a_chip_has_one_form(void)
{
	static const struct instance_signal two[] = {
		{"b", "/28.000000000001/x", OWS_DOUBLE, false, 0, "28.000000000001"},
		{"none", "/settings/x", OWS_DOUBLE, false, 0, ""},
		{"a", "/28000000000001/x", OWS_DOUBLE, false, 0, "28000000000001"},
		{"c", "/28000000000001/y", OWS_DOUBLE, false, 0, "28000000000001"}};

	instance_reload(&in, two, 4);
	TEST_ASSERT_EQUAL_INT(0, ows_reopen(ows));
	TEST_ASSERT_EQUAL_INT(0, stream_make(&s, ows));
	TEST_ASSERT_EQUAL_INT(1, s.chip_count);
	TEST_ASSERT_EQUAL_INT(3, s.chips[0].rows);
	TEST_ASSERT_EQUAL_PTR(&s.rows[0], s.by_chip[s.chips[0].first]);
	TEST_ASSERT_EQUAL_INT(-1, s.rows[1].chip);
	TEST_ASSERT_FALSE(s.rows[0].twice);
	TEST_ASSERT_FALSE(s.rows[1].twice);
	TEST_ASSERT_TRUE(s.rows[2].twice);
	TEST_ASSERT_FALSE(s.rows[3].twice);
}

static void test_an_alarm_is_an_event_for_those_who_are_there(void)
{
	struct ows_alarm alarm = {
		.signal = ROOM, .kind = OWS_ALARM_DEVICE, .event = OWS_ALARM_RAISED, .text = "3"};

	pump();
	said[0] = '\0';
	s.profile->alarm(&s, &alarm);
	TEST_ASSERT_NOT_NULL(strstr(said, "\"t\":null}"));
	TEST_ASSERT_EQUAL_STRING_LEN(
		"o/pi/room/event (once) {\"event_type\":\"raised\",\"kind\":", said, 49);
	s.clock_set = true;
	said[0] = '\0';
	s.profile->alarm(&s, &alarm);
	TEST_ASSERT_NOT_NULL(strstr(said, "\"t\":1"));
	alarm.signal = COUNT;
	said[0] = '\0';
	s.profile->alarm(&s, &alarm);
	TEST_ASSERT_EQUAL_STRING("", said);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_birth_has_all_and_the_state_is_last);
	RUN_TEST(test_the_time_is_there_when_the_clock_is_right);
	RUN_TEST(test_the_same_value_is_said_again_after_half_of_its_time_alone);
	RUN_TEST(test_a_value_of_which_no_change_comes_is_said_again_by_time);
	RUN_TEST(test_a_bad_value_has_no_number);
	RUN_TEST(test_what_has_no_room_comes_later_with_its_newest_value_and_nothing_twice);
	RUN_TEST(test_a_chip_is_unknown_until_it_has_answered);
	RUN_TEST(test_of_a_chip_with_outputs_alone_a_command_shows_whether_it_is_there);
	RUN_TEST(test_an_owsd_that_is_lost_takes_all_back);
	RUN_TEST(test_what_the_broker_keeps_is_emptied_if_nobody_writes_it_any_more);
	RUN_TEST(test_signals_of_one_property_are_told_apart_and_a_chip_has_one_form);
	RUN_TEST(test_an_alarm_is_an_event_for_those_who_are_there);
	RUN_TEST(test_the_topics_of_all_profiles_are_looked_at_our_own_first);
	RUN_TEST(test_no_command_or_question_stands_where_the_broker_is_asked_what_it_keeps);
	RUN_TEST(test_what_another_profile_has_left_is_emptied_if_it_is_of_this_node);
	RUN_TEST(test_a_node_with_the_slug_of_another_empties_nothing_of_it);
	RUN_TEST(test_homie_has_no_value_that_is_bad_and_an_alert_instead);
	RUN_TEST(test_another_description_has_a_higher_version_and_the_same_the_same);
	RUN_TEST(test_wirenboard_keeps_the_last_value_and_never_without_its_error);
	RUN_TEST(test_a_simulated_value_is_no_value_of_a_plant_in_any_profile);
	RUN_TEST(test_names_of_one_slug_have_ids_of_their_own_and_commands_find_them);
	return UNITY_END();
}
