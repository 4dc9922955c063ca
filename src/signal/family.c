/* SPDX-License-Identifier: MIT */
/* The kinds of chips by family code. */
#include <stddef.h>

#include "src/signal/family.h"

/* clang-format off */
static const struct {
	uint8_t code;
	const char *name;
} families[] = {
	{0x01, "DS2401"},
	{0x02, "DS1991"},
	{0x04, "DS2404"},
	{0x05, "DS2405"},
	{0x06, "DS1993"},
	{0x08, "DS1992"},
	{0x09, "DS2502"},
	{0x0a, "DS1995"},
	{0x0b, "DS2505"},
	{0x0c, "DS1996"},
	{0x0f, "DS2506"},
	{0x10, "DS18S20"},
	{0x12, "DS2406"},
	{0x14, "DS2430A"},
	{0x18, "DS1963S"},
	{0x19, "DS28E17"},
	{0x1a, "DS1963L"},
	{0x1b, "DS2436"},
	{0x1c, "DS28E04"},
	{0x1d, "DS2423"},
	{0x1e, "DS2437"},
	{0x1f, "DS2409"},
	{0x20, "DS2450"},
	{0x21, "DS1921"},
	{0x22, "DS1822"},
	{0x23, "DS2433"},
	{0x24, "DS2415"},
	{0x26, "DS2438"},
	{0x27, "DS2417"},
	{0x28, "DS18B20"},
	{0x29, "DS2408"},
	{0x2c, "DS2890"},
	{0x2d, "DS2431"},
	{0x2e, "DS2770"},
	{0x30, "DS2760"},
	{0x31, "DS2720"},
	{0x32, "DS2780"},
	{0x35, "DS2755"},
	{0x36, "DS2740"},
	{0x37, "DS1977"},
	{0x3a, "DS2413"},
	{0x3b, "DS1825"},
	{0x3d, "DS2781"},
	{0x41, "DS1923"},
	{0x42, "DS28EA00"},
	{0x43, "DS28EC20"},
	{0x51, "DS2751"},
	{0x54, "MAX31888"},
	{0x56, "DS28E18"},
	{0x7e, "EDS"},
	{0x81, "DS1420"},
	{0x82, "DS1425"},
	{0x89, "DS1982U"},
	{0x8b, "DS1985U"},
	{0x8f, "DS1986U"},
	{0xa0, "mRS001"},
	{0xa2, "mCM001"},
	{0xa5, "mDI001"},
	{0xa6, "DS2438"},
	{0xb2, "mAM001"},
	{0xdd, "Example_slave"},
	{0xed, "InfernoEmbedded"},
	{0xee, "HobbyBoards_EE"},
	{0xef, "HobbyBoards_EF"},
	{0xfc, "BAE"},
	{0xfe, "IBLSS"},
	{0xff, "LCD"},
};
/* clang-format on */

const char *family_name(uint8_t code)
{
	for (size_t i = 0; i < sizeof(families) / sizeof(families[0]); i++)
		if (families[i].code == code)
			return families[i].name;
	return NULL;
}
