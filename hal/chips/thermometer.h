/* SPDX-License-Identifier: MIT */
/*
 * What the thermometers with a nine-byte scratchpad have in common (data sheets DS18B20 19-7487,
 * DS18S20 19-5474, DS1822, DS1825, DS28EA00).
 */
#ifndef HAL_CHIPS_THERMOMETER_H
#define HAL_CHIPS_THERMOMETER_H

#include "hal/chips/family.h"

#define THERMOMETER_CONVERT 0x44
#define THERMOMETER_READ_POWER 0xb4

enum { SP_LSB, SP_MSB, SP_HIGH, SP_LOW, SP_CONFIG, SP_5, SP_REMAIN, SP_PER_DEGREE, SP_CRC };

/* The scratchpad, CRC checked; what its configuration tells is noted in the device. */
int thermometer_scratchpad(struct txn *txn, uint8_t scratchpad[9]);
/* A conversion's longest time at the device's present resolution. */
int64_t thermometer_convert_ns(const struct device *device);
/* Make the chip convert at this resolution; may take several calls. */
int thermometer_prepare(struct txn *txn, unsigned resolution);

/* Asks for the power supply and notes it: 1 external, 0 parasitic, or an error. */
int thermometer_ask_power(struct txn *txn);

int thermometer_read_temperature(struct txn *txn);
int thermometer_read_limit(struct txn *txn); /* arg: SP_HIGH or SP_LOW */
int thermometer_write_limit(struct txn *txn);
int thermometer_read_tempres(struct txn *txn);
int thermometer_write_tempres(struct txn *txn);
int thermometer_read_power(struct txn *txn);
int thermometer_read_scratchpad(struct txn *txn);
int thermometer_read_die(struct txn *txn);
int thermometer_read_trim(struct txn *txn);
int thermometer_refuse_trim(struct txn *txn);
int thermometer_read_trim_valid(struct txn *txn);
int thermometer_read_trim_blanket(struct txn *txn);

/* clang-format off */
#define THERMOMETER_TEMPERATURE(text, resolution)                                        \
	{.name = (text), .type = PROPERTY_TEMPERATURE, .life = LIFE_VOLATILE,             \
	 .access = ACCESS_READ, .convert = (resolution), .read = thermometer_read_temperature}
#define THERMOMETER_LATEST                                                               \
	{.name = "latesttemp", .type = PROPERTY_TEMPERATURE, .life = LIFE_VOLATILE,       \
	 .access = ACCESS_READ, .read = thermometer_read_temperature}
#define THERMOMETER_LIMIT(text, where)                                                   \
	{.name = (text), .type = PROPERTY_TEMPERATURE, .life = LIFE_STABLE,               \
	 .access = ACCESS_BOTH, .arg = (where), .read = thermometer_read_limit,           \
	 .write = thermometer_write_limit}
#define THERMOMETER_TEMPRES                                                              \
	{.name = "tempres", .type = PROPERTY_UNSIGNED, .life = LIFE_STABLE,               \
	 .access = ACCESS_BOTH, .read = thermometer_read_tempres,                         \
	 .write = thermometer_write_tempres}
#define THERMOMETER_POWER                                                                \
	{.name = "power", .type = PROPERTY_YESNO, .life = LIFE_VOLATILE,                  \
	 .access = ACCESS_READ, .read = thermometer_read_power}
#define THERMOMETER_SCRATCHPAD                                                           \
	{.name = "scratchpad", .type = PROPERTY_BINARY, .life = LIFE_VOLATILE,            \
	 .access = ACCESS_READ, .size = 9, .read = thermometer_read_scratchpad}
#define THERMOMETER_ERRATA                                                               \
	PROPERTY_DIR("errata"),                                                           \
	{.name = "errata/die", .type = PROPERTY_ASCII, .life = LIFE_STATIC,               \
	 .access = ACCESS_READ, .size = 2, .read = thermometer_read_die},                 \
	{.name = "errata/trim", .type = PROPERTY_UNSIGNED, .life = LIFE_VOLATILE,         \
	 .access = ACCESS_BOTH, .read = thermometer_read_trim,                            \
	 .write = thermometer_refuse_trim},                                               \
	{.name = "errata/trimblanket", .type = PROPERTY_YESNO, .life = LIFE_VOLATILE,     \
	 .access = ACCESS_BOTH, .read = thermometer_read_trim_blanket,                    \
	 .write = thermometer_refuse_trim},                                               \
	{.name = "errata/trimvalid", .type = PROPERTY_YESNO, .life = LIFE_VOLATILE,       \
	 .access = ACCESS_READ, .read = thermometer_read_trim_valid}
/* clang-format on */

/* What DS18B20, DS1822 and DS28EA00 have alike. */
#define THERMOMETER_PROPERTIES \
	THERMOMETER_TEMPERATURE("fasttemp", 9), THERMOMETER_LATEST, THERMOMETER_POWER, \
		THERMOMETER_TEMPERATURE("temperature", CONVERT_TEMPRES), \
		THERMOMETER_TEMPERATURE("temperature10", 10), \
		THERMOMETER_TEMPERATURE("temperature11", 11), \
		THERMOMETER_TEMPERATURE("temperature12", 12), \
		THERMOMETER_TEMPERATURE("temperature9", 9), \
		THERMOMETER_LIMIT("temphigh", SP_HIGH), THERMOMETER_LIMIT("templow", SP_LOW), \
		THERMOMETER_TEMPRES

#endif
