/* SPDX-License-Identifier: MIT */
/* The kinds of chips by family code. */
#include <stddef.h>

#include "src/signal/family.h"

static const struct {
	uint8_t code;
	const char *name;
} families[] = {
	{0x01, "DS2401"}, {0x05, "DS2405"},  {0x09, "DS2502"},   {0x10, "DS18S20"},
	{0x12, "DS2406"}, {0x14, "DS2430A"}, {0x1d, "DS2423"},   {0x1f, "DS2409"},
	{0x20, "DS2450"}, {0x21, "DS1921"},  {0x22, "DS1822"},   {0x23, "DS2433"},
	{0x26, "DS2438"}, {0x28, "DS18B20"}, {0x29, "DS2408"},   {0x2c, "DS2890"},
	{0x2d, "DS2431"}, {0x30, "DS2760"},  {0x31, "DS2720"},   {0x3a, "DS2413"},
	{0x3b, "DS1825"}, {0x41, "DS1922"},  {0x42, "DS28EA00"}, {0x43, "DS28EC20"},
};

const char *family_name(uint8_t code)
{
	for (size_t i = 0; i < sizeof(families) / sizeof(families[0]); i++)
		if (families[i].code == code)
			return families[i].name;
	return NULL;
}
