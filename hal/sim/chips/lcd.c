/* SPDX-License-Identifier: MIT */
/*
 * LCD controller by Louis Swart (data sheet rev. 1.7 cannot be had; the facts are those of OWFS's
 * driver and manual page): an HD44780 display, four lines of input and output with counters, 112
 * bytes of EEPROM. Everything goes through a scratchpad that has no checksum.
 */
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/families.h"

enum { PINS = 4, SCRATCHPAD = 17, EEPROM = 112, DISPLAY = 128, VERSION_TEXT = 16 };
enum { CLEAR_DISPLAY = 0x01, SET_ADDRESS = 0x80 }; /* instructions of the HD44780 */

struct lcd {
	/* What a scenario or a test may look at: EEPROM, display, then two flags. */
	uint8_t eeprom[EEPROM], display[DISPLAY], on, backlight;
	uint8_t scratchpad[SCRATCHPAD], filled; /* with so many bytes from the master */
	uint8_t cursor;
	uint8_t output; /* 1: the pin's transistor does not conduct */
	uint16_t count[PINS];
	uint8_t level; /* of the pins, when they were last looked at */
};

static uint8_t pin_levels(struct sim_slave *slave)
{
	uint8_t level = 0;

	for (unsigned i = 0; i < PINS; i++)
		if (sim_input_now(slave, i) >= 0.5)
			level |= (uint8_t)(1u << i);
	return level & sim_state(slave, lcd)->output;
}

static void lcd_create(struct sim_slave *slave)
{
	memset(sim_state(slave, lcd)->eeprom, 0xFF, EEPROM);
}

static void lcd_power_on(struct sim_slave *slave)
{
	struct lcd *s = slave->state;

	memset(s->display, ' ', DISPLAY);
	memset(s->scratchpad, 0, SCRATCHPAD);
	memset(s->count, 0, sizeof(s->count));
	s->on = s->backlight = s->cursor = s->filled = 0;
	s->output = 0x0F;
	s->level = pin_levels(slave);
}

/* Each change from outside counts, so a button counts twice. */
static void lcd_advance(struct sim_slave *slave)
{
	struct lcd *s = slave->state;
	uint8_t now = pin_levels(slave);

	for (unsigned i = 0; i < PINS; i++)
		if ((now ^ s->level) >> i & 1)
			s->count[i]++;
	s->level = now;
}

static void clear_display(struct lcd *s)
{
	memset(s->display, ' ', DISPLAY);
	s->cursor = 0;
}

static void display_instruction(struct lcd *s, uint8_t byte)
{
	if (byte == CLEAR_DISPLAY)
		clear_display(s);
	else if (byte & SET_ADDRESS)
		s->cursor = byte & 0x7F;
}

static void print_byte(struct lcd *s, uint8_t byte)
{
	s->display[s->cursor] = byte;
	s->cursor = (uint8_t)((s->cursor + 1) % DISPLAY);
}

static void take_counters(struct lcd *s)
{
	for (unsigned i = 0; i < PINS; i++) {
		sim_put(s->scratchpad + 2 * i, 2, s->count[i]);
		s->count[i] = 0;
	}
}

/* The scratchpad's first byte is an address, the others go there. */
static void write_eeprom(struct lcd *s)
{
	for (unsigned i = 1; i < s->filled && s->scratchpad[0] + i - 1 < EEPROM; i++)
		s->eeprom[s->scratchpad[0] + i - 1] = s->scratchpad[i];
}

/* ... and the second the number of bytes. */
static void read_eeprom(struct lcd *s)
{
	unsigned at = s->scratchpad[0], n = s->scratchpad[1];

	for (unsigned i = 0; i < n && i < SCRATCHPAD && at + i < EEPROM; i++)
		s->scratchpad[i] = s->eeprom[at + i];
}

static void print_scratchpad(struct lcd *s)
{
	s->cursor = s->scratchpad[0] % DISPLAY;
	for (unsigned i = 1; i < s->filled; i++)
		print_byte(s, s->scratchpad[i]);
}

