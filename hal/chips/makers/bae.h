/* SPDX-License-Identifier: MIT */
/*
 * BAE 0910 and 0911 by Pascal Baerten: microcontrollers whose functions are registers, family FC.
 * What a command gives has a CRC16; a command that writes is acknowledged with one, and acts when
 * the master confirms it. Nothing but what is read back shows whether the confirmation was heard.
 */
#pragma once

#include "hal/chips/family.h"

/* device.kind */
enum bae_kind { BAE_910 = 1, BAE_911, BAE_OTHER };
struct bae {
	uint32_t sector; /* of the card */
};
/* A command of n bytes, its checksum, the confirmation. */
int bae_confirmed(struct txn *txn, const uint8_t *command, unsigned n);

/* What runs in a 0911: the expander on its I2C, the card, texts. */
property_function bae_read_expander, bae_write_expander, bae_read_sector, bae_write_sector;
property_function bae_read_sector_number, bae_write_sector_number, bae_write_text;
