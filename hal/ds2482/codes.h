/* SPDX-License-Identifier: MIT */
/* DS2482-100, -101, -800, DS2483, DS2484: codes, register bits and longest times by data sheet. */
#pragma once

enum ds2482_command {
	DS2482_DEVICE_RESET = 0xF0,
	DS2482_READ_POINTER = 0xE1,
	DS2482_WRITE_CONFIG = 0xD2,
	DS2482_CHANNEL = 0xC3, /* -800 alone; on DS2483 and DS2484 it adjusts the port */
	DS2482_RESET = 0xB4,
	DS2482_BIT = 0x87,
	DS2482_WRITE = 0xA5,
	DS2482_READ = 0x96,
	DS2482_TRIPLET = 0x78,
};

enum ds2482_register {
	DS2482_AT_STATUS = 0xF0,
	DS2482_AT_DATA = 0xE1,
	DS2482_AT_CHANNEL = 0xD2, /* -800 */
	DS2482_AT_CONFIG = 0xC3,
	DS2482_AT_PORT = 0xB4, /* DS2483, DS2484 */
};

enum ds2482_status {
	DS2482_1WB = 0x01,
	DS2482_PPD = 0x02,
	DS2482_SD = 0x04,
	DS2482_LL = 0x08,
	DS2482_RST = 0x10,
	DS2482_SBR = 0x20,
	DS2482_TSB = 0x40,
	DS2482_DIR = 0x80,
};

enum ds2482_config {
	DS2482_APU = 0x01,
	DS2482_PDN = 0x02, /* DS2483, DS2484: the port's supply off */
	DS2482_SPU = 0x04,
};

/* ns; "1-Wire timing" of the electrical characteristics, at standard speed. */
static const long ds2482_slot_min_ns = 65800;
static const long ds2482_slot_ns = 69300;
static const long ds2482_slot_max_ns = 72800;
static const long ds2482_byte_max_ns = 8 * 72800;
static const long ds2482_reset_min_ns = 1124800;
static const long ds2482_reset_ns = 1184000;
static const long ds2482_reset_max_ns = 1243200;
