/* SPDX-License-Identifier: MIT */
/*
 * `errata`: the die of a DS18B20, and the two bytes of the factory's trim as OWFS knows them. A
 * property function does one transaction; the bytes come twice.
 */
#include <errno.h>
#include <string.h>

#include "hal/chips/property.h"
#include "hal/chips/thermometers/thermometer.h"

#define READ_TRIM_1 0x93
#define READ_TRIM_2 0x68
#define TRIM_BLANKET 0x9d
#define TRIM_SECOND 0xbb

/* What a visit keeps from call to call. */
struct visit {
	uint8_t trim[4];
};
static uint8_t *trim_of(struct txn *txn)
{
	return txn_own(txn, struct visit)->trim;
}

/*
 * Of the dies that OWFS tells apart only the last is still around: B6 and B7 left the market before
 * 2001.
 */
int thermometer_read_die(struct txn *txn)
{
	return property_text(txn, "C2");
}

/*
 * The two bytes of the factory's trim; a chip that does not know the commands leaves ones. Without
 * a checksum both are read twice.
 */
static int read_trim(struct txn *txn)
{
	static const uint8_t commands[] = {READ_TRIM_1, READ_TRIM_2};
	int err = txn_ask(txn, &commands[txn->phase % 2], 1, &trim_of(txn)[txn->phase], 1);

	txn->silent = false;
	if (err || ++txn->phase < 4)
		return err ? err : TXN_MORE;
	return memcmp(trim_of(txn), trim_of(txn) + 2, 2) == 0 ? 0 : -EBADMSG;
}

int thermometer_read_trim(struct txn *txn)
{
	int err = read_trim(txn);

	txn->number[0] = trim_of(txn)[0] | trim_of(txn)[1] << 8;
	return err;
}

/* Only the B7 die has a trim value to repair. */
int thermometer_refuse_trim(struct txn *txn)
{
	(void)txn;
	return -EINVAL;
}

int thermometer_read_trim_valid(struct txn *txn)
{
	int err = read_trim(txn), low = trim_of(txn)[0] & 7;

	txn->number[0] = (low == 3 || low == 5) && trim_of(txn)[1] == TRIM_SECOND;
	return err;
}

int thermometer_read_trim_blanket(struct txn *txn)
{
	int err = read_trim(txn);

	txn->number[0] = trim_of(txn)[0] == TRIM_BLANKET && trim_of(txn)[1] == TRIM_SECOND;
	return err;
}
