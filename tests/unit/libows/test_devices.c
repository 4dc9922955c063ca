/* SPDX-License-Identifier: MIT */
/* What libows and ows.py return of devices, also of an image that is not as owsd made it. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "src/memory/shm/entries.h"
#include "tests/unit/aid/instance.h"

static const struct instance_signal signals[] = {
	{"room", "/28.551DDF030000/temperature", OWS_DOUBLE, false, 0, "28.551DDF030000"},
	{"alone", "/alias/temperature", OWS_DOUBLE, false, 0, NULL},
	{"cellar", "/28.FFDDDF030000/temperature", OWS_DOUBLE, false, 0, "28.FFDDDF030000"},
};
static const struct ows_device_entry full = {
	.target = 1,
	.answers = 0x100000001,
	.errors = 0x200000002,
	.retries = 0x300000003,
	.wire_us = 0x400000004,
	.ok_ns = 5,
	.power = OWS_POWER_PARASITE,
	.identity = "DS18B20 clone, family B1",
};

static struct instance in;
static struct ows *h;

void setUp(void)
{
	instance_start(&in, "devices", signals, 3);
	image_device(&in.image, 1, &full);
	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_READ, &h));
}

void tearDown(void)
{
	ows_close(h);
	instance_end(&in);
}

static int open_it(void)
{
	ows_close(h);
	h = NULL;
	return ows_open(in.name, OWS_READ, &h);
}

static struct ows_device device_of(int index)
{
	struct ows_device device;

	TEST_ASSERT_EQUAL(0, ows_device(h, index, &device));
	return device;
}

static void test_a_device_has_all_that_owsd_put_into_its_entry(void)
{
	struct ows_device device = device_of(1);

	TEST_ASSERT_EQUAL_STRING("28.FFDDDF030000", device.id);
	TEST_ASSERT_EQUAL_STRING("DS18B20", device.family);
	TEST_ASSERT_EQUAL_STRING("DS18B20 clone, family B1", device.identity);
	TEST_ASSERT_EQUAL(1, device.target);
	TEST_ASSERT_EQUAL(OWS_POWER_PARASITE, device.power);
	TEST_ASSERT_EQUAL_UINT64(0x100000001, device.answers);
	TEST_ASSERT_EQUAL_UINT64(0x200000002, device.errors);
	TEST_ASSERT_EQUAL_UINT64(0x300000003, device.retries);
	TEST_ASSERT_EQUAL_UINT64(0x400000004, device.wire_us);
	TEST_ASSERT_EQUAL_INT64(5, device.ok_ns);
}

static void test_a_device_of_which_nothing_is_known_says_so(void)
{
	struct ows_device device = device_of(0);

	TEST_ASSERT_EQUAL_STRING("28.551DDF030000", device.id);
	TEST_ASSERT_EQUAL_STRING("", device.identity);
	TEST_ASSERT_EQUAL(-1, device.target);
	TEST_ASSERT_EQUAL(OWS_POWER_UNKNOWN, device.power);
	TEST_ASSERT_EQUAL_INT64(0, device.ok_ns);
}

static void test_there_is_nothing_past_the_end(void)
{
	struct ows_device device;

	TEST_ASSERT_EQUAL(-ENOENT, ows_device(h, 2, &device));
	TEST_ASSERT_EQUAL(-ENOENT, ows_device(h, -1, &device));
	TEST_ASSERT_EQUAL(-1, device.target);
}

static void test_an_entry_that_owsd_did_not_end_is_an_error(void)
{
	struct ows_device device;

	in.image.devices[1].seq++;
	TEST_ASSERT_EQUAL(-EIO, ows_device(h, 1, &device));
	in.image.devices[1].seq++;
	TEST_ASSERT_EQUAL(0, ows_device(h, 1, &device));
}

static void test_numbers_that_lead_elsewhere_lead_nowhere(void)
{
	struct ows_device_entry *entry = &in.image.devices[1];
	struct ows_device device;

	entry->id_off = in.image.header->size - 8;
	entry->family_off = 0xfffffff0;
	entry->target = 2;
	entry->power = 3;
	memset(entry->identity, 'x', sizeof(entry->identity));
	device = device_of(1);
	TEST_ASSERT_EQUAL_STRING("", device.id);
	TEST_ASSERT_EQUAL_STRING("", device.family);
	TEST_ASSERT_EQUAL(-1, device.target);
	TEST_ASSERT_EQUAL(OWS_POWER_UNKNOWN, device.power);
	TEST_ASSERT_EQUAL_UINT(sizeof(device.identity) - 1, strlen(device.identity));
}

static struct ows_area_entry *area(void)
{
	return &in.image.areas[OWS_AREA_DEVICES - 1];
}

static void test_an_area_that_does_not_lie_inside_is_refused(void)
{
	const struct ows_area_entry right = *area();

	TEST_ASSERT_EQUAL_UINT32(2, right.count);
	area()->count = (in.image.header->size - right.off) / right.size + 1;
	TEST_ASSERT_EQUAL(-EPROTO, open_it());
	area()->count = 0x02000000; /* times 128: 0 in 32 bits */
	TEST_ASSERT_EQUAL(-EPROTO, open_it());
	*area() = right;
	area()->off = in.image.header->size;
	TEST_ASSERT_EQUAL(-EPROTO, open_it());
	*area() = right;
	area()->size -= 8;
	TEST_ASSERT_EQUAL(-EPROTO, open_it());
	*area() = right;
	TEST_ASSERT_EQUAL(0, open_it());
	TEST_ASSERT_EQUAL_STRING("28.FFDDDF030000", device_of(1).id);
}

static void test_an_area_that_shrinks_after_the_opening_changes_nothing(void)
{
	*area() = (struct ows_area_entry){OWS_AREA_DEVICES, 0x7ffffff0, 0, UINT32_MAX};
	TEST_ASSERT_EQUAL_UINT64(0x100000001, device_of(1).answers);
	TEST_ASSERT_EQUAL_UINT64(0, device_of(0).answers);
}

/* As that of the first owsd of this major version. */
static void test_an_image_without_the_area_has_no_devices(void)
{
	struct ows_device device;

	in.image.header->area_count = OWS_AREA_DEVICES - 1;
	TEST_ASSERT_EQUAL(0, open_it());
	TEST_ASSERT_EQUAL(-ENOENT, ows_device(h, 0, &device));
	TEST_ASSERT_EQUAL(3, ows_count(h));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_device_has_all_that_owsd_put_into_its_entry);
	RUN_TEST(test_a_device_of_which_nothing_is_known_says_so);
	RUN_TEST(test_there_is_nothing_past_the_end);
	RUN_TEST(test_an_entry_that_owsd_did_not_end_is_an_error);
	RUN_TEST(test_numbers_that_lead_elsewhere_lead_nowhere);
	RUN_TEST(test_an_area_that_does_not_lie_inside_is_refused);
	RUN_TEST(test_an_area_that_shrinks_after_the_opening_changes_nothing);
	RUN_TEST(test_an_image_without_the_area_has_no_devices);
	return UNITY_END();
}
