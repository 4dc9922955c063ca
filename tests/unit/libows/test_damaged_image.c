/* SPDX-License-Identifier: MIT */
/* libows on an image that is not as owsd made it: it is refused, or nothing else is read. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "src/ground/signal/value.h"
#include "tests/unit/aid/instance.h"

static const struct instance_signal signals[] = {
	{"room", "/28.1/temperature", OWS_DOUBLE, false, 0},
	{"label", "/23.1/memory", OWS_STRING, true, 0},
};

static struct instance in;
static struct ows *h;

void setUp(void)
{
	instance_start(&in, "damaged", signals, 2);
	instance_put_text(&in, 2, "boiler", ows_now());
	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_READ, &h));
}

void tearDown(void)
{
	ows_close(h);
	instance_end(&in);
}

/* As it is found by the next one that opens it. */
static int open_it(void)
{
	ows_close(h);
	h = NULL;
	return ows_open(in.name, OWS_READ, &h);
}

static void test_numbers_of_the_header_that_change_later_lead_nowhere(void)
{
	struct ows_image_header *header = in.image.header;
	struct ows_target target;
	struct ows_counter counter;
	struct ows_alarm alarm;

	header->area_off = 0x7ffffff0;
	header->area_count = 0xffffffff;
	for (unsigned i = 0; i < OWS_AREAS - 1; i++)
		in.image.areas[i] = (struct ows_area_entry){i + 1, 0x7ffffff0, 0,
		                                            i % 2 ? UINT32_MAX : 0};
	header->alarm_head = 1;
	TEST_ASSERT_EQUAL(0, ows_target(h, 1, &target));
	TEST_ASSERT_EQUAL_STRING("w1", target.name);
	TEST_ASSERT_EQUAL(-ENOENT, ows_target(h, 2, &target));
	TEST_ASSERT_EQUAL(0, ows_counter(h, 1, &counter));
	TEST_ASSERT_EQUAL_STRING("keepalives", counter.name);
	TEST_ASSERT_EQUAL(-ENOENT, ows_counter(h, 2, &counter));
	TEST_ASSERT_EQUAL(-ENOENT, ows_alarm(h, 0, &alarm));
	header->served_off = header->size - 8;
	TEST_ASSERT_EQUAL_STRING("", ows_served(h));
}

static void test_a_text_that_is_said_to_lie_elsewhere_is_not_read(void)
{
	struct ows_record *record = &in.image.records[2];
	uint32_t right = record->text_off;
	struct ows_value value;
	char text[16];
	int id = ows_find(h, "label");

	TEST_ASSERT_EQUAL(0, ows_get_text(h, id, ows_now(), &value, text, sizeof(text)));
	TEST_ASSERT_EQUAL_STRING("boiler", text);
	record->text_off = in.image.header->size;
	TEST_ASSERT_EQUAL(-EAGAIN, ows_get_text(h, id, ows_now(), &value, text, sizeof(text)));
	TEST_ASSERT_EQUAL_STRING("", text);
	record->text_off = right;
	record->text_cap = 0xfffc;
	TEST_ASSERT_EQUAL(-EAGAIN, ows_get_text(h, id, ows_now(), &value, text, sizeof(text)));
}

static void test_a_name_that_changes_into_none_of_the_table_is_not_found(void)
{
	for (uint32_t i = 0; i < in.image.record_count; i++)
		in.image.names[i].record = 1000000;
	TEST_ASSERT_EQUAL(-ENOENT, ows_find(h, "room"));
}

static void test_a_name_without_end_is_refused(void)
{
	memset(in.image.counters[1].name, 'x', sizeof(in.image.counters[1].name));
	TEST_ASSERT_EQUAL(-EPROTO, open_it());
	in.image.counters[1].name[5] = '\0';
	memset(in.image.targets[1].name, 'x', sizeof(in.image.targets[1].name));
	TEST_ASSERT_EQUAL(-EPROTO, open_it());
	in.image.targets[1].name[103] = '\0';
	TEST_ASSERT_EQUAL(0, open_it());
}

static void test_decimals_that_no_number_has_are_not_known(void)
{
	static const struct {
		uint32_t said;
		int32_t known;
	} rows[] = {{0, 0},          {17, 17},        {99, 99},         {100, -1},
	            {290489133, -1}, {INT32_MAX, -1}, {0x80000000, -1}, {UINT32_MAX, -1}};
	struct ows_info info;

	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		in.image.infos[1].decimals = rows[i].said;
		TEST_ASSERT_EQUAL(0, open_it());
		TEST_ASSERT_EQUAL(0, ows_info(h, 0, &info));
		TEST_ASSERT_EQUAL_INT32(rows[i].known, info.decimals);
	}
}

static void test_texts_at_odd_places_are_refused(void)
{
	in.image.records[2].text_off += 2;
	TEST_ASSERT_EQUAL(-EPROTO, open_it());
	in.image.records[2].text_off -= 2;
	in.image.records[2].text_cap -= 2;
	TEST_ASSERT_EQUAL(-EPROTO, open_it());
}

static void test_times_at_the_ends_of_their_range_are_old_or_new(void)
{
	struct ows_value value;
	int id = ows_find(h, "room");

	instance_put_double(&in, 1, 1, INT64_MIN);
	ows_get(h, id, ows_now(), &value);
	TEST_ASSERT_EQUAL_INT64(INT64_MAX, value.age_ns);
	instance_put_double(&in, 1, 1, INT64_MAX);
	ows_get(h, id, ows_now(), &value);
	TEST_ASSERT_EQUAL_INT64(0, value.age_ns);
	instance_beat(&in, INT64_MIN, 0);
	TEST_ASSERT_EQUAL(0, ows_get(h, id, ows_now(), &value));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_NO_OWSD, value.quality);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_numbers_of_the_header_that_change_later_lead_nowhere);
	RUN_TEST(test_a_text_that_is_said_to_lie_elsewhere_is_not_read);
	RUN_TEST(test_a_name_that_changes_into_none_of_the_table_is_not_found);
	RUN_TEST(test_a_name_without_end_is_refused);
	RUN_TEST(test_decimals_that_no_number_has_are_not_known);
	RUN_TEST(test_texts_at_odd_places_are_refused);
	RUN_TEST(test_times_at_the_ends_of_their_range_are_old_or_new);
	return UNITY_END();
}
