/* SPDX-License-Identifier: MIT */
/*
 * DS2438 (data sheet 19-5099): temperature, two voltages, a current, a clock. How its memory is
 * read and written stands in ds2438.c; what stands on boards with this chip (humidity, pressure,
 * light) is computed in sensors_26.c.
 */
#include <errno.h>
#include <string.h>

#include "hal/chips/ds2438.h"

#define OFFSET_AT 13             /* page 1, byte 5 */
#define CURRENT_NS (28 * TXN_MS) /* 36.41 measurements a second */

static const struct conversion convert_t = {.command = {0x44}, .n = 1, .ns = 10 * TXN_MS};
static const struct conversion convert_v = {.command = {0xb4}, .n = 1, .ns = 10 * TXN_MS};

static int16_t word(const uint8_t *bytes)
{
	return (int16_t)(bytes[0] | bytes[1] << 8);
}

static int measure_temperature(struct txn *txn, double *value)
{
	uint8_t bytes[8];

	if (txn->phase == 0) {
		txn->phase++;
		return conversion_start(txn, &convert_t, false);
	}
	int err = ds2438_read(txn, 0, bytes);
	if (err)
		return err;
	*value = (word(bytes + 1) >> 3) / 32.0;
	return 0;
}

/*
 * The scratchpad's configuration is the one in force. The memory keeps what it has, which spares
 * its EEPROM, and the recall behind the conversion puts it in force again.
 */
static int measure_voltage(struct txn *txn, uint8_t select, double *value)
{
	uint8_t bytes[8];
	int err;

	switch (txn->phase) {
	case 0:
		err = ds2438_select(txn, select);
		txn->phase += err == 0;
		return err ? err : TXN_MORE;
	case 1:
		txn->phase++;
		return conversion_start(txn, &convert_v, false);
	default:
		err = ds2438_read_selected(txn, select, bytes);
		if (err)
			return err;
		*value = (word(bytes + 3) & 0x3ff) / 100.0;
		return 0;
	}
}

/* The current's measurement is switched on for this reading where it is off. */
static int measure_current(struct txn *txn, double *value)
{
	uint8_t bytes[8], *before = &ds2438_visit(txn)->before;
	int err;

	switch (txn->phase) {
	case 0:
		err = ds2438_configure(txn, DS2438_IAD, DS2438_IAD, before);
		if (err)
			return err;
		txn->phase++;
		return *before & DS2438_IAD ? TXN_MORE : txn_wait(txn, CURRENT_NS);
	case 1:
		err = ds2438_read(txn, 0, bytes);
		if (err)
			return err;
		*value = word(bytes + 5) * 0.0002441;
		txn->phase++;
		return TXN_MORE;
	default:
		return *before & DS2438_IAD ? 0 : ds2438_configure(txn, DS2438_IAD, 0, NULL);
	}
}

static int measure_one(struct txn *txn, enum ds2438_quantity what, double *value)
{
	switch (what) {
	case DS2438_TEMPERATURE:
		return measure_temperature(txn, value);
	case DS2438_VDD:
		return measure_voltage(txn, DS2438_AD, value);
	case DS2438_VAD:
		return measure_voltage(txn, 0, value);
	case DS2438_VIS:
		return measure_current(txn, value);
	case DS2438_QUANTITIES:
		break;
	}
	return -EINVAL;
}

/*
 * A restart empties the registers, and their checksum is right: a zero may be what a restart left.
 * Of the supply it always is. A zero of another quantity is measured again between a mark that a
 * restart destroys and a look at the mark. proof: as far as that is.
 */
enum proof { FIRST, MARK, AGAIN, LOOK };

static int measure_and_prove(struct txn *txn, enum ds2438_quantity what, double *value)
{
	uint8_t *proof = &ds2438_visit(txn)->proof;
	int err;

	switch ((enum proof) * proof) {
	case MARK:
		err = ds2438_mark(txn);
		if (err)
			return err;
		*proof = AGAIN;
		return txn_wait(txn, what == DS2438_VIS ? CURRENT_NS : 0);
	case LOOK:
		return ds2438_is_marked(txn);
	default:
		err = measure_one(txn, what, value);
	}
	if (err || *value != 0)
		return err;
	if (what == DS2438_VDD)
		return -EIO;
	*proof = *proof == FIRST ? MARK : LOOK;
	txn->phase = 0;
	return TXN_MORE;
}

