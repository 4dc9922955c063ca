/* SPDX-License-Identifier: MIT */
/* What owsd --check prints is a configuration of the same meaning. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/config/check/know.h"
#include "src/config/edit/print.h"
#include "src/config/read/config.h"
#include "src/config/read/load.h"
#include "tests/unit/aid/said.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static struct config *parse(const char *text, size_t len)
{
	struct config *config;

	said_must_not_begin();
	TEST_ASSERT_EQUAL_INT(0, config_parse("f", text, len, &report, &config));
	return config;
}

static char *print(const struct config *config)
{
	size_t len;
	char *text;
	FILE *out = open_memstream(&text, &len);

	TEST_ASSERT_NOT_NULL(out);
	config_print(config, out);
	TEST_ASSERT_EQUAL_INT(0, fclose(out));
	return text;
}

static void equal_text(const char *a, const char *b)
{
	if (a && b)
		TEST_ASSERT_EQUAL_STRING(a, b);
	else
		TEST_ASSERT_TRUE(!a && !b);
}

static void equal_items(const struct config_item *a, const struct config_item *b)
{
	equal_text(a->name, b->name);
	equal_text(a->path, b->path);
	TEST_ASSERT_EQUAL_INT(a->type, b->type);
	TEST_ASSERT_EQUAL(a->output, b->output);
	TEST_ASSERT_EQUAL(a->readable, b->readable);
	TEST_ASSERT_EQUAL(a->writable, b->writable);
	TEST_ASSERT_EQUAL(a->fresh, b->fresh);
	TEST_ASSERT_EQUAL(a->has_init, b->has_init);
	TEST_ASSERT_EQUAL(a->has_safe, b->has_safe);
	TEST_ASSERT_EQUAL(a->has_safe_delay, b->has_safe_delay);
	TEST_ASSERT_EQUAL_INT64(a->safe_delay_ns, b->safe_delay_ns);
	TEST_ASSERT_EQUAL(a->starts_last, b->starts_last);
	TEST_ASSERT_EQUAL(a->confirm, b->confirm);
	TEST_ASSERT_EQUAL_INT64(a->init_value, b->init_value);
	TEST_ASSERT_EQUAL_INT64(a->safe_value, b->safe_value);
	equal_text(a->init_text, b->init_text);
	equal_text(a->safe_text, b->safe_text);
	TEST_ASSERT_EQUAL_UINT32(a->per_factor, b->per_factor);
	TEST_ASSERT_EQUAL_INT64(a->stale_after_ns, b->stale_after_ns);
	TEST_ASSERT_EQUAL(a->alarm, b->alarm);
	equal_text(a->latch_alarm, b->latch_alarm);
	equal_text(a->por_alarm, b->por_alarm);
	equal_text(a->set_alarm, b->set_alarm);
	equal_text(a->reset_latch, b->reset_latch);
	TEST_ASSERT_EQUAL(a->limits.any, b->limits.any);
	for (int i = 0; i < CONFIG_LIMITS; i++) {
		TEST_ASSERT_EQUAL(a->limits.has[i], b->limits.has[i]);
		TEST_ASSERT_EQUAL_DOUBLE(a->limits.limit[i], b->limits.limit[i]);
	}
	TEST_ASSERT_EQUAL_DOUBLE(a->limits.hysteresis, b->limits.hysteresis);
	TEST_ASSERT_EQUAL_INT64(a->limits.on_delay_ns, b->limits.on_delay_ns);
	TEST_ASSERT_EQUAL_INT64(a->limits.off_delay_ns, b->limits.off_delay_ns);
}

static void survives(const char *text, size_t len)
{
	struct config *a = parse(text, len), *b;
	char *first = print(a), *second;

	b = parse(first, strlen(first));
	second = print(b);
	TEST_ASSERT_EQUAL_STRING(first, second);
	TEST_ASSERT_EQUAL_UINT(a->max_cons_alarms, b->max_cons_alarms);
	TEST_ASSERT_EQUAL_UINT(a->max_retries, b->max_retries);
	TEST_ASSERT_EQUAL_INT64(a->timeout_ns, b->timeout_ns);
	TEST_ASSERT_EQUAL_INT64(a->period_ns, b->period_ns);
	TEST_ASSERT_EQUAL_INT64(a->alarm_period_ns, b->alarm_period_ns);
	TEST_ASSERT_EQUAL_UINT(a->target_count, b->target_count);
	for (unsigned i = 0; i < a->target_count; i++) {
		equal_text(a->targets[i].text, b->targets[i].text);
		TEST_ASSERT_EQUAL_INT(a->targets[i].relation, b->targets[i].relation);
	}
	TEST_ASSERT_EQUAL_UINT(a->item_count, b->item_count);
	for (unsigned i = 0; i < a->item_count; i++)
		equal_items(&a->items[i], &b->items[i]);
	free(first);
	free(second);
	config_free(a);
	config_free(b);
}

static void test_every_key_survives_being_printed_and_read(void)
{
	static const char text[] =
		"OwsDrv { TargetName \"a | i2c:/dev/i2c-1, sim:C:\\\\x\" MaxConsAlarms 7 MaxRetries 0\n"
		"Timeout 0.3 Period 0.001 AlarmPeriod 0.3\n"
		"Item { Name \"r\" Path \"uncached/bus.1/29.B89115000000/sensed.BYTE\" IOType 0x0012\n"
		"Alarm on PorAlarm \"por\" LatchAlarm \"latch.BYTE\" SetAlarm \"set_alarm=1\"\n"
		"ResetLatch \"\" PerFactor 1000000 StaleAfter 0.123456789 }\n"
		"Item { Name \"l\" Path \"a/d\" Type double LimitLL -1e-3 LimitL 0 LimitH 1.7\n"
		"LimitHH 1e300 Hysteresis 0.1 OnDelay 0.5 OffDelay 86400 }\n"
		"Item { Name \"o\" Path \"/a/b\" Type float IO output Readable on Writable off\n"
		"InitValue \"1e-3\" SafeValue \" .5 \" SafeDelay 0.5 Start last Confirm on }\n"
		"Item { Name \"t\" Path \"/a/c\" Type string IO output InitValue \"say \\\"x\\\" in a text "
		"that is longer than the fifty characters of a line\" SafeValue \"\" } }";

	survives(text, sizeof(text) - 1);
}

static void test_an_item_alone_shows_which_strings_of_an_alarm_are_missing(void)
{
	static const char text[] =
		"OwsDrv { Item { Name i Path /29.B89115000000/sensed.0 Type bool } }";
	struct config *config = parse(text, sizeof(text) - 1);
	char printed[4096] = "";
	FILE *out = fmemopen(printed, sizeof(printed), "w");

	config_print_item(&config->items[0], true, out);
	fclose(out);
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(printed, "    # PorAlarm              not defined\n"),
	                             printed);
	TEST_ASSERT_NULL_MESSAGE(strstr(printed, "# SafeValue"), printed);
	TEST_ASSERT_NULL_MESSAGE(strstr(printed, "# Unit"), printed);
	config_free(config);
}

/* An input has none: 0 there would be a key that means nothing. */
static void test_how_often_it_is_read_back_is_printed_of_outputs_alone(void)
{
	static const char text[] =
		"OwsDrv { Item { Name i Path /29.B89115000000/sensed.0 Type bool }\n"
		"Item { Name o Path /29.B89115000000/PIO.0 Type bool IO output }\n"
		"Item { Name n Path /29.B89115000000/PIO.1 Type bool IO output ReadBack 0 } }";
	struct config *config = parse(text, sizeof(text) - 1);
	char *printed, *second;

	config_know(config);
	printed = print(config);
	second = strstr(printed, "\"o\"");
	TEST_ASSERT_NOT_NULL(second);
	TEST_ASSERT_NOT_NULL(strstr(second, "    ReadBack                10\n"));
	TEST_ASSERT_NOT_NULL(strstr(second, "    ReadBack                0\n"));
	*second = '\0';
	TEST_ASSERT_NULL(strstr(printed, "ReadBack"));
	free(printed);
	config_free(config);
}

static void test_an_empty_configuration_survives(void)
{
	survives("OwsDrv{}", 8);
}

static void test_files_of_genuine_shape_survive(void)
{
	static const char *const files[] = {
		"tests/unit/data/relay_and_inputs.rio", "tests/unit/data/one_thermometer.rio",
		"tests/unit/data/four_thermometers.rio", "tests/unit/data/light_and_humidity.rio"};

	for (size_t i = 0; i < sizeof(files) / sizeof(files[0]); i++) {
		FILE *in = fopen(files[i], "r");
		char text[4096];
		size_t len;

		TEST_ASSERT_NOT_NULL_MESSAGE(in, files[i]);
		len = fread(text, 1, sizeof(text), in);
		fclose(in);
		TEST_ASSERT_TRUE(len > 0);
		survives(text, len);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_every_key_survives_being_printed_and_read);
	RUN_TEST(test_an_item_alone_shows_which_strings_of_an_alarm_are_missing);
	RUN_TEST(test_how_often_it_is_read_back_is_printed_of_outputs_alone);
	RUN_TEST(test_an_empty_configuration_survives);
	RUN_TEST(test_files_of_genuine_shape_survive);
	return UNITY_END();
}
