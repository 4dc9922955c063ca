/* SPDX-License-Identifier: MIT */
/*
 * WS603: a weather station. The host leaves a command in the memory of its DS2760, and the station
 * its answer behind it. There is no data sheet: commands and scales are those of OWFS. Both stay
 * until the next ones, so they are cleared before a command is given. Nothing shows whether the
 * station took a setting: none is written.
 *
 * An answer has a sum.
 */
#include <errno.h>
#include <string.h>

#include "hal/chips/area.h"
#include "hal/chips/batteries/ws603.h"

#define COMMAND 0x80
#define ANSWER 0x88
#define ANSWER_BYTES 7 /* what it answers, five bytes, their sum */
#define TRIES 20
#define WAIT_NS (20 * TXN_MS)

static AREA_NAMED(memory, "station", .size = 256, .address_bytes = 1, .read = 0x69, .row = 1,
                  .write = 0x6c);

enum step { CLEAR, ASK, TAKE };

struct visit {
	uint8_t step, tries;
	bool calibrated;     /* the calibration is known */
	uint8_t calibration; /* of the wind, in percent */
};

static uint8_t sum_of(const uint8_t *bytes, unsigned n)
{
	uint8_t total = 0;

	for (unsigned i = 0; i < n; i++)
		total = (uint8_t)(total + bytes[i]);
	return total;
}

/* And read back. */
static int ws603_put(struct txn *txn, uint8_t at, const uint8_t *bytes, unsigned n)
{
	uint8_t command[2 + 16] = {memory.write, at}, in[16];
	int err;

	memcpy(command + 2, bytes, n);
	txn_void(txn);
	err = txn_command(txn, command, 2 + n);
	if (!err)
		err = area_fetch(txn, &memory, at, in, n);
	if (err)
		return err;
	return memcmp(in, bytes, n) == 0 ? 0 : -EBADMSG;
}

/* The five bytes that the station answers; several calls. */
static int ws603_ask(struct txn *txn, uint8_t what, uint8_t bytes[5])
{
	static const uint8_t nothing[ANSWER - COMMAND + ANSWER_BYTES] = {0};
	struct visit *visit = txn_own(txn, struct visit);
	/* the command, its sum, an end that follows from it */
	const uint8_t command[] = {what, what, (uint8_t)(what << 4 | 0x0e)};
	uint8_t in[ANSWER_BYTES];
	int err;

	switch ((enum step)visit->step) {
	case CLEAR:
		err = ws603_put(txn, COMMAND, nothing, sizeof(nothing));
		visit->step = ASK;
		return err ? err : TXN_MORE;
	case ASK:
		err = ws603_put(txn, COMMAND, command, sizeof(command));
		visit->step = TAKE;
		visit->tries = 0;
		return err ? err : txn_wait(txn, WAIT_NS);
	case TAKE:
		break;
	}
	err = area_fetch(txn, &memory, ANSWER, in, ANSWER_BYTES);
	if (err)
		return err;
	if (in[0] != what || in[ANSWER_BYTES - 1] != sum_of(in, ANSWER_BYTES - 1))
		return ++visit->tries < TRIES ? txn_wait(txn, WAIT_NS) : -EIO;
	visit->step = CLEAR;
	memcpy(bytes, in + 1, 5);
	return 0;
}

int ws603_read_byte(struct txn *txn)
{
	uint8_t bytes[5] = {0};
	int err = ws603_ask(txn, txn->property->arg & 0xff, bytes);

	if (!err)
		txn->number[0] = bytes[txn->property->arg >> 8 & 0xff];
	return err;
}

int ws603_read_bytes(struct txn *txn)
{
	uint8_t bytes[5] = {0};
	int err = ws603_ask(txn, txn->property->arg & 0xff, bytes);

	if (err)
		return err;
	txn->len = sizeof(bytes);
	memcpy(txn->data, bytes, sizeof(bytes));
	return 0;
}

/* Rotations times what one means in km/h, in m/s. */
int ws603_read_wind(struct txn *txn)
{
	struct visit *visit = txn_own(txn, struct visit);
	uint8_t bytes[5] = {0};
	int err = ws603_ask(txn, visit->calibrated ? WS603_DATA : WS603_PARAMETERS, bytes);

	if (err)
		return err;
	if (!visit->calibrated) {
		bool usual = bytes[1] == 0 || bytes[1] > 199;

		visit->calibration = usual ? 100 : bytes[1];
		visit->calibrated = true;
		return TXN_MORE;
	}
	txn->number[0] = bytes[0] * 2.453 * 1.069 * 1000 * visit->calibration / (3600 * 100.);
	return 0;
}
