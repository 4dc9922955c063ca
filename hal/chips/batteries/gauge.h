/* SPDX-License-Identifier: MIT */
/*
 * What the battery gauges with 256 addresses have in common (DS2740, DS2751, DS2755, DS2760,
 * DS2770, DS2780, DS2781): commands, areas, rows of their tables. None of their bytes has a
 * checksum; words come high byte first.
 */
#pragma once

#include "hal/chips/family.h"
#include "hal/chips/thermometers/thermocouple.h"

/* Read Data, Write Data, Recall Data, Copy Data. */
#define GAUGE_READ .address_bytes = 1, .read = 0x69
#define GAUGE_WRITE(row_) GAUGE_READ, .row = (row_), .write = 0x6c
/* Read and written by way of its shadow RAM, in blocks. */
#define GAUGE_STORED(block_) \
	.block = (block_), GAUGE_WRITE(block_), .recall = 0xb8, .copy = 0x48, .copy_ns = 10 * TXN_MS

/* An area of one byte that is written by itself. */
#define GAUGE_REGISTER(text, where) AREA(.name = (text), .at = (where), .size = 1, GAUGE_WRITE(1))

/* A number of two bytes that goes on counting while it is written. */
bool gauge_is_counted(struct txn *txn, const uint8_t *have, const uint8_t *want, unsigned n);
extern const struct area gauge_memory, gauge_words, gauge_bytes, gauge_charge, gauge_eeprom;
/* Of DS2780 and DS2781: one block of their EEPROM. */
extern const struct area gauge_parameters;
/* Of DS2720 and DS2760: the protection register, and the same byte to read the pins. */
extern const struct area gauge_protection, gauge_pins;

/* What stands first in the lists of the families. */
enum {
	MEMORY = 1, /* as it is, the shadow of the EEPROM too; read-only */
	WORDS,      /* the same, two by two */
	BYTES,      /* the same, one by one */
	CHARGE,     /* the accumulated current */
	EEPROM,     /* in blocks of 16 bytes */
	AFTER_GAUGE_AREAS
};
enum {
	WAY_LOCK = 1,
	WAY_COUPLE,
	WAY_COUPLE_LOW,
	WAY_COUPLE_HIGH,
	WAY_BESIDE_PIO,
	AFTER_GAUGE_WAYS
};

/* arg of a lock: the EEPROM register, and from bit 8 on the address of each block. */
int gauge_read_lock(struct txn *txn);
int gauge_write_lock(struct txn *txn);
/* arg of a thermocouple: its type, the temperature's address, how fine the voltage is. */
int gauge_read_couple(struct txn *txn);
int gauge_couple_low(struct txn *txn);
int gauge_couple_high(struct txn *txn);

/* V across the resistor of one step of a word: of 13 bits, left-aligned, and of 16. */
#define GAUGE_COARSE (15.625e-6 / 8)
#define GAUGE_FINE 1.5625e-6
/* The resistor that some of them have inside, in Ohm. */
#define GAUGE_RESISTOR .025

/* clang-format off */
#define GAUGE_AREAS \
	[MEMORY] = &gauge_memory, [WORDS] = &gauge_words, [BYTES] = &gauge_bytes, \
	[CHARGE] = &gauge_charge, [EEPROM] = &gauge_eeprom
#define GAUGE_WAYS \
	[WAY_LOCK] = {.read = gauge_read_lock, .write = gauge_write_lock}, \
	[WAY_COUPLE] = {.read = gauge_read_couple}, \
	[WAY_COUPLE_LOW] = {.read = gauge_couple_low}, \
	[WAY_COUPLE_HIGH] = {.read = gauge_couple_high}, \
	[WAY_BESIDE_PIO] = {.write = property_refuse}

#define GAUGE_LOCK(n, register_, blocks) \
	PROPERTY("lock", YESNO, STABLE, BOTH, ELEMENTS(n, NUMBERS), \
	         .arg = (register_) | (blocks) << 8, .how = WAY_LOCK)
#define GAUGE_WORD(text, where, unit_, measures_) \
	PROPERTY(text, FLOAT, VOLATILE, READ, \
	         FIELD(WORDS, .at = (where), .bytes = 2, .big_endian = true, .is_signed = true, \
	               .unit = (unit_)), measures_)
