/* SPDX-License-Identifier: MIT */
/*
 * DS2438: reading `temperature`, `vad` and `vdd` makes the chip convert and leaves the result in
 * page 0, where the family's functions look for it.
 */
#include <errno.h>
#include <string.h>
#include <strings.h>

#include "hal/chips/ds2438.h"
#include "hal/w1/ds2438.h"

static int read_page(struct w1_slave *slave, unsigned at, uint8_t *bytes, unsigned n)
{
	uint8_t page[8];
	int err = at / 8 > 1 || at % 8 + n > 8
	                  ? -ENOENT
	                  : w1_slave_read(slave, at / 8 ? "page1" : "page0", 0, page, sizeof(page));

	if (!err)
		memcpy(bytes, page + at % 8, n);
	return err;
}

/* Of the configuration the driver can change what it measures, not the accumulator's bits. */
static int write_configuration(struct w1_slave *slave, unsigned at, const uint8_t *bytes,
                               unsigned n)
{
	uint8_t now, on = bytes[0] & DS2438_IAD;
	int err = at || n != 1 ? -EOPNOTSUPP : read_page(slave, 0, &now, 1);

	if (err)
		return err;
	if ((now ^ bytes[0]) & (DS2438_CA | DS2438_EE))
		return -EOPNOTSUPP;
	return (now ^ bytes[0]) & DS2438_IAD ? w1_slave_write(slave, "iad", 0, &on, 1) : 0;
}

/* The attributes' names are the quantities', but for the case. */
static int ds2438_convert(struct w1_slave *slave, const char *what)
{
	static const char *const files[] = {"temperature", "vad", "vdd"};

	for (size_t i = 0; i < sizeof(files) / sizeof(files[0]); i++)
		if (strcasecmp(files[i], what) == 0)
			return w1_slave_text(slave, files[i]);
	return -EOPNOTSUPP;
}

static const struct w1_part parts[] = {
	{.area = "pages", .read = read_page, .write = write_configuration},
};

static const struct w1_property properties[] = {
	{.name = "CA"},
	{.name = "EE"},
	{.name = "HIH3600/humidity"},
	{.name = "HIH4000/humidity"},
	{.name = "HIH5030/humidity"},
	{.name = "HTM1735/humidity"},
	{.name = "IAD"},
	{.name = "VAD"},
	{.name = "VDD"},
	{.name = "date", .file = "page1"},
	{.name = "humidity"},
	{.name = "identity"},
	{.name = "latesttemp"},
	{.name = "offset", .file = "page1"},
	{.name = "pages/page", .first = 0, .count = 1},
	{.name = "pages/page", .file = "page1", .first = 1, .count = 1},
	{.name = "temperature"},
	{.name = "udate", .file = "page1"},
	{.name = "vis"},
};

const struct w1_driver w1_ds2438[] = {
	{.family = 0x26,
         .files = {"page0"},
         W1_PARTS(parts),
         W1_PROPERTIES(properties),
         .convert = ds2438_convert},
	{.family = 0},
};
