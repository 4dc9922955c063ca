/* SPDX-License-Identifier: MIT */
/* DS2413 and DS2438: the family's own functions, over commands that attributes answer. */
#include "hal/w1/w1.h"

static const struct w1_way ds2413[] = {
	{.property = "PIO"},
	{.property = "piostate"},
	{.property = "sensed"},
};

#define PAGE1(text) \
	{ \
		.property = (text), .file = "page1" \
	}
static const struct w1_way ds2438[] = {
	{.property = "CA"},
	{.property = "EE"},
	{.property = "HIH3600/humidity"},
	{.property = "HIH4000/humidity"},
	{.property = "HIH5030/humidity"},
	{.property = "HTM1735/humidity"},
	{.property = "IAD"},
	{.property = "VAD"},
	{.property = "VDD"},
	PAGE1("date"),
	{.property = "humidity"},
	{.property = "latesttemp"},
	PAGE1("offset"),
	{.property = "pages/page", .first = 0, .count = 1},
	{.property = "pages/page", .file = "page1", .first = 1, .count = 1},
	{.property = "temperature"},
	PAGE1("udate"),
	{.property = "vis"},
};

const struct w1_driver w1_wired[2] = {
	{.family = 0x26, .files = {"page0"}, .wire = &w1_ds2438_wire, W1_WAYS(ds2438)},
	{.family = 0x3a, .files = {"state"}, .wire = &w1_ds2413_wire, W1_WAYS(ds2413)},
};
