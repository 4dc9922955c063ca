/* SPDX-License-Identifier: MIT */
/*
 * What the LCD controller by Louis Swart shows: lines and screens, light. Nothing shows that such a
 * command was taken: all of them are sent twice, which changes nothing.
 */
#pragma once

#include "hal/chips/family.h"

#define LCD_PAD 16 /* bytes of the scratchpad that can be read */

/* What stands first in the list of the family. */
enum { WAY_LCD_SWITCH = 1, WAY_LCD_LINE, WAY_LCD_SCREEN, AFTER_LCD_SWART_WAYS };
#define LCD_SWART_WAYS \
	[WAY_LCD_SWITCH] = {.write = lcd_swart_switch}, \
	[WAY_LCD_LINE] = {.write = lcd_swart_line}, [WAY_LCD_SCREEN] = {.write = lcd_swart_screen}
property_function lcd_swart_switch, lcd_swart_line, lcd_swart_screen;

/* arg: the commands, or the width of the display. */
#define LCD_SWART_SWITCH(text, on, off) \
	PROPERTY(text, YESNO, STABLE, WRITE, .arg = (on) << 8 | (off), .how = WAY_LCD_SWITCH)
#define LCD_SWART_LINE(text, lines, width) \
	PROPERTY(text, ASCII, STABLE, WRITE, ELEMENTS(lines, NUMBERS), .size = (width), \
	         .arg = (width), .how = WAY_LCD_LINE)
#define LCD_SWART_SCREEN(text, width) \
	PROPERTY(text, ASCII, STABLE, WRITE, .size = 128, .arg = (width), .how = WAY_LCD_SCREEN)

/* Write n bytes to the scratchpad, and read them back. */
int lcd_swart_fill(struct txn *txn, const uint8_t *bytes, unsigned n);
