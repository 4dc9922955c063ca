/* SPDX-License-Identifier: MIT */
/*
 * TMP1826 and TMP1827 (data sheets SBOSA45, SBOSA15), and what tells them from a DS2438 (19-5099).
 *
 * Both have Read Scratchpad (BEh), and nothing else that is a reading in both data sheets. Behind
 * it a DS2438 takes the number of a page, and sends 8 bytes and their CRC8. A TMP1826 sends at
 * once: 8 bytes, their CRC8, 8 bytes, their CRC8. The slots of the page's number are read slots to
 * it, so behind them 17 of its 18 bytes come. So the number of page 0 and 17 bytes are harmless to
 * both, and the checksums stand in different places. A look that is disturbed proves nothing: the
 * chip is known when LOOKS in a row say the same.
 *
 * The drivers of the kernel (driver_ops.has) give pages without a checksum. A TMP1826 has the
 * same bytes for each page's number, and a DS2438 has not.
 */
#include <errno.h>
#include <string.h>

#include "hal/chips/thermometers/tmp1826.h"
#include "hal/owfs/path.h"

#define READ_SCRATCHPAD 0xbe
#define CONVERT 0x44

#define LOOKS 3
#define LOOKS_MOST 5
#define FIRST 9  /* bytes of a page with its CRC8 */
#define BYTES 17 /* behind the page's number */

#define PAD TMP1826_PAD
enum { STATUS = TMP1826_STATUS, RESERVED_3, CONFIG_1 = TMP1826_SETTINGS };
enum { RESERVED_7 = 7, RESERVED_15 = 15, RESERVED_16 };
enum { DATA_VALID = 0x08, FED_BY_BUS = 0x04, ALERT_SHIFT = 6 }; /* of the status */
enum { AVERAGES = 0x08 };                                       /* of CONFIG_1 */
/* What it measures; an offset or noise makes others. */
#define LOWEST (-55)
#define HIGHEST 150
#define END_STOP (2047 / 16.0) /* what 12 bits hold at the most: it may be hotter */

#define CONVERT_NS (8 * TXN_MS)  /* tDELAY and the longest tACT: 6.5 ms */
#define AVERAGE_NS (55 * TXN_MS) /* eight of them */

struct look {
	uint8_t bytes[BYTES];
	uint8_t verdict, same, all;
	bool chip; /* the bytes of an earlier look were a TMP1826's, with these: */
	uint8_t lost, status;
};
_Static_assert(sizeof(struct look) <= TXN_OWN, "no room for the look");

static bool all_are(const uint8_t *bytes, unsigned n, uint8_t byte)
{
	while (n && bytes[n - 1] == byte)
		n--;
	return n == 0;
}

/* Of bytes that begin with a TMP1826's second one: do its reserved ones stand in their places? */
static bool is_reserved(const uint8_t *in)
{
	return in[RESERVED_3 - 1] == 0xff && in[RESERVED_7 - 1] == 0xff;
}

/*
 * in: what came behind the page's number. 0: nothing is sure. The first byte of a TMP1826 is lost;
 * where it was 0, and the low byte of the lower limit is 0, the others have a right checksum in
 * the place of a DS2438's: so that alone proves no DS2438. Behind its page that has only ones.
 */
static unsigned verdict_of(const uint8_t in[BYTES])
{
	bool blank = all_are(in + FIRST, BYTES - FIRST, 0xff);
	bool second = rom_crc8(in + FIRST - 1, BYTES - FIRST + 1) == 0 && !blank;

	if (second && is_reserved(in) && in[RESERVED_15 - 1] == 0xff && in[RESERVED_16 - 1] == 0xff)
		return IS_TMP1826;
	if (rom_crc8(in, FIRST) || all_are(in, BYTES, 0))
		return 0;
	return blank || (!second && !is_reserved(in)) ? IS_DS2438 : 0;
}

/*
 * Of a TMP1826 both pages are the same settings between reserved bytes. Old kernels have no page 1.
 */
static int identify_driven(struct txn *txn)
{
	uint8_t page[8], other[8];
	int err = txn_driver_read(txn, &ds2438_pages, 0, page, 8);

	if (err)
		return err;
	err = txn_driver_read(txn, &ds2438_pages, 8, other, 8);
	if (err && err != -ENOENT)
		return err;
	if (is_reserved(page) && (err || memcmp(page + 2, other + 2, 5) == 0))
		return -EIO;
	txn->device->kind = IS_DS2438;
	return 0;
}

/* The byte ahead of a TMP1826's, which went with the page's number: the CRC8 says which it was. */
static uint8_t lost_byte(const uint8_t in[BYTES])
{
	uint8_t first[FIRST] = {0};

	memcpy(first + 1, in, FIRST - 1);
	for (unsigned byte = 0; byte < 0xff && rom_crc8(first, FIRST); byte++)
		first[0] = (uint8_t)(byte + 1);
	return first[0];
}

/*
 * A look clears the alerts in the chip, so they are kept. As the CRC8 is spent on the lost byte,
 * they count when another look says the same byte: a status that was disturbed makes it another.
 */
