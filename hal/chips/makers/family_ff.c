/* SPDX-License-Identifier: MIT */
/*
 * LCD controller by Louis Swart: four pins with counters, EEPROM, and a display. Its data sheet
 * could not be had: the commands are those of OWFS's driver. All that is read goes by way of a
 * scratchpad without a checksum. Nothing shows that a command to the display was taken: all of them
 * are sent twice, which changes nothing.
 *
 * A command that fills the scratchpad and is lost leaves it as it was: so it is given in two
 * rounds, ahead of which the scratchpad is filled with different bytes. The counters, which a read
 * clears, have ones there before.
 */
#include <errno.h>
#include <string.h>

#include "hal/chips/family.h"

#define LCD_PAD 16 /* bytes of the scratchpad that can be read */

#define WIDTH_MAX 40
#define SENT 2              /* times */
#define CHUNK (LCD_PAD - 1) /* letters, so that all of them are read back */
#define PRINT_NS (2 * TXN_MS)
#define CLEAR_NS (3 * TXN_MS)

enum {
	WRITE_PINS = 0x21,
	READ_PINS,
	READ_COUNTERS,
	READ_EEPROM = 0x37,
	WRITE_EEPROM = 0x39,
	READ_VERSION = 0x41,
	PRINT = 0x48,
	CLEAR,
	WRITE_PAD = 0x4e,
	READ_PAD = 0xbe,
};

struct shown {
	uint8_t cleared, row, chunk, filled, printed;
};

/* Write n bytes to the scratchpad, and read them back. */
static int lcd_swart_fill(struct txn *txn, const uint8_t *bytes, unsigned n)
{
	uint8_t command[2 + LCD_PAD] = {WRITE_PAD}, in[LCD_PAD];
	int err;

	memcpy(command + 1, bytes, n);
	err = txn_command(txn, command, 1 + n);
	if (!err)
		err = txn_command(txn, TXN_BYTES(READ_PAD));
	if (!err)
		err = txn_read_slots(txn, in, sizeof(in));
	if (err)
		return err;
	return memcmp(in, bytes, n < LCD_PAD ? n : LCD_PAD) == 0 ? 0 : -EBADMSG;
}

static int lcd_swart_switch(struct txn *txn)
{
	int arg = txn->property->arg;
	const uint8_t command = (uint8_t)(txn->number[0] != 0 ? arg >> 8 : arg);
	int err = txn_command(txn, &command, 1);

	return err ? err : ++txn->phase < SENT ? txn_wait(txn, CLEAR_NS) : 0;
}

/* A line goes to the display in chunks, each with its place ahead. 0: all are there. */
static int print_line(struct txn *txn, unsigned row, const char *line)
{
	struct shown *shown = txn_own(txn, struct shown);
	unsigned width = (unsigned)txn->property->arg, from = shown->chunk * CHUNK;
	unsigned n = width - from < CHUNK ? width - from : CHUNK;
	uint8_t pad[1 + LCD_PAD] = {(uint8_t)((row & 1) * 0x40 + (row >> 1) * width + from)};
	int err;

	if (from >= width) {
		shown->chunk = 0;
		return 0;
	}
	if (!shown->filled) {
		memcpy(pad + 1, line + from, n);
		err = lcd_swart_fill(txn, pad, 1 + n);
		shown->filled = true;
		return err ? err : TXN_MORE;
	}
	err = txn_command_wait(txn, TXN_BYTES(PRINT), PRINT_NS);
	if (++shown->printed == SENT) {
		shown->filled = shown->printed = 0;
		shown->chunk++;
	}
	return err;
}

static int lcd_swart_line(struct txn *txn)
{
	char line[WIDTH_MAX];

	memset(line, ' ', sizeof(line));
	if (txn->at + txn->len > (unsigned)txn->property->arg)
		return -EINVAL;
	memcpy(line + txn->at, txn->data, txn->len);
	return print_line(txn, (unsigned)txn->element, line);
}

