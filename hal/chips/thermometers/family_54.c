/* SPDX-License-Identifier: MIT */
/*
 * MAX31888 and MAX30207: thermometers of 16 bits that convert in 18 ms. No whole data sheet could
 * be had: the facts are those of the maker's summary, of published drivers, and of the register map
 * of the MAX31889, which is the same chip with I2C. All that goes over the wire has a CRC16.
 *
 * A result stands in a FIFO. It is the one that was asked for if the FIFO holds one and no more:
 * what was read is no longer there, and a restart leaves none. The count stands at 07h by the map
 * of the MAX31889, at 04h by a driver that quotes the MAX31888's: there the former has the place of
 * the next result. In a FIFO that was emptied before, both are 1 after one conversion.
 *
 * Convert T is proved by the CRC16 behind the command. Where neither count says that one result is
 * there, the FIFO is emptied, and one conversion made.
 */
#include <errno.h>

#include "hal/chips/family.h"
#include "hal/wire/crc.h"

/* Commands; behind a register stands the count of bytes less one. */
enum { CONVERT = 0x44, READ = 0x33, WRITE = 0xcc };
enum { FIFO_CONFIGURATION = 0x0a, LIMITS_AT = 0x10, FLUSH = 0x10 };
/* Of what is read from register 0 on; the FIFO's register does not move on. */
enum { PLACE = 4, RESULTS = 7, FIFO = 8, ALL = 10 };

#define CONVERT_NS INT64_C(18000000)
#define PER_DEGREE 200

struct visit {
	bool started, flush, flushed;
	int64_t done_ns; /* when the conversion ends */
};

static int read_registers(struct txn *txn, uint8_t at, uint8_t *bytes, uint8_t n)
{
	const uint8_t command[] = {READ, at, (uint8_t)(n - 1)};
	return txn_ask_crc16(txn, command, sizeof(command), bytes, n);
}

/* The chip answers with the CRC16 of the command; behind its last bit the conversion begins. */
static int start_conversion(struct txn *txn)
{
	uint16_t covered = onewire_crc16(0, TXN_BYTES(CONVERT));
	uint8_t crc[2] = {0};
	int err = txn_command(txn, TXN_BYTES(CONVERT));

	if (!err)
		err = txn_read_slots(txn, crc, txn->link->facts->strong ? 1 : 2);
	for (unsigned i = 0; !err && txn->link->facts->strong && i < 7; i++) {
		int bit = txn_bit(txn);

		err = bit < 0 ? bit : 0;
		crc[1] |= (uint8_t)((bit == 1) << i);
	}
	if (err)
		return err;
	/* The last one is what it has to be, or the result will not be there. */
	if (txn->link->facts->strong)
		crc[1] |= (uint8_t)(~covered >> 8 & 0x80);
	if (!onewire_crc16_matches(covered, crc))
		return txn_checked(txn, false);
	return txn->link->facts->strong ? txn_bit_strong(txn, CONVERT_NS)
	                                : txn_wait(txn, CONVERT_NS);
}

static int flush_fifo(struct txn *txn)
{
	uint8_t none;
	return txn_ask_crc16(txn, TXN_BYTES(WRITE, FIFO_CONFIGURATION, 0, FLUSH), &none, 0);
}

static int read_temperature(struct txn *txn)
{
	struct visit *visit = txn_own(txn, struct visit);
	uint8_t bytes[ALL];
	int err;

	if (visit->flush) {
		err = flush_fifo(txn);
		visit->flush = visit->started = false;
		visit->flushed = !err;
		return err ? err : TXN_MORE;
	}
	if (!visit->started) {
		err = start_conversion(txn);
		visit->started = err == TXN_MORE;
		visit->done_ns = txn->wake_ns;
		return err;
	}
	err = read_registers(txn, 0, bytes, sizeof(bytes));
	if (err)
		return err;
	if (bytes[RESULTS] != 1 && !(visit->flushed && bytes[PLACE] == 1)) {
		/* left behind, or lost: once more with an empty FIFO */
		visit->flush = txn->phase++ == 0;
		return visit->flush ? TXN_MORE : -EBADMSG;
	}
	txn->number[0] = (int16_t)(bytes[FIFO] << 8 | bytes[FIFO + 1]) / (double)PER_DEGREE;
	txn->measured_ns = visit->done_ns;
	return 0;
}

static int load_limits(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                       unsigned n)
{
	return read_registers(txn, (uint8_t)(area->at + at), bytes, (uint8_t)n);
}

/* Read-only: a disturbed address of a write would reach another register, and act at once. */
static AREA_NAMED(limits, "limits", .at = LIMITS_AT, .size = 4, .block = 4, .load = load_limits);

enum { LIMITS = 1 };
static const struct area *const areas[] = {[LIMITS] = &limits};
enum { WAY_TEMPERATURE = 1 };
static const struct property_how how[] = {[WAY_TEMPERATURE] = {.read = read_temperature}};

#define LIMIT(text, at_) \
	PROPERTY(text, TEMPERATURE, STABLE, READ, \
	         FIELD(LIMITS, .at = (at_), .bytes = 2, .is_signed = true, .big_endian = true, \
	               .unit = 1.0 / PER_DEGREE))

static const struct property properties[] = {
	/* -40 to +125 within 0.7, 0.005 */
	PROPERTY("temperature", TEMPERATURE, VOLATILE, READ, MEASURES(-42, 127, 3, DEGREES_C),
                 .how = WAY_TEMPERATURE),
	LIMIT("temphigh", 0),
	LIMIT("templow", 2),
};

CHIP_FAMILY(54, "MAX31888", CHECKSUM, SCAN({"temperature", "temperature"}), AREAS(areas), HOW(how),
            PROPERTIES(properties));
