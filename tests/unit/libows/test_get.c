/* SPDX-License-Identifier: MIT */
/* Tests of reading values by libows. */
#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "src/ground/signal/value.h"
#include "tests/unit/aid/instance.h"

static const struct instance_signal signals[] = {
	{"room1", "/28.1/temperature", OWS_DOUBLE, false, 10 * INSTANCE_S},
	{"relay", "/29.1/PIO.0", OWS_BOOL, true, 0},
	{"count", "/1D.1/counters.A", OWS_DWORD, false, 0},
	{"label", "/23.1/memory", OWS_STRING, true, 0},
	{"room1_Age", "/28.2/temperature", OWS_DOUBLE, false, 0},
	{"room", "/28.3/temperature", OWS_FLOAT, false, 0},
};
#define COUNT 6

static struct instance in;
static struct ows *h;
static int64_t now;

void setUp(void)
{
	instance_start(&in, "get", signals, COUNT);
	instance_dies_soon(&in);
	now = in.start_ns + INSTANCE_S;
	instance_beat(&in, now, 100);
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
	TEST_ASSERT_EQUAL(0, ows_get(h, id, now, &v));
	return v;
}

static void test_a_value_comes_back_as_it_was_published(void)
{
	struct ows_value v;

	instance_put_double(&in, 1, 21.5, now - 5);
	v = get("room1");
	TEST_ASSERT_EQUAL_DOUBLE(21.5, v.number);
	TEST_ASSERT_EQUAL_INT64(now - 5, v.measured_ns);
	TEST_ASSERT_EQUAL_INT64(5, v.age_ns);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, v.quality);
	TEST_ASSERT_EQUAL(OWS_DOUBLE, v.type);
	TEST_ASSERT_EQUAL(1, v.target);
	TEST_ASSERT_EQUAL(1, v.count);
}

static void test_integers_come_in_both_forms(void)
{
	struct ows_value v;

	instance_put(&in, 3, 4294967295, now);
	v = get("count");
	TEST_ASSERT_EQUAL_INT64(4294967295, v.integer);
	TEST_ASSERT_EQUAL_DOUBLE(4294967295.0, v.number);
}

static void test_the_prefix_may_stand_before_a_name(void)
{
	char name[80];

	snprintf(name, sizeof(name), "%s__room1", in.name);
	TEST_ASSERT_GREATER_OR_EQUAL(0, ows_find(h, name));
	TEST_ASSERT_EQUAL(-ENOENT, ows_find(h, "ELSE__room1"));
}

static void test_a_signals_own_name_wins_over_an_attribute(void)
{
	instance_put_double(&in, 1, 1, now);
	instance_put_double(&in, 5, 55, now);
	TEST_ASSERT_EQUAL_DOUBLE(55, get("room1_Age").number);
}

static void test_an_unknown_name_is_not_found(void)
{
	TEST_ASSERT_EQUAL(-ENOENT, ows_find(h, "room2"));
	TEST_ASSERT_EQUAL(-ENOENT, ows_find(h, ""));
	TEST_ASSERT_EQUAL(-ENOENT, ows_find(h, "roo"));
	TEST_ASSERT_EQUAL(-ENOENT, ows_find(h, "room1_"));
}

static void test_the_same_name_has_the_same_id(void)
{
	TEST_ASSERT_EQUAL(ows_find(h, "relay"), ows_find(h, "relay"));
	TEST_ASSERT_NOT_EQUAL(ows_find(h, "relay"), ows_find(h, "room"));
}

static void test_an_id_that_was_never_given_is_refused(void)
{
	struct ows_value v;

	TEST_ASSERT_EQUAL(-ENOENT, ows_get(h, 12, now, &v));
	TEST_ASSERT_EQUAL(-ENOENT, ows_get(h, -1, now, &v));
	TEST_ASSERT_FALSE(ows_good(v.quality));
}

static void test_a_value_older_than_stale_after_is_not_good(void)
{
	instance_put_double(&in, 1, 1, now - 10 * INSTANCE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, get("room1").quality);
	instance_put_double(&in, 1, 1, now - 10 * INSTANCE_S - 1);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_STALE, get("room1").quality);
}

static void test_without_stale_after_a_value_stays_good(void)
{
	instance_put(&in, 2, 1, 1);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, get("relay").quality);
}

