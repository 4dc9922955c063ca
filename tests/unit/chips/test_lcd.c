/* SPDX-License-Identifier: MIT */
/* Tests of LCDs behind a DS2408: the pin writes that carry a message. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/native/native.h"
#include "hal/owfs/path.h"
#include "tests/unit/aid/one_slave.h"

/* An HD44780: what its pins tell it at each strobe. */
static struct display {
	unsigned bits; /* of its interface */
	bool half;
	uint8_t high;
	uint8_t text[0x80], glyphs[0x40];
	unsigned at;
	bool glyph;
	uint8_t shows, entry;
} display;

static void take(bool is_data, uint8_t byte)
{
	if (is_data) {
		if (display.glyph)
			display.glyphs[display.at++ % 0x40] = byte;
		else
			display.text[display.at++ % 0x80] = byte;
		return;
	}
	display.glyph = (byte & 0xc0) == 0x40;
	if (byte & 0x80)
		display.at = byte & 0x7f;
	else if (byte & 0x40)
		display.at = byte & 0x3f;
	else if (byte & 0x20)
		display.bits = byte & 0x10 ? 8 : 4;
	else if (byte & 0x08)
		display.shows = byte & 7;
	else if (byte & 0x04)
		display.entry = byte & 3;
	else
		display.at = 0;
	if (byte == 0x01)
		memset(display.text, ' ', sizeof(display.text));
}

static void strobe_h(uint8_t pins)
{
	TEST_ASSERT_EQUAL_HEX8(0x07, pins & 0x07);
	if (display.bits == 8) {
		take(pins & 0x08, pins & 0xf0);
	} else if (!display.half) {
		display.half = true;
		display.high = pins & 0xf0;
	} else {
		display.half = false;
		take(pins & 0x08, display.high | pins >> 4);
	}
}

static void strobe_m(uint8_t pins)
{
	take(pins & 0x80, pins & 0x7f);
}

/* The bytes for the outputs, behind the command or behind another. */
static bool is_output(const uint8_t *bytes, size_t n, uint8_t *pins)
{
	if (n == 12 && bytes[9] == 0x5a)
		bytes += 10;
	else if (n != 2)
		return false;
	*pins = bytes[0];
	return (bytes[0] ^ bytes[1]) == 0xff;
}

static void sent_h(const uint8_t *bytes, size_t n)
{
	uint8_t pins;

	if (is_output(bytes, n, &pins))
		strobe_h(pins);
}

static void sent_m(const uint8_t *bytes, size_t n)
{
	uint8_t pins;

	if (is_output(bytes, n, &pins))
		strobe_m(pins);
}

void setUp(void)
{
	one_slave_begin();
}

void tearDown(void)
{
	one_slave_end();
}

static void start(void (*strobe)(const uint8_t *, size_t))
{
	display = (struct display){.bits = 8};

	wire_init(&host, 1, 1);
	slave = wire_add(0, "DS2408", 1);
	wire_net.sent = strobe;
	bus = wire_open();
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host.now + HOST_S));
}

static void shows(unsigned at, const char *text)
{
	TEST_ASSERT_EQUAL_STRING_LEN(text, (char *)display.text + at, strlen(text));
}

static void test_four_bits_carry_a_message(void)
{
	start(sent_h);
	writes("LCD_H/message", "Hello, house");
	TEST_ASSERT_EQUAL_UINT(4, display.bits);
	TEST_ASSERT_FALSE(display.half);
	TEST_ASSERT_EQUAL_UINT8(4, display.shows);
	TEST_ASSERT_EQUAL_UINT8(2, display.entry);
	shows(0, "Hello, house    ");
	TEST_ASSERT_EQUAL_INT(0, go(BUS_READ, "strobe", NULL)->err);
	TEST_ASSERT_EQUAL_CHAR('1', slave_data[0]);
	writes("LCD_H/screen", "!");
	shows(0, "Hello, house!   ");
	writes("LCD_H/home", "1");
	writes("LCD_H/screen", "J");
	shows(0, "Jello, house!   ");
	writes("LCD_H/message", "x");
	shows(0, "x               ");
	writes("LCD_H/clear", "1");
	shows(0, "                ");
}

static void test_text_goes_to_its_line_and_column(void)
{
	start(sent_h);
	writes("LCD_H/clear", "1");
	writes("LCD_H/screenyx", "2,4:Bc");
	shows(0x40, "   Bc ");
	writes("LCD_H/screenyx", "12:d");
	shows(11, "d ");
	writes("LCD_H/screenyx", "\x04\x02z");
	shows(0x54, " z ");
	refuses(-EINVAL, BUS_WRITE, "LCD_H/screenyx", "5,1:x");
	refuses(-EINVAL, BUS_WRITE, "LCD_H/screenyx", "1,0:x");
	refuses(-EINVAL, BUS_WRITE, "LCD_H/screenyx", "text");
	shows(0, "           d ");
}

static void test_glyphs_are_drawn(void)
{
	static const uint8_t second[] = {1, 2, 3, 4, 5, 6, 7, 31},
			     last[] = {31, 17, 0, 1, 2, 3, 4, 10};

	start(sent_h);
	writes("LCD_H/redefchar.1", "\x01\x02\x03\x04\x05\x06\x07\x1f");
	TEST_ASSERT_EQUAL_MEMORY(second, display.glyphs + 8, 8);
	writes("LCD_H/redefchar_hex.7", "1F1100010203040a");
	TEST_ASSERT_EQUAL_MEMORY(last, display.glyphs + 56, 8);
	writes("LCD_H/onoff", "7");
	TEST_ASSERT_EQUAL_UINT8(7, display.shows);
	writes("LCD_H/onoff", "0");
	TEST_ASSERT_EQUAL_UINT8(0, display.shows);
	refuses(-EINVAL, BUS_WRITE, "LCD_H/redefchar.1", "short");
	refuses(-EINVAL, BUS_WRITE, "LCD_H/redefchar_hex.1", "0102030405060g08");
}

static void test_seven_bits_carry_a_message(void)
{
	char text[129];

	start(sent_m);
	writes("LCD_M/message", "Hi");
	TEST_ASSERT_EQUAL_UINT(8, display.bits);
	shows(0, "Hi              ");
	writes("LCD_M/home", "1");
	writes("LCD_M/screen", "h");
	shows(0, "hi              ");
	for (int i = 0; i < 128; i++)
		text[i] = (char)('a' + i % 26);
	text[128] = '\0';
	writes("LCD_M/message", text);
	shows(0, text);
	writes("LCD_M/clear", "1");
	shows(0, "                ");
	refuses(-EACCES, BUS_READ, "LCD_M/screen", NULL);
}

static void test_a_display_that_lost_its_power_is_set_up_again(void)
{
	start(sent_h);
	writes("LCD_H/message", "one");
	sim_slave_power_on(slave, host.now);
	display = (struct display){.bits = 8};
	TEST_ASSERT_EQUAL_INT(0, go(BUS_READ, "por", NULL)->err);
	writes("LCD_H/message", "two");
	TEST_ASSERT_EQUAL_UINT(4, display.bits);
	shows(0, "two ");
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_four_bits_carry_a_message);
	RUN_TEST(test_text_goes_to_its_line_and_column);
	RUN_TEST(test_glyphs_are_drawn);
	RUN_TEST(test_seven_bits_carry_a_message);
	RUN_TEST(test_a_display_that_lost_its_power_is_set_up_again);
	return UNITY_END();
}
