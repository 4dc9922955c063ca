/* SPDX-License-Identifier: MIT */
/*
 * A write that has reached the chip, but that nobody could see to have: its request fails, and
 * stands as it is. The next write of something else changes that alone.
 */
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/one_slave.h"

static struct trouble trouble;
static struct {
	uint8_t write, read; /* commands: from write on all answers of read are disturbed */
	bool written;
	unsigned answers;
} failing;
static unsigned turn_at; /* bit of the next command `write` that is turned over; 0: none */

void setUp(void)
{
	one_slave_begin();
	memset(&failing, 0, sizeof(failing));
	turn_at = 0;
}

void tearDown(void)
{
	one_slave_end();
}

static void turn(unsigned slots)
{
	trouble.kind = TROUBLE_TURN;
	trouble.mask = 1;
	trouble.at = trouble.slots + slots;
}

/*
 * Match ROM takes nine bytes. No two answers in a row have the same wrong bit. Of the PIO status,
 * which is sent again and again, the second byte counts.
 */
static void sent(const uint8_t *bytes, size_t n)
{
	if (n < 10)
		return;
	failing.written |= bytes[9] == failing.write;
	if (failing.written && bytes[9] == failing.read)
		turn((failing.read == 0xf5 ? 8 : 0) + failing.answers++ % 7);
}

static void sends(const uint8_t *bytes, size_t n)
{
	if (!turn_at || n < 10 || bytes[9] != failing.write)
		return;
	turn(turn_at);
	turn_at = 0;
}

static void start(const char *chip)
{
	wire_init(&host, 1, 1);
	trouble_none(&trouble);
	wire_net.trouble = &trouble;
	slave = wire_add(0, chip, 1);
	bus = wire_open();
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host.now + HOST_S));
}

/* The request fails, but the chip has taken it. */
static void fails(uint8_t write, uint8_t read, const char *property, const char *text)
{
	failing.write = write;
	failing.read = read;
	failing.written = false;
	wire_net.sent = sent;
	TEST_ASSERT_LESS_THAN_INT_MESSAGE(0, go(BUS_WRITE, property, text)->err, property);
	TEST_ASSERT_TRUE(failing.written);
	wire_net.sent = NULL;
}

static const struct switches {
	const char *chip, *first, *second;
	const char *before, *after; /* of both */
	uint8_t write, read;
} switches[] = {
	{"DS2406", "PIO.A", "PIO.B", "0", "1", 0x55, 0xaa},
	{"DS2408", "PIO.0", "PIO.1", "0", "1", 0x5a, 0xf0},
	{"DS2413", "PIO.A", "PIO.B", "0", "1", 0x5a, 0xf5},
	{"DS2450", "PIO.A", "PIO.B", "1", "0", 0x55, 0xaa},
	{"DS28E04", "PIO.0", "PIO.1", "0", "1", 0x5a, 0xf0},
	{"DS28EA00", "PIO.A", "PIO.B", "0", "1", 0xa5, 0xf5},
};

static void test_the_next_write_switches_no_other_output_back(void)
{
	for (size_t i = 0; i < sizeof(switches) / sizeof(switches[0]); i++) {
		const struct switches *s = &switches[i];

		start(s->chip);
		writes(s->first, s->before);
		writes(s->second, s->before);
		fails(s->write, s->read, s->first, s->after);
		reads(s->first, s->after);
		writes(s->second, s->after);
		TEST_ASSERT_EQUAL_INT(0, go(BUS_READ, s->first, NULL)->err);
		slave_data[host.answer[0].len] = '\0';
		TEST_ASSERT_EQUAL_STRING_MESSAGE(s->after, (char *)slave_data, s->chip);
		reads(s->second, s->after);
		tearDown();
		setUp();
	}
}

/* Its own disturbed write has switched that back: made again it begins with what stood there. */
static void test_a_write_that_is_made_again_switches_no_other_output_back(void)
{
	start("DS2406");
	writes("PIO.BYTE", "0");
	fails(0x55, 0xaa, "PIO.A", "1");
	wire_net.sends = sends;
	turn_at = 12 * 8 + 5;
	writes("PIO.B", "1");
	TEST_ASSERT_EQUAL_UINT(0, turn_at);
	reads("PIO.BYTE", "           3");
}

static void test_a_write_of_all_outputs_ends_what_was_before(void)
{
	start("DS2408");
	fails(0x5a, 0xf0, "PIO.0", "1");
	fails(0x5a, 0xf0, "PIO.BYTE", "6");
	writes("PIO.3", "1");
	reads("PIO.BYTE", "          14");
}

static void test_the_next_write_of_a_limit_leaves_the_other(void)
{
	start("DS18B20");
	fails(0x48, 0xbe, "temphigh", "30");
	writes("templow", "10");
	sim_slave_brownout(slave, wire_time());
	reads("temphigh", "          30");
	reads("templow", "          10");
	tearDown();
	setUp();
	start("DS2450");
	fails(0x55, 0xaa, "set_alarm/volthigh.D", "3");
	writes("set_alarm/voltlow.D", "1");
	reads("set_alarm/volthigh.D", "           3");
}

/* EEPROM in blocks, which a copy takes as a whole. */
static void test_the_next_write_leaves_the_other_bytes_of_its_block(void)
{
	static const char *const chips[] = {"DS2751", "DS2755", "DS2760", "DS2770"};
	uint8_t settings[16];

	for (size_t i = 0; i < sizeof(chips) / sizeof(chips[0]); i++) {
		start(chips[i]);
		writes("pages/page.0", "0123456789abcdef");
		TEST_ASSERT_EQUAL_INT(0, go(BUS_READ, "pages/page.1", NULL)->err);
		memcpy(settings, slave_data, sizeof(settings));
		fails(0x48, 0x69, "vbias", "0.0001");
		writes("pages/page.0", "XYZ");
		sim_slave_brownout(slave, wire_time());
		TEST_ASSERT_EQUAL_INT(0, go(BUS_READ, "pages/page.0", NULL)->err);
		TEST_ASSERT_EQUAL_MEMORY_MESSAGE("XYZ3456789abcdef", slave_data, 16, chips[i]);
		fails(0x48, 0x69, "pages/page.0", "abc");
		writes("vbias", "-0.0001");
		TEST_ASSERT_EQUAL_INT(0, go(BUS_READ, "pages/page.1", NULL)->err);
		TEST_ASSERT_EQUAL_MEMORY_MESSAGE(settings, slave_data, 1, chips[i]);
		TEST_ASSERT_EQUAL_MEMORY_MESSAGE(settings + 4, slave_data + 4, 12, chips[i]);
		tearDown();
		setUp();
	}
}

static void test_a_reset_ends_an_increment_that_failed(void)
{
	start("DS2436");
	writes("counter/increment", "1");
	fails(0xb5, 0xb2, "counter/increment", "1");
	writes("counter/reset", "1");
	writes("counter/increment", "1");
	reads("counter/cycles", "           1");
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_next_write_switches_no_other_output_back);
	RUN_TEST(test_a_write_that_is_made_again_switches_no_other_output_back);
	RUN_TEST(test_a_write_of_all_outputs_ends_what_was_before);
	RUN_TEST(test_the_next_write_of_a_limit_leaves_the_other);
	RUN_TEST(test_the_next_write_leaves_the_other_bytes_of_its_block);
	RUN_TEST(test_a_reset_ends_an_increment_that_failed);
	return UNITY_END();
}