static void test_a_dead_owsd_has_no_good_values(void)
{
	instance_put(&in, 2, 1, now);
	now += 2 * INSTANCE_S;
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, get("relay").quality);
	now += 1;
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_NO_OWSD, get("relay").quality);
	TEST_ASSERT_EQUAL_INT64(1, get("relay").integer);
}

static void test_a_bad_quality_is_not_replaced(void)
{
	struct ows_sample sample = {.measured_ns = 1, .quality = OWS_Q_SENSOR, .err = -ERANGE};
	struct ows_attrs attrs = {0};

	image_publish(&in.image, 1, &sample, &attrs, NULL);
	now += 100 * INSTANCE_S;
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_SENSOR, get("room1").quality);
	TEST_ASSERT_EQUAL(-ERANGE, get("room1").err);
}

static void test_before_the_first_value_age_counts_from_the_start(void)
{
	TEST_ASSERT_EQUAL_INT64(INSTANCE_S, get("room").age_ns);
}

static void test_a_clock_read_before_the_measurement_gives_age_zero(void)
{
	instance_put_double(&in, 1, 1, now + 1000);
	TEST_ASSERT_EQUAL_INT64(0, get("room1").age_ns);
}

static void test_texts_come_whole_or_cut_to_the_room(void)
{
	struct ows_value v;
	char text[INSTANCE_TEXT + 1], little[4];
	int id = ows_find(h, "label");

	instance_put_text(&in, 4, "boiler house", now);
	TEST_ASSERT_EQUAL(0, ows_get_text(h, id, now, &v, text, sizeof(text)));
	TEST_ASSERT_EQUAL_STRING("boiler house", text);
	TEST_ASSERT_EQUAL(12, v.len);
	TEST_ASSERT_EQUAL(-ENOSPC, ows_get_text(h, id, now, &v, little, sizeof(little)));
	TEST_ASSERT_EQUAL_STRING("boi", little);
	TEST_ASSERT_EQUAL(-ENOSPC, ows_get_text(h, id, now, &v, little, 0));
}

static void test_numbers_are_printed_as_they_read_back(void)
{
	struct ows_value v;
	char text[40];

	instance_put_double(&in, 1, 0.1, now);
	TEST_ASSERT_EQUAL(0, ows_get_text(h, ows_find(h, "room1"), now, &v, text, sizeof(text)));
	TEST_ASSERT_EQUAL_STRING("0.1", text);
	instance_put(&in, 3, 42, now);
	TEST_ASSERT_EQUAL(0, ows_get_text(h, ows_find(h, "count"), now, &v, text, sizeof(text)));
	TEST_ASSERT_EQUAL_STRING("42", text);
}

static void test_signals_are_numbered_in_the_order_of_the_table(void)
{
	struct ows_value values[COUNT + 2];

	for (uint32_t i = 1; i <= 3; i += 2)
		instance_put(&in, i, i, now);
	TEST_ASSERT_EQUAL(COUNT, ows_count(h));
	for (int i = 0; i < COUNT; i++)
		TEST_ASSERT_EQUAL(0, ows_get_signal(h, i, now, &values[i]));
	TEST_ASSERT_EQUAL_INT64(3, values[2].integer);
	TEST_ASSERT_EQUAL(OWS_STRING, values[3].type);
	TEST_ASSERT_EQUAL(-ENOENT, ows_get_signal(h, COUNT, now, &values[0]));
}

static void test_info_says_what_is_configured(void)
{
	struct ows_info info;

	TEST_ASSERT_EQUAL(0, ows_info(h, 1, &info));
	TEST_ASSERT_EQUAL_STRING("relay", info.name);
	TEST_ASSERT_EQUAL_STRING("/29.1/PIO.0", info.path);
	TEST_ASSERT_EQUAL(1, info.output);
	TEST_ASSERT_EQUAL(2, info.per_factor);
	TEST_ASSERT_EQUAL(-ENOENT, ows_info(h, COUNT, &info));
	TEST_ASSERT_EQUAL(-ENOENT, ows_info(h, -1, &info));
}

static void test_the_daemon_is_alive_while_its_heart_beats(void)
{
	struct ows_daemon d;

	TEST_ASSERT_EQUAL(0, ows_daemon(h, now + 7, &d));
	TEST_ASSERT_EQUAL(1, d.alive);
	TEST_ASSERT_EQUAL_INT64(7, d.beat_age_ns);
	TEST_ASSERT_EQUAL(getpid(), d.pid);
	TEST_ASSERT_EQUAL(0, ows_daemon(h, now + 3 * INSTANCE_S, &d));
	TEST_ASSERT_EQUAL(0, d.alive);
}

