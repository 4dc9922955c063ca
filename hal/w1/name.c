/* SPDX-License-Identifier: MIT */
/* The kernel's names of 1-Wire devices, to and from ROM ids. */
#include <stdio.h>
#include <string.h>

#include "hal/owfs/path.h"
#include "hal/w1/w1.h"

/* The kernel prints the six bytes of the id as one number. */
void w1_name(const uint8_t rom[8], char name[W1_NAME_MAX])
{
	snprintf(name, W1_NAME_MAX, "%02x-%02x%02x%02x%02x%02x%02x", rom[0], rom[6], rom[5], rom[4],
	         rom[3], rom[2], rom[1]);
}

static int hex(char c)
{
	if (c >= '0' && c <= '9')
		return c - '0';
	return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

bool w1_name_parse(const char *name, size_t len, uint8_t rom[8])
{
	static const uint8_t place[] = {0, 6, 5, 4, 3, 2, 1};

	if (len != W1_NAME_MAX - 1 || name[2] != '-')
		return false;
	for (unsigned i = 0; i < sizeof(place); i++) {
		const char *digits = name + 2 * i + (i > 0);
		int high = hex(digits[0]), low = hex(digits[1]);

		if (high < 0 || low < 0)
			return false;
		rom[place[i]] = (uint8_t)(high << 4 | low);
	}
	rom[7] = rom_crc8(rom, 7);
	return rom[0] != 0;
}
