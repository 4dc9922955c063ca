/* SPDX-License-Identifier: MIT */
/* Tests of Home Assistant's discovery: what becomes of a signal, and what its component says. */
#include <math.h>
#include <string.h>

#include "unity.h"

#include "src/faces/mqtt/entity.h"
#include "src/faces/mqtt/health.h"
#include "tests/unit/aid/published.h"

static const struct instance_signal signals[] = {
	{"room", "/28.000000000001/temperature", OWS_DOUBLE, false, 4 * INSTANCE_S,
         "28.000000000001"},
	{"dimmer", "/2C.000000000001/wiper", OWS_BYTE, true, 0, "2C.000000000001"},
	{"lamp", "/29.000000000001/PIO.0", OWS_BOOL, true, 0, "29.000000000001"},
	{"door", "/29000000000001/sensed.0", OWS_BOOL, false, 0, "29000000000001"},
	{"text", "/settings/x", OWS_STRING, true, 0, ""},
	/* it is in the place of one that was lost */
	{"key", "/01.000000000008/present", OWS_BOOL, false, 0, "01.000000000008",
         "/01.000000000007/present"},
};
enum { ROOM, DIMMER, LAMP, DOOR, TEXT, KEY, COUNT };

static struct published p;
static const char *class = "";

static const char *class_of(void *ctx, const char *name)
{
	(void)ctx;
	return strcmp(name, "lamp") == 0 || strcmp(name, "dimmer") == 0 ? class : "";
}

void setUp(void)
{
	class = "";
	published_start(&p, signals, COUNT, &profile_homeassistant);
}

void tearDown(void)
{
	published_end(&p);
}

/* --- What a signal becomes --- */

static struct ows_info info_of(uint8_t type, bool output, double min, double max)
{
	return (struct ows_info){.type = type, .output = output, .min = min, .max = max};
}

static void test_a_kind_is_of_type_direction_class_and_range(void)
{
	static const struct {
		uint8_t type;
		bool output, range;
		const char *class;
		enum entity_kind kind, not_written;
	} cases[] = {
		{OWS_DOUBLE, false, false, "", ENTITY_SENSOR, ENTITY_SENSOR},
		{OWS_BOOL, false, false, "", ENTITY_BINARY, ENTITY_BINARY},
		{OWS_BOOL, false, false, "light", ENTITY_BINARY, ENTITY_BINARY},
		{OWS_STRING, false, false, "", ENTITY_SENSOR, ENTITY_SENSOR},
		{OWS_BOOL, true, false, "", ENTITY_SWITCH, ENTITY_BINARY},
		{OWS_BOOL, true, false, "light", ENTITY_LIGHT, ENTITY_BINARY},
		{OWS_BOOL, true, false, "cover", ENTITY_COVER, ENTITY_BINARY},
		{OWS_BYTE, true, false, "", ENTITY_NUMBER, ENTITY_SENSOR},
		{OWS_BYTE, true, true, "", ENTITY_NUMBER, ENTITY_SENSOR},
		/* what is on and off of a number is known by Min and Max alone */
		{OWS_BYTE, true, false, "light", ENTITY_NUMBER, ENTITY_SENSOR},
		{OWS_BYTE, true, true, "light", ENTITY_LIGHT, ENTITY_SENSOR},
		{OWS_DOUBLE, true, true, "cover", ENTITY_COVER, ENTITY_SENSOR},
		{OWS_STRING, true, false, "", ENTITY_TEXT, ENTITY_SENSOR},
		{OWS_STRING, true, true, "light", ENTITY_TEXT, ENTITY_SENSOR},
	};

	for (unsigned i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct ows_info info = info_of(cases[i].type, cases[i].output,
		                               cases[i].range ? 0 : NAN,
		                               cases[i].range ? 100 : NAN);

		TEST_ASSERT_EQUAL(cases[i].kind, entity_kind(&info, cases[i].class, true));
		TEST_ASSERT_EQUAL(cases[i].not_written, entity_kind(&info, cases[i].class, false));
		/* one bound alone is no range */
		info.min = 0;
		info.max = NAN;
		if (cases[i].kind == ENTITY_LIGHT && cases[i].type != OWS_BOOL)
			TEST_ASSERT_EQUAL(ENTITY_NUMBER, entity_kind(&info, "light", true));
	}
}

