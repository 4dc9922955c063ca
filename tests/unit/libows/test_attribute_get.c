/* SPDX-License-Identifier: MIT */
/* Tests of reading attributes and driver signals by libows. */
#include <errno.h>

#include "unity.h"

#include "src/ground/signal/value.h"
#include "tests/unit/aid/instance.h"

static const struct instance_signal signals[] = {
	{"x", "/28.1/temperature", OWS_DOUBLE, false, 0},
	{"y", "/29.1/sensed.0", OWS_BOOL, false, 0},
};

static struct instance in;
static struct ows *h;
static int64_t now;
static const struct ows_attrs attrs = {
	.transactions = UINT64_C(5000000000),
	.update_ns = 2500000000,
	.age_max_ns = 3 * INSTANCE_S,
	.per_base = 90,
	.per_max = 12,
	.pend_base = 97,
	.pend_last = 2,
	.pend_max = 4,
	.alarms = 2,
	.flags = OWS_ATTR_READ_ENABLE | OWS_ATTR_IN_WORK,
};

static void publish(const struct ows_attrs *a, int64_t measured_ns)
{
	struct ows_sample sample = {.measured_ns = measured_ns, .quality = OWS_Q_GOOD};

	image_publish(&in.image, 1, &sample, a, NULL);
}

void setUp(void)
{
	instance_start(&in, "attribute", signals, 2);
	instance_dies_soon(&in);
	now = in.start_ns + 10 * INSTANCE_S;
	instance_beat(&in, now, 100);
	publish(&attrs, now - INSTANCE_S);
	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_READ, &h));
}

void tearDown(void)
{
	ows_close(h);
	instance_end(&in);
}

static struct ows_value get(const char *name)
{
	struct ows_value v;
	int id = ows_find(h, name);

	TEST_ASSERT_GREATER_OR_EQUAL_MESSAGE(0, id, name);
	TEST_ASSERT_EQUAL_MESSAGE(0, ows_get(h, id, now, &v), name);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_GOOD, v.quality, name);
	return v;
}

static void test_counters_and_settings_come_as_published(void)
{
	TEST_ASSERT_EQUAL_INT64(5000000000, get("x_TRANSACTIONS").integer);
	TEST_ASSERT_EQUAL(OWS_LARGE, get("x_TRANSACTIONS").type);
	TEST_ASSERT_EQUAL_INT64(1, get("x_PerFactor").integer);
	TEST_ASSERT_EQUAL_INT64(2, get("x_PendLast").integer);
	TEST_ASSERT_EQUAL_DOUBLE(2.5, get("x_Period").number);
	TEST_ASSERT_EQUAL_INT64(1, get("x_RE").integer);
	TEST_ASSERT_EQUAL_INT64(1, get("x_ReadEnable").integer);
	TEST_ASSERT_EQUAL_INT64(0, get("x_WE").integer);
	TEST_ASSERT_EQUAL(OWS_BOOL, get("x_WE").type);
}

static void test_driver_signals_come_from_record_zero(void)
{
	TEST_ASSERT_EQUAL_INT64(77, get("_TRANSACTIONS").integer);
	TEST_ASSERT_EQUAL_INT64(3, get("_RECONNECTS").integer);
}

static void test_running_counts_run(void)
{
	TEST_ASSERT_EQUAL_INT64(10, get("x_PerCount").integer);
	TEST_ASSERT_EQUAL_INT64(12, get("x_PerMax").integer);
	TEST_ASSERT_EQUAL_INT64(3, get("x_PendCount").integer);
	TEST_ASSERT_EQUAL_INT64(4, get("x_PendMax").integer);
	instance_beat(&in, now, 104);
	TEST_ASSERT_EQUAL_INT64(14, get("x_PerCount").integer);
	TEST_ASSERT_EQUAL_INT64(14, get("x_PerMax").integer);
	TEST_ASSERT_EQUAL_INT64(7, get("x_PendCount").integer);
	TEST_ASSERT_EQUAL_INT64(7, get("x_PendMax").integer);
}

/* owsd sleeps through periods in which it has nothing to do; one is 0.1 s here. */
static void test_periods_without_a_beat_count(void)
{
	now += INSTANCE_S / 2 + INSTANCE_S / 20;
	TEST_ASSERT_EQUAL_INT64(15, get("x_PerCount").integer);
	TEST_ASSERT_EQUAL_INT64(8, get("x_PendCount").integer);
	instance_beat(&in, now, 105);
	TEST_ASSERT_EQUAL_INT64(15, get("x_PerCount").integer);
	now -= INSTANCE_S / 10;
	TEST_ASSERT_EQUAL_INT64(15, get("x_PerCount").integer);
}

static void test_counts_survive_the_wrap_of_the_period_number(void)
{
	struct ows_attrs a = attrs;

	a.per_base = 0xfffffffeu;
	publish(&a, now);
	instance_beat(&in, now, 1);
	TEST_ASSERT_EQUAL_INT64(3, get("x_PerCount").integer);
}

static void test_nothing_in_work_waits_zero_periods(void)
{
	struct ows_attrs a = attrs;

	a.flags = 0;
	publish(&a, now);
	TEST_ASSERT_EQUAL_INT64(0, get("x_PendCount").integer);
	TEST_ASSERT_EQUAL_INT64(4, get("x_PendMax").integer);
}