/* The row's text, which ends with a line end or where the display does; false: there is none. */
static bool line_of(const struct txn *txn, unsigned row, char line[WIDTH_MAX])
{
	size_t width = (size_t)txn->property->arg, at = 0, n = 0;

	for (unsigned i = 0; i <= row; i++) {
		if (i && at >= txn->len)
			return false;
		for (n = 0; n < width && at + n < txn->len && txn->data[at + n] != '\n';)
			n++;
		if (i == row)
			break;
		at += n;
		at += at < txn->len && n < width && txn->data[at] == '\n';
	}
	memset(line, ' ', WIDTH_MAX);
	memcpy(line, txn->data + at, n);
	return true;
}

static int lcd_swart_screen(struct txn *txn)
{
	struct shown *shown = txn_own(txn, struct shown);
	unsigned rows = txn->property->arg == WIDTH_MAX ? 2 : 4;
	char line[WIDTH_MAX];
	int err;

	if (txn->at)
		return -EINVAL;
	if (shown->cleared < SENT) {
		shown->cleared++;
		return txn_command_wait(txn, TXN_BYTES(CLEAR), CLEAR_NS);
	}
	if (shown->row == rows || !line_of(txn, shown->row, line))
		return 0;
	err = print_line(txn, shown->row, line);
	if (err)
		return err;
	shown->row++;
	return TXN_MORE;
}

#define PINS 4
#define ROUNDS 2
#define BLANK_ROUNDS 5 /* where nothing but ones is read */
#define SOON_NS (1 * TXN_MS)
#define EEPROM_NS (17 * 4 * TXN_MS)
#define LOOKS 3

/* What a command has put into the scratchpad, from call to call. */
struct pad {
	uint8_t step, round, looks;
	uint8_t seen[LCD_PAD];
};

struct lcd {
	double sum[PINS]; /* of all counts that were read */
	bool pending;     /* counts may be in the scratchpad that were not read yet */
};

static int read_pad(struct txn *txn, uint8_t bytes[LCD_PAD])
{
	return txn_ask(txn, TXN_BYTES(READ_PAD), bytes, LCD_PAD);
}

/*
 * What the command puts into the scratchpad, twice, ahead of which other bytes stood there: so a
 * lost command shows. setup: what it takes from the scratchpad.
 */
static int fetch_by_pad(struct txn *txn, uint8_t code, const uint8_t *setup, unsigned setup_n,
                        uint8_t *bytes, unsigned n)
{
	struct pad *pad = txn_own(txn, struct pad);
	uint8_t fill[LCD_PAD], in[LCD_PAD];
	int err;

	switch (pad->step++) {
	case 0:
		memset(fill, pad->round % 2 ? 0x5a : 0xa5, sizeof(fill));
		if (setup_n)
			memcpy(fill, setup, setup_n);
		err = lcd_swart_fill(txn, fill, sizeof(fill));
		return err ? err : TXN_MORE;
	case 1:
		return txn_command_wait(txn, &code, 1, SOON_NS);
	}
	err = read_pad(txn, in);
	if (err)
		return err;
	if (pad->round && memcmp(in, pad->seen, n) != 0)
		return -EBADMSG;
	memcpy(pad->seen, in, sizeof(in));
	pad->step = 0;
	if (++pad->round < (txn->silent ? BLANK_ROUNDS : ROUNDS))
		return TXN_MORE;
	memset(pad, 0, sizeof(*pad));
	memcpy(bytes, in, n);
	return 0;
}

static int load_eeprom(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                       unsigned n)
{
	const uint8_t setup[] = {(uint8_t)at, LCD_PAD};

	(void)area;
	return fetch_by_pad(txn, READ_EEPROM, setup, sizeof(setup), bytes, n);
}