/* One that was measured for another request, as far as this one allows it, is not measured again. */
int ds2438_measure(struct txn *txn, unsigned what)
{
	static const char quantities[DS2438_QUANTITIES];
	struct ds2438_visit *visit = ds2438_visit(txn);

	while (visit->stage < DS2438_QUANTITIES) {
		enum ds2438_quantity one = visit->stage;
		double *value = &visit->value[one];

		if (!(what >> one & 1) || (!visit->begun_ns && txn_shared(txn, &quantities[one], 0,
		                                                          value, sizeof(*value)))) {
			visit->stage++;
			continue;
		}
		if (!visit->begun_ns)
			visit->begun_ns = txn_now(txn);
		int err = measure_and_prove(txn, one, value);
		if (err)
			return err;
		txn_share(txn, &quantities[one], 0, value, sizeof(*value), visit->begun_ns);
		visit->begun_ns = 0;
		visit->proof = FIRST;
		txn->phase = 0;
		visit->stage++;
		if (what >> visit->stage)
			return TXN_MORE;
	}
	return 0;
}

static int read_measured(struct txn *txn)
{
	int err = ds2438_measure(txn, 1u << txn->property->arg);

	txn->number[0] = ds2438_visit(txn)->value[txn->property->arg];
	return err;
}

/* A zero may be what a restart left: it is measured. */
static int read_latest(struct txn *txn)
{
	struct ds2438_visit *visit = ds2438_visit(txn);
	uint8_t bytes[8];
	int err;

	if (visit->measuring) {
		err = ds2438_measure(txn, 1 << DS2438_TEMPERATURE);
		txn->number[0] = visit->value[DS2438_TEMPERATURE];
		return err;
	}
	err = area_read(txn, &ds2438_pages, 0, bytes, sizeof(bytes));
	if (err)
		return err;
	txn->number[0] = (word(bytes + 1) >> 3) / 32.0;
	visit->measuring = txn->number[0] == 0;
	return visit->measuring ? TXN_MORE : 0;
}

static int write_flag(struct txn *txn)
{
	uint8_t bit = (uint8_t)(1 << txn->property->field.shift);

	return ds2438_configure(txn, bit, txn->number[0] != 0 ? bit : 0, NULL);
}

/* In the upper 13 bits of two bytes. */
static int read_offset(struct txn *txn)
{
	uint8_t bytes[2];
	int err = area_read(txn, &ds2438_pages, OFFSET_AT, bytes, sizeof(bytes));

	if (!err)
		txn->number[0] = (double)(uint32_t)(word(bytes) >> 3);
	return err;
}

/* The chip takes it only while it does not measure the current. */
static int write_offset(struct txn *txn)
{
	struct ds2438_visit *visit = ds2438_visit(txn);
	int value = (int32_t)(uint32_t)(int64_t)txn->number[0]; /* as it is read, or below zero */
	int err;

	if (value < -256 || value > 255)
		return -EINVAL;
	uint16_t stored = (uint16_t)(value * 8);
	uint8_t bytes[] = {(uint8_t)stored, (uint8_t)(stored >> 8)};
	switch (visit->stage) {
	case 0:
		err = ds2438_configure(txn, DS2438_IAD, 0, &visit->before);
		break;
	case 1:
		err = ds2438_patch(txn, OFFSET_AT / 8, OFFSET_AT % 8, bytes, sizeof(bytes));
		break;
	default:
		return visit->before & DS2438_IAD
		               ? ds2438_configure(txn, DS2438_IAD, DS2438_IAD, NULL)
		               : 0;
	}
	visit->stage += err == 0;
	return err < 0 ? err : TXN_MORE;
}

