/* SPDX-License-Identifier: MIT */
/* The checksums of 1-Wire: CRC16 of blocks, and what makes a ROM id valid. */
#include "hal/wire/crc.h"
#include "hal/owfs/path.h"

uint16_t onewire_crc16(uint16_t crc, const uint8_t *data, size_t n)
{
	while (n--) {
		crc ^= *data++;
		for (int bit = 0; bit < 8; bit++)
			crc = (uint16_t)(crc & 1 ? crc >> 1 ^ 0xa001 : crc >> 1);
	}
	return crc;
}

bool onewire_crc16_matches(uint16_t crc, const uint8_t sent[2])
{
	return (crc ^ 0xffff) == (sent[0] | sent[1] << 8);
}

bool onewire_rom_valid(const uint8_t rom[8])
{
	return rom[0] != 0 && rom_crc8(rom, 7) == rom[7];
}