static void test_age_grows_on_the_readers_clock(void)
{
	TEST_ASSERT_EQUAL_DOUBLE(1.0, get("x_Age").number);
	TEST_ASSERT_EQUAL_DOUBLE(3.0, get("x_AgeMax").number);
	TEST_ASSERT_EQUAL_DOUBLE(10.0, get("y_Age").number);
	now += INSTANCE_S / 2;
	TEST_ASSERT_EQUAL_DOUBLE(1.5, get("x_Age").number);
	publish(&attrs, now - 5 * INSTANCE_S);
	TEST_ASSERT_EQUAL_DOUBLE(5.0, get("x_AgeMax").number);
}

static void test_the_raw_value_is_as_old_and_as_good_as_the_value(void)
{
	struct ows_sample sample = {.measured_ns = now - INSTANCE_S, .quality = OWS_Q_RANGE};
	struct ows_attrs a = attrs;
	struct ows_value v;

	a.raw = value_of_double(3.75);
	publish(&a, now - INSTANCE_S);
	TEST_ASSERT_EQUAL_DOUBLE(3.75, get("x_Raw").number);
	TEST_ASSERT_EQUAL(OWS_DOUBLE, get("x_Raw").type);
	TEST_ASSERT_EQUAL_INT64(INSTANCE_S, get("x_Raw").age_ns);
	image_publish(&in.image, 1, &sample, &a, NULL);
	TEST_ASSERT_EQUAL(0, ows_get(h, ows_find(h, "x_Raw"), now, &v));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_RANGE, v.quality);
	TEST_ASSERT_EQUAL_DOUBLE(3.75, v.number);
}

static void test_an_alarm_is_read_once_by_each_handle(void)
{
	struct ows_attrs a = attrs;
	struct ows *other;
	struct ows_value v;

	TEST_ASSERT_EQUAL_INT64(1, get("x_Alarm").integer);
	TEST_ASSERT_EQUAL_INT64(0, get("x_Alarm").integer);
	TEST_ASSERT_EQUAL_INT64(0, get("y_Alarm").integer);
	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_READ, &other));
	TEST_ASSERT_EQUAL(0, ows_get(other, ows_find(other, "x_Alarm"), now, &v));
	TEST_ASSERT_EQUAL_INT64(1, v.integer);
	ows_close(other);
	a.alarms++;
	publish(&a, now);
	TEST_ASSERT_EQUAL_INT64(1, get("x_Alarm").integer);
	TEST_ASSERT_EQUAL_INT64(0, get("x_Alarm").integer);
}

static void test_a_reload_keeps_what_was_seen_of_alarms(void)
{
	get("x_Alarm");
	instance_reload(&in, signals, 2);
	instance_beat(&in, now, 100);
	publish(&attrs, now);
	TEST_ASSERT_EQUAL(0, ows_reopen(h));
	TEST_ASSERT_EQUAL_INT64(0, get("x_Alarm").integer);
}

static void test_write_only_names_refuse_reading(void)
{
	struct ows_value v;

	TEST_ASSERT_EQUAL(-EACCES, ows_get(h, ows_find(h, "x_DGNRESET"), now, &v));
	TEST_ASSERT_EQUAL(-EACCES, ows_get(h, ows_find(h, "_DGNRESET"), now, &v));
	TEST_ASSERT_EQUAL(-EACCES, ows_get(h, ows_find(h, "x_WOS"), now, &v));
	TEST_ASSERT_FALSE(ows_good(v.quality));
}

static void test_value_is_another_name_of_the_signal(void)
{
	TEST_ASSERT_EQUAL(OWS_DOUBLE, get("x_Value").type);
	TEST_ASSERT_EQUAL_INT64(INSTANCE_S, get("x_Value").age_ns);
}

static void test_attributes_of_a_dead_owsd_are_not_good(void)
{
	struct ows_value v;

	now += 100 * INSTANCE_S;
	TEST_ASSERT_EQUAL(0, ows_get(h, ows_find(h, "x_Age"), now, &v));
	TEST_ASSERT_EQUAL_DOUBLE(101.0, v.number);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_NO_OWSD, v.quality);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_counters_and_settings_come_as_published);
	RUN_TEST(test_driver_signals_come_from_record_zero);
	RUN_TEST(test_running_counts_run);
	RUN_TEST(test_periods_without_a_beat_count);
	RUN_TEST(test_counts_survive_the_wrap_of_the_period_number);
	RUN_TEST(test_nothing_in_work_waits_zero_periods);
	RUN_TEST(test_age_grows_on_the_readers_clock);
	RUN_TEST(test_the_raw_value_is_as_old_and_as_good_as_the_value);
	RUN_TEST(test_an_alarm_is_read_once_by_each_handle);
	RUN_TEST(test_a_reload_keeps_what_was_seen_of_alarms);
	RUN_TEST(test_write_only_names_refuse_reading);
	RUN_TEST(test_value_is_another_name_of_the_signal);
	RUN_TEST(test_attributes_of_a_dead_owsd_are_not_good);
	return UNITY_END();
}
