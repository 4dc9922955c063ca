/* SPDX-License-Identifier: MIT */
/* EEPROMs, which are one attribute, and the DS2423, whose driver gives the text of four pages. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/w1/w1.h"

#define EEPROM_MAX 512
#define ROW_MAX 32

/* What a chip writes at once: its scratchpad, or a page. */
static unsigned row_of(const struct txn *txn)
{
	return txn->device->rom[0] == 0x2d ? 8 : ROW_MAX;
}

static int once(struct txn *txn, unsigned at, uint8_t *bytes, unsigned n)
{
	int got = w1_slave_read_at(w1_master_of(txn), txn->device->rom, "eeprom", at, bytes, n);

	txn->on_wire = true;
	return got < 0 ? got : (unsigned)got == n ? 0 : -EIO;
}

/* The driver of the DS2433 takes what comes; the others' read twice themselves. */
static int part(struct txn *txn, unsigned at, uint8_t *bytes, unsigned n)
{
	uint8_t again[EEPROM_MAX];
	int err = once(txn, at, bytes, n);

	if (err || txn->device->rom[0] != 0x23)
		return err;
	err = once(txn, at, again, n);
	return err ? err : memcmp(bytes, again, n) == 0 ? 0 : -EBADMSG;
}

static unsigned start_of(const struct txn *txn)
{
	return (unsigned)txn->element * txn->property->size;
}

static int read_eeprom(struct txn *txn)
{
	txn->len = txn->property->size;
	return part(txn, start_of(txn), txn->data, txn->property->size);
}

/* Row by row, and none that holds the bytes already: an EEPROM wears out. */
static int write_row(struct txn *txn, unsigned row, unsigned size)
{
	unsigned start = start_of(txn) + (unsigned)txn->at, end = start + (unsigned)txn->len;
	uint8_t have[ROW_MAX], want[ROW_MAX];
	int err = part(txn, row, have, size);

	memcpy(want, have, size);
	for (unsigned i = 0; i < size; i++)
		if (row + i >= start && row + i < end)
			want[i] = txn->data[row + i - start];
	if (err || memcmp(have, want, size) == 0)
		return err;
	err = w1_slave_write_at(w1_master_of(txn), txn->device->rom, "eeprom", row, want, size);
	if (!err)
		err = part(txn, row, have, size);
	return err ? err : memcmp(have, want, size) == 0 ? 0 : -EIO;
}

static int write_eeprom(struct txn *txn)
{
	unsigned *rows = txn_own(txn);
	unsigned size = row_of(txn), start = start_of(txn) + (unsigned)txn->at;
	unsigned end = start + (unsigned)txn->len;
	unsigned row = start - start % size + (*rows)++ * size;
	int err = row < end ? write_row(txn, row, size) : 0;

	return err || row + size >= end ? err : TXN_MORE;
}

static int read_lines(struct txn *txn)
{
	txn->on_wire = true;
	return w1_slave_text(w1_master_of(txn), txn->device->rom, "w1_slave");
}

/* The driver's lines are of pages 12 to 15: 42 bytes, "crc=YES c=1234". */
static int counter(const char *line, unsigned page, double *count)
{
	const char *good, *number;
	char *end;

	for (unsigned i = 12; i < page; i++) {
		line = strchr(line, '\n');
		if (!line)
			return -EIO;
		line++;
	}
	size_t len = strcspn(line, "\n");
	good = strstr(line, "crc=YES");
	if (!good || (size_t)(good - line) > len)
		return memchr(line, '=', len) ? -EBADMSG : -EIO;
	number = strstr(good, "c=Y") == good ? NULL : strstr(good, " c=");
	if (!number || (size_t)(number - line) > len)
		return -EIO;
	/* Printed with a sign. */
	*count = (double)(uint32_t)strtoll(number + 3, &end, 10);
	return end == number + 3 ? -EIO : 0;
}

static int read_counter(struct txn *txn)
{
	int err = read_lines(txn);

	return err ? err
	           : counter(w1_master_of(txn)->text, (unsigned)(txn->property->arg + txn->element),
	                     &txn->number[0]);
}

static int read_minimum(struct txn *txn)
{
	const char *text = w1_master_of(txn)->text;
	double a = 0, b = 0;
	int err = read_lines(txn);

	if (!err)
		err = counter(text, 14, &a);
	if (!err)
		err = counter(text, 15, &b);
	txn->number[0] = a < b ? a : b;
	return err;
}

static const struct w1_way eeprom[] = {
	{.property = "memory", .read = read_eeprom, .write = write_eeprom},
	{.property = "pages/page", .read = read_eeprom, .write = write_eeprom},
};

static const struct w1_way ds2423[] = {
	{.property = "counter", .read = read_counter},
	{.property = "counters", .read = read_counter},
	{.property = "mincount", .read = read_minimum},
	{.property = "pages/count", .first = 12, .count = 4, .read = read_counter},
};

const struct w1_driver w1_memories[4] = {
	{.family = 0x14, .files = {"eeprom"}, W1_WAYS(eeprom)},
	{.family = 0x1d, .files = {"w1_slave"}, W1_WAYS(ds2423)},
	{.family = 0x23, .files = {"eeprom"}, W1_WAYS(eeprom)},
	{.family = 0x2d, .files = {"eeprom"}, W1_WAYS(eeprom)},
};
