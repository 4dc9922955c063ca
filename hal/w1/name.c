/* SPDX-License-Identifier: MIT */
/* The names of slaves, to and from ROM ids, and of masters, to and from numbers. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/owfs/path.h"
#include "hal/w1/name.h"

/* The kernel prints the six bytes of the id as one number. */
void w1_name(const uint8_t rom[8], char name[W1_NAME_MAX])
{
	snprintf(name, W1_NAME_MAX, "%02x-%02x%02x%02x%02x%02x%02x", rom[0], rom[6], rom[5], rom[4],
	         rom[3], rom[2], rom[1]);
}

bool w1_name_parse(const char *name, size_t len, uint8_t rom[8])
{
	static const uint8_t place[] = {0, 6, 5, 4, 3, 2, 1};

	if (len != W1_NAME_MAX - 1 || name[2] != '-')
		return false;
	for (unsigned i = 0; i < sizeof(place); i++) {
		const char *digits = name + 2 * i + (i > 0);
		int high = hex_digit(digits[0]), low = hex_digit(digits[1]);

		if (high < 0 || low < 0)
			return false;
		rom[place[i]] = (uint8_t)(high << 4 | low);
	}
	rom[7] = rom_crc8(rom, 7);
	return rom[0] != 0;
}

void w1_master_name(unsigned number, char name[W1_MASTER_NAME_MAX])
{
	snprintf(name, W1_MASTER_NAME_MAX, "w1_bus_master%u", number);
}

unsigned w1_master_number(const char *name)
{
	static const char prefix[] = "w1_bus_master";
	char *end;

	if (strncmp(name, prefix, sizeof(prefix) - 1) != 0 || name[sizeof(prefix) - 1] < '1' ||
	    name[sizeof(prefix) - 1] > '9')
		return 0;
	unsigned long number = strtoul(name + sizeof(prefix) - 1, &end, 10);
	return *end || number > 9999 ? 0 : (unsigned)number;
}