static void keep_alerts(struct txn *txn, struct look *look, const uint8_t in[BYTES])
{
	uint8_t lost = lost_byte(in), status = in[STATUS - 1];

	if (look->chip && look->lost == lost)
		tmp1826_of(txn)->alerts |= (look->status | status) >> ALERT_SHIFT;
	look->chip = true;
	look->lost = lost;
	look->status = status;
}

/* One look more; TXN_MORE until it is known. A chip that always says the same is IS_NEITHER. */
static int look_again(struct txn *txn, const uint8_t in[BYTES])
{
	struct look *look = txn_own(txn, struct look);
	unsigned verdict = verdict_of(in);
	bool blank = txn->silent || all_are(in, BYTES, 0);
	bool same = verdict == look->verdict &&
	            (verdict || (!blank && memcmp(in, look->bytes, BYTES) == 0));

	txn->misread |= !verdict;
	look->same = look->all && same ? look->same + 1 : !blank;
	look->verdict = (uint8_t)verdict;
	memcpy(look->bytes, in, BYTES);
	if (verdict == IS_TMP1826)
		keep_alerts(txn, look, in);
	if (look->same < LOOKS)
		return ++look->all < LOOKS_MOST ? TXN_MORE : -EBADMSG;
	txn->device->kind = verdict ? (uint8_t)verdict : IS_NEITHER;
	return 0;
}

int tmp1826_identify(struct txn *txn)
{
	static const uint8_t command[] = {READ_SCRATCHPAD, 0};
	uint8_t in[BYTES];
	int err;

	if (txn_driven(txn))
		return identify_driven(txn);
	err = txn_ask(txn, command, sizeof(command), in, BYTES);
	return err ? err : look_again(txn, in);
}

/* --- A TMP1826 --- */

struct measurement {
	uint8_t config, looks;
};

int tmp1826_read_pad(struct txn *txn, uint8_t pad[PAD])
{
	static const uint8_t command = READ_SCRATCHPAD;
	int err = txn_ask(txn, &command, 1, pad, PAD);

	if (err)
		return err;
	err = txn_checked(txn, !rom_crc8(pad, FIRST) && !rom_crc8(pad + FIRST, PAD - FIRST));
	/* The checksum of zeros is zero: so reads a wire that became short in between. */
	txn->blank |= all_are(pad, FIRST, 0) || all_are(pad + FIRST, PAD - FIRST, 0);
	if (err || all_are(pad, PAD, 0))
		return -EBADMSG;
	tmp1826_of(txn)->alerts |= pad[STATUS] >> ALERT_SHIFT;
	txn->device->power = pad[STATUS] & FED_BY_BUS ? POWER_PARASITE : POWER_EXTERNAL;
	return 0;
}

double tmp1826_celsius(const uint8_t pad[PAD], unsigned at)
{
	int raw = (int16_t)(pad[at] | pad[at + 1] << 8);

	return pad[CONFIG_1] & TMP1826_PRECISE ? raw / 128.0 : raw / 16.0;
}

/*
 * Nothing shows that the chip converts, and an old result stays, so the flag of a new one has to be
 * seen: it is cleared first.
 */
int tmp1826_read_temperature(struct txn *txn)
{
	static const uint8_t command = CONVERT;
	struct measurement *visit = txn_own(txn, struct measurement);
	uint8_t pad[PAD];
	int err;

	if (txn->phase == 1) {
		int64_t ns = visit->config & AVERAGES ? AVERAGE_NS : CONVERT_NS;

		txn->phase = 2;
		if (txn->device->power == POWER_PARASITE)
			return txn_command_strong(txn, &command, 1, ns);
		err = txn_command(txn, &command, 1);
		return err ? err : txn_wait(txn, ns);
	}
	err = tmp1826_read_pad(txn, pad);
	if (err)
		return err;
	bool fresh = pad[STATUS] & DATA_VALID;
	if (txn->phase == 2) {
		txn->number[0] = tmp1826_celsius(pad, 0);
		if (!fresh)
			return -EBADMSG;
		if (txn->number[0] < LOWEST || txn->number[0] > HIGHEST)
			return -EDOM;
		bool most = !(visit->config & TMP1826_PRECISE) && txn->number[0] >= END_STOP;
		return most ? -ERANGE : 0;
	}
	visit->config = pad[CONFIG_1];
	txn->phase = !fresh;
	return !fresh || ++visit->looks < LOOKS ? TXN_MORE : -EBADMSG;
}

int tmp1826_read_power(struct txn *txn)
{
	uint8_t pad[PAD];
	int err = tmp1826_read_pad(txn, pad);

	if (!err)
		txn->number[0] = (pad[STATUS] & FED_BY_BUS) == 0;
	return err;
}

int tmp1826_read_format(struct txn *txn)
{
	uint8_t pad[PAD];
	int err = tmp1826_read_pad(txn, pad);

	if (!err)
		txn->number[0] = pad[CONFIG_1] & TMP1826_PRECISE ? 16 : 12;
	return err;
}
