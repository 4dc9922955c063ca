/* SPDX-License-Identifier: MIT */
/*
 * DS2438 (data sheet 19-5099): temperature, two voltages, a current, a clock. How its memory is
 * read and written stands in ds2438.c; what stands on boards with this chip (humidity, pressure,
 * light) is computed in sensors_26.c.
 */
#include <errno.h>
#include <string.h>

#include "hal/chips/ds2438.h"

#define CONVERT_T 0x44
#define CONVERT_V 0xb4
#define CONVERT_NS (10 * TXN_MS)
#define CURRENT_NS (28 * TXN_MS) /* 36.41 measurements a second */

static int16_t word(const uint8_t *bytes)
{
	return (int16_t)(bytes[0] | bytes[1] << 8);
}

static int convert(struct txn *txn, uint8_t command)
{
	int err = txn_command(txn, &command, 1);

	if (!err)
		err = txn_started(txn);
	return err ? err : txn_wait(txn, CONVERT_NS);
}

static int measure_temperature(struct txn *txn, double *value)
{
	uint8_t bytes[8];

	if (txn->phase % DS2438_STEPS == 0) {
		txn->phase++;
		return convert(txn, CONVERT_T);
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

	switch (txn->phase % DS2438_STEPS) {
	case 0:
		err = ds2438_select(txn, select);
		txn->phase += err == 0;
		return err ? err : TXN_MORE;
	case 1:
		txn->phase++;
		return convert(txn, CONVERT_V);
	default:
		err = ds2438_read_selected(txn, select, bytes);
		if (err)
			return err;
		*value = (word(bytes + 3) & 0x3ff) / 100.0;
		return 0;
	}
}

/* The current's measurement is switched on for this reading where it is off. mem[2]: it was on. */
static int measure_current(struct txn *txn, double *value)
{
	uint8_t bytes[8];
	int err;

	switch (txn->phase % DS2438_STEPS) {
	case 0:
		err = ds2438_configure(txn, DS2438_IAD, DS2438_IAD, &txn->mem[2]);
		if (err)
			return err;
		txn->phase++;
		return txn->mem[2] & DS2438_IAD ? TXN_MORE : txn_wait(txn, CURRENT_NS);
	case 1:
		err = ds2438_read(txn, 0, bytes);
		if (err)
			return err;
		txn->real[3] = word(bytes + 5) * 0.0002441;
		txn->phase++;
		return TXN_MORE;
	default:
		*value = txn->real[3];
		return txn->mem[2] & DS2438_IAD ? 0 : ds2438_configure(txn, DS2438_IAD, 0, NULL);
	}
}

static int measure_one(struct txn *txn, unsigned what, double *value)
{
	switch (what) {
	case DS2438_TEMPERATURE:
		return measure_temperature(txn, value);
	case DS2438_VDD:
		return measure_voltage(txn, DS2438_AD, value);
	case DS2438_VAD:
		return measure_voltage(txn, 0, value);
	default:
		return measure_current(txn, value);
	}
}

/*
 * A restart empties the registers, and their checksum is right: a zero may be what a restart left.
 * Of the supply it always is. A zero of another quantity is measured again between a mark that a
 * restart destroys and a look at the mark. *proof: as far as that is.
 */
enum proof { FIRST, MARK, AGAIN, LOOK };

static int measure_and_prove(struct txn *txn, unsigned what, double *value, uint8_t *proof)
{
	unsigned begin = txn->phase - txn->phase % DS2438_STEPS;
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
	txn->phase = begin;
	return TXN_MORE;
}

int ds2438_measure(struct txn *txn, unsigned what)
{
	static const unsigned order[] = {DS2438_TEMPERATURE, DS2438_VAD, DS2438_VDD, DS2438_VIS};
	static const unsigned place[] = {0, 2, 1, 3}; /* in real[] */
	unsigned stage = txn->phase / DS2438_STEPS;

	while (stage < 4 && !(what & order[stage]))
		stage++;
	if (stage == 4)
		return 0;
	if (txn->phase / DS2438_STEPS != stage)
		txn->phase = stage * DS2438_STEPS;
	int err = measure_and_prove(txn, order[stage], &txn->real[place[stage]],
	                            &txn->mem[20 + stage]);
	if (err)
		return err;
	txn->phase = (stage + 1) * DS2438_STEPS;
	while (++stage < 4)
		if (what & order[stage])
			return TXN_MORE;
	return 0;
}

static int read_measured(struct txn *txn)
{
	unsigned what = (unsigned)txn->property->arg;
	int err = ds2438_measure(txn, what);

	txn->number[0] = txn->real[what == DS2438_TEMPERATURE ? 0
	                           : what == DS2438_VDD       ? 1
	                           : what == DS2438_VAD       ? 2
	                                                      : 3];
	return err;
}

/* A zero may be what a restart left: it is measured. mem[4]: that it is. */
static int read_latest(struct txn *txn)
{
	uint8_t bytes[8];
	int err;

	if (txn->mem[4]) {
		err = ds2438_measure(txn, DS2438_TEMPERATURE);
		txn->number[0] = txn->real[0];
		return err;
	}
	err = ds2438_read(txn, 0, bytes);
	if (err)
		return err;
	txn->number[0] = (word(bytes + 1) >> 3) / 32.0;
	txn->mem[4] = txn->number[0] == 0;
	return txn->mem[4] ? TXN_MORE : 0;
}

static int read_flag(struct txn *txn)
{
	uint8_t bytes[8];
	int err = ds2438_read(txn, 0, bytes);

	if (!err)
		txn->number[0] = (bytes[0] & txn->property->arg) != 0;
	return err;
}

static int write_flag(struct txn *txn)
{
	uint8_t bit = (uint8_t)txn->property->arg;

	return ds2438_configure(txn, bit, txn->number[0] != 0 ? bit : 0, NULL);
}

/* arg: page * 8 + byte. */
static int read_time(struct txn *txn)
{
	uint8_t page[8];
	unsigned at = (unsigned)txn->property->arg % 8;
	int err = ds2438_read(txn, (unsigned)txn->property->arg / 8, page);

	if (err)
		return err;
	txn->number[0] = (double)(page[at] | page[at + 1] << 8 | page[at + 2] << 16 |
	                          (uint32_t)page[at + 3] << 24);
	return 0;
}

static int write_time(struct txn *txn)
{
	uint32_t time = (uint32_t)txn->number[0];
	uint8_t bytes[] = {(uint8_t)time, (uint8_t)(time >> 8), (uint8_t)(time >> 16),
	                   (uint8_t)(time >> 24)};
	unsigned arg = (unsigned)txn->property->arg;

	return ds2438_patch(txn, arg / 8, arg % 8, bytes, sizeof(bytes));
}

/* In the upper 13 bits of two bytes. */
static int read_offset(struct txn *txn)
{
	uint8_t page[8];
	int err = ds2438_read(txn, 1, page);

	if (!err)
		txn->number[0] = (double)(uint32_t)(word(page + 5) >> 3);
	return err;
}

/* The chip takes it only while it does not measure the current. mem[2]: as it was. */
static int write_offset(struct txn *txn)
{
	int value = (int32_t)(uint32_t)(int64_t)txn->number[0]; /* as it is read, or below zero */
	int err;

	if (value < -256 || value > 255)
		return -EINVAL;
	uint16_t stored = (uint16_t)(value * 8);
	uint8_t bytes[] = {(uint8_t)stored, (uint8_t)(stored >> 8)};
	switch (txn->mem[4]) {
	case 0:
		err = ds2438_configure(txn, DS2438_IAD, 0, &txn->mem[2]);
		break;
	case 1:
		err = ds2438_patch(txn, 1, 5, bytes, sizeof(bytes));
		break;
	default:
		return txn->mem[2] & DS2438_IAD
		               ? ds2438_configure(txn, DS2438_IAD, DS2438_IAD, NULL)
		               : 0;
	}
	txn->mem[4] += err == 0;
	return err < 0 ? err : TXN_MORE;
}

static int read_page(struct txn *txn)
{
	txn->len = 8;
	return ds2438_read(txn, (unsigned)txn->element, txn->data);
}

static int put_page(struct txn *txn)
{
	return ds2438_patch(txn, (unsigned)txn->element, (unsigned)txn->at, txn->data,
	                    (unsigned)txn->len);
}

/* clang-format off */
#define MEASURED(text, kind, what)                                                        \
	{.name = (text), .type = (kind), .life = LIFE_VOLATILE, .access = ACCESS_READ,      \
	 .arg = (what), .read = read_measured}
#define FLAG(text, bit)                                                                   \
	{.name = (text), .type = PROPERTY_YESNO, .life = LIFE_STABLE, .access = ACCESS_BOTH, \
	 .arg = (bit), .read = read_flag, .write = write_flag}
#define TIME(text, kind, life_, page, at)                                                 \
	{.name = (text), .type = (kind), .life = (life_), .access = ACCESS_BOTH,            \
	 .arg = (page) * 8 + (at), .read = read_time, .write = write_time}

static const struct property properties[] = {
	DS2438_SENSORS,
	FLAG("CA", DS2438_CA),
	FLAG("EE", DS2438_EE),
	FLAG("IAD", DS2438_IAD),
	MEASURED("VAD", PROPERTY_FLOAT, DS2438_VAD),
	MEASURED("VDD", PROPERTY_FLOAT, DS2438_VDD),
	TIME("date", PROPERTY_DATE, LIFE_VOLATILE, 1, 0),
	PROPERTY_DIR("disconnect"),
	TIME("disconnect/date", PROPERTY_DATE, LIFE_VOLATILE, 2, 0),
	TIME("disconnect/udate", PROPERTY_UNSIGNED, LIFE_VOLATILE, 2, 0),
	PROPERTY_DIR("endcharge"),
	TIME("endcharge/date", PROPERTY_DATE, LIFE_VOLATILE, 2, 4),
	TIME("endcharge/udate", PROPERTY_UNSIGNED, LIFE_VOLATILE, 2, 4),
	{.name = "latesttemp", .type = PROPERTY_TEMPERATURE, .life = LIFE_VOLATILE,
	 .access = ACCESS_READ, .read = read_latest},
	{.name = "offset", .type = PROPERTY_UNSIGNED, .life = LIFE_STABLE, .access = ACCESS_BOTH,
	 .negative = true, .read = read_offset, .write = write_offset},
	PROPERTY_DIR("pages"),
	{.name = "pages/page", .type = PROPERTY_BINARY, .life = LIFE_STABLE, .access = ACCESS_BOTH,
	 .array = {8, INDEX_NUMBERS, false}, .size = 8, .read = read_page, .write = put_page},
	MEASURED("temperature", PROPERTY_TEMPERATURE, DS2438_TEMPERATURE),
	TIME("udate", PROPERTY_UNSIGNED, LIFE_SECOND, 1, 0),
	MEASURED("vis", PROPERTY_FLOAT, DS2438_VIS),
};
/* clang-format on */

const struct family family_26 = {.code = 0x26, .type = "DS2438", PROPERTIES(properties)};
