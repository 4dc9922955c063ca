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

#include "hal/chips/steady.h"
#include "hal/chips/thermometers/tmp1826.h"
#include "hal/owfs/path.h"
#include "hal/wire/unfinished.h"

#define READ_SCRATCHPAD 0xbe
#define CONVERT 0x44

#define LOOKS 3
#define LOOKS_MOST 5
#define FIRST 9  /* bytes of a page with its CRC8 */
#define BYTES 17 /* behind the page's number */

/* The scratchpad: temperature, status, 3 bytes of settings, limits and offset; 2 checksums. */
#define PAD 18
enum { STATUS = 2, RESERVED_3, CONFIG_1 };
#define PRECISE 0x80 /* of the first byte of the settings: 1/128 degrees, not 1/16 */
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
	uint8_t in[BYTES];
	int err;

	if (txn_driven(txn))
		return identify_driven(txn);
	err = txn_ask(txn, TXN_BYTES(READ_SCRATCHPAD, 0), in, BYTES);
	return err ? err : look_again(txn, in);
}

/* --- A TMP1826 --- */

struct measurement {
	uint8_t config, looks;
};

/*
 * To read the status clears its flags: that there is a new result, and the alerts, which are kept
 * in tmp1826.alerts. -EBADMSG: a checksum is wrong.
 */
