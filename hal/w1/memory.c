/* SPDX-License-Identifier: MIT */
/* EEPROMs, which are one attribute, and the DS2423, whose driver gives the text of four pages. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/chips/area.h"
#include "hal/w1/memory.h"

static int read_eeprom(struct w1_slave *slave, unsigned at, uint8_t *bytes, unsigned n)
{
	return w1_slave_read(slave, "eeprom", at, bytes, n);
}

/* The drivers of DS2433 and DS28E04 take what comes; the others' read twice themselves. */
static int read_twice(struct w1_slave *slave, unsigned at, uint8_t *bytes, unsigned n)
{
	uint8_t again[AREA_UNIT];
	int err = n <= sizeof(again) ? read_eeprom(slave, at, bytes, n) : -EIO;

	if (!err)
		err = read_eeprom(slave, at, again, n);
	return err ? err : memcmp(bytes, again, n) == 0 ? 0 : -EBADMSG;
}

static int write_eeprom(struct w1_slave *slave, unsigned at, const uint8_t *bytes, unsigned n)
{
	return w1_slave_write(slave, "eeprom", at, bytes, n);
}

/* The driver's lines are of pages 12 to 15: 42 bytes, "crc=YES c=1234". */
static int counter(const char *line, unsigned page, uint32_t *count)
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
	*count = (uint32_t)strtoll(number + 3, &end, 10);
	return end == number + 3 ? -EIO : 0;
}

/* Four bytes of each page. */
static int read_counters(struct w1_slave *slave, unsigned at, uint8_t *bytes, unsigned n)
{
	int err = w1_slave_text(slave, "w1_slave");

	for (unsigned i = 0; i < n && !err; i++) {
		uint32_t count = 0;

		err = at + i < 4 * 12 ? -ENOENT : counter(slave->tree->text, (at + i) / 4, &count);
		bytes[i] = (uint8_t)(count >> 8 * ((at + i) % 4));
	}
	return err;
}

static const struct w1_part eeprom[] = {
	{.area = "memory", .read = read_eeprom, .write = write_eeprom},
};
static const struct w1_part ds2433[] = {
	{.area = "memory", .read = read_twice, .write = write_eeprom},
};
static const struct w1_property eeprom_properties[] = {
	{.name = "memory"},
	{.name = "pages/page"},
};

/* What follows the pages is no attribute. */
static const struct w1_property ds28e04_properties[] = {
	{.name = "pages/page"},
};

static const struct w1_part ds2423[] = {
	{.area = "counters", .read = read_counters},
};
static const struct w1_property ds2423_properties[] = {
	{.name = "counter"},
	{.name = "counters"},
	{.name = "mincount"},
	{.name = "pages/count", .first = 12, .count = 4},
};

/* clang-format off */
#define EEPROM(code, parts_) \
	{.family = (code), .files = {"eeprom"}, W1_PARTS(parts_), W1_PROPERTIES(eeprom_properties)}

const struct w1_driver w1_memories[] = {
	EEPROM(0x14, eeprom),
	{.family = 0x1c, .files = {"eeprom"}, W1_PARTS(ds2433), W1_PROPERTIES(ds28e04_properties)},
	{.family = 0x1d, .files = {"w1_slave"}, W1_PARTS(ds2423), W1_PROPERTIES(ds2423_properties)},
	EEPROM(0x23, ds2433),
	EEPROM(0x2d, eeprom),
	{.family = 0},
};
/* clang-format on */