static void test_a_range_is_that_of_the_configuration_else_of_the_type(void)
{
	static const struct {
		uint8_t type;
		double least, most;
	} types[] = {{OWS_BOOL, 0, 1},           {OWS_BYTE, 0, 255},
	             {OWS_SHORT, -32768, 32767}, {OWS_LONG, -2147483648.0, 2147483647},
	             {OWS_WORD, 0, 65535},       {OWS_DWORD, 0, 4294967295.0},
	             {OWS_LARGE, -1e15, 1e15},   {OWS_FLOAT, -1e6, 1e6},
	             {OWS_DOUBLE, -1e6, 1e6}};
	double least, most;

	for (unsigned i = 0; i < sizeof(types) / sizeof(types[0]); i++) {
		struct ows_info info = info_of(types[i].type, true, NAN, NAN);

		entity_range(&info, &least, &most);
		TEST_ASSERT_EQUAL_DOUBLE(types[i].least, least);
		TEST_ASSERT_EQUAL_DOUBLE(types[i].most, most);
		info.min = -7;
		entity_range(&info, &least, &most);
		TEST_ASSERT_EQUAL_DOUBLE(-7, least);
		TEST_ASSERT_EQUAL_DOUBLE(types[i].most, most);
		info.max = 0;
		entity_range(&info, &least, &most);
		TEST_ASSERT_EQUAL_DOUBLE(0, most);
	}
}

/* --- What is announced --- */

#define CHIP(id) "ha/device/owsd_" id "/config"

/* Announce all anew; the component of that id. */
static const char *component(const char *topic, const char *id)
{
	static char text[2000];
	const char *all, *at, *end;
	char key[120];

	p.s.class_of = class_of;
	TEST_ASSERT_EQUAL_INT(0, stream_make(&p.s, p.h));
	stream_announce(&p.s, true);
	instance_put_double(&p.in, ROOM + 1, 21, ows_now());
	instance_put(&p.in, DIMMER + 1, 3, ows_now());
	instance_put(&p.in, LAMP + 1, 1, ows_now());
	instance_put(&p.in, KEY + 1, 0, ows_now());
	for (int i = 0; i < COUNT; i++) {
		p.s.rows[i].info.min = i == DIMMER ? 10 : NAN;
		p.s.rows[i].info.max = i == DIMMER ? 90 : NAN;
		p.s.rows[i].alarms = i == ROOM;
	}
	p.s.rows[ROOM].info.unit = "\302\260"
				   "C";
	p.s.rows[ROOM].info.decimals = 1;
	published_pump(&p);
	all = published_at(&p, topic);
	TEST_ASSERT_NOT_NULL_MESSAGE(all, p.said);
	snprintf(key, sizeof(key), "\"%s\":{\"p\":", id);
	at = strstr(all, key);
	TEST_ASSERT_NOT_NULL_MESSAGE(at, all);
	end = strstr(at + 1, ",\"owsd_");
	snprintf(text, sizeof(text), "%.*s", (int)(end ? end - at : (long)strlen(at)), at);
	return text;
}

static void has(const char *text, const char *part)
{
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(text, part), text);
}

static void test_a_sensor_has_unit_class_decimals_and_expires_after_its_time(void)
{
	const char *c = component(CHIP("28_000000000001"), "owsd_28_000000000001_temperature");

	has(c, "\"p\":\"sensor\",\"uniq_id\":\"owsd_28_000000000001_temperature\",\"name\":null");
	has(c, "\"stat_t\":\"o/pi/room\"");
	has(c, "\"dev_cla\":\"temperature\",\"unit_of_meas\":\"\302\260"
	       "C\"");
	/* StaleAfter, the half of it in which it is published again, and a margin */
	has(c, "\"exp_aft\":11,");
	has(c, "\"stat_cla\":\"measurement\",\"sug_dsp_prc\":1");
	TEST_ASSERT_NULL(strstr(c, "cmd_t"));
}

static void test_a_limit_alarm_is_a_problem_of_its_own(void)
{
	const char *c = component(CHIP("28_000000000001"),
	                          "owsd_28_000000000001_temperature_alarm");

	has(c, "\"p\":\"binary_sensor\"");
	has(c, "\"name\":\"Limit alarm\",\"dev_cla\":\"problem\",\"stat_t\":\"o/pi/room/alarm\"");
}

