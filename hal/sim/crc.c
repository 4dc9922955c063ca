/* SPDX-License-Identifier: MIT */
/* The checksums that simulated slaves make. */
#include "hal/sim/crc.h"

uint8_t sim_crc8(uint8_t crc, const uint8_t *data, size_t n)
{
	while (n--) {
		crc ^= *data++;
		for (int bit = 0; bit < 8; bit++)
			crc = (uint8_t)(crc & 1 ? crc >> 1 ^ 0x8C : crc >> 1);
	}
	return crc;
}

uint16_t sim_crc16(uint16_t crc, const uint8_t *data, size_t n)
{
	while (n--) {
		crc ^= *data++;
		for (int bit = 0; bit < 8; bit++)
			crc = (uint16_t)(crc & 1 ? crc >> 1 ^ 0xA001 : crc >> 1);
	}
	return crc;
}