/*
 * As a program with the right to write the image could forge it, or a clock of another namespace.
 */
static void test_a_heart_that_beats_in_the_future_is_dead(void)
{
	static const int64_t ahead[] = {3 * INSTANCE_S, 3600 * INSTANCE_S, INT64_MAX};
	struct ows_daemon d;
	struct ows_value v;
	char text[32];

	instance_put_double(&in, 1, 21.5, now);
	for (size_t i = 0; i < sizeof(ahead) / sizeof(ahead[0]); i++) {
		instance_beat(&in, ahead[i] == INT64_MAX ? INT64_MAX : now + ahead[i], 100);
		TEST_ASSERT_EQUAL(0, ows_daemon(h, now + (int64_t)i, &d));
		TEST_ASSERT_EQUAL(0, d.alive);
		ows_get_signal(h, 0, now + (int64_t)i, &v);
		TEST_ASSERT_EQUAL_HEX8(OWS_Q_NO_OWSD, v.quality);
		ows_get_text(h, ows_find(h, "relay_PerFactor"), now + (int64_t)i, &v, text,
		             sizeof(text));
		TEST_ASSERT_EQUAL_HEX8(OWS_Q_NO_OWSD, v.quality);
	}
	/* owsd published after this program had looked at its clock */
	instance_beat(&in, now + INSTANCE_S, 100);
	TEST_ASSERT_EQUAL(0, ows_daemon(h, now + 9, &d));
	TEST_ASSERT_EQUAL(1, d.alive);
	TEST_ASSERT_EQUAL_INT64(0, d.beat_age_ns);
}

static void test_a_value_that_was_measured_in_the_future_is_not_good(void)
{
	struct ows_value v;

	instance_put_double(&in, 1, 21.5, now + INSTANCE_S);
	TEST_ASSERT_EQUAL(0, ows_get_signal(h, 0, now + 1, &v));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, v.quality);
	TEST_ASSERT_EQUAL_INT64(0, v.age_ns);
	instance_put_double(&in, 1, 21.5, now + 3 * INSTANCE_S);
	TEST_ASSERT_EQUAL(0, ows_get_signal(h, 0, now + 2, &v));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_NO_OWSD, v.quality);
	TEST_ASSERT_EQUAL_INT64(0, v.age_ns);
}

static void test_targets_and_counters_end_with_enoent(void)
{
	struct ows_target t;
	struct ows_counter c;

	image_target(&in.image, 1, 1, 9);
	image_counter(&in.image, 1, UINT64_C(0x100000002));
	TEST_ASSERT_EQUAL(0, ows_target(h, 1, &t));
	TEST_ASSERT_EQUAL_STRING("w1", t.name);
	TEST_ASSERT_EQUAL(1, t.state);
	TEST_ASSERT_EQUAL(9, t.reconnects);
	TEST_ASSERT_EQUAL(1, t.group);
	TEST_ASSERT_EQUAL(0, t.moves);
	image_moves(&in.image, 1, 5);
	TEST_ASSERT_EQUAL(0, ows_target(h, 1, &t));
	TEST_ASSERT_EQUAL(5, t.moves);
	TEST_ASSERT_EQUAL(-ENOENT, ows_target(h, 2, &t));
	TEST_ASSERT_EQUAL(0, ows_counter(h, 1, &c));
	TEST_ASSERT_EQUAL_UINT64(UINT64_C(0x100000002), c.value);
	TEST_ASSERT_EQUAL(0, c.target);
	TEST_ASSERT_EQUAL(0, ows_counter(h, 0, &c));
	TEST_ASSERT_EQUAL(-1, c.target);
	TEST_ASSERT_EQUAL(-ENOENT, ows_counter(h, 2, &c));
}

static void test_where_it_is_served_is_told_and_so_is_an_image_without(void)
{
	TEST_ASSERT_EQUAL_STRING("owserver:/run/owsd/T.sock", ows_served(h));
	in.image.header->served_off = 0;
	TEST_ASSERT_NULL(ows_served(h));
	in.image.header->served_off = 0xfffffff0u;
	TEST_ASSERT_EQUAL_STRING("", ows_served(h));
}

