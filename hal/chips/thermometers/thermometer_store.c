/* SPDX-License-Identifier: MIT */
/*
 * The user's settings of a thermometer go to its EEPROM, so that they outlive its power. Copy
 * Scratchpad (48h) takes all of them along, and in the scratchpad may be others than in the EEPROM:
 * the resolution of a conversion, limits that a program which was killed has left. So what is
 * copied is what the EEPROM has, but for the setting that is written:
 *
 *   LOOK      what is in the scratchpad?
 *   RECALL    recall it from the EEPROM (B8h). A recall says nothing, and may be lost: only what
 *             it changes proves it.
 *   WRITE     the setting to the scratchpad, and read it back
 *   PROBE     nothing is proven yet: then a recall takes the setting away again. A chip that keeps
 *             it may not know the command. It gets back what it had: -EIO.
 *   COPY      and then recall it three times: if the copy was lost, what was before comes back.
 *
 * What the EEPROM has already is not written again, as it wears out. What is in force is what stood
 * there or what is wanted, at each moment. A driver knows no recall: there it is as it says.
 *
 * Both are called until they return something else than TXN_MORE. 0; -EINVAL: the chip does not
 * take it; -EIO: it was not kept, or nothing shows what the EEPROM has. Commands: data sheets
 * 19-7487 and 19-5474.
 *
 * Two wrong bits make Copy Scratchpad (48h) of Convert T (44h), which begins alike: nothing shows
 * that.
 */
#include <errno.h>
#include <string.h>

#include "hal/chips/thermometers/state.h"
#include "hal/chips/thermometers/thermometer.h"
#include "hal/chips/thermometers/thermometer_proof.h"
#include "hal/wire/unfinished.h"

#define COPY_SCRATCHPAD 0x48
#define RECALL 0xb8
#define COPY_NS (10 * TXN_MS)
#define RECALLS_FIRST 2 /* that change nothing, before it is taken for the EEPROM's */
#define PROBES 3

/* What a visit keeps from call to call. */
struct visit {
	uint8_t scratchpad[9]; /* as it is to be */
	uint8_t was[3];        /* limits and configuration as they stood there at first */
	uint8_t kept[3];       /* ... and as the EEPROM has them */
	uint8_t at, value;     /* which byte is changed, and to what */
	uint8_t looks;         /* recalls in a row that changed nothing */
	bool proven;           /* `kept` is the EEPROM's */
};
static struct visit *visit_of(struct txn *txn)
{
	return txn_own(txn, struct visit);
}

enum {
	LOOK,
	RECALL_FIRST,
	WRITE,
	VERIFY,
	PROBE,
	COPY,
	RESTORE,
	RESTORED,
	RECALLS,
	CHECK = RECALLS + 3
};

/* While the chip recalls its slots are zeros, as the data sheet says; it takes microseconds. */
#define RECALL_BYTES 4

static unsigned count_settings(const struct txn *txn)
{
	return txn->device->family->fixed ? 2 : 3;
}

static bool has_settings(struct txn *txn, const uint8_t scratchpad[9])
{
	return memcmp(scratchpad + SP_HIGH, visit_of(txn)->scratchpad + SP_HIGH,
	              count_settings(txn)) == 0;
}

/* Recall E2, its end, and what is there then. */
static int recall_settings(struct txn *txn, uint8_t scratchpad[9])
{
	uint8_t slots = 0;
	int err = txn_command(txn, TXN_BYTES(RECALL));

	thermometer_of(txn->device)->resolution = 0;
	for (unsigned i = 0; !err && slots != 0xff && i < RECALL_BYTES; i++)
		err = txn_read_slots(txn, &slots, 1);
	if (!err && slots != 0xff)
		err = -EBADMSG;
	/* Ones are also what a chip gives that did not hear it. */
	txn->silent = false;
	return err ? err : thermometer_settings(txn, scratchpad);
}

static int copy_settings(struct txn *txn)
{
	static AREA_NAMED(eeprom, "eeprom", .size = 3);
	static const uint8_t copy = COPY_SCRATCHPAD;

	/* A driver's word for it is all there is. */
	if (txn_driven(txn)) {
		txn->phase = CHECK;
		int err = txn_driver_write(txn, &eeprom, 0, visit_of(txn)->scratchpad + SP_HIGH, 3);

		return err ? err : TXN_MORE;
	}
	/* Without a strong pull-up a chip that the wire feeds cannot copy. */
	if (!txn->link->facts->strong && !device_power_known(txn->device->power)) {
		int err = thermometer_ask_power(txn);

		return err < 0 ? err : TXN_MORE;
	}
	txn->phase = RECALLS;
	return txn_command_strong(txn, &copy, 1, COPY_NS);
}

/* The EEPROM has what is wanted. */
static int stored(struct txn *txn)
{
	struct thermometer *chip = thermometer_of(txn->device);

	unfinished_end(txn->device, &thermometer_area, SP_HIGH);
	chip->stored = chip->resolution;
	chip->recalled = true;
	return 0;
}

/* What the EEPROM has, but for the field; after a write that failed see unfinished_base(). */
static int want_settings(struct txn *txn, const uint8_t scratchpad[9])
{
	struct visit *visit = visit_of(txn);

	memcpy(visit->scratchpad, scratchpad, sizeof(visit->scratchpad));
	bool failed = unfinished_base(txn->device, &thermometer_area, SP_HIGH,
	                              visit->scratchpad + SP_HIGH, 3);
	memcpy(visit->kept, visit->scratchpad + SP_HIGH, 3);
	visit->proven |= failed;
	uint8_t *byte = visit->scratchpad + visit->at;
	uint8_t value = visit->at == SP_CONFIG ? thermometer_config(*byte, visit->value)
	                                       : visit->value;
	if (!failed && *byte == value)
		return visit->proven ? stored(txn) : 0;
	*byte = value;
	txn->phase = WRITE;
	return TXN_MORE;
}

