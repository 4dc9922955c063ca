/* SPDX-License-Identifier: MIT */
/* To which of the known ids a search will lead. */
#include "unity.h"

#include "hal/serial/known.h"

/* In the order of a search: the lowest bit first, 0 before 1. */
static const uint8_t a[8] = {0x10}, b[8] = {0x28}, c[8] = {0x3A}, last[8] = {0xFF};

static struct known_ids known;

void setUp(void)
{
	known.n = 0;
	known_found(&known, -1, c);
	known_found(&known, -1, a);
}

void tearDown(void)
{
}

static const uint8_t *expected(const uint8_t directions[8])
{
	int at = known_expect(&known, directions);

	return at < 0 ? last : known.id[at];
}

static void test_a_search_leads_to_the_next_id_from_its_directions_on(void)
{
	static const uint8_t none[8] = {0}, behind_a[8] = {0x08}, second[8] = {0x02};

	TEST_ASSERT_EQUAL_HEX8(0x10, expected(none)[0]);
	TEST_ASSERT_EQUAL_HEX8(0x10, expected(a)[0]);
	TEST_ASSERT_EQUAL_HEX8(0x3A, expected(behind_a)[0]);
	TEST_ASSERT_EQUAL_HEX8(0x3A, expected(second)[0]);
	TEST_ASSERT_EQUAL_PTR(last, expected(last));
	known_found(&known, -1, b);
	TEST_ASSERT_EQUAL_HEX8(0x28, expected(behind_a)[0]);
}

static void test_what_is_found_elsewhere_takes_the_place_of_what_was_expected(void)
{
	known_found(&known, known_expect(&known, a), a);
	TEST_ASSERT_EQUAL_UINT(2, known.n);
	known_found(&known, known_expect(&known, a), b);
	TEST_ASSERT_EQUAL_UINT(2, known.n);
	TEST_ASSERT_EQUAL_HEX8(0x28, expected(a)[0]);
	/* it is known already */
	known_found(&known, known_expect(&known, b), c);
	TEST_ASSERT_EQUAL_UINT(1, known.n);
	TEST_ASSERT_EQUAL_HEX8(0x3A, expected(a)[0]);
	known_found(&known, 0, b);
	TEST_ASSERT_EQUAL_UINT(1, known.n);
	TEST_ASSERT_EQUAL_HEX8(0x28, expected(a)[0]);
}

static void test_what_has_no_room_is_not_kept(void)
{
	for (unsigned i = 0; i < 2 * KNOWN_IDS; i++) {
		const uint8_t id[8] = {0x28, (uint8_t)i};

		known_found(&known, -1, id);
	}
	TEST_ASSERT_EQUAL_UINT(KNOWN_IDS, known.n);
	TEST_ASSERT_EQUAL_HEX8(0x3A, known.id[0][0]);
	known_found(&known, 0, b);
	TEST_ASSERT_EQUAL_UINT(KNOWN_IDS - 1, known.n); /* b is one of them */
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_search_leads_to_the_next_id_from_its_directions_on);
	RUN_TEST(test_what_is_found_elsewhere_takes_the_place_of_what_was_expected);
	RUN_TEST(test_what_has_no_room_is_not_kept);
	return UNITY_END();
}
