/* SPDX-License-Identifier: MIT */
/*
 * DS2408 (data sheet 19-5702): eight switches with activity latches (ds2408.c has the registers),
 * and displays with an HD44780 on one whose RSTZ is the strobe of each byte written (E). LCD_H, the
 * board of Hobby Boards: four bits on P4 to P7, RS on P3, P0 to P2 left high. LCD_M, Maxim's
 * application note 3286: seven bits on P0 to P6, RS on P7. Neither can be read.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/chips/family.h"
#include "hal/chips/switches/ds2408.h"

enum lcd_board { LCD_NONE, LCD_H, LCD_M };
enum lcd_command {
	LCD_CLEAR,
	LCD_HOME,
	LCD_ON_OFF,
	LCD_SCREEN,
	LCD_SCREEN_YX,
	LCD_MESSAGE,
	LCD_GLYPH,
	LCD_GLYPH_HEX,
};
#define LCD_DO(board, command) ((board) << 8 | (command))

/* Instructions of the HD44780 (Hitachi ADE-207-272, table 6) and their times. */
#define CLEAR 0x01
#define HOME 0x02
#define ENTRY_RIGHT 0x06
#define DISPLAY 0x08
#define FOUR_BITS_TWO_LINES 0x28
#define EIGHT_BITS 0x30
#define EIGHT_BITS_TWO_LINES 0x38
#define GLYPH 0x40
#define POSITION 0x80
#define SLOW_NS (2 * TXN_MS)
#define RESET_NS (5 * TXN_MS)

#define TEXT_MAX 128
#define STEPS_MAX (TEXT_MAX + 16)
#define CHUNK 4 /* bytes of one transaction */

/* A visit: whether the display is to be set up first, and how far it is. */
struct lcd_visit {
	bool begun, set_up, strobed;
	uint8_t next; /* step */
};

/* What a step is beside its byte. */
enum { DATA = 0x100, NIBBLE = 0x200, SLOW = 0x400, RESET = 0x800 };

struct steps {
	unsigned n;
	uint16_t step[STEPS_MAX];
};

static void lcd_add(struct steps *steps, unsigned step)
{
	if (steps->n < STEPS_MAX)
		steps->step[steps->n++] = (uint16_t)step;
}

static void add_initialisation(struct steps *steps, int board)
{
	if (board == LCD_M) {
		lcd_add(steps, EIGHT_BITS | RESET);
		lcd_add(steps, EIGHT_BITS_TWO_LINES);
		lcd_add(steps, DISPLAY | 7);
		lcd_add(steps, ENTRY_RIGHT);
		return;
	}
	for (int i = 0; i < 3; i++)
		lcd_add(steps, EIGHT_BITS | NIBBLE | RESET);
	lcd_add(steps, FOUR_BITS_TWO_LINES | NIBBLE);
	lcd_add(steps, FOUR_BITS_TWO_LINES);
	lcd_add(steps, DISPLAY | 4);
	lcd_add(steps, ENTRY_RIGHT);
}

static void add_text(struct steps *steps, const uint8_t *text, size_t len)
{
	for (size_t i = 0; i < len; i++)
		lcd_add(steps, DATA | text[i]);
}

/* "\x02\x04text", "2,4:text" or "4:text", which is the first line's: bytes used, or -EINVAL. */
static int take_position(const uint8_t *text, size_t len, unsigned *position)
{
	static const uint8_t lines[] = {0x00, 0x40, 0x14, 0x54};
	unsigned value[2] = {1, 0}, n = 1;
	size_t at = 0;

	if (len >= 2 && text[0] < ' ') {
		value[0] = text[0];
		value[1] = text[1];
		at = 2;
	} else {
		for (; at < len && text[at] != ':'; at++) {
			if (text[at] == ',' && n == 1) {
				value[0] = value[1];
				value[1] = 0;
				n = 2;
			} else if (text[at] >= '0' && text[at] <= '9' && value[1] < 100) {
				value[1] = value[1] * 10 + text[at] - '0';
			} else if (text[at] != ' ') {
				return -EINVAL;
			}
		}
		if (at++ == len)
			return -EINVAL;
	}
	if (value[0] < 1 || value[0] > sizeof(lines) || value[1] < 1 || value[1] > 40)
		return -EINVAL;
	*position = lines[value[0] - 1] + value[1] - 1;
	return (int)at;
}

static int add_glyph(struct steps *steps, const struct txn *txn, bool hex)
{
	char digits[3] = "", *end;

	if (txn->len != (hex ? 16 : 8))
		return -EINVAL;
	lcd_add(steps, GLYPH | (unsigned)txn->element << 3);
	for (int i = 0; i < 8; i++) {
		unsigned line = txn->data[i];

		if (hex) {
			memcpy(digits, txn->data + 2 * i, 2);
			line = (unsigned)strtoul(digits, &end, 16);
			if (end != digits + 2)
				return -EINVAL;
		}
		lcd_add(steps, DATA | line);
	}
	return 0;
}