static int store_eeprom(struct txn *txn, const struct area *area, unsigned at, const uint8_t *bytes,
                        unsigned n)
{
	uint8_t pad[1 + LCD_PAD] = {(uint8_t)at};

	(void)area;
	memcpy(pad + 1, bytes, n);
	return lcd_swart_fill(txn, pad, 1 + n);
}

static AREA_NAMED(eeprom, "EEPROM", .size = 112, .block = LCD_PAD, .row = LCD_PAD,
                  .copy = WRITE_EEPROM, .copy_ns = EEPROM_NS, .load = load_eeprom,
                  .store = store_eeprom);

static int read_version(struct txn *txn)
{
	uint8_t bytes[LCD_PAD] = {0};
	int err = fetch_by_pad(txn, READ_VERSION, NULL, 0, bytes, LCD_PAD);

	if (err)
		return err;
	if (txn->room < LCD_PAD)
		return -EMSGSIZE;
	memcpy(txn->data, bytes, LCD_PAD);
	txn->len = LCD_PAD;
	return 0;
}

/* 1: the pin is low. */
static int read_pins(struct txn *txn)
{
	uint8_t byte = 0;
	int err = fetch_by_pad(txn, READ_PINS, NULL, 0, &byte, 1);

	if (!err)
		txn->bits = ~byte & 0x0f;
	return err;
}

/* What a pin was told, where that is known; it may be low from outside. */
static int merge_pins(struct txn *txn)
{
	if (!txn->device->shadow_known)
		return read_pins(txn);
	txn->bits = txn->device->shadow;
	return 0;
}

/* Twice, for a pin that is low from outside does not show that it was released. */
static int write_pins(struct txn *txn)
{
	const uint8_t bits = txn->bits & 0x0f;
	const uint8_t command[] = {WRITE_PINS, (uint8_t)(0x80 | (~bits & 0x0f))};
	int err;

	if (txn->phase < 2) {
		txn->phase++;
		txn->device->shadow_known = false;
		err = txn_command(txn, command, sizeof(command));
		return err ? err : TXN_MORE;
	}
	err = read_pins(txn);
	if (err)
		return err;
	if (bits & ~txn->bits)
		return -EIO;
	txn->device->shadow = bits;
	txn->device->shadow_known = true;
	return 0;
}

/* The chip counts from zero on after each read: what was read goes to the sum, and once only. */
static int add_counts(struct txn *txn, const uint8_t bytes[LCD_PAD])
{
	struct lcd *lcd = txn->device->own;

	for (unsigned i = 0; i < PINS; i++) {
		txn->number[i] = bytes[2 * i] | bytes[2 * i + 1] << 8;
		if (txn->number[i] == 0xffff)
			return -EBADMSG; /* the command was not taken */
	}
	for (unsigned i = 0; i < PINS; i++)
		lcd->sum[i] += txn->number[i];
	return 0;
}

/* The scratchpad is all ones before; what an attempt that failed left in it is read first. */
static int read_counts(struct txn *txn)
{
	struct pad *pad = txn_own(txn, struct pad);
	struct lcd *lcd = txn->device->own;
	uint8_t ones[LCD_PAD], in[LCD_PAD];
	int err;

	if (pad->step == 0 && lcd->pending)
		pad->step = 2;
	switch (pad->step) {
	case 0:
		memset(ones, 0xff, sizeof(ones));
		pad->step = 1;
		err = lcd_swart_fill(txn, ones, sizeof(ones));
		return err ? err : TXN_MORE;
	case 1:
		pad->step = 2;
		lcd->pending = true;
		return txn_command_wait(txn, TXN_BYTES(READ_COUNTERS), SOON_NS);
	}
	err = read_pad(txn, in);
	if (err)
		return err;
	if (pad->looks && memcmp(in, pad->seen, sizeof(in)) != 0)
		return -EBADMSG;
	memcpy(pad->seen, in, sizeof(in));
	if (++pad->looks < LOOKS)
		return TXN_MORE;
	lcd->pending = false;
	return add_counts(txn, in);
}

