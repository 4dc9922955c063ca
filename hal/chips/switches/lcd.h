/* SPDX-License-Identifier: MIT */
/*
 * Displays with an HD44780 on a DS2408 whose RSTZ is the strobe of each byte written (E). LCD_H,
 * the board of Hobby Boards: four bits on P4 to P7, RS on P3, P0 to P2 left high. LCD_M, Maxim's
 * application note 3286: seven bits on P0 to P6, RS on P7. Neither can be read.
 */
#pragma once

#include "hal/chips/property.h"

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

int lcd_write(struct txn *txn); /* arg: LCD_DO(board, command) */

/* What stands first in the list of the family. */
enum { WAY_LCD = 1, AFTER_LCD_WAYS };
#define LCD_WAYS [WAY_LCD] = {.write = lcd_write}

#define LCD_DO(board, command) ((board) << 8 | (command))
#define LCD_ENTRY(text, kind, bytes, board, command) \
	PROPERTY(text, kind, STABLE, WRITE, .size = (bytes), .arg = LCD_DO(board, command), \
	         .how = WAY_LCD)
#define LCD_GLYPHS(text, bytes, command) \
	PROPERTY(text, BINARY, STABLE, WRITE, ELEMENTS(8, NUMBERS), .size = 8, .takes = (bytes), \
	         .arg = LCD_DO(LCD_H, command), .how = WAY_LCD)
#define LCD_PROPERTIES \
	PROPERTY_DIR("LCD_H"), LCD_ENTRY("LCD_H/clear", YESNO, 0, LCD_H, LCD_CLEAR), \
		LCD_ENTRY("LCD_H/home", YESNO, 0, LCD_H, LCD_HOME), \
		LCD_ENTRY("LCD_H/message", ASCII, 128, LCD_H, LCD_MESSAGE), \
		LCD_ENTRY("LCD_H/onoff", UNSIGNED, 0, LCD_H, LCD_ON_OFF), \
		LCD_GLYPHS("LCD_H/redefchar", 8, LCD_GLYPH), \
		LCD_GLYPHS("LCD_H/redefchar_hex", 16, LCD_GLYPH_HEX), \
		LCD_ENTRY("LCD_H/screen", ASCII, 128, LCD_H, LCD_SCREEN), \
		LCD_ENTRY("LCD_H/screenyx", ASCII, 128, LCD_H, LCD_SCREEN_YX), \
		PROPERTY_DIR("LCD_M"), LCD_ENTRY("LCD_M/clear", YESNO, 0, LCD_M, LCD_CLEAR), \
		LCD_ENTRY("LCD_M/home", YESNO, 0, LCD_M, LCD_HOME), \
		LCD_ENTRY("LCD_M/message", ASCII, 128, LCD_M, LCD_MESSAGE), \
		LCD_ENTRY("LCD_M/screen", ASCII, 128, LCD_M, LCD_SCREEN)
