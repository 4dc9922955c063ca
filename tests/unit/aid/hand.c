/* SPDX-License-Identifier: MIT */
/* Works a simulated wire by hand: resets, slots, searches. */
#include <stdarg.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/hand.h"

void hand_clear(struct hand *hand)
{
	sim_wire_clear(&hand->wire);
	*hand = (struct hand){0};
}

struct sim_slave *hand_plug(struct hand *hand, const struct sim_family *family, uint8_t last)
{
	const uint8_t id[6] = {last};
	struct sim_slave *slave = sim_slave_create(family, id);

	TEST_ASSERT_NOT_NULL(slave);
	TEST_ASSERT_EQUAL_INT(0, sim_wire_add(&hand->wire, slave));
	sim_slave_power_on(slave, hand->now);
	return slave;
}

bool hand_reset(struct hand *hand)
{
	bool present = sim_wire_reset(&hand->wire, hand->overdrive, hand->now);

	hand->now += hand->overdrive ? 146000 : 1184000;
	return present;
}

bool hand_bit(struct hand *hand, bool out)
{
	bool line = sim_wire_slot(&hand->wire, out, hand->overdrive, hand->now);

	hand->now += hand->overdrive ? 10500 : 69300;
	return line;
}

void hand_write(struct hand *hand, const uint8_t *bytes, unsigned n)
{
	for (unsigned i = 0; i < 8 * n; i++)
		hand_bit(hand, bytes[i / 8] >> (i % 8) & 1);
}

void hand_read(struct hand *hand, uint8_t *bytes, unsigned n)
{
	memset(bytes, 0, n);
	for (unsigned i = 0; i < 8 * n; i++)
		bytes[i / 8] |= (uint8_t)(hand_bit(hand, true) << (i % 8));
}

uint8_t hand_byte(struct hand *hand)
{
	uint8_t byte;

	hand_read(hand, &byte, 1);
	return byte;
}

void hand_skip(struct hand *hand, unsigned n, ...)
{
	uint8_t byte = 0xCC;
	va_list bytes;

	TEST_ASSERT_TRUE(hand_reset(hand));
	hand_write(hand, &byte, 1);
	va_start(bytes, n);
	while (n--) {
		byte = (uint8_t)va_arg(bytes, int);
		hand_write(hand, &byte, 1);
	}
	va_end(bytes);
}

void hand_match(struct hand *hand, const struct sim_slave *slave)
{
	const uint8_t match = 0x55;

	TEST_ASSERT_TRUE(hand_reset(hand));
	hand_write(hand, &match, 1);
	hand_write(hand, slave->rom, 8);
}

unsigned hand_search(struct hand *hand, uint8_t command, uint8_t (*rom)[8], unsigned room)
{
	uint8_t path[8] = {0};
	int fork = -1;
	unsigned found = 0;

	do {
		int last = -1;

		if (found == room || !hand_reset(hand))
			return found;
		hand_write(hand, &command, 1);
		for (int i = 0; i < 64; i++) {
			uint8_t *byte = &path[i / 8], mask = (uint8_t)(1 << i % 8);
			bool id = hand_bit(hand, true), complement = hand_bit(hand, true);
			bool way = id;

			if (id && complement)
				return found;
			if (!id && !complement) {
				way = i < fork ? *byte & mask : i == fork;
				if (!way)
					last = i;
			}
			*byte = (uint8_t)(way ? *byte | mask : *byte & ~mask);
			hand_bit(hand, way);
		}
		memcpy(rom[found++], path, 8);
		fork = last;
	} while (fork >= 0);
	return found;
}

bool hand_in_alarm(struct hand *hand, const struct sim_slave *slave)
{
	uint8_t rom[16][8];
	unsigned n = hand_search(hand, 0xEC, rom, 16);

	for (unsigned i = 0; i < n; i++) {
		if (memcmp(rom[i], slave->rom, 8) == 0)
			return true;
	}
	return false;
}