/* What the register of the voltage across the resistor holds, in V and, inside, in A. */
#define GAUGE_VIS_COARSE MEASURES(-0.064, 0.064, 6, "V")
#define GAUGE_VIS_FINE MEASURES(-0.0512, 0.0512, 7, "V")
#define GAUGE_CURRENT_COARSE MEASURES(-2.56, 2.56, 6, "A")
#define GAUGE_CURRENT_FINE MEASURES(-2.048, 2.048, 7, "A")
/* 10 bits and sign; the chip measures from 0 on, within 5 mV of one cell. */
#define GAUGE_VOLT(unit_) \
	PROPERTY("volt", FLOAT, VOLATILE, READ, \
	         FIELD(WORDS, .at = 0x0c, .bytes = 2, .big_endian = true, .is_signed = true, \
	               .shift = 5, .unit = (unit_)), \
	         MEASURES(-0.02, (unit_) * 1023.5, 3, "V"))
/* Registers hold -128 to 127.875; no such chip lives below -55 or above 125, within 3. */
#define GAUGE_CELSIUS MEASURES(-58, 127.875, 3, DEGREES_C)
#define GAUGE_TEMPERATURE(where) \
	PROPERTY("temperature", TEMPERATURE, VOLATILE, READ, \
	         FIELD(WORDS, .at = (where), .bytes = 2, .big_endian = true, .is_signed = true, \
	               .shift = 5, .unit = .125), GAUGE_CELSIUS)
/* The accumulated current: 6.25 uVh, 15 bits and sign. */
#define GAUGE_CHARGE(text, resistor, unit_) \
	PROPERTY(text, FLOAT, VOLATILE, BOTH, \
	         FIELD(CHARGE, .bytes = 2, .big_endian = true, .is_signed = true, \
	               .unit = 6.25e-6 / (resistor)), \
	         MEASURES(-.2048 / (resistor), .2048 / (resistor), 6, unit_))
#define GAUGE_AMPHOURS GAUGE_CHARGE("amphours", GAUGE_RESISTOR, "Ah")
#define GAUGE_VOLTHOURS GAUGE_CHARGE("volthours", 1, "Vh")
#define GAUGE_BIT(text, life_, access_, area_, where, bit) \
	PROPERTY(text, YESNO, life_, access_, \
	         FIELD(area_, .at = (where), .shift = (bit), .bits = 1))
#define GAUGE_BESIDE_PIO(text, life_, area_, bit) \
	PROPERTY(text, YESNO, life_, BOTH, FIELD(area_, .shift = (bit), .bits = 1), \
	         .how = WAY_BESIDE_PIO)
/* Each type ends inside the range of all of them; range_low and range_high have its own. */
#define GAUGE_COUPLE(text, type_, where, fine) \
	PROPERTY_DIR(text), \
	PROPERTY(text "/range_high", TEMPERATURE, STATIC, READ, .offline = true, \
	         .arg = (type_), .how = WAY_COUPLE_HIGH), \
	PROPERTY(text "/range_low", TEMPERATURE, STATIC, READ, .offline = true, \
	         .arg = (type_), .how = WAY_COUPLE_LOW), \
	PROPERTY(text "/temperature", TEMPERATURE, VOLATILE, READ, \
	         .arg = (type_) | (where) << 8 | (fine) << 16, \
	         MEASURES(-270, 1820, 3, DEGREES_C), .how = WAY_COUPLE)
#define GAUGE_COUPLES(where, fine) \
	GAUGE_COUPLE("typeB", TYPE_B, where, fine), GAUGE_COUPLE("typeE", TYPE_E, where, fine), \
	GAUGE_COUPLE("typeJ", TYPE_J, where, fine), GAUGE_COUPLE("typeK", TYPE_K, where, fine), \
	GAUGE_COUPLE("typeN", TYPE_N, where, fine), GAUGE_COUPLE("typeR", TYPE_R, where, fine), \
	GAUGE_COUPLE("typeS", TYPE_S, where, fine), GAUGE_COUPLE("typeT", TYPE_T, where, fine)
/* clang-format on */