static void test_a_switch_takes_on_and_off_and_its_chip_has_to_be_there(void)
{
	const char *topic = CHIP("29_000000000001");

	has(component(topic, "owsd_29_000000000001_PIO_0"),
	    "\"cmd_t\":\"o/pi/lamp/set\",\"pl_on\":\"on\",\"pl_off\":\"off\"");
	has(component(topic, "owsd_29_000000000001_PIO_0"), "\"p\":\"switch\"");
	has(component(topic, "owsd_29_000000000001_sensed_0"), "\"p\":\"binary_sensor\"");
	has(published_at(&p, topic), "\"ids\":[\"29.000000000001\"]");
	has(published_at(&p, topic), "\"via_device\":\"owsd_pi\"");
	has(published_at(&p, topic), "\"avty\":[{\"t\":\"o/pi/state\"},"
	                             "{\"t\":\"o/pi/chip/29.000000000001/state\",\"val_tpl\":");
}

static void test_a_number_has_its_range_a_light_its_scale_a_cover_its_ends(void)
{
	const char *topic = CHIP("2C_000000000001"), *id = "owsd_2C_000000000001_wiper";

	has(component(topic, id), "\"p\":\"number\"");
	has(component(topic, id), "\"min\":10,\"max\":90,\"step\":1,\"mode\":\"box\"");
	class = "light";
	has(component(topic, id), "\"p\":\"light\"");
	has(component(topic, id), "\"bri_scl\":90");
	/* off is its least value, which is not 0 */
	has(component(topic, id), "('on' if value_json.v > 10 else 'off')");
	class = "cover";
	has(component(topic, id), "\"p\":\"cover\"");
	has(component(topic, id), "\"pos_clsd\":10,\"pos_open\":90");
	has(component(topic, id), "('open' if value_json.v > 10 else 'closed')");
	/* a cover keeps a bad position, so its topic counts for whether it is there */
	has(component(topic, id), "\"avty\":[{\"t\":\"o/pi/state\"},");
	has(component(topic, id), "{\"t\":\"o/pi/dimmer\",\"val_tpl\":");
}

static void test_without_commands_nothing_has_a_topic_of_commands(void)
{
	p.s.write = false;
	class = "light";
	has(component(CHIP("29_000000000001"), "owsd_29_000000000001_PIO_0"),
	    "\"p\":\"binary_sensor\"");
	TEST_ASSERT_NULL(strstr(p.said, "cmd_t"));
}

static void test_what_has_no_chip_and_the_health_are_of_the_node(void)
{
	has(component(CHIP("pi"), "owsd_pi_settings_x"), "\"p\":\"text\"");
	has(component(CHIP("pi"), "owsd_pi_settings_x"), "\"name\":\"text\"");
	has(component(CHIP("pi"), "owsd_pi_health_bus"), "\"dev_cla\":\"connectivity\"");
	has(component(CHIP("pi"), "owsd_pi_health_refused"), "\"ent_cat\":\"diagnostic\"");
	has(published_at(&p, CHIP("pi")), "\"name\":\"owsd pi\",\"mdl\":\"owsd\"");
}

static void test_a_key_is_a_tag_too(void)
{
	has(component(CHIP("01_000000000007"), "owsd_01_000000000007_present"),
	    "\"p\":\"binary_sensor\"");
	has(published_at(&p, CHIP("01_000000000007")),
	    "\"owsd_01_000000000007_present_tag\":{\"p\":\"tag\",\"t\":\"o/pi/key/tag\"}");
	/* it comes while we look: its own id goes to those who are there, once */
	instance_put(&p.in, KEY + 1, 1, ows_now());
	has(published_change(&p, KEY), "o/pi/key/tag (once) 01.000000000008\n");
	instance_put(&p.in, KEY + 1, 1, ows_now());
	TEST_ASSERT_NULL(strstr(published_change(&p, KEY), "tag"));
}

/* --- What has been announced, and is no more --- */