static int read_sum(struct txn *txn)
{
	const struct lcd *lcd = txn->device->own;
	int err = read_counts(txn);

	for (unsigned i = 0; i < PINS && !err; i++)
		txn->number[i] = lcd->sum[i];
	return err;
}

static int write_sum(struct txn *txn)
{
	struct lcd *lcd = txn->device->own;

	memcpy(lcd->sum, txn->number, sizeof(lcd->sum));
	return 0;
}

/* The sums last. */
static void family_ff_forget(struct device *device)
{
	((struct lcd *)device->own)->pending = false;
}

enum { EEPROM = 1 };
static const struct area *const areas[] = {[EEPROM] = &eeprom};

enum { WAY_SWITCH = 1, WAY_LINE, WAY_SCREEN, WAY_VERSION, WAY_BYTE, WAY_PINS, WAY_COUNTS, WAY_SUM };
static const struct property_how how[] = {
	[WAY_SWITCH] = {.write = lcd_swart_switch},
	[WAY_LINE] = {.write = lcd_swart_line},
	[WAY_SCREEN] = {.write = lcd_swart_screen},
	[WAY_VERSION] = {.read = read_version},
	/* each read changes the display: what a disturbed one has left cannot be told */
	[WAY_BYTE] = {.read = property_refuse, .write = property_refuse},
	[WAY_PINS] = {.read = read_pins, .write = write_pins, .merge = merge_pins},
	[WAY_COUNTS] = {.read = read_counts},
	[WAY_SUM] = {.read = read_sum, .write = write_sum},
};

/* clang-format off */
/* arg: the commands, or the width of the display. */
#define SWITCH(text, on, off) \
	PROPERTY(text, YESNO, STABLE, WRITE, .arg = (on) << 8 | (off), .how = WAY_SWITCH)
#define LINE(text, lines, width) \
	PROPERTY(text, ASCII, STABLE, WRITE, ELEMENTS(lines, NUMBERS), .size = (width), \
	         .arg = (width), .how = WAY_LINE)
#define SCREEN(text, width) \
	PROPERTY(text, ASCII, STABLE, WRITE, .size = 128, .arg = (width), .how = WAY_SCREEN)

static const struct property properties[] = {
	SWITCH("LCDon", 0x03, 0x05),
	SWITCH("backlight", 0x08, 0x07),
	PROPERTY("counters", UNSIGNED, VOLATILE, READ, AGGREGATE(PINS, NUMBERS),
	         COUNTS_TO(UINT16_MAX), .how = WAY_COUNTS),
	PROPERTY("cumulative", UNSIGNED, VOLATILE, BOTH, AGGREGATE(PINS, NUMBERS),
	         COUNTS_TO(HUGE_VAL), .how = WAY_SUM),
	PROPERTY("data", UNSIGNED, VOLATILE, BOTH, .how = WAY_BYTE),
	PROPERTY("gpio", BITS, VOLATILE, BOTH, AGGREGATE(PINS, NUMBERS), .how = WAY_PINS),
	LINE("line16", 4, 16),
	LINE("line20", 4, 20),
	LINE("line40", 2, 40),
	PROPERTY("memory", BINARY, STABLE, BOTH, .size = 112, FIELD(EEPROM)),
	PROPERTY("register", UNSIGNED, VOLATILE, BOTH, .how = WAY_BYTE),
	SCREEN("screen16", 16),
	SCREEN("screen20", 20),
	SCREEN("screen40", 40),
	PROPERTY("version", ASCII, STABLE, READ, .size = LCD_PAD, .how = WAY_VERSION),
};
/* clang-format on */

CHIP_FAMILY(ff, "LCD", PRESENCE, .flags = FLAG_ALARM, .forget = family_ff_forget,
            SCAN({"cumulative", "count"}), AREAS(areas), HOW(how), PROPERTIES(properties));