static int read_pad(struct txn *txn, uint8_t pad[PAD])
{
	int err = txn_ask(txn, TXN_BYTES(READ_SCRATCHPAD), pad, PAD);

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

/* Degrees of a register. */
static double celsius_of(const uint8_t pad[PAD], unsigned at)
{
	int raw = (int16_t)(pad[at] | pad[at + 1] << 8);

	return pad[CONFIG_1] & PRECISE ? raw / 128.0 : raw / 16.0;
}

/*
 * Nothing shows that the chip converts, and an old result stays, so the flag of a new one has to be
 * seen: it is cleared first.
 */
int tmp1826_read_temperature(struct txn *txn)
{
	struct measurement *visit = txn_own(txn, struct measurement);
	uint8_t pad[PAD];
	int err;

	if (txn->phase == 1) {
		int64_t ns = visit->config & AVERAGES ? AVERAGE_NS : CONVERT_NS;

		txn->phase = 2;
		if (txn->device->power == POWER_PARASITE)
			return txn_command_strong(txn, TXN_BYTES(CONVERT), ns);
		return txn_command_wait(txn, TXN_BYTES(CONVERT), ns);
	}
	err = read_pad(txn, pad);
	if (err)
		return err;
	bool fresh = pad[STATUS] & DATA_VALID;
	if (txn->phase == 2) {
		txn->number[0] = celsius_of(pad, 0);
		if (!fresh)
			return -EBADMSG;
		if (txn->number[0] < LOWEST || txn->number[0] > HIGHEST)
			return -EDOM;
		bool most = !(visit->config & PRECISE) && txn->number[0] >= END_STOP;
		return most ? -ERANGE : 0;
	}
	visit->config = pad[CONFIG_1];
	txn->phase = !fresh;
	return !fresh || ++visit->looks < LOOKS ? TXN_MORE : -EBADMSG;
}

int tmp1826_read_power(struct txn *txn)
{
	uint8_t pad[PAD];
	int err = read_pad(txn, pad);

	if (!err)
		txn->number[0] = (pad[STATUS] & FED_BY_BUS) == 0;
	return err;
}

int tmp1826_read_format(struct txn *txn)
{
	uint8_t pad[PAD];
	int err = read_pad(txn, pad);

	if (!err)
		txn->number[0] = pad[CONFIG_1] & PRECISE ? 16 : 12;
	return err;
}

/*
 * --- Limits and offset ---
 *
 * The facts are those of the maker's pages of the data sheets; the times (tPROG 21 ms, tREADIDLE
 * 0.56 ms at most) are those that a published driver cites.
 *
 * Write Scratchpad-1 (4Eh) takes all nine settings, which the chip answers with their CRC8, and
 * uses at once. Copy Scratchpad-1 (48h) keeps them over a loss of power. Nothing shows that it did:
 * there is no command that reads what is kept.
 */
#define WRITE_SCRATCHPAD_1 0x4e
#define COPY_SCRATCHPAD_1 0x48
#define PROGRAM_NS (25 * TXN_MS)

#define SETTINGS 9
#define FIRST_HALF 3 /* settings that stand ahead of the scratchpad's first CRC8 */

static const char base[] = "settings"; /* for unfinished_begin() */

/* All settings, in the order in which they are written. */
static void settings_of_pad(const uint8_t pad[PAD], uint8_t settings[SETTINGS])
{
	memcpy(settings, pad + CONFIG_1, FIRST_HALF);
	memcpy(settings + FIRST_HALF, pad + TMP1826_LOW, SETTINGS - FIRST_HALF);
}

static int in_range(double raw, int16_t *out)
{
	if (!(raw > -32768.5 && raw < 32767.5))
		return -EINVAL;
	*out = (int16_t)(raw < 0 ? raw - 0.5 : raw + 0.5);
	return 0;
}

/* What the settings are to be, from what the write begins with. */
static int wanted_settings(struct txn *txn, const uint8_t begun[SETTINGS], uint8_t want[SETTINGS])
{
	unsigned at = FIRST_HALF + (unsigned)txn->property->arg - TMP1826_LOW;
	int16_t raw = 0;

	memcpy(want, begun, SETTINGS);
	int err = in_range(txn->number[0] * (want[0] & PRECISE ? 128 : 16), &raw);
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
	return err ? err : txn_checked(txn, crc == rom_crc8(settings, SETTINGS));
}

int tmp1826_read_limit(struct txn *txn)
{
	uint8_t pad[PAD];
	int err = read_pad(txn, pad);

	if (!err)
		txn->number[0] = celsius_of(pad, (unsigned)txn->property->arg);
	return err;
}

enum { LOOK, VERIFY, CHECK };

int tmp1826_write_limit(struct txn *txn)
{
	struct visit *visit = txn_own(txn, struct visit);
	uint8_t pad[PAD], have[SETTINGS], begun[SETTINGS];
	int err = read_pad(txn, pad);

	if (err)
		return err;
	settings_of_pad(pad, have);
	if (txn->phase == LOOK) {
		memcpy(begun, have, SETTINGS);
		if (!txn->restarted)
			unfinished_base(txn->device, base, 0, begun, SETTINGS);
		err = wanted_settings(txn, begun, visit->want);
		if (err)
			return err;
		bool equal = memcmp(have, visit->want, SETTINGS) == 0;
		if (equal && tmp1826_of(txn)->kept)
			return 0;
		txn->phase = VERIFY;
		if (equal)
			return TXN_MORE;
		unfinished_begin(txn->device, base, 0, begun, visit->want, SETTINGS);
		err = write_settings(txn, visit->want);
		return err ? err : TXN_MORE;
	}
	/* A chip whose settings are locked takes none. */
	if (memcmp(have, visit->want, SETTINGS) != 0)
		return -EIO;
	if (txn->phase == VERIFY) {
		unfinished_end(txn->device, base, 0);
		txn->phase = CHECK;
		return txn_command_strong(txn, TXN_BYTES(COPY_SCRATCHPAD_1), PROGRAM_NS);
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
	uint8_t pad[PAD];
	int err;

	if (txn->number[0] != 0)
		return -EOPNOTSUPP;
	err = read_pad(txn, pad);
	if (!err)
		tmp1826_of(txn)->alerts &= (uint8_t)~txn->property->arg;
	return err;
}

/*
 * --- EEPROM ---
 *
 * It is read by blocks of 8 bytes. The maker's pages say that a CRC8 follows each block, published
 * drivers read none. So a block is read alone, until three looks are the same, and what follows it
 * is not looked at. But it is read: a chip that has sent a block fetches the next one, and hears no
 * reset meanwhile (a report in the maker's forum).
 */
#define READ_EEPROM 0xf0
#define READ_IDLE_NS TXN_MS

#define BLOCK 8
#define BEHIND 2 /* bytes that are read after a block: longer than tREADIDLE */

static int load_memory(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                       unsigned n)
{
	const uint8_t where[] = {0, (uint8_t)at};
	uint8_t in[BLOCK + BEHIND];
	int err;

	(void)area;
	if (n != BLOCK || at % BLOCK)
		return -EINVAL;
	err = txn_command(txn, TXN_BYTES(READ_EEPROM));
	if (!err)
		err = txn_write_paused(txn, where, sizeof(where), READ_IDLE_NS);
	if (!err)
		err = txn_read(txn, in, sizeof(in));
	if (err)
		return err;
	memcpy(bytes, in, n);
	return steady(txn, in, n);
}

AREA_NAMED(tmp1826_memory, "memory", .size = 256, .address_bytes = 2, .high_first = true,
           .block = BLOCK, .row = BLOCK, .write = 0x0f, .verify = 0xaa, .copy = 0x55, .key = 0xa5,
           .strong = true, .copy_ns = PROGRAM_NS, .load = load_memory);
