/* SPDX-License-Identifier: MIT */
/*
 * What a DS2438 measures (data sheet 19-5099), and the proof that a zero is one.
 *
 * Convert T and Convert V are proved by the busy slots. A VDD of 0 fails, because the chip runs on
 * it. Any other 0 may be what a restart left: it is measured again between a mark in the scratchpad
 * of page 3, which a restart destroys, and a look at the mark.
 */
#include <errno.h>

#include "hal/chips/batteries/ds2438_measure.h"

#define CURRENT_NS (28 * TXN_MS) /* 36.41 measurements a second */

/* It measures from -55 to 125 degrees, and may be wrong by 3 there. */
#define LOWEST (-58)
#define HIGHEST 128

/* A copy does not show that it heard a command to convert: it gets so many. */
#define COPY_CONVERTS 3

#define CONVERSION(what, code) \
	{ \
		.name = (what), .command = {code}, .n = 1, .ns = 10 * TXN_MS \
	}
static const struct conversion convert_t = CONVERSION("temperature", 0x44);
static const struct conversion convert_vad = CONVERSION("VAD", 0xb4);
static const struct conversion convert_vdd = CONVERSION("VDD", 0xb4);

/*
 * TXN_MORE: it converts, and phase is the next one; or that is not known yet. What shows no
 * conversion may be a copy: its page 0 tells. To a copy the command goes several times, and the
 * longest time is waited for.
 */
static int convert(struct txn *txn, const struct conversion *conversion)
{
	bool *probing = &ds2438_visit(txn)->probing;
	uint8_t bytes[8];
	int err;

	if (*probing) {
		err = ds2438_read(txn, 0, bytes);
		if (err)
			return err;
		*probing = false;
		if (!ds2438_is_copy(txn))
			return -EBADMSG;
	}
	err = conversion_start(txn, conversion, false);
	txn->phase++;
	if (err == TXN_MORE && !txn_driven(txn))
		ds2438_is_genuine(txn);
	if (err != -EBADMSG || txn->link_error || ds2438_of(txn)->genuine)
		return err;
	if (ds2438_is_copy(txn) && ++ds2438_visit(txn)->converts == COPY_CONVERTS) {
		ds2438_visit(txn)->converts = 0;
		return txn_wait(txn, conversion->ns);
	}
	txn->phase--;
	*probing = !ds2438_is_copy(txn);
	return TXN_MORE;
}

static int measure_temperature(struct txn *txn, double *value)
{
	uint8_t bytes[8];

	if (txn->phase == 0)
		return convert(txn, &convert_t);
	int err = ds2438_read(txn, 0, bytes);
	if (err)
		return err;
	*value = (ds2438_word(bytes + 1) >> 3) / 32.0;
	txn->number[0] = *value; /* of -EDOM, also of what would be computed from it */
	return *value < LOWEST || *value > HIGHEST ? -EDOM : 0;
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
		return convert(txn, select ? &convert_vdd : &convert_vad);
	default:
		err = ds2438_read_selected(txn, select, bytes);
		if (err)
			return err;
		*value = (ds2438_word(bytes + 3) & 0x3ff) / 100.0;
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
		*value = ds2438_word(bytes + 5) * 0.0002441;
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
 * It is measured again, of the supply once: two zeros say that there is none. One of another
 * quantity is measured between a mark that a restart destroys and a look at the mark. proof: as far
 * as that is.
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
	if (what == DS2438_VDD && *proof == AGAIN)
		return -ENODATA;
	/* The mark would stay in a copy; its zero is as good as its other values. */
	if (what != DS2438_VDD && ds2438_is_copy(txn))
		return 0;
	*proof = what == DS2438_VDD ? AGAIN : *proof == FIRST ? MARK : LOOK;
	txn->phase = 0;
	return TXN_MORE;
}

/*
 * One that was measured for another request, as far as this one allows it, is not measured again.
 */
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

int ds2438_read_measured(struct txn *txn)
{
	int err = ds2438_measure(txn, 1u << txn->property->arg);

	txn->number[0] = ds2438_visit(txn)->value[txn->property->arg];
	return err;
}