static void add_clear(struct steps *steps, int board)
{
	lcd_add(steps, CLEAR | SLOW);
	if (board == LCD_M)
		lcd_add(steps, HOME | SLOW);
}

static int plan(struct steps *steps, const struct txn *txn, int board, bool initialise)
{
	unsigned position = 0;
	int used = 0;

	steps->n = 0;
	if (initialise)
		add_initialisation(steps, board);
	switch ((enum lcd_command)(txn->property->arg & 0xff)) {
	case LCD_CLEAR:
		if (txn->number[0] != 0)
			add_clear(steps, board);
		return 0;
	case LCD_HOME:
		if (txn->number[0] != 0)
			lcd_add(steps, HOME | SLOW);
		return 0;
	case LCD_ON_OFF:
		lcd_add(steps, DISPLAY | ((unsigned)txn->number[0] & 7));
		return 0;
	case LCD_SCREEN_YX:
		used = take_position(txn->data, txn->len, &position);
		if (used < 0)
			return used;
		lcd_add(steps, POSITION | position);
		break;
	case LCD_MESSAGE:
		add_clear(steps, board);
		break;
	case LCD_SCREEN:
		break;
	case LCD_GLYPH:
		return add_glyph(steps, txn, false);
	case LCD_GLYPH_HEX:
		return add_glyph(steps, txn, true);
	}
	add_text(steps, txn->data + used, txn->len - (size_t)used);
	return 0;
}

static unsigned outputs(int board, unsigned step, uint8_t *bytes)
{
	uint8_t byte = (uint8_t)step;

	if (board == LCD_M) {
		bytes[0] = (uint8_t)((byte & 0x7f) | (step & DATA ? 0x80 : 0));
		return 1;
	}
	uint8_t low = step & DATA ? 0x0f : 0x07;
	bytes[0] = (uint8_t)((byte & 0xf0) | low);
	bytes[1] = (uint8_t)(byte << 4 | low);
	return step & NIBBLE ? 1 : 2;
}

/* arg: LCD_DO(board, command) */
static int lcd_write(struct txn *txn)
{
	int board = txn->property->arg >> 8, err;
	struct ds2408 *chip = txn->device->own;
	struct lcd_visit *visit = txn_own(txn, struct lcd_visit);
	uint8_t bytes[2 * CHUNK];
	struct steps steps;
	unsigned n = 0, step = 0;

	if (!visit->begun)
		visit->set_up = chip->display != board;
	visit->begun = true;
	err = plan(&steps, txn, board, visit->set_up);
	if (err)
		return err;
	if (!visit->strobed) {
		err = ds2408_strobe(txn);
		/* Who had it off was restarted. */
		visit->set_up |= err > 0;
		visit->strobed = err == 0;
		return err < 0 ? err : TXN_MORE;
	}
	while (visit->next < steps.n && n <= CHUNK - 2 && !(step & (SLOW | RESET))) {
		step = steps.step[visit->next++];
		n += outputs(board, step, bytes + n);
	}
	chip->display = LCD_NONE;
	err = n ? ds2408_put(txn, bytes, n) : 0;
	if (err)
		return err;
	if (visit->next < steps.n && step & (SLOW | RESET))
		return txn_wait(txn, step & RESET ? RESET_NS : SLOW_NS);
	if (visit->next < steps.n)
		return TXN_MORE;
	chip->display = (uint8_t)board;
	return 0;
}

/* --- The family --- */

#define PINS 8

static int read_alarm(struct txn *txn)
{
	uint8_t condition[3] = {0};
	int err = area_read(txn, &ds2408_registers, DS2408_MASK, condition, sizeof(condition));

	txn->number[0] = ds2408_digits(condition, PINS);
	return err;
}

static int write_alarm(struct txn *txn)
{
	static const uint8_t which[] = {0xff, 0xff, DS2408_CONTROL_SOURCE};
	uint8_t condition[3];

	ds2408_condition_of(txn->number[0], PINS, condition);
	return area_write(txn, &ds2408_condition, 0, condition, which, sizeof(condition));
}

static int write_test_mode(struct txn *txn)
{
	return txn->number[0] == 0 ? 0 : ds2408_leave_test_mode(txn);
}

#define FLAG(text, life_, access_, bit, ...) \
	PROPERTY(text, YESNO, life_, access_, \
	         FIELD(REGISTERS, .at = DS2408_CONTROL, .shift = (bit), .bits = 1), __VA_ARGS__)

