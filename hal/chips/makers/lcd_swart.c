/* SPDX-License-Identifier: MIT */
/* The scratchpad of the LCD controller by Louis Swart, and what it shows. */
#include <errno.h>
#include <string.h>

#include "hal/chips/makers/lcd_swart.h"

#define WIDTH_MAX 40
#define SENT 2              /* times */
#define CHUNK (LCD_PAD - 1) /* letters, so that all of them are read back */
#define PRINT_NS (2 * TXN_MS)
#define CLEAR_NS (3 * TXN_MS)

enum { PRINT = 0x48, CLEAR = 0x49, WRITE_PAD = 0x4e, READ_PAD = 0xbe };

struct shown {
	uint8_t cleared, row, chunk, filled, printed;
};

int lcd_swart_fill(struct txn *txn, const uint8_t *bytes, unsigned n)
{
	static const uint8_t read = READ_PAD;
	uint8_t command[2 + LCD_PAD] = {WRITE_PAD}, in[LCD_PAD];
	int err;

	memcpy(command + 1, bytes, n);
	err = txn_command(txn, command, 1 + n);
	if (!err)
		err = txn_command(txn, &read, 1);
	if (!err)
		err = txn_read_slots(txn, in, sizeof(in));
	if (err)
		return err;
	return memcmp(in, bytes, n < LCD_PAD ? n : LCD_PAD) == 0 ? 0 : -EBADMSG;
}

int lcd_swart_switch(struct txn *txn)
{
	int arg = txn->property->arg;
	const uint8_t command = (uint8_t)(txn->number[0] != 0 ? arg >> 8 : arg);
	int err = txn_command(txn, &command, 1);

	return err ? err : ++txn->phase < SENT ? txn_wait(txn, CLEAR_NS) : 0;
}

static int lcd_swart_send(struct txn *txn, uint8_t command, int64_t ns)
{
	int err = txn_command(txn, &command, 1);

	return err ? err : txn_wait(txn, ns);
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
	err = lcd_swart_send(txn, PRINT, PRINT_NS);
	if (++shown->printed == SENT) {
		shown->filled = shown->printed = 0;
		shown->chunk++;
	}
	return err;
}

int lcd_swart_line(struct txn *txn)
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

int lcd_swart_screen(struct txn *txn)
{
	struct shown *shown = txn_own(txn, struct shown);
	unsigned rows = txn->property->arg == WIDTH_MAX ? 2 : 4;
	char line[WIDTH_MAX];
	int err;

	if (txn->at)
		return -EINVAL;
	if (shown->cleared < SENT) {
		shown->cleared++;
		return lcd_swart_send(txn, CLEAR, CLEAR_NS);
	}
	if (shown->row == rows || !line_of(txn, shown->row, line))
		return 0;
	err = print_line(txn, shown->row, line);
	if (err)
		return err;
	shown->row++;
	return TXN_MORE;
}
