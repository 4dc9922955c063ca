/* SPDX-License-Identifier: MIT */
/* Which DS9490R a target is, and what becomes of one that is pulled, busy, or the kernel's. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/parts.h"
#include "tests/unit/aid/usb_scene.h"

#define WIRE(id) \
	"chip DS2482-100 0x18\nDS1420 81." id " as own\nDS18B20 28." id " as t temperature 21.5\n"
static const char first[] = WIRE("000000000001"), second[] = WIRE("000000000002");
static const char third[] = WIRE("000000000003");

void setUp(void)
{
	sticks_begin();
}

void tearDown(void)
{
	sticks_end();
}

static void refused(int err, const char *text)
{
	TEST_ASSERT_EQUAL_INT(err, sticks_try());
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(sticks.why, text), sticks.why);
	TEST_ASSERT_EQUAL_UINT(0, sticks.master->ops->channels(sticks.master));
}

/* The adapter that was opened; the next try is another one. */
static const char *opened(void)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, sticks_try(), sticks.why);
	for (unsigned i = 0; i < sticks.sticks; i++) {
		if (!sticks.stick[i].open)
			continue;
		sticks.master->ops->close(sticks.master);
		return sticks.stick[i].place.name;
	}
	return "none";
}

static int visible(void)
{
	uint64_t mark;

	return sticks.master->ops->visible(sticks.master, &mark);
}

static void test_a_target_is_a_chip_of_an_adapter_a_place_or_nothing(void)
{
	static const char *const wrong[] = {"1",
	                                    "1-",
	                                    "-1",
	                                    "1-1.",
	                                    "1-a",
	                                    "28.000000000001",
	                                    "81.00000000000",
	                                    "81.000000000001.00",
	                                    "/dev/ttyUSB0"};
	static const char *const right[] = {"", "1-1", "12-1.4.2", "81.000000000001",
	                                    "81.3B4429000000"};

	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
		TEST_ASSERT_EQUAL_INT_MESSAGE(-EINVAL,
		                              usb_create(&sticks_system, wrong[i], &sticks.host.env,
		                                         &sticks.master, sticks.why,
		                                         sizeof(sticks.why)),
		                              wrong[i]);
		TEST_ASSERT_NOT_NULL(strstr(sticks.why, "81.3B4429000000, or its place, as 1-1.4"));
	}
	for (size_t i = 0; i < sizeof(right) / sizeof(right[0]); i++) {
		sticks_make(right[i]);
		sticks.master->ops->destroy(sticks.master);
		sticks.master = NULL;
	}
}

static void test_without_a_name_the_only_one_is_taken(void)
{
	sticks_make("");
	TEST_ASSERT_EQUAL_INT(0, visible());
	refused(-ENODEV, "no DS9490R: is it plugged in? lsusb -d 04fa:2490");
	stick_add(first);
	stick_add(second);
	TEST_ASSERT_EQUAL_INT(1, visible());
	refused(-EINVAL, "there are 2 DS9490R, at USB 1-1, 1-2: name one, as usb:1-1");
	TEST_ASSERT_EQUAL_UINT(0, sticks.stick[0].opens + sticks.stick[1].opens);
	stick_pull(&sticks.stick[0]);
	TEST_ASSERT_EQUAL_STRING("1-2", opened());
	/* from now on it is that one */
	stick_plug(&sticks.stick[0], "1-1");
	TEST_ASSERT_EQUAL_STRING("1-2", opened());
	stick_pull(&sticks.stick[1]);
	refused(-ENODEV, "no DS9490R with the chip 81.000000000002: is it plugged in?");
	TEST_ASSERT_EQUAL_INT(0, visible());
	stick_plug(&sticks.stick[1], "2-4.1");
	TEST_ASSERT_EQUAL_INT(1, visible());
	TEST_ASSERT_EQUAL_STRING("2-4.1", opened());
}

static void test_one_is_found_by_its_chip_wherever_it_is_plugged_in(void)
{
	stick_add(first);
	stick_add(second);
	stick_add(third);
	sticks_make("81.000000000002");
	TEST_ASSERT_EQUAL_STRING("1-2", opened());
	stick_plug(&sticks.stick[1], "1-9");
	stick_plug(&sticks.stick[2], "1-2");
	TEST_ASSERT_EQUAL_STRING("1-9", opened());
	stick_pull(&sticks.stick[1]);
	refused(-ENODEV, "no DS9490R with the chip 81.000000000002");
	/* the others are not opened again and again while it is awaited */
	unsigned opens = sticks.stick[0].opens + sticks.stick[2].opens;

	refused(-ENODEV, "no DS9490R with the chip 81.000000000002");
	TEST_ASSERT_EQUAL_UINT(opens, sticks.stick[0].opens + sticks.stick[2].opens);
	stick_plug(&sticks.stick[1], "3-1");
	TEST_ASSERT_EQUAL_STRING("3-1", opened());
}

static void test_one_is_found_by_its_place_whichever_it_is(void)
{
	stick_add(first);
	stick_add(second);
	sticks_make("1-2");
	TEST_ASSERT_EQUAL_STRING("1-2", opened());
	stick_plug(&sticks.stick[1], "1-9");
	TEST_ASSERT_EQUAL_INT(0, visible());
	refused(-ENODEV, "no DS9490R at USB 1-2: is it plugged in?");
	stick_plug(&sticks.stick[0], "1-2");
	TEST_ASSERT_EQUAL_INT(1, visible());
	TEST_ASSERT_EQUAL_STRING("1-2", opened());
	TEST_ASSERT_EQUAL_UINT(1, sticks.stick[0].opens);
}