static int thermometer_store_look(struct txn *txn)
{
	struct visit *visit = visit_of(txn);
	int err = thermometer_settings(txn, visit->scratchpad);

	if (err)
		return err;
	memcpy(visit->was, visit->scratchpad + SP_HIGH, 3);
	visit->looks = 0;
	visit->proven = false;
	txn->phase = RECALL_FIRST;
	if (!txn_driven(txn))
		return TXN_MORE;
	if (!txn->device->family->fixed)
		visit->scratchpad[SP_CONFIG] = thermometer_config(
			visit->scratchpad[SP_CONFIG], thermometer_of(txn->device)->stored);
	visit->proven = true;
	return want_settings(txn, visit->scratchpad);
}

static int recall_first(struct txn *txn)
{
	struct visit *visit = visit_of(txn);
	uint8_t scratchpad[9];
	int err = thermometer_rest(txn);

	if (!err)
		err = recall_settings(txn, scratchpad);
	if (err)
		return err;
	visit->proven = memcmp(visit->was, scratchpad + SP_HIGH, count_settings(txn)) != 0;
	if (!visit->proven && ++visit->looks < RECALLS_FIRST)
		return TXN_MORE;
	visit->looks = 0;
	return want_settings(txn, scratchpad);
}

static int thermometer_store_write(struct txn *txn)
{
	int err = thermometer_rest(txn);

	if (!err)
		err = thermometer_write_settings(txn, visit_of(txn)->scratchpad);
	if (err)
		return err;
	txn->phase = VERIFY;
	return TXN_MORE;
}

static int verify(struct txn *txn)
{
	struct visit *visit = visit_of(txn);
	uint8_t scratchpad[9];

	thermometer_of(txn->device)->resolution = 0;
	int err = thermometer_settings(txn, scratchpad);
	if (err)
		return err;
	if (!has_settings(txn, scratchpad))
		return scratchpad[SP_CONFIG] != visit->scratchpad[SP_CONFIG] ? -EINVAL : -EBADMSG;
	if (visit->proven)
		unfinished_begin(txn->device, &thermometer_area, SP_HIGH, visit->kept,
		                 visit->scratchpad + SP_HIGH, 3);
	txn->phase = visit->proven ? COPY : PROBE;
	return TXN_MORE;
}

static int probe(struct txn *txn)
{
	struct visit *visit = visit_of(txn);
	uint8_t scratchpad[9];
	int err = recall_settings(txn, scratchpad);

	if (err)
		return err;
	visit->proven = !has_settings(txn, scratchpad);
	if (visit->proven)
		return want_settings(txn, scratchpad);
	if (++visit->looks >= PROBES) {
		memcpy(visit->scratchpad + SP_HIGH, visit->was, 3);
		txn->phase = RESTORE;
	}
	return TXN_MORE;
}

/* What is in force again is what the chip had. */
static int restore(struct txn *txn)
{
	uint8_t scratchpad[9];
	int err;

	if (txn->phase == RESTORE) {
		err = thermometer_write_settings(txn, visit_of(txn)->scratchpad);
		txn->phase = RESTORED;
		return err ? err : TXN_MORE;
	}
	thermometer_of(txn->device)->resolution = 0;
	err = thermometer_settings(txn, scratchpad);
	if (!err)
		err = has_settings(txn, scratchpad) ? -EIO : -EBADMSG;
	return err;
}

static int thermometer_store_check(struct txn *txn)
{
	uint8_t scratchpad[9];
	int err;

	if (txn->phase < CHECK) {
		err = recall_settings(txn, scratchpad);
	} else {
		thermometer_of(txn->device)->resolution = 0;
		err = thermometer_settings(txn, scratchpad);
	}
	if (err)
		return err;
	if (!has_settings(txn, scratchpad))
		return -EIO;
	if (++txn->phase < CHECK)
		return TXN_MORE;
	return stored(txn);
}

static int store_settings(struct txn *txn)
{
	switch (txn->phase) {
	case LOOK:
		return thermometer_store_look(txn);
	case RECALL_FIRST:
		return recall_first(txn);
	case WRITE:
		return thermometer_store_write(txn);
	case VERIFY:
		return verify(txn);
	case PROBE:
		return probe(txn);
	case COPY:
		return copy_settings(txn);
	case RESTORE:
	case RESTORED:
		return restore(txn);
	default:
		return thermometer_store_check(txn);
	}
}

int thermometer_write_limit(struct txn *txn)
{
	double value = txn->number[0];

	if (txn->phase)
		return store_settings(txn);
	if (!(value > -128.5 && value < 127.5))
		return -EINVAL;
	visit_of(txn)->at = (uint8_t)txn->property->field.at;
	visit_of(txn)->value = (uint8_t)(int)(value < 0 ? value - 0.5 : value + 0.5);
	return store_settings(txn);
}

int thermometer_write_tempres(struct txn *txn)
{
	if (txn->phase)
		return store_settings(txn);
	if (!(txn->number[0] >= 9 && txn->number[0] <= 12))
		return -EINVAL;
	visit_of(txn)->at = SP_CONFIG;
	visit_of(txn)->value = (uint8_t)txn->number[0];
	return store_settings(txn);
}