static void test_every_quality_has_words(void)
{
	for (unsigned q = 0; q < 256; q++)
		TEST_ASSERT_GREATER_THAN(2, strlen(ows_quality_text((uint8_t)q)));
	TEST_ASSERT_EQUAL_STRING("good", ows_quality_text(OWS_Q_GOOD));
	TEST_ASSERT_EQUAL_STRING("device absent", ows_quality_text(OWS_Q_NO_DEVICE));
}

static void publish_command(uint32_t record, int64_t value, int64_t commanded, uint8_t flags)
{
	struct ows_sample sample = {.value = value, .quality = OWS_Q_GOOD, .flags = flags};
	struct ows_attrs attrs = {.commanded = commanded, .flags = OWS_ATTR_COMMANDED};

	image_publish(&in.image, record, &sample, &attrs, NULL);
}

static void test_a_command_is_told_beside_the_value(void)
{
	struct ows_command command;

	instance_put(&in, 2, 1, now);
	TEST_ASSERT_EQUAL(0, ows_command(h, ows_find(h, "relay"), &command));
	TEST_ASSERT_FALSE(command.given || command.pending || command.safe);
	publish_command(2, 1, 0, OWS_SAMPLE_PENDING);
	TEST_ASSERT_EQUAL(0, ows_command(h, ows_find(h, "relay"), &command));
	TEST_ASSERT_TRUE(command.given && command.pending && !command.safe);
	TEST_ASSERT_EQUAL_INT64(0, command.integer);
	TEST_ASSERT_EQUAL(1, get("relay").integer);
	publish_command(1, value_of_double(1.5), value_of_double(-2.25), OWS_SAMPLE_SAFE);
	TEST_ASSERT_EQUAL(0, ows_command(h, ows_find(h, "room1"), &command));
	TEST_ASSERT_TRUE(command.given && !command.pending && command.safe);
	TEST_ASSERT_EQUAL_DOUBLE(-2.25, command.number);
	TEST_ASSERT_EQUAL_INT64(0, command.integer);
}

static void test_strings_and_what_is_no_signal_have_no_command(void)
{
	struct ows_command command;

	publish_command(4, 0, 1, 0);
	TEST_ASSERT_EQUAL(0, ows_command(h, ows_find(h, "label"), &command));
	TEST_ASSERT_FALSE(command.given);
	TEST_ASSERT_EQUAL(-ENOENT, ows_command(h, ows_find(h, "_RECONNECTS"), &command));
	TEST_ASSERT_EQUAL(-ENOENT, ows_command(h, 12345, &command));
	TEST_ASSERT_EQUAL(-ENOENT, ows_command(h, -1, &command));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_command_is_told_beside_the_value);
	RUN_TEST(test_strings_and_what_is_no_signal_have_no_command);
	RUN_TEST(test_a_value_comes_back_as_it_was_published);
	RUN_TEST(test_integers_come_in_both_forms);
	RUN_TEST(test_the_prefix_may_stand_before_a_name);
	RUN_TEST(test_a_signals_own_name_wins_over_an_attribute);
	RUN_TEST(test_an_unknown_name_is_not_found);
	RUN_TEST(test_the_same_name_has_the_same_id);
	RUN_TEST(test_an_id_that_was_never_given_is_refused);
	RUN_TEST(test_a_value_older_than_stale_after_is_not_good);
	RUN_TEST(test_without_stale_after_a_value_stays_good);
	RUN_TEST(test_a_dead_owsd_has_no_good_values);
	RUN_TEST(test_a_bad_quality_is_not_replaced);
	RUN_TEST(test_before_the_first_value_age_counts_from_the_start);
	RUN_TEST(test_a_clock_read_before_the_measurement_gives_age_zero);
	RUN_TEST(test_texts_come_whole_or_cut_to_the_room);
	RUN_TEST(test_numbers_are_printed_as_they_read_back);
	RUN_TEST(test_signals_are_numbered_in_the_order_of_the_table);
	RUN_TEST(test_info_says_what_is_configured);
	RUN_TEST(test_the_daemon_is_alive_while_its_heart_beats);
	RUN_TEST(test_a_heart_that_beats_in_the_future_is_dead);
	RUN_TEST(test_a_value_that_was_measured_in_the_future_is_not_good);
	RUN_TEST(test_targets_and_counters_end_with_enoent);
	RUN_TEST(test_where_it_is_served_is_told_and_so_is_an_image_without);
	RUN_TEST(test_every_quality_has_words);
	return UNITY_END();
}