static void test_the_kernels_driver_gets_it_back_at_the_end_and_not_before(void)
{
	stick_add(first);
	sticks_make("");
	TEST_ASSERT_EQUAL_INT(0, sticks_try());
	TEST_ASSERT_FALSE(sticks.stick[0].kernel);
	sticks.master->ops->close(sticks.master);
	TEST_ASSERT_FALSE(sticks.stick[0].kernel);
	sticks.master->ops->destroy(sticks.master);
	sticks.master = NULL;
	TEST_ASSERT_TRUE(sticks.stick[0].kernel);
}

static void test_the_kernels_driver_gets_back_at_once_what_is_not_the_one(void)
{
	stick_add(first);
	stick_add(second);
	sticks_make("81.000000000002");
	TEST_ASSERT_EQUAL_STRING("1-2", opened());
	TEST_ASSERT_FALSE(sticks.stick[1].kernel);
	stick_pull(&sticks.stick[1]);
	refused(-ENODEV, "no DS9490R with the chip 81.000000000002");
	TEST_ASSERT_NOT_EQUAL_UINT(0, sticks.stick[0].opens);
	TEST_ASSERT_TRUE(sticks.stick[0].kernel);
}

static void test_one_that_cannot_be_opened_is_the_reason_and_is_tried_again(void)
{
	stick_add(first);
	stick_add(second);
	sticks.stick[1].refuses = -EACCES;
	sticks_make("81.000000000002");
	refused(-EACCES, "1-2 cannot be opened");
	sticks.stick[1].refuses = 0;
	TEST_ASSERT_EQUAL_STRING("1-2", opened());
}

/* Each of two targets has the other's adapter open at first. */
static void test_two_targets_find_theirs(void)
{
	struct link_master *master[2];
	unsigned open = 0;

	stick_add(second);
	stick_add(first);
	for (unsigned i = 0; i < 2; i++) {
		sticks_make(i ? "81.000000000002" : "81.000000000001");
		master[i] = sticks.master;
	}
	for (unsigned round = 0; round < 4 && open < 2; round++)
		for (unsigned i = 0; i < 2; i++)
			if (!master[i]->ops->channels(master[i]))
				open += !master[i]->ops->open(master[i], sticks.why,
				                              sizeof(sticks.why));
	TEST_ASSERT_EQUAL_UINT(2, open);
	master[0]->ops->destroy(master[0]);
	TEST_ASSERT_TRUE(sticks.stick[0].open);
	TEST_ASSERT_FALSE(sticks.stick[1].open);
}

static void test_on_a_short_wire_the_only_one_is_taken_and_of_two_none(void)
{
	stick_add(first);
	sticks_make("81.000000000001");
	stick_event(&sticks.stick[0], "short 0x18 for 10s");
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, sticks_try(), sticks.why);
	TEST_ASSERT_EQUAL_INT(-ECOMM, part_reset(sticks.wire));
	sticks.master->ops->close(sticks.master);
	stick_add(second);
	refused(-ECOMM, "whether the adapter at USB 1-1 has the chip 81.000000000001");
	TEST_ASSERT_EQUAL_INT(1, visible());
	TEST_ASSERT_TRUE(sticks.stick[0].kernel && sticks.stick[1].kernel);
	/* nobody has to plug it in again when the wire is mended */
	sticks.host.now += 10 * HOST_S;
	TEST_ASSERT_EQUAL_STRING("1-1", opened());
}

/* It may have its supply for a moment only. */
static void test_one_that_does_not_show_its_own_chip_is_asked_again(void)
{
	stick_add(first);
	sticks_make("81.000000000001");
	stick_event(&sticks.stick[0], "unplug own");
	refused(-EIO, "the adapter at USB 1-1 does not show its own chip");
	stick_event(&sticks.stick[0], "plug own");
	TEST_ASSERT_EQUAL_STRING("1-1", opened());
}

static void test_one_that_is_pulled_while_it_is_opened_is_named(void)
{
	int err = -ENODEV;

	for (unsigned n = 1; err; n++) {
		stick_add(first);
		sticks_make("81.000000000001");
		sticks.pulls = true;
		sticks.fail_at = n;
		sticks.why[0] = '\0';
		err = sticks_try();
		TEST_ASSERT_TRUE(!err || strstr(sticks.why, "the adapter at USB 1-1"));
		TEST_ASSERT_TRUE(!err || err == -ENODEV);
		TEST_ASSERT_TRUE(err || n > 10);
		tearDown();
		setUp();
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_target_is_a_chip_of_an_adapter_a_place_or_nothing);
	RUN_TEST(test_without_a_name_the_only_one_is_taken);
	RUN_TEST(test_one_is_found_by_its_chip_wherever_it_is_plugged_in);
	RUN_TEST(test_one_is_found_by_its_place_whichever_it_is);
	RUN_TEST(test_the_kernels_driver_gets_it_back_at_the_end_and_not_before);
	RUN_TEST(test_the_kernels_driver_gets_back_at_once_what_is_not_the_one);
	RUN_TEST(test_one_that_cannot_be_opened_is_the_reason_and_is_tried_again);
	RUN_TEST(test_two_targets_find_theirs);
	RUN_TEST(test_one_that_does_not_show_its_own_chip_is_asked_again);
	RUN_TEST(test_on_a_short_wire_the_only_one_is_taken_and_of_two_none);
	RUN_TEST(test_one_that_is_pulled_while_it_is_opened_is_named);
	return UNITY_END();
}