static int put_page(struct txn *txn)
{
	return ds2438_patch(txn, (unsigned)txn->element, (unsigned)txn->at, txn->data,
	                    (unsigned)txn->len);
}

#define MEASURED(text, kind, what) \
	PROPERTY(text, kind, VOLATILE, READ, .arg = (what), .read = read_measured)
#define FLAG(text, bit) \
	PROPERTY(text, YESNO, STABLE, BOTH, FIELD(ds2438_pages, .shift = (bit), .bits = 1), \
	         .write = write_flag)
#define TIME(text, kind, life_, where) \
	PROPERTY(text, kind, life_, BOTH, FIELD(ds2438_pages, .at = (where), .bytes = 4), \
	         .write = ds2438_write_field)

static const struct property properties[] = {
	PROPERTY_DIR("B1-R1-A"),
	DS2438_SETTING("B1-R1-A/gain", PRESSURE, B1_GAIN),
	DS2438_SETTING("B1-R1-A/offset", PRESSURE, B1_OFFSET),
	PROPERTY("B1-R1-A/pressure", PRESSURE, VOLATILE, READ, .read = sensor_read_pressure),
	FLAG("CA", 1),
	PROPERTY("DATANAB", DIRECTORY, STATIC, NONE, .visible = sensor_is_datanab),
	PROPERTY("DATANAB/humidity", FLOAT, VOLATILE, READ, .arg = DATANAB,
                 .visible = sensor_is_datanab, .read = sensor_read_humidity),
	PROPERTY("DATANAB/reset", YESNO, STABLE, WRITE, .visible = sensor_is_datanab,
                 .write = sensor_reset_datanab),
	FLAG("EE", 2),
	PROPERTY_DIR("HIH3600"),
	DS2438_HUMIDITY("HIH3600/humidity", HIH3600),
	PROPERTY_DIR("HIH4000"),
	DS2438_HUMIDITY("HIH4000/humidity", HIH4000),
	PROPERTY_DIR("HIH5030"),
	DS2438_HUMIDITY("HIH5030/humidity", HIH5030),
	PROPERTY_DIR("HTM1735"),
	DS2438_HUMIDITY("HTM1735/humidity", HTM1735),
	FLAG("IAD", 0),
	PROPERTY_DIR("MultiSensor"),
	PROPERTY("MultiSensor/type", ASCII, STABLE, READ, .size = 12, .read = sensor_read_type),
	PROPERTY_DIR("S3-R1-A"),
	DS2438_LIGHT("S3-R1-A/current", 0),
	DS2438_SETTING("S3-R1-A/gain", FLOAT, S3_GAIN),
	DS2438_LIGHT("S3-R1-A/illuminance", 1),
	MEASURED("VAD", FLOAT, DS2438_VAD),
	MEASURED("VDD", FLOAT, DS2438_VDD),
	TIME("date", DATE, VOLATILE, 8),
	PROPERTY_DIR("disconnect"),
	TIME("disconnect/date", DATE, VOLATILE, 16),
	TIME("disconnect/udate", UNSIGNED, VOLATILE, 16),
	PROPERTY_DIR("endcharge"),
	TIME("endcharge/date", DATE, VOLATILE, 20),
	TIME("endcharge/udate", UNSIGNED, VOLATILE, 20),
	DS2438_HUMIDITY("humidity", HIH3600),
	PROPERTY("latesttemp", TEMPERATURE, VOLATILE, READ, .read = read_latest),
	PROPERTY("offset", UNSIGNED, STABLE, BOTH, .negative = true, .read = read_offset,
                 .write = write_offset),
	PROPERTY_DIR("pages"),
	PROPERTY("pages/page", BINARY, STABLE, BOTH, ELEMENTS(8, NUMBERS), .size = 8,
                 FIELD(ds2438_pages), .write = put_page),
	MEASURED("temperature", TEMPERATURE, DS2438_TEMPERATURE),
	TIME("udate", UNSIGNED, SECOND, 8),
	MEASURED("vis", FLOAT, DS2438_VIS),
};

const struct family family_26 = {.code = 0x26, .type = "DS2438", PROPERTIES(properties)};
