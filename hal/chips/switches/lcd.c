/* SPDX-License-Identifier: MIT */
/* Character displays behind a DS2408: messages as bytes for the outputs of the chip. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/chips/switches/ds2408.h"
#include "hal/chips/switches/lcd.h"

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

int lcd_write(struct txn *txn)
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
