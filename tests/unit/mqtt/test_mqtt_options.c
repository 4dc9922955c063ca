/* SPDX-License-Identifier: MIT */
/* Tests of what owsd-mqtt makes of its block: names, ways, defaults. */
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "src/faces/kit/face.h"
#include "src/faces/mqtt/options.h"
#include "src/faces/mqtt/profiles.h"

static struct config config;
static struct face_arguments arguments;
static struct face face;
static struct mqtt_options options;

void setUp(void)
{
	memset(&config, 0, sizeof(config));
	config.mqtt.topic = "owsd";
	config.mqtt.discovery = "homeassistant";
	config.mqtt.profile = "homeassistant";
	arguments.instance = "OWS";
	face.arguments = &arguments;
	face.config = &config;
	/* what was there before has no part in it */
	memset(&options, 0x55, sizeof(options));
}

void tearDown(void)
{
}

static void test_a_way_is_shown_as_the_key_broker_has_it(void)
{
	static const struct {
		struct mqtt_way way;
		const char *name;
	} ways[] = {{{"localhost", 1883, false}, "mqtt://localhost:1883"},
	            {{"fd00::7", 8883, true}, "mqtts://[fd00::7]:8883"},
	            {{"10.0.0.1", 65535, true}, "mqtts://10.0.0.1:65535"}};
	char text[MQTT_WAY_NAME];

	for (unsigned i = 0; i < sizeof(ways) / sizeof(ways[0]); i++)
		TEST_ASSERT_EQUAL_STRING(ways[i].name, mqtt_way_name(&ways[i].way, text));
}

static void test_the_page_is_where_a_block_says_or_where_it_listens_for_others(void)
{
	static const uint8_t lan[] = {10, 0, 0, 7};

	mqtt_options_take(&options, &face);
	TEST_ASSERT_EQUAL_STRING("", options.link);
	/* an address of all, and one that only this machine reaches, help nobody */
	config.web.address_count = 2;
	config.web.addresses[0].port = 8080;
	config.web.addresses[1] = (struct listen_address){.port = 81, .bytes = {127, 0, 0, 1}};
	mqtt_options_take(&options, &face);
	TEST_ASSERT_EQUAL_STRING("", options.link);
	memcpy(config.web.addresses[1].bytes, lan, sizeof(lan));
	mqtt_options_take(&options, &face);
	TEST_ASSERT_EQUAL_STRING("http://10.0.0.7:81/", options.link);
	config.notify.link = "https://plant.example/";
	mqtt_options_take(&options, &face);
	TEST_ASSERT_EQUAL_STRING("https://plant.example/", options.link);
	config.mqtt.link = "https://pi7.example/";
	mqtt_options_take(&options, &face);
	TEST_ASSERT_EQUAL_STRING("https://pi7.example/", options.link);
}

static void test_the_node_is_the_key_as_it_is(void)
{
	config.mqtt.node = "House 7.b";
	mqtt_options_take(&options, &face);
	TEST_ASSERT_EQUAL_STRING("House 7.b", options.node);
	TEST_ASSERT_EQUAL_STRING("owsd/House 7.b", options.prefix);
}

static void test_without_the_key_the_node_is_the_machine_and_another_instance_has_its_name(void)
{
	char host[64] = "";

	gethostname(host, sizeof(host) - 1);
	mqtt_options_take(&options, &face);
	TEST_ASSERT_EQUAL_UINT(strcspn(host, "."), strlen(options.node));
	TEST_ASSERT_NULL(strpbrk(options.node, "/+#. "));
	arguments.instance = "HOUSE";
	mqtt_options_take(&options, &face);
	TEST_ASSERT_EQUAL_STRING("-HOUSE", options.node + strcspn(host, "."));
}

static void test_a_password_without_a_user_is_of_the_node(void)
{
	config.mqtt.node = "pi";
	mqtt_options_take(&options, &face);
	TEST_ASSERT_EQUAL_STRING("", options.user);
	config.mqtt.password_file = "/etc/secret";
	mqtt_options_take(&options, &face);
	TEST_ASSERT_EQUAL_STRING("pi", options.user);
	config.mqtt.user = "other";
	mqtt_options_take(&options, &face);
	TEST_ASSERT_EQUAL_STRING("other", options.user);
}

/* They are compared as memory to find whether a reload has changed something. */
static void test_the_same_block_gives_the_same_bytes(void)
{
	struct mqtt_options again;

	config.mqtt.node = "pi";
	config.mqtt.way_count = 1;
	config.mqtt.ways[0].host = "a.example.org";
	config.mqtt.ways[0].port = 1883;
	mqtt_options_take(&options, &face);
	memset(&again, 0xaa, sizeof(again));
	mqtt_options_take(&again, &face);
	TEST_ASSERT_EQUAL_MEMORY(&options, &again, sizeof(again));
	config.mqtt.ways[0].host = "a";
	mqtt_options_take(&again, &face);
	TEST_ASSERT_TRUE(memcmp(&options, &again, sizeof(again)) != 0);
	/* nothing is left of the longer name */
	for (size_t i = 1; i < OPTION_SIZE; i++)
		TEST_ASSERT_EQUAL_INT8(0, again.ways[0].host[i]);
}

static void test_the_prefix_is_that_of_the_profile(void)
{
	static const struct {
		const char *profile, *prefix;
	} profiles[] = {{"plain", "owsd/Pi_7"},
	                {"homie5", "homie/5/owsd-pi-7"},
	                {"wirenboard", "/devices/owsd_pi_7"}};

	config.mqtt.node = "Pi_7";
	for (unsigned i = 0; i < sizeof(profiles) / sizeof(profiles[0]); i++) {
		char name[20];

		snprintf(name, sizeof(name), "%s", profiles[i].profile);
		config.mqtt.profile = name;
		mqtt_options_take(&options, &face);
		TEST_ASSERT_EQUAL_STRING(profiles[i].profile, options.profile->name);
		TEST_ASSERT_EQUAL_STRING(profiles[i].prefix, options.prefix);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_way_is_shown_as_the_key_broker_has_it);
	RUN_TEST(test_the_page_is_where_a_block_says_or_where_it_listens_for_others);
	RUN_TEST(test_the_node_is_the_key_as_it_is);
	RUN_TEST(test_without_the_key_the_node_is_the_machine_and_another_instance_has_its_name);
	RUN_TEST(test_a_password_without_a_user_is_of_the_node);
	RUN_TEST(test_the_same_block_gives_the_same_bytes);
	RUN_TEST(test_the_prefix_is_that_of_the_profile);
	return UNITY_END();
}
