/* SPDX-License-Identifier: MIT */
/*
 * DS2405 (data sheet 19-5140): each Match ROM turns its switch over, so it is never matched to be
 * read: the conditional search finds it while it conducts, and after a search that ended at it the
 * next slots give its pin.
 */
#include <errno.h>

#include "hal/native/family.h"

/* Not conducting and not there look the same: the second call makes the difference. */
static int read_pio(struct txn *txn)
{
	int there = txn_verify(txn, txn->phase == 0);

	if (there < 0)
		return there;
	if (txn->phase++ == 0) {
		txn->number[0] = there;
		return there ? 0 : TXN_MORE;
	}
	txn->silent = !there;
	return there ? 0 : -ENODEV;
}

static int read_pin(struct txn *txn)
{
	int there = txn_verify(txn, false);

	if (there <= 0) {
		txn->silent = true;
		return there < 0 ? there : -ENODEV;
	}
	int level = txn_bit(txn);
	txn->number[0] = level;
	return level < 0 ? level : 0;
}

static int write_pio(struct txn *txn)
{
	bool want = txn->number[0] != 0;
	int state;

	switch (txn->phase) {
	case 0:
	case 2:
		state = txn_verify(txn, true);
		if (state < 0)
			return state;
		if (state == want && txn->phase == 0 && !want) {
			txn->phase = 3;
			return TXN_MORE;
		}
		if (state == want)
			return 0;
		txn->phase++;
		return txn->phase == 3 ? -EIO : TXN_MORE;
	case 1:
		state = txn_command(txn, NULL, 0);
		txn->phase = 2;
		return state ? state : TXN_MORE;
	default:
		state = txn_verify(txn, false);
		txn->silent = !state;
		return state < 0 ? state : state ? 0 : -ENODEV;
	}
}

static const struct property properties[] = {
	{.name = "PIO", .type = PROPERTY_YESNO, .life = LIFE_STABLE, .access = ACCESS_BOTH,
	 .read = read_pio, .write = write_pio},
	{.name = "sensed", .type = PROPERTY_YESNO, .life = LIFE_VOLATILE, .access = ACCESS_READ,
	 .read = read_pin},
};

const struct family family_05 = {
	.code = 0x05, .alarms = true, .type = "DS2405", PROPERTIES(properties),
};
