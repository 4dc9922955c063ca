/* SPDX-License-Identifier: MIT */
/*
 * The names of displays that were once sold with a DS2408 (LCD_H, LCD_M). They are stated so that
 * /structure is that of owserver; how those boards are wired is not documented, so a write is
 * refused.
 */
#ifndef HAL_NATIVE_LCD_H
#define HAL_NATIVE_LCD_H

#include "hal/native/family.h"

int lcd_refuse(struct txn *txn);

#define LCD_ENTRY(text, kind, bytes)                                                      \
	{.name = (text), .type = (kind), .life = LIFE_STABLE, .access = ACCESS_WRITE,       \
	 .size = (bytes), .write = lcd_refuse}
#define LCD_GLYPHS(text)                                                                  \
	{.name = (text), .type = PROPERTY_BINARY, .life = LIFE_STABLE, .access = ACCESS_WRITE, \
	 .array = {8, INDEX_NUMBERS, false}, .size = 8, .write = lcd_refuse}
#define LCD_PROPERTIES                                                                    \
	PROPERTY_DIR("LCD_H"), LCD_ENTRY("LCD_H/clear", PROPERTY_YESNO, 0),                 \
	LCD_ENTRY("LCD_H/home", PROPERTY_YESNO, 0),                                         \
	LCD_ENTRY("LCD_H/message", PROPERTY_ASCII, 128),                                    \
	LCD_ENTRY("LCD_H/onoff", PROPERTY_UNSIGNED, 0), LCD_GLYPHS("LCD_H/redefchar"),      \
	LCD_GLYPHS("LCD_H/redefchar_hex"), LCD_ENTRY("LCD_H/screen", PROPERTY_ASCII, 128),  \
	LCD_ENTRY("LCD_H/screenyx", PROPERTY_ASCII, 128), PROPERTY_DIR("LCD_M"),            \
	LCD_ENTRY("LCD_M/clear", PROPERTY_YESNO, 0),                                        \
	LCD_ENTRY("LCD_M/home", PROPERTY_YESNO, 0),                                         \
	LCD_ENTRY("LCD_M/message", PROPERTY_ASCII, 128),                                    \
	LCD_ENTRY("LCD_M/screen", PROPERTY_ASCII, 128)

#endif
