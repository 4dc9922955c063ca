/* SPDX-License-Identifier: MIT */
/* EEPROMs, which are one attribute, and the DS2423, whose driver gives the text of four pages. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/w1/w1.h"

#define EEPROM_MAX 512

/* The file as a whole, in master->text. */
static int whole(struct txn *txn, unsigned size)
{
	struct w1_master *master = w1_master_of(txn);
	int n = w1_slave_read(master, txn->device->rom, "eeprom", master->text, size);

	txn->on_wire = true;
	return n < 0 ? n : (unsigned)n == size ? 0 : -EIO;
}

static unsigned size_of(const struct txn *txn)
{
	return txn->device->rom[0] == 0x14 ? 32 : txn->device->rom[0] == 0x2d ? 128 : EEPROM_MAX;
}

static unsigned start_of(const struct txn *txn)
{
	return (unsigned)txn->element * txn->property->size;
}

static int read_eeprom(struct txn *txn)
{
	int err = whole(txn, size_of(txn));

	if (err)
		return err;
	memcpy(txn->data, w1_master_of(txn)->text + start_of(txn), txn->property->size);
	txn->len = txn->property->size;
	return 0;
}

/* What is there already is not written: an EEPROM wears out. */
static int write_eeprom(struct txn *txn)
{
	struct w1_master *master = w1_master_of(txn);
	char *here = master->text + start_of(txn);
	unsigned size = size_of(txn);
	int err = whole(txn, size);

	if (err)
		return err;
	if (memcmp(here, txn->data, txn->len) == 0)
		return 0;
	memcpy(here, txn->data, txn->len);
	err = w1_slave_write(master, txn->device->rom, "eeprom", master->text, size);
	if (!err)
		err = whole(txn, size);
	return err ? err : memcmp(here, txn->data, txn->len) == 0 ? 0 : -EIO;
}

/* The driver's lines are of pages 12 to 15: 42 bytes, "crc=YES c=1234". */
static int counter(struct txn *txn, unsigned page, double *count)
{
	struct w1_master *master = w1_master_of(txn);
	int err = w1_slave_text(master, txn->device->rom, "w1_slave");
	const char *line = master->text, *good, *number;

	txn->on_wire = true;
	for (unsigned i = 12; i < page && !err; i++) {
		line = strchr(line, '\n');
		err = line ? 0 : -EIO;
		line += !err;
	}
	if (err)
		return err;
	size_t len = strcspn(line, "\n");
	good = strstr(line, "crc=YES");
	if (!good || (size_t)(good - line) > len)
		return memchr(line, '=', len) ? -EBADMSG : -EIO;
	number = strstr(good, "c=Y") == good ? NULL : strstr(good, " c=");
	if (!number || (size_t)(number - line) > len)
		return -EIO;
	/* Printed with a sign. */
	*count = (double)(uint32_t)strtoll(number + 3, NULL, 10);
	return 0;
}

static int read_counter(struct txn *txn)
{
	return counter(txn, (unsigned)(txn->property->arg + txn->element), &txn->number[0]);
}

static int read_minimum(struct txn *txn)
{
	double a = 0, b = 0;
	int err = counter(txn, 14, &a);

	if (!err)
		err = counter(txn, 15, &b);
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
