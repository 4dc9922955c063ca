/* SPDX-License-Identifier: MIT */
/*
 * What the thermometers with a nine-byte scratchpad have in common (data sheets DS18B20 19-7487,
 * DS18S20 19-5474, DS1822, DS1825, DS28EA00).
 */
#pragma once

#include "hal/chips/family.h"
#include "hal/chips/thermometers/thermometer_proof.h"

#define THERMOMETER_CONVERT 0x44
#define THERMOMETER_READ_POWER 0xb4

void thermometer_forget(struct device *device);

/* A right checksum, and yet what a wire without an answer gives, or nearly so. */
bool thermometer_is_blank(const struct family *family, const uint8_t scratchpad[9]);
/*
 * The nine bytes. What their configuration tells is noted; -EBADMSG: no such chip sends them,
 * -ENOENT it has not the property that is asked for.
 */
extern const struct area thermometer_area;
int thermometer_saw(struct txn *txn, unsigned at, uint8_t *scratchpad, unsigned n);
/* The scratchpad as it is now. */
int thermometer_scratchpad(struct txn *txn, uint8_t scratchpad[9]);
/* Limits and configuration of these nine bytes to the scratchpad, not to the EEPROM. */
int thermometer_write_settings(struct txn *txn, const uint8_t scratchpad[9]);
/*
 * The scratchpad as far as the limits and the configuration: a driver gives these without a
 * conversion.
 */
int thermometer_settings(struct txn *txn, uint8_t scratchpad[9]);
/* The configuration with another resolution. */
uint8_t thermometer_config(uint8_t config, unsigned resolution);
/* The resolution of property.convert; 0: it is not known yet. */
unsigned thermometer_bits(const struct device *device, unsigned convert);
/* Is it at that, as far as is known, or has no other? The reading will tell. */
bool thermometer_has_bits(const struct device *device, unsigned bits);
/* Make the chip convert at this resolution; may take several calls. */
int thermometer_prepare(struct txn *txn, unsigned resolution);

/* Is its resolution perhaps not that of its EEPROM? That is recalled once; TXN_MORE: done. */
bool thermometer_forgot(const struct device *device);
int thermometer_recall(struct txn *txn);

/* It converts; -EBADMSG: it has not taken the command. */
int thermometer_start(struct txn *txn);
/* ... of one that the wire feeds: TXN_MORE; the strong pull-up is on for so long. */
int thermometer_start_fed(struct txn *txn, int64_t ns);

/* Asks for the power supply and notes it: 1 external, 0 parasitic, or an error. */
int thermometer_ask_power(struct txn *txn);

property_function thermometer_read_temperature, thermometer_read_tempres, thermometer_read_power;
/* The user's settings go to the EEPROM (thermometer_store.c): the field's byte, the resolution. */
property_function thermometer_write_limit, thermometer_write_tempres;
property_function thermometer_read_die;

/* What stands first in the lists of their families; those with more begin behind the last. */
enum { SCRATCHPAD = 1, AFTER_THERMOMETER_AREAS };
/* NOLINTNEXTLINE(bugprone-macro-parentheses): a row of a list */
#define THERMOMETER_AREAS [SCRATCHPAD] = &thermometer_area
enum {
	WAY_TEMPERATURE = 1,
	WAY_LIMIT,
	WAY_TEMPRES,
	WAY_POWER,
	WAY_DIE,
	WAY_TRIM,
	AFTER_THERMOMETER_WAYS,
};
/* clang-format off */
#define THERMOMETER_WAYS \
	[WAY_TEMPERATURE] = {.read = thermometer_read_temperature}, \
	[WAY_LIMIT] = {.write = thermometer_write_limit}, \
	[WAY_TEMPRES] = {.read = thermometer_read_tempres, .write = thermometer_write_tempres}, \
	[WAY_POWER] = {.read = thermometer_read_power}, \
	[WAY_DIE] = {.read = thermometer_read_die}, \
	[WAY_TRIM] = {.read = property_refuse, .write = property_refuse}
/* clang-format on */

/* -55 to +125, at the ends within 2 degrees, a DS1822 within 3; 9 to 12 bits, 0.5 to 0.0625 */
#define THERMOMETER_MEASURES(decimals) .measures = {-58, 128, DEGREES_C, decimals, true}
#define THERMOMETER_TEMPERATURE(text, resolution, decimals) \
	PROPERTY(text, TEMPERATURE, VOLATILE, READ, .convert = (resolution), \
	         THERMOMETER_MEASURES(decimals), .how = WAY_TEMPERATURE)
#define THERMOMETER_LIMIT(text, where) \
	PROPERTY(text, TEMPERATURE, STABLE, BOTH, \
	         FIELD(SCRATCHPAD, .at = (where), .is_signed = true), .how = WAY_LIMIT)

/*
 * Parts of the families' tables, sorted: what all have first, then (a scratchpad) and what all have
 * last. The commands of the factory's trim stand in no data sheet: it is refused.
 */
#define THERMOMETER_ERRATA \
	PROPERTY_DIR("errata"), \
		PROPERTY("errata/die", ASCII, STATIC, READ, .size = 2, .how = WAY_DIE), \
		PROPERTY("errata/trim", UNSIGNED, VOLATILE, BOTH, .how = WAY_TRIM), \
		PROPERTY("errata/trimblanket", YESNO, VOLATILE, BOTH, .how = WAY_TRIM), \
		PROPERTY("errata/trimvalid", YESNO, VOLATILE, READ, .how = WAY_TRIM)
#define THERMOMETER_LATEST THERMOMETER_TEMPERATURE("latesttemp", 0, 4)
#define THERMOMETER_POWER PROPERTY("power", YESNO, VOLATILE, READ, .how = WAY_POWER)
#define THERMOMETER_SCRATCHPAD \
	PROPERTY("scratchpad", BINARY, VOLATILE, READ, .size = 9, FIELD(SCRATCHPAD))
#define THERMOMETER_TEMPRES PROPERTY("tempres", UNSIGNED, STABLE, BOTH, .how = WAY_TEMPRES)
/* At each resolution, the limits, and the resolution of the EEPROM. */
#define THERMOMETER_TEMPERATURES \
	THERMOMETER_TEMPERATURE("temperature", CONVERT_TEMPRES, 4), \
		THERMOMETER_TEMPERATURE("temperature10", 10, 2), \
		THERMOMETER_TEMPERATURE("temperature11", 11, 3), \
		THERMOMETER_TEMPERATURE("temperature12", 12, 4), \
		THERMOMETER_TEMPERATURE("temperature9", 9, 1), \
		THERMOMETER_LIMIT("temphigh", SP_HIGH), THERMOMETER_LIMIT("templow", SP_LOW), \
		THERMOMETER_TEMPRES
/* DS18B20 and DS1822 */
#define THERMOMETER_PROPERTIES \
	THERMOMETER_ERRATA, THERMOMETER_TEMPERATURE("fasttemp", 9, 1), THERMOMETER_LATEST, \
		THERMOMETER_POWER, THERMOMETER_SCRATCHPAD, THERMOMETER_TEMPERATURES
#define THERMOMETER_FAMILY .thermometer = true, .alarms = true, .forget = thermometer_forget