static void test_a_component_that_is_no_more_is_removed_and_the_birth_follows(void)
{
	char old[400];

	component(CHIP("28_000000000001"), "owsd_28_000000000001_temperature");
	snprintf(old, sizeof(old),
	         "{\"dev\":{\"via_device\":\"owsd_pi\"},\"cmps\":{"
	         "\"owsd_28_000000000001_temperature\":{\"p\":\"sensor\"},"
	         "\"owsd_28_000000000001_gone\":{\"p\":\"number\"}}}");
	profiles_kept(&p.s, CHIP("28_000000000001"), old);
	published_pump(&p);
	/* all that stays comes along: the name of the device, too */
	has(p.said, "\"name\":\"room\"");
	has(p.said, ",\"owsd_28_000000000001_gone\":{\"p\":\"number\"}}}\n");
	TEST_ASSERT_NULL(
		strstr(p.said, "temperature\":{\"p\":\"sensor\"},\"owsd_28_000000000001_gone"));
	/* of a chip that no signal names any more nothing is left */
	profiles_kept(&p.s, CHIP("28_0000000000AA"), old);
	TEST_ASSERT_EQUAL_STRING(CHIP("28_0000000000AA") " \n", published_pump(&p));
	/* and that of another node is none of ours */
	snprintf(old, sizeof(old), "{\"dev\":{\"via_device\":\"owsd_pi2\"},\"cmps\":{}}");
	profiles_kept(&p.s, CHIP("28_0000000000AA"), old);
	TEST_ASSERT_EQUAL_STRING("", published_pump(&p));
}

static void test_at_a_reload_only_what_is_another_is_announced(void)
{
	component(CHIP("28_000000000001"), "owsd_28_000000000001_temperature");
	/* as a configuration has it that was only read again: rows are as at first */
	for (int i = 0; i < 2; i++) {
		TEST_ASSERT_EQUAL_INT(0, stream_make(&p.s, p.h));
		published_pump(&p);
	}
	TEST_ASSERT_NULL_MESSAGE(strstr(p.said, "/config {"), p.said);
	TEST_ASSERT_NOT_NULL(published_at(&p, "o/pi/room"));
	/* one that is another, alone */
	TEST_ASSERT_EQUAL_INT(0, stream_make(&p.s, p.h));
	p.s.rows[ROOM].info.decimals = 2;
	published_pump(&p);
	TEST_ASSERT_NOT_NULL(published_at(&p, CHIP("28_000000000001")));
	TEST_ASSERT_NULL(published_at(&p, CHIP("29_000000000001")));
	/* another broker knows nothing */
	stream_begin(&p.s);
	published_pump(&p);
	TEST_ASSERT_NOT_NULL(published_at(&p, CHIP("29_000000000001")));
}

static void test_a_device_names_its_maker_its_chip_and_the_page(void)
{
	p.s.link = "http://pi7:8080/";
	component(CHIP("01_000000000007"), "owsd_01_000000000007_present");
	/* the chip that is there, not the one that it began with */
	has(published_at(&p, CHIP("01_000000000007")),
	    "\"sn\":\"01.000000000008\",\"via_device\":\"owsd_pi\",\"cu\":\"http://pi7:8080/\"}");
	has(published_at(&p, CHIP("pi")), "\"cu\":\"http://pi7:8080/\"}");
	TEST_ASSERT_EQUAL_STRING("Maxim Integrated", entity_maker("DS18B20"));
	TEST_ASSERT_EQUAL_STRING("Embedded Data Systems", entity_maker("EDS0068"));
	TEST_ASSERT_EQUAL_STRING("Hobby Boards", entity_maker("HobbyBoards_EF"));
	TEST_ASSERT_NULL(entity_maker("LCD"));
	TEST_ASSERT_NULL(entity_maker(""));
}

static void lose(int signal)
{
	struct ows_sample sample = {.quality = OWS_Q_NO_DEVICE};
	struct ows_attrs attrs = {0};

	image_publish(&p.in.image, (uint32_t)signal + 1, &sample, &attrs, NULL);
	published_change(&p, signal);
}

static void test_a_chip_has_a_problem_with_its_reason_also_while_it_is_away(void)
{
	static const char topic[] = "o/pi/chip/29.000000000001/problem";
	const char *c;

	instance_put(&p.in, DOOR + 1, 1, ows_now());
	c = component(CHIP("29_000000000001"), "owsd_29_000000000001_problem");
	has(c, "\"dev_cla\":\"problem\",\"ent_cat\":\"diagnostic\",\"stat_t\":");
	has(c, "\"avty\":[{\"t\":\"o/pi/state\"}]");
	TEST_ASSERT_EQUAL_STRING(
		"{\"problem\":false,\"health\":\"normal\",\"why\":null,\"signal\":null,\"bad\":0}",
		published_at(&p, topic));
	lose(DOOR);
	has(published_at(&p, topic), "{\"problem\":true,\"health\":\"failure\",\"why\":\"");
	has(published_at(&p, topic), "\"signal\":\"door\",\"bad\":1}");
	published_change(&p, DOOR);
	TEST_ASSERT_NULL(published_at(&p, topic));
	/* a key that is away is away */
	lose(KEY);
	TEST_ASSERT_NULL(published_at(&p, "o/pi/chip/01.000000000007/problem"));
}

