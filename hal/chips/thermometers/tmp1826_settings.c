/* SPDX-License-Identifier: MIT */
/*
 * TMP1826 and TMP1827 (data sheets SBOSA45, SBOSA15): limits and offset, and the alerts. The facts
 * are those of the maker's pages of the data sheets; the time of a copy (tPROG 21 ms at most) is
 * that which a published driver cites.
 *
 * Write Scratchpad-1 (4Eh) takes all nine settings, which the chip answers with their CRC8, and
 * uses at once. Copy Scratchpad-1 (48h) keeps them over a loss of power. Nothing shows that it did:
 * there is no command that reads what is kept.
 */
#include <errno.h>
#include <string.h>

#include "hal/chips/thermometers/tmp1826_settings.h"
#include "hal/wire/crc.h"

#define WRITE_SCRATCHPAD_1 0x4e
#define COPY_SCRATCHPAD_1 0x48
#define PROGRAM_NS (25 * TXN_MS)

#define SETTINGS 9
#define FIRST_HALF 3 /* settings that stand ahead of the scratchpad's first CRC8 */

static const char base[] = "settings"; /* for txn_keep() */

/* All settings, in the order in which they are written. */
static void settings_of_pad(const uint8_t pad[TMP1826_PAD], uint8_t settings[SETTINGS])
{
	memcpy(settings, pad + TMP1826_SETTINGS, FIRST_HALF);
	memcpy(settings + FIRST_HALF, pad + TMP1826_LOW, SETTINGS - FIRST_HALF);
}

static int in_range(double raw, int16_t *out)
{
	if (!(raw > -32768.5 && raw < 32767.5))
		return -EINVAL;
	*out = (int16_t)(raw < 0 ? raw - 0.5 : raw + 0.5);
	return 0;
}

/* What the settings are to be; of a write that failed before, from those before it. */
static int wanted_settings(struct txn *txn, const uint8_t have[SETTINGS], uint8_t want[SETTINGS])
{
	unsigned at = FIRST_HALF + (unsigned)txn->property->arg - TMP1826_LOW;
	int16_t raw = 0;

	memcpy(want, have, SETTINGS);
	if (!txn->restarted)
		txn_base(txn, base, want, SETTINGS);
	int err = in_range(txn->number[0] * (want[0] & TMP1826_PRECISE ? 128 : 16), &raw);
	want[at] = (uint8_t)raw;
	want[at + 1] = (uint8_t)((uint16_t)raw >> 8);
	return err;
}

struct visit {
	uint8_t want[SETTINGS];
};

static int write_settings(struct txn *txn, const uint8_t settings[SETTINGS])
{
	uint8_t command[1 + SETTINGS] = {WRITE_SCRATCHPAD_1}, crc;

	memcpy(command + 1, settings, SETTINGS);
	tmp1826_of(txn)->kept = false;
	txn_void(txn);
	int err = txn_ask(txn, command, sizeof(command), &crc, 1);
	return err ? err : txn_checked(txn, crc == onewire_crc8(settings, SETTINGS));
}

int tmp1826_read_limit(struct txn *txn)
{
	uint8_t pad[TMP1826_PAD];
	int err = tmp1826_read_pad(txn, pad);

	if (!err)
		txn->number[0] = tmp1826_celsius(pad, (unsigned)txn->property->arg);
	return err;
}

enum { LOOK, VERIFY, CHECK };

int tmp1826_write_limit(struct txn *txn)
{
	static const uint8_t copy = COPY_SCRATCHPAD_1;
	struct visit *visit = txn_own(txn, struct visit);
	uint8_t pad[TMP1826_PAD], have[SETTINGS];
	int err = tmp1826_read_pad(txn, pad);

	if (err)
		return err;
	settings_of_pad(pad, have);
	if (txn->phase == LOOK) {
		err = wanted_settings(txn, have, visit->want);
		if (err)
			return err;
		bool equal = memcmp(have, visit->want, SETTINGS) == 0;
		if (equal && tmp1826_of(txn)->kept)
			return 0;
		txn->phase = VERIFY;
		if (equal)
			return TXN_MORE;
		txn_keep(txn, base, have, SETTINGS);
		err = write_settings(txn, visit->want);
		return err ? err : TXN_MORE;
	}
	/* A chip whose settings are locked takes none. */
	if (memcmp(have, visit->want, SETTINGS) != 0)
		return -EIO;
	if (txn->phase == VERIFY) {
		txn_changed(txn);
		txn->phase = CHECK;
		return txn_command_strong(txn, &copy, 1, PROGRAM_NS);
	}
	tmp1826_of(txn)->kept = true;
	return 0;
}

/* Alerts are of a conversion: one is made, so that they are not older than the request. */
int tmp1826_read_alert(struct txn *txn)
{
	int err = tmp1826_read_temperature(txn);

	if (!err)
		txn->number[0] = (tmp1826_of(txn)->alerts & txn->property->arg) != 0;
	return err;
}

/* A chip whose next conversion is beyond its limit says so again. */
int tmp1826_write_alert(struct txn *txn)
{
	uint8_t pad[TMP1826_PAD];
	int err;

	if (txn->number[0] != 0)
		return -EOPNOTSUPP;
	err = tmp1826_read_pad(txn, pad);
	if (!err)
		tmp1826_of(txn)->alerts &= (uint8_t)~txn->property->arg;
	return err;
}
