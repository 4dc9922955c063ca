/* SPDX-License-Identifier: MIT */
/* Sensors on boards with a DS2438, from the data sheets of the sensors. */
#include <errno.h>

#include "hal/chips/batteries/ds2438.h"
#include "hal/chips/batteries/ds2438_measure.h"
#include "hal/chips/batteries/sensors_26.h"

/*
 * The Hobby Boards' settings stand in page 3, 16 bits each. 0 is not set: 46 mV/mbar and 904.7
 * mbar, and a SFH203P of 9.5 nA/lx.
 */
#define SETTING_PAGE 3
#define SHUNT_OHM 390.0

static const struct {
	uint8_t at;
	bool is_signed;
	double unit, standard;
} settings[] = {
	[S3_GAIN] = {2, false, 0.1, 1 / 0.0095},
	[B1_GAIN] = {4, false, 0.001, 1 / 0.046},
	[B1_OFFSET] = {6, true, 0.05, 904.7},
};

/* HIH3600 stands for the HIH-3610 with 0.8 V at 0 %RH whatever the supply; the others follow it. */
static double relative_humidity(int sensor, double celsius, double supply, double volt)
{
	double ratio = volt / supply, compensation = 1.0546 - 0.00216 * celsius;

	switch ((enum sensor_humidity)sensor) {
	case HIH3600:
		return (volt - 0.8) / supply / 0.0062 / compensation;
	case HIH4000:
	case DATANAB:
		return (ratio - 0.16) / 0.0062 / compensation;
	case HIH5030:
		return (ratio - 0.1515) / 0.00636 / compensation;
	case HTM1735:
		return 38.92 * volt - 41.98;
	}
	return 0;
}

int sensor_read_humidity(struct txn *txn)
{
	const double *value = ds2438_visit(txn)->value;
	int sensor = txn->property->arg;
	unsigned what = 1 << DS2438_VAD;

	if (sensor != HTM1735)
		what |= 1 << DS2438_TEMPERATURE | 1 << DS2438_VDD;
	int err = ds2438_measure(txn, what);
	if (err)
		return err;
	if (sensor != HTM1735 && value[DS2438_VDD] <= 0)
		return -ENODATA;
	txn->number[0] = relative_humidity(sensor, value[DS2438_TEMPERATURE], value[DS2438_VDD],
	                                   value[DS2438_VAD]);
	return 0;
}

static double setting(const uint8_t page[8], int which)
{
	unsigned raw = page[settings[which].at] | (unsigned)page[settings[which].at + 1] << 8;

	if (raw == 0)
		return settings[which].standard;
	return (settings[which].is_signed ? (int16_t)raw : (int)raw) * settings[which].unit;
}

int sensor_read_setting(struct txn *txn)
{
	uint8_t page[8];
	int err = area_read(txn, &ds2438_pages, 8 * SETTING_PAGE, page, 8);

	if (!err)
		txn->number[0] = setting(page, txn->property->arg);
	return err;
}

int sensor_write_setting(struct txn *txn)
{
	int which = txn->property->arg;
	double scaled = txn->number[0] / settings[which].unit;

	if (!(scaled > (settings[which].is_signed ? -32768.5 : -0.5) && scaled < 32767.5))
		return -EINVAL;
	int16_t raw = (int16_t)(scaled < 0 ? scaled - 0.5 : scaled + 0.5);
	uint8_t bytes[] = {(uint8_t)raw, (uint8_t)((uint16_t)raw >> 8)};
	return ds2438_patch(txn, SETTING_PAGE, settings[which].at, bytes, sizeof(bytes));
}

/* The settings' page comes last. */
static int with_settings(struct txn *txn, enum ds2438_quantity what, uint8_t page[8])
{
	struct ds2438_visit *visit = ds2438_visit(txn);

	if (visit->stage <= DS2438_QUANTITIES) {
		int err = ds2438_measure(txn, 1u << what);

		if (!err)
			visit->stage = DS2438_QUANTITIES + 1;
		return err ? err : TXN_MORE;
	}
	return area_read(txn, &ds2438_pages, 8 * SETTING_PAGE, page, 8);
}

int sensor_read_pressure(struct txn *txn)
{
	uint8_t page[8];
	int err = with_settings(txn, DS2438_VAD, page);

	if (!err)
		txn->number[0] = ds2438_visit(txn)->value[DS2438_VAD] * setting(page, B1_GAIN) +
		                 setting(page, B1_OFFSET);
	return err;
}

int sensor_read_light(struct txn *txn)
{
	uint8_t page[8];
	int err = with_settings(txn, DS2438_VIS, page);

	if (err)
		return err;
	double microampere = ds2438_visit(txn)->value[DS2438_VIS] / SHUNT_OHM * 1e6;
	double lux = microampere * setting(page, S3_GAIN);
	txn->number[0] = txn->property->arg ? (lux < 1 ? 1 : lux) : microampere;
	return 0;
}

int sensor_read_type(struct txn *txn)
{
	static const char *const types[] = {"MS-TH", "MS-TV", "MS-TL", "MS-TC", "MS-TW"};
	const char *type = "unknown";
	uint8_t page[8];
	int err = area_read(txn, &ds2438_pages, 8 * SETTING_PAGE, page, 8);

	if (err)
		return err;
	if (page[0] == 0)
		type = "MS-T";
	else if (page[0] >= 0x19 && page[0] < 0x19 + sizeof(types) / sizeof(types[0]))
		type = types[page[0] - 0x19];
	return property_text(txn, type);
}
