/* SPDX-License-Identifier: MIT */
/* A DS2438: its pages and its configuration (ds2438.c), what it measures (family_26.c). */
#ifndef HAL_CHIPS_DS2438_H
#define HAL_CHIPS_DS2438_H

#include "hal/chips/family.h"

/* Bits of the status/configuration register, page 0 byte 0. */
#define DS2438_IAD 0x01
#define DS2438_CA 0x02
#define DS2438_EE 0x04
#define DS2438_AD 0x08 /* the supply, not the input, is measured */

enum { DS2438_TEMPERATURE = 1, DS2438_VDD = 2, DS2438_VAD = 4, DS2438_VIS = 8 };
#define DS2438_STEPS 4 /* of the phase, for each quantity */

/*
 * All of these take several calls. They use txn->mem[] as here:
 *   0, 1 ds2438_configure   2, 4 for the caller   3, 8..15 ds2438_patch   16..19 ds2438_read
 *   20..23 ds2438_measure   24, 25 ds2438_mark
 *
 * A page of the memory as it is now.
 */
int ds2438_read(struct txn *txn, unsigned page, uint8_t bytes[8]);
/* Put n bytes into a page; phase 0 first. */
int ds2438_patch(struct txn *txn, unsigned page, unsigned at, const uint8_t *bytes, unsigned n);
/* Set the configuration's bits of mask. *before (if not NULL): the configuration as it was. */
int ds2438_configure(struct txn *txn, uint8_t mask, uint8_t bits, uint8_t *before);
/* What Convert V measures, DS2438_AD or 0, until the next ds2438_read(). */
int ds2438_select(struct txn *txn, uint8_t select);
/* Page 0 after that; -EBADMSG if something else was selected. */
int ds2438_read_selected(struct txn *txn, uint8_t select, uint8_t bytes[8]);
/*
 * Leave a mark in a scratchpad, other than what a restart leaves there. ds2438_is_marked(): -EBADMSG
 * if the chip has restarted since, or it cannot be known.
 */
int ds2438_mark(struct txn *txn);
int ds2438_is_marked(struct txn *txn);
/* Measure; several calls. real[]: degrees, volts of the supply, of the input, of the shunt. */
int ds2438_measure(struct txn *txn, unsigned what);

int sensor_read_humidity(struct txn *txn); /* arg: enum sensor_humidity */
int sensor_read_pressure(struct txn *txn);
int sensor_read_light(struct txn *txn);   /* arg: 1 in lux */
int sensor_read_setting(struct txn *txn); /* arg: enum sensor_setting */
int sensor_write_setting(struct txn *txn);
int sensor_read_type(struct txn *txn);
bool sensor_is_datanab(const struct device *device);
int sensor_reset_datanab(struct txn *txn);

enum sensor_humidity { HIH3600, HIH4000, HIH5030, HTM1735, DATANAB };
enum sensor_setting { B1_GAIN, B1_OFFSET, S3_GAIN };

/* clang-format off */
#define DS2438_HUMIDITY(text, which)                                                      \
	{.name = (text), .type = PROPERTY_FLOAT, .life = LIFE_VOLATILE, .access = ACCESS_READ, \
	 .arg = (which), .read = sensor_read_humidity}
#define DS2438_SETTING(text, kind, which)                                                 \
	{.name = (text), .type = (kind), .life = LIFE_STABLE, .access = ACCESS_BOTH,        \
	 .arg = (which), .read = sensor_read_setting, .write = sensor_write_setting}
#define DS2438_LIGHT(text, lux)                                                           \
	{.name = (text), .type = PROPERTY_FLOAT, .life = LIFE_VOLATILE, .access = ACCESS_READ, \
	 .arg = (lux), .read = sensor_read_light}
#define DS2438_SENSORS                                                                    \
	PROPERTY_DIR("B1-R1-A"), DS2438_SETTING("B1-R1-A/gain", PROPERTY_PRESSURE, B1_GAIN), \
	DS2438_SETTING("B1-R1-A/offset", PROPERTY_PRESSURE, B1_OFFSET),                     \
	{.name = "B1-R1-A/pressure", .type = PROPERTY_PRESSURE, .life = LIFE_VOLATILE,      \
	 .access = ACCESS_READ, .read = sensor_read_pressure},                              \
	{.name = "DATANAB", .type = PROPERTY_DIRECTORY, .life = LIFE_STATIC,                \
	 .visible = sensor_is_datanab},                                                     \
	{.name = "DATANAB/humidity", .type = PROPERTY_FLOAT, .life = LIFE_VOLATILE,         \
	 .access = ACCESS_READ, .arg = DATANAB, .visible = sensor_is_datanab,               \
	 .read = sensor_read_humidity},                                                     \
	{.name = "DATANAB/reset", .type = PROPERTY_YESNO, .life = LIFE_STABLE,              \
	 .access = ACCESS_WRITE, .visible = sensor_is_datanab, .write = sensor_reset_datanab}, \
	PROPERTY_DIR("HIH3600"), DS2438_HUMIDITY("HIH3600/humidity", HIH3600),              \
	PROPERTY_DIR("HIH4000"), DS2438_HUMIDITY("HIH4000/humidity", HIH4000),              \
	PROPERTY_DIR("HIH5030"), DS2438_HUMIDITY("HIH5030/humidity", HIH5030),              \
	PROPERTY_DIR("HTM1735"), DS2438_HUMIDITY("HTM1735/humidity", HTM1735),              \
	PROPERTY_DIR("MultiSensor"),                                                        \
	{.name = "MultiSensor/type", .type = PROPERTY_ASCII, .life = LIFE_STABLE,           \
	 .access = ACCESS_READ, .size = 12, .read = sensor_read_type},                      \
	PROPERTY_DIR("S3-R1-A"), DS2438_LIGHT("S3-R1-A/current", 0),                        \
	DS2438_SETTING("S3-R1-A/gain", PROPERTY_FLOAT, S3_GAIN),                            \
	DS2438_LIGHT("S3-R1-A/illuminance", 1),                                             \
	DS2438_HUMIDITY("humidity", HIH3600)
/* clang-format on */

#endif
