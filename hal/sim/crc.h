/* SPDX-License-Identifier: MIT */
/*
 * The checksums that 1-Wire slaves make (Application Note 27). The simulator has its own, so that
 * an error in those of the native bus cannot hide behind the same error here.
 */
#pragma once

#include <stddef.h>
#include <stdint.h>

/* x^8 + x^5 + x^4 + 1, least significant bit first, started with crc (0). */
uint8_t sim_crc8(uint8_t crc, const uint8_t *data, size_t n);
/* x^16 + x^15 + x^2 + 1, least significant bit first, started with crc (0); not inverted. */
uint16_t sim_crc16(uint16_t crc, const uint8_t *data, size_t n);
