/* SPDX-License-Identifier: MIT */
/* Searches of a wire on which three bits in a thousand are turned over. */
#include <string.h>

#include "unity.h"

#include "hal/wire/search.h"
#include "tests/unit/aid/native_scene.h"

#define DEVICES 30
#define LISTS 20

static struct trouble trouble;

void setUp(void)
{
	native_begin();
	wire_init(&host, 1, 1);
	for (unsigned i = 0; i < DEVICES; i++)
		wire_add(0, "DS18B20", (uint8_t)(i * 37 + 1));
	wire_net.trouble = &trouble;
	trouble.random = 20251;
	trouble_none(&trouble);
}

void tearDown(void)
{
	native_end();
}

static void make_noise(void)
{
	trouble.kind = TROUBLE_NOISE;
	trouble.probability = 0.003;
}

static unsigned lines(const char *text, size_t len)
{
	unsigned n = 0;

	for (size_t i = 0; i < len; i++)
		n += text[i] == '\n';
	return n;
}

/* A wrong bit costs the search for one device, not the whole list. */
static void test_a_noisy_wire_can_be_listed(void)
{
	unsigned most = 0, listed = 0;

	start();
	host_run(&host, bus, host.now + 10 * HOST_S);
	make_noise();
	for (unsigned i = 0; i < LISTS; i++) {
		uint32_t id = ask(BUS_DIR, BUS_GUEST, true, "/bus.0", NULL);
		const struct bus_answer *answer = answer_to(id);

		if (answer->err)
			continue;
		listed++;
		most += lines((const char *)data[id], answer->len) > DEVICES / 2;
	}
	TEST_ASSERT_GREATER_THAN_UINT(LISTS * 3 / 4, listed);
	TEST_ASSERT_GREATER_THAN_UINT(LISTS / 4, most);
}

/*
 * ... nor the first one: each device is found. A wrong bit may also hide a branch from a search
 * whose checksums are right: a round in which one was wrong calls nobody lost.
 */
static void test_all_devices_of_a_noisy_wire_are_found(void)
{
	make_noise();
	start();
	host_run(&host, bus, host.now + 60 * HOST_S);
	TEST_ASSERT_GREATER_OR_EQUAL_UINT64(DEVICES, counted("devices_found"));
	TEST_ASSERT_EQUAL_UINT64(0, counted("devices_lost"));
}

static void test_what_two_ids_have_in_common_is_counted_from_the_first_bit(void)
{
	uint8_t a[8] = {0x28, 0x01, 0x00, 0xff, 0, 0, 0, 0x5a}, b[8];

	memcpy(b, a, sizeof(b));
	TEST_ASSERT_EQUAL_UINT(64, search_common(a, b));
	b[7] ^= 0x80;
	TEST_ASSERT_EQUAL_UINT(63, search_common(a, b));
	b[1] ^= 0x10;
	TEST_ASSERT_EQUAL_UINT(12, search_common(a, b));
	b[0] ^= 0x01;
	TEST_ASSERT_EQUAL_UINT(0, search_common(a, b));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_noisy_wire_can_be_listed);
	RUN_TEST(test_all_devices_of_a_noisy_wire_are_found);
	RUN_TEST(test_what_two_ids_have_in_common_is_counted_from_the_first_bit);
	return UNITY_END();
}
