/* SPDX-License-Identifier: MIT */
/*
 * CRC16 of 1-Wire memory commands (Maxim application note 27): X^16+X^15+X^2+1, reflected, start
 * value 0. The CRC8 of ids and scratchpads is rom_crc8() of hal/owfs/path.h.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Goes on from crc (0 at the start). */
uint16_t onewire_crc16(uint16_t crc, const uint8_t *data, size_t n);
/* The chip sends the complement, low byte first: is it that of crc? */
bool onewire_crc16_matches(uint16_t crc, const uint8_t sent[2]);
/* A family that is not 0, and a right CRC8. */
bool onewire_rom_valid(const uint8_t rom[8]);