static void test_old_readers_has_a_message_of_its_own_if_that_is_wanted(void)
{
	static const char topic[] = "ha/switch/owsd_pi/owsd_29_000000000001_PIO_0/config";
	const char *c;
	int count = 0;

	p.s.old_readers = true;
	stream_announce(&p.s, true);
	instance_put(&p.in, LAMP + 1, 1, ows_now());
	/* the outlet takes little at a time, and no entity is left out or comes twice */
	for (int i = 0; i < 30; i++) {
		p.room = 3;
		published_pump(&p);
		count += published_at(&p, topic) != NULL;
	}
	TEST_ASSERT_EQUAL_INT(1, count);
	p.room = 1000;
	stream_announce(&p.s, true);
	published_pump(&p);
	TEST_ASSERT_NULL(strstr(p.said, "/device/"));
	c = published_at(&p, topic);
	has(c, "{\"dev\":{\"ids\":[\"29.000000000001\"]");
	has(c, ",\"avty\":[{\"t\":\"o/pi/state\"},{\"t\":\"o/pi/chip/29.000000000001/state\",");
	has(c,
	    "\"avty_mode\":\"all\",\"qos\":1,\"p\":\"switch\",\"uniq_id\":\"owsd_29_000000000001_PIO_0\"");
	TEST_ASSERT_NULL(strstr(c, "cmps"));
	/* what is there while the chip is away says so alone */
	c = published_at(&p, "ha/binary_sensor/owsd_pi/owsd_29_000000000001_problem/config");
	has(c, "\"avty\":[{\"t\":\"o/pi/state\"}]}");
	TEST_ASSERT_NULL(strstr(c, "chip/29.000000000001\",\"val"));
	has(published_at(&p, "ha/text/owsd_pi/owsd_pi_settings_x/config"), "\"p\":\"text\"");
}

static void test_entities_and_devices_of_the_other_way_are_emptied(void)
{
	char at[TOPIC_SIZE];

	TEST_ASSERT_TRUE(p.s.profile->births(&p.s, 1, at));
	TEST_ASSERT_EQUAL_STRING("ha/+/owsd_pi/+/config", at);
	TEST_ASSERT_FALSE(p.s.profile->births(&p.s, 2, at));
	instance_put(&p.in, LAMP + 1, 1, ows_now());
	published_pump(&p);
	/* those of devices follow an entity that stood there */
	profiles_kept(&p.s, "ha/switch/owsd_pi/owsd_29_000000000001_PIO_0/config", "{}");
	published_pump(&p);
	has(p.said, "ha/switch/owsd_pi/owsd_29_000000000001_PIO_0/config \nha/device/owsd_29");
	p.s.old_readers = true;
	profiles_kept(&p.s, "ha/switch/owsd_pi/owsd_29_000000000001_PIO_0/config", "{}");
	profiles_kept(&p.s, "ha/switch/owsd_pi/owsd_29_000000000001_PIO_1/config", "{}");
	profiles_kept(&p.s, "ha/switch/owsd_pi2/owsd_29_000000000001_PIO_1/config", "{}");
	profiles_kept(&p.s, "ha/sensor/owsd_pi/owsd_29_000000000001_PIO_0/config", "{}");
	profiles_kept(&p.s, "ha/sensor/lamp/config", "{}");
	profiles_kept(&p.s, CHIP("29_000000000001"), "{\"dev\":{\"via_device\":\"owsd_pi\"}}");
	published_pump(&p);
	TEST_ASSERT_EQUAL_STRING(
		"", published_at(&p, "ha/switch/owsd_pi/owsd_29_000000000001_PIO_1/config"));
	TEST_ASSERT_EQUAL_STRING(
		"", published_at(&p, "ha/sensor/owsd_pi/owsd_29_000000000001_PIO_0/config"));
	TEST_ASSERT_EQUAL_STRING("", published_at(&p, CHIP("29_000000000001")));
	has(published_at(&p, "ha/switch/owsd_pi/owsd_29_000000000001_PIO_0/config"), "{\"dev\"");
	TEST_ASSERT_NULL(published_at(&p, "ha/sensor/lamp/config"));
	TEST_ASSERT_NULL(published_at(&p, "ha/switch/owsd_pi2/owsd_29_000000000001_PIO_1/config"));
}

