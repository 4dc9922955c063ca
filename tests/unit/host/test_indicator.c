/* SPDX-License-Identifier: MIT */
/* The alarm line and the heartbeat line, from an image made by hand. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/daemon/host/indicator.h"
#include "src/public/ows.h"
#include "tests/unit/aid/fake_gpio.h"

#define MS INT64_C(1000000)
#define SECOND (1000 * MS)
#define ALARM 1
#define LAMP 4

static struct image image;
static void *memory;
static int64_t now;
static struct indicator *indicator;

static const struct config config = {
	.period_ns = 100 * MS,
	.alarm_line = "gpiochip0/1",
	.heartbeat_line = "gpiochip0/4,active-low",
};

void setUp(void)
{
	static const struct image_signal signals[2] = {
		{.name = "door",
	         .path = "/29.000000000001/sensed.0",
	         .type = OWS_BOOL,
	         .per_factor = 1},
		{.name = "room",
	         .path = "/28.000000000001/temperature",
	         .type = OWS_DOUBLE,
	         .per_factor = 1},
	};
	static const char *const targets[2] = {"w1", "i2c:/dev/i2c-1"};
	const struct image_plan plan = {.signals = signals,
	                                .signal_count = 2,
	                                .targets = targets,
	                                .target_count = 2,
	                                .period_ns = 100 * MS,
	                                .generation = 1};
	size_t size = (image_size(&plan) + 63) / 64 * 64;

	memory = aligned_alloc(64, size);
	TEST_ASSERT_NOT_NULL(memory);
	memset(memory, 0, size);
	image_build(&plan, memory, &image);
	fake_gpio_begin();
	now = 1000 * SECOND;
	TEST_ASSERT_EQUAL_INT(0, indicator_create(&config, &image, NULL, &indicator));
	TEST_ASSERT_NOT_NULL(indicator);
}

void tearDown(void)
{
	indicator_destroy(indicator);
	indicator = NULL;
	free(memory);
	fake_gpio_end();
}

static void beat(void)
{
	const struct ows_sample sample = {.measured_ns = now};

	image_publish(&image, 0, &sample, &(struct ows_attrs){0}, NULL);
}

static void alarm(uint32_t record, uint8_t limit_state, uint32_t flags)
{
	const struct ows_attrs attrs = {.limit_state = limit_state, .flags = flags};

	image_publish(&image, record, &(struct ows_sample){0}, &attrs, NULL);
}

/* As its thread does; the heart beats. Returns for how long of the time the lamp was on. */
static int64_t pass(int64_t ns)
{
	int64_t until = now + ns, lit = 0;

	while (now < until) {
		int64_t next;

		beat();
		next = indicator_step(indicator, now);
		TEST_ASSERT_GREATER_THAN_INT64(now, next);
		if (next > until)
			next = until;
		if (!fake_gpio.line[LAMP].high)
			lit += next - now;
		now = next;
	}
	return lit;
}

static void test_the_alarm_line_is_on_as_long_as_an_alarm_stands_or_waits(void)
{
	static const uint8_t states[] = {OWS_LIMIT_UNACKNOWLEDGED, OWS_LIMIT_ACKNOWLEDGED,
	                                 OWS_LIMIT_RETURNED};

	pass(SECOND);
	TEST_ASSERT_FALSE(fake_gpio.line[ALARM].high);
	for (size_t i = 0; i < sizeof(states); i++) {
		alarm(2, states[i], OWS_ATTR_LIMITS);
		pass(SECOND);
		TEST_ASSERT_TRUE(fake_gpio.line[ALARM].high);
		alarm(2, OWS_LIMIT_NORMAL, OWS_ATTR_LIMITS);
		pass(SECOND);
		TEST_ASSERT_FALSE(fake_gpio.line[ALARM].high);
	}
	alarm(1, OWS_LIMIT_NORMAL, OWS_ATTR_ALARM_STANDS);
	pass(SECOND);
	TEST_ASSERT_TRUE(fake_gpio.line[ALARM].high);
	alarm(1, OWS_LIMIT_NORMAL, OWS_ATTR_ALARM_POLLED);
	pass(SECOND);
	TEST_ASSERT_FALSE(fake_gpio.line[ALARM].high);
	/* an output that reads otherwise than it was written */
	image_publish(&image, 1, &(struct ows_sample){.quality = OWS_Q_DIFFERS},
	              &(struct ows_attrs){0}, NULL);
	pass(SECOND);
	TEST_ASSERT_TRUE(fake_gpio.line[ALARM].high);
	alarm(1, OWS_LIMIT_NORMAL, 0);
	pass(SECOND);
	TEST_ASSERT_FALSE(fake_gpio.line[ALARM].high);
	TEST_ASSERT_EQUAL_UINT(1, fake_gpio.line[ALARM].requests);
}

static void test_a_line_is_set_when_it_changes_and_every_five_seconds(void)
{
	alarm(2, OWS_LIMIT_UNACKNOWLEDGED, OWS_ATTR_LIMITS);
	pass(10 * SECOND);
	TEST_ASSERT_TRUE(fake_gpio.line[ALARM].high);
	TEST_ASSERT_EQUAL_UINT(1, fake_gpio.line[ALARM].sets);
}