/* Commands without bytes of their own. */
static void lcd_command(struct sim_slave *slave)
{
	static const char version[VERSION_TEXT + 1] = "LCD 1.00 L.Swart";
	struct lcd *s = slave->state;

	switch (slave->function->code) {
	case 0x03:
	case 0x05:
		s->on = slave->function->code == 0x03;
		if (s->on)
			clear_display(s);
		break;
	case 0x07:
	case 0x08:
		s->backlight = slave->function->code == 0x08;
		break;
	case 0x11: /* busy flag and address */
		s->scratchpad[0] = s->cursor;
		break;
	case 0x13:
		s->scratchpad[0] = s->display[s->cursor];
		break;
	case 0x22:
		s->scratchpad[0] = s->level;
		break;
	case 0x23:
		take_counters(s);
		break;
	case 0x37:
		read_eeprom(s);
		break;
	case 0x41:
		memcpy(s->scratchpad, version, VERSION_TEXT);
		break;
	case 0x48:
		print_scratchpad(s);
		break;
	case 0x49:
		clear_display(s);
		break;
	}
	sim_end(slave);
}

static void byte_command(struct sim_slave *slave)
{
	struct lcd *s = slave->state;
	uint8_t byte = slave->taken[0];

	if (slave->function->code == 0x10)
		display_instruction(s, byte);
	else if (slave->function->code == 0x12)
		print_byte(s, byte);
	else
		s->output = byte & 0x0F;
	s->level = pin_levels(slave); /* what the chip does itself is no change from outside */
	sim_end(slave);
}

static void begin_copy(struct sim_slave *slave)
{
	unsigned n = sim_state(slave, lcd)->filled;

	sim_work(slave, (n ? n - 1 : 0) * 4 * NS_PER_MS);
	sim_end(slave);
}

static void lcd_worked(struct sim_slave *slave)
{
	write_eeprom(sim_state(slave, lcd));
}

static void lcd_begin_write(struct sim_slave *slave)
{
	sim_state(slave, lcd)->filled = 0;
}

static void lcd_write_scratchpad(struct sim_slave *slave, uint8_t byte)
{
	struct lcd *s = slave->state;

	if (s->filled < SCRATCHPAD)
		s->scratchpad[s->filled++] = byte;
}

static void lcd_read_scratchpad(struct sim_slave *slave)
{
	sim_send(slave, sim_state(slave, lcd)->scratchpad, VERSION_TEXT);
}

#define COMMAND(code_) .code = (code_), .start = lcd_command
static const struct sim_function functions[] = {
	{COMMAND(0x03)},
	{COMMAND(0x05)},
	{COMMAND(0x07)},
	{COMMAND(0x08)},
	{.code = 0x10, .takes = 1, .start = byte_command}, /* Write Register, Data, GPIO */
	{COMMAND(0x11)},
	{.code = 0x12, .takes = 1, .start = byte_command},
	{COMMAND(0x13)},
	{.code = 0x21, .takes = 1, .start = byte_command},
	{COMMAND(0x22)},
	{COMMAND(0x23)},
	{COMMAND(0x37)},
	{.code = 0x39, .start = begin_copy}, /* Scratchpad to EEPROM */
	{COMMAND(0x41)},
	{COMMAND(0x48)},
	{COMMAND(0x49)},
	{.code = 0x4E, .start = lcd_begin_write, .byte = lcd_write_scratchpad},
	{.code = 0xBE, .start = lcd_read_scratchpad},
	{0},
};

static const struct sim_input inputs[] = {
	{SIM_PIN("gpio.0")}, {SIM_PIN("gpio.1")}, {SIM_PIN("gpio.2")}, {SIM_PIN("gpio.3")}, {0}};

const struct sim_family sim_lcd = {
	.name = "LCD",
	.code = 0xFF,
	.state_size = sizeof(struct lcd),
	.functions = functions,
	.inputs = inputs,
	.create = lcd_create,
	.power_on = lcd_power_on,
	.worked = lcd_worked,
	.advance = lcd_advance,
	SIM_MEMORY(lcd, eeprom, EEPROM + DISPLAY + 2),
};