static void test_home_assistant_that_comes_is_told_all_again_and_nobody_else(void)
{
	char topic[TOPIC_SIZE];

	p.s.profile->listen(&p.s, topic);
	TEST_ASSERT_EQUAL_STRING("ha/status", topic);
	TEST_ASSERT_TRUE(p.s.profile->heard(&p.s, "ha/status", "online", 6));
	TEST_ASSERT_FALSE(p.s.profile->heard(&p.s, "ha/status", "offline", 7));
	TEST_ASSERT_FALSE(p.s.profile->heard(&p.s, "ha/status", "onlineX", 7));
	TEST_ASSERT_FALSE(p.s.profile->heard(&p.s, "ha/statu", "online", 6));
}

/* --- Health --- */

static void test_health_is_published_when_it_is_another_and_has_the_trouble(void)
{
	struct health health = {.trouble = "", .connects = 2, .commands = 3, .refused_commands = 1};
	const char *text;

	p.said[0] = '\0';
	TEST_ASSERT_TRUE(health_publish(&p.s, &health));
	text = published_at(&p, "o/pi/health");
	TEST_ASSERT_NOT_NULL(text);
	has(text, "{\"signals\":6,\"bad\":");
	has(text,
	    "\"connects\":2,\"refused\":0,\"commands\":3,\"commands_refused\":1,\"trouble\":\"\",\"reload_refused\":\"\"}");
	p.said[0] = '\0';
	TEST_ASSERT_TRUE(health_publish(&p.s, &health));
	TEST_ASSERT_EQUAL_STRING("", p.said);
	health.trouble = "no broker";
	p.room = 0;
	TEST_ASSERT_FALSE(health_publish(&p.s, &health));
	p.room = 1;
	TEST_ASSERT_TRUE(health_publish(&p.s, &health));
	has(published_at(&p, "o/pi/health"), "\"trouble\":\"no broker\"");
}

static void test_signals_that_are_not_good_are_counted(void)
{
	int64_t before[HEALTH_NUMBERS], after[HEALTH_NUMBERS];

	health_count(&p.s, before);
	instance_put_double(&p.in, ROOM + 1, 21, ows_now());
	health_count(&p.s, after);
	TEST_ASSERT_EQUAL_INT64(before[HEALTH_BAD] - 1, after[HEALTH_BAD]);
	TEST_ASSERT_EQUAL_INT64(COUNT - 1, after[HEALTH_BAD]);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_kind_is_of_type_direction_class_and_range);
	RUN_TEST(test_a_range_is_that_of_the_configuration_else_of_the_type);
	RUN_TEST(test_a_sensor_has_unit_class_decimals_and_expires_after_its_time);
	RUN_TEST(test_a_limit_alarm_is_a_problem_of_its_own);
	RUN_TEST(test_a_switch_takes_on_and_off_and_its_chip_has_to_be_there);
	RUN_TEST(test_a_number_has_its_range_a_light_its_scale_a_cover_its_ends);
	RUN_TEST(test_without_commands_nothing_has_a_topic_of_commands);
	RUN_TEST(test_what_has_no_chip_and_the_health_are_of_the_node);
	RUN_TEST(test_a_key_is_a_tag_too);
	RUN_TEST(test_a_component_that_is_no_more_is_removed_and_the_birth_follows);
	RUN_TEST(test_at_a_reload_only_what_is_another_is_announced);
	RUN_TEST(test_a_device_names_its_maker_its_chip_and_the_page);
	RUN_TEST(test_a_chip_has_a_problem_with_its_reason_also_while_it_is_away);
	RUN_TEST(test_old_readers_has_a_message_of_its_own_if_that_is_wanted);
	RUN_TEST(test_entities_and_devices_of_the_other_way_are_emptied);
	RUN_TEST(test_home_assistant_that_comes_is_told_all_again_and_nobody_else);
	RUN_TEST(test_health_is_published_when_it_is_another_and_has_the_trouble);
	RUN_TEST(test_signals_that_are_not_good_are_counted);
	return UNITY_END();
}
