/* SPDX-License-Identifier: MIT */
/*
 * DS2405 (data sheet 19-5140): each Match ROM turns its switch over, so it is never matched to be
 * read: the conditional search finds it while it conducts, and after a search that ended at it the
 * next slots give its pin.
 *
 * A conditional search that is lost says "does not conduct": so there are three looks, and then a
 * search for the chip. The looks show a Match ROM that was lost, too.
 */
#include <errno.h>

#include "hal/chips/family.h"
#include "hal/chips/field.h"

#define LOOKS 3

/*
 * Not conducting, not there and not heard look the same: LOOKS that do not find it say that it does
 * not conduct, and then it is looked for among all.
 */
static int is_there(struct txn *txn)
{
	int there = txn_verify(txn, false);

	txn->silent = !there;
	return there < 0 ? there : there ? 0 : -ENODEV;
}

static int read_pio(struct txn *txn)
{
	int there;

	if (txn_driven(txn))
		return field_read(txn);
	if (txn->phase >= LOOKS)
		return is_there(txn);
	there = txn_verify(txn, true);
	txn->number[0] = there > 0;
	txn->phase++;
	return there < 0 ? there : there ? 0 : TXN_MORE;
}

/* A chip that the last slot of the search did not select leaves a one, too. */
static int read_pin(struct txn *txn)
{
	if (txn_driven(txn))
		return field_read(txn);
	int err = is_there(txn), level = err ? err : txn_bit(txn);

	if (level < 0)
		return level;
	if (txn->phase && level != (int)txn->number[0])
		return -EBADMSG;
	txn->number[0] = level;
	return ++txn->phase < LOOKS ? TXN_MORE : 0;
}

/* Looks, turned over if it is not as wanted, looks again; and is it there, if it is found off. */
static int write_pio(struct txn *txn)
{
	enum { TURN = LOOKS, AFTER, THERE = AFTER + LOOKS };
	bool want = txn->number[0] != 0, after = txn->phase >= AFTER;
	int there;

	if (txn_driven(txn))
		return field_write(txn);
	if (txn->phase == THERE)
		return is_there(txn);
	if (txn->phase == TURN) {
		there = txn_command(txn, NULL, 0);
		txn->phase = AFTER;
		return there ? there : TXN_MORE;
	}
	there = txn_verify(txn, true);
	if (there < 0)
		return there;
	if (!there && ++txn->phase != TURN && txn->phase != THERE)
		return TXN_MORE;
	if (there == want) {
		txn->phase = THERE;
		return want ? 0 : TXN_MORE;
	}
	txn->phase = TURN;
	return after ? -EIO : TXN_MORE;
}

/* As a driver gives them. 1: does not conduct. */
enum { OUTPUT = 1, PIN };
static const struct area *const areas[] = {
	[OUTPUT] = AREA(.name = "output", .size = 1, .row = 1, .hidden = true),
	[PIN] = AREA(.name = "pin", .size = 1),
};

enum { WAY_PIO = 1, WAY_PIN };
static const struct property_how how[] = {
	[WAY_PIO] = {.read = read_pio, .write = write_pio},
	[WAY_PIN] = {.read = read_pin},
};

static const struct property properties[] = {
	PROPERTY("PIO", YESNO, STABLE, BOTH, FIELD(OUTPUT, .bits = 1, .inverted = true),
                 .holds = true, .how = WAY_PIO),
	PROPERTY("sensed", YESNO, VOLATILE, READ, FIELD(PIN), .how = WAY_PIN),
};

CHIP_FAMILY(05, "DS2405", PRESENCE, .alarms = true, .flags = FLAG_ALARM,
            SCAN({"sensed", "contact"}, {"PIO", "switch"}), AREAS(areas), HOW(how),
            PROPERTIES(properties));