enum { REGISTERS = 1, OUTPUT, CONDITION };
static const struct area *const areas[] = {
	[REGISTERS] = &ds2408_registers,
	[OUTPUT] = &ds2408_output,
	[CONDITION] = &ds2408_condition,
};

#define SET_CONTROL(bit) \
	SET(CONDITION, .at = DS2408_CONTROL - DS2408_MASK, .shift = (bit), .bits = 1)
enum { WAY_LCD = 1, WAY_PIO, WAY_LATCH, WAY_TEST_MODE, WAY_POR, WAY_STROBE, WAY_ALARM };
static const struct property_how how[] = {
	[WAY_LCD] = {.write = lcd_write},
	[WAY_PIO] = {SET(OUTPUT, .inverted = true)},
	[WAY_LATCH] = {.write = ds2408_write_latch},
	[WAY_TEST_MODE] = {.write = write_test_mode},
	[WAY_POR] = {SET_CONTROL(DS2408_POR)},
	[WAY_STROBE] = {SET_CONTROL(DS2408_STROBE)},
	[WAY_ALARM] = {.read = read_alarm, .write = write_alarm},
};

#define LCD_ENTRY(text, kind, bytes, board, command) \
	PROPERTY(text, kind, STABLE, WRITE, .size = (bytes), .arg = LCD_DO(board, command), \
	         .how = WAY_LCD)
#define LCD_GLYPHS(text, bytes, command) \
	PROPERTY(text, BINARY, STABLE, WRITE, ELEMENTS(8, NUMBERS), .size = 8, .takes = (bytes), \
	         .arg = LCD_DO(LCD_H, command), .how = WAY_LCD)

static const struct property properties[] = {
	PROPERTY_DIR("LCD_H"),
	LCD_ENTRY("LCD_H/clear", YESNO, 0, LCD_H, LCD_CLEAR),
	LCD_ENTRY("LCD_H/home", YESNO, 0, LCD_H, LCD_HOME),
	LCD_ENTRY("LCD_H/message", ASCII, 128, LCD_H, LCD_MESSAGE),
	LCD_ENTRY("LCD_H/onoff", UNSIGNED, 0, LCD_H, LCD_ON_OFF),
	LCD_GLYPHS("LCD_H/redefchar", 8, LCD_GLYPH),
	LCD_GLYPHS("LCD_H/redefchar_hex", 16, LCD_GLYPH_HEX),
	LCD_ENTRY("LCD_H/screen", ASCII, 128, LCD_H, LCD_SCREEN),
	LCD_ENTRY("LCD_H/screenyx", ASCII, 128, LCD_H, LCD_SCREEN_YX),
	PROPERTY_DIR("LCD_M"),
	LCD_ENTRY("LCD_M/clear", YESNO, 0, LCD_M, LCD_CLEAR),
	LCD_ENTRY("LCD_M/home", YESNO, 0, LCD_M, LCD_HOME),
	LCD_ENTRY("LCD_M/message", ASCII, 128, LCD_M, LCD_MESSAGE),
	LCD_ENTRY("LCD_M/screen", ASCII, 128, LCD_M, LCD_SCREEN),
	PROPERTY("PIO", BITS, STABLE, BOTH, AGGREGATE(8, NUMBERS),
                 FIELD(REGISTERS, .at = DS2408_OUTPUT, .inverted = true), .holds = true,
                 .how = WAY_PIO),
	PROPERTY("latch", BITS, VOLATILE, BOTH, AGGREGATE(8, NUMBERS),
                 FIELD(REGISTERS, .at = DS2408_ACTIVITY), .flag = true,
                 .alarm = ALARM_LATCH | ALARM_STAYS | ALARM_CLEARS, .how = WAY_LATCH),
	PROPERTY("out_of_testmode", YESNO, VOLATILE, WRITE, .how = WAY_TEST_MODE),
	FLAG("por", STABLE, BOTH, DS2408_POR, .flag = true, .alarm = ALARM_POR, .how = WAY_POR),
	FLAG("power", VOLATILE, READ, DS2408_VCC, .flag = false),
	PROPERTY("sensed", BITS, VOLATILE, READ, AGGREGATE(8, NUMBERS), FIELD(REGISTERS),
                 .alarm = ALARM_LATCH),
	PROPERTY("set_alarm", UNSIGNED, STABLE, BOTH, .digits = 333333333, .how = WAY_ALARM),
	FLAG("strobe", STABLE, BOTH, DS2408_STROBE, .how = WAY_STROBE),
};

CHIP_FAMILY(29, "DS2408", PRESENCE, .alarms = true, .latches = true,
            .flags = FLAG_RESUME | FLAG_ALARM | FLAG_OVERDRIVE,
            SCAN({"sensed.BYTE", "inputs"}, {"PIO.BYTE", "outputs"}), AREAS(areas), HOW(how),
            PROPERTIES(properties));