static void test_the_heartbeat_tells_a_target_that_is_up_from_none(void)
{
	TEST_ASSERT_EQUAL_INT64(500 * MS, pass(10 * SECOND));
	image_target(&image, 1, 1, 0);
	TEST_ASSERT_EQUAL_INT64(5 * SECOND, pass(10 * SECOND));
	image_target(&image, 1, 2, 0);
	TEST_ASSERT_EQUAL_INT64(500 * MS, pass(10 * SECOND));
}

static void test_the_heartbeat_is_dark_when_the_engine_stands_still(void)
{
	image_target(&image, 0, 1, 0);
	pass(3 * SECOND);
	now += 2 * SECOND;
	for (unsigned i = 0; i < 20; i++) {
		now = indicator_step(indicator, now);
		TEST_ASSERT_TRUE(fake_gpio.line[LAMP].high);
	}
	TEST_ASSERT_EQUAL_INT64(SECOND, pass(2 * SECOND));
}

static void test_a_line_that_cannot_be_had_is_taken_when_it_is_free(void)
{
	strcpy(fake_gpio.line[ALARM].consumer, "other");
	alarm(2, OWS_LIMIT_UNACKNOWLEDGED, OWS_ATTR_LIMITS);
	image_target(&image, 0, 1, 0);
	TEST_ASSERT_EQUAL_INT64(SECOND, pass(2 * SECOND));
	TEST_ASSERT_FALSE(fake_gpio.line[ALARM].high);
	fake_gpio.line[ALARM].consumer[0] = '\0';
	pass(6 * SECOND);
	TEST_ASSERT_TRUE(fake_gpio.line[ALARM].high);
}

static void test_a_chip_that_goes_and_comes_is_taken_again(void)
{
	alarm(2, OWS_LIMIT_UNACKNOWLEDGED, OWS_ATTR_LIMITS);
	image_target(&image, 0, 1, 0);
	pass(2 * SECOND);
	fake_gpio.gone = true;
	pass(6 * SECOND);
	fake_gpio.line[ALARM].high = false;
	fake_gpio.gone = false;
	TEST_ASSERT_GREATER_THAN_INT64(SECOND, pass(10 * SECOND));
	TEST_ASSERT_EQUAL_UINT(2, fake_gpio.line[LAMP].requests);
	TEST_ASSERT_TRUE(fake_gpio.line[ALARM].high);
}

static void test_at_the_end_the_lamp_goes_out_and_the_alarm_stays(void)
{
	alarm(2, OWS_LIMIT_UNACKNOWLEDGED, OWS_ATTR_LIMITS);
	image_target(&image, 0, 1, 0);
	pass(SECOND + 100 * MS);
	TEST_ASSERT_FALSE(fake_gpio.line[LAMP].high);
	indicator_destroy(indicator);
	indicator = NULL;
	TEST_ASSERT_TRUE(fake_gpio.line[LAMP].high);
	TEST_ASSERT_TRUE(fake_gpio.line[ALARM].high);
	TEST_ASSERT_FALSE(fake_gpio.line[ALARM].held);
}

static void test_without_lines_there_is_no_indicator(void)
{
	static const struct config none = {.period_ns = 100 * MS};
	static const struct config wrong = {.period_ns = 100 * MS, .alarm_line = "17"};
	struct indicator *made = indicator;

	TEST_ASSERT_EQUAL_INT(0, indicator_create(&none, &image, NULL, &made));
	TEST_ASSERT_NULL(made);
	TEST_ASSERT_EQUAL_INT(0, indicator_start(NULL));
	TEST_ASSERT_TRUE(indicator_stop(NULL, SECOND));
	TEST_ASSERT_EQUAL_INT(-EINVAL, indicator_create(&wrong, &image, NULL, &made));
	TEST_ASSERT_NULL(made);
}

static void test_the_thread_ends_when_it_is_told_to(void)
{
	TEST_ASSERT_EQUAL_INT(0, indicator_start(indicator));
	TEST_ASSERT_TRUE(indicator_stop(indicator, 10 * SECOND));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_alarm_line_is_on_as_long_as_an_alarm_stands_or_waits);
	RUN_TEST(test_a_line_is_set_when_it_changes_and_every_five_seconds);
	RUN_TEST(test_the_heartbeat_tells_a_target_that_is_up_from_none);
	RUN_TEST(test_the_heartbeat_is_dark_when_the_engine_stands_still);
	RUN_TEST(test_a_line_that_cannot_be_had_is_taken_when_it_is_free);
	RUN_TEST(test_a_chip_that_goes_and_comes_is_taken_again);
	RUN_TEST(test_at_the_end_the_lamp_goes_out_and_the_alarm_stays);
	RUN_TEST(test_without_lines_there_is_no_indicator);
	RUN_TEST(test_the_thread_ends_when_it_is_told_to);
	return UNITY_END();
}
