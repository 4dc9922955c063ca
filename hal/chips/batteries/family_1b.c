/* SPDX-License-Identifier: MIT */
/*
 * DS2436: temperature, voltage, a counter, and three pages behind scratchpads (data sheet, "Battery
 * ID/Monitor Chip"). Nothing has a checksum, and no command an answer: a conversion is started
 * twice, so that a lost command leaves nothing old, and what is read is looked at three times.
 *
 * One wrong bit makes Increment of Convert V: nothing shows that. Each look has its own recall.
 * What is written is read back in the scratchpad before the copy, and in the page, the status or
 * the counter after it. An increment that failed is made again from what the counter was before it.
 * Volts of 0 fail; a temperature of 0 is measured again between a mark and a look at it.
 */
#include <errno.h>
#include <string.h>

#include "hal/chips/family.h"
#include "hal/wire/unfinished.h"

enum { PAGES_OF_CHIP = 3, PAGE = 32, MARK_AT = 0x20 };
enum { CELSIUS = 0x60, STATUS = 0x62, VOLTS = 0x77, COUNT = 0x82 };
enum { WRITE_SCRATCHPAD = 0x17, LOCK = 0x43, UNLOCK = 0x44 };
#define LOCKED 0x04 /* of the status register */

#define CONVERT_NS (10 * TXN_MS)
#define COPY_NS (10 * TXN_MS)

/* The bytes of a page, its commands. */
static const struct {
	uint8_t size, recall, copy;
} pages[PAGES_OF_CHIP] = {{24, 0x71, 0x22}, {8, 0x77, 0x25}, {8, 0x7a, 0x28}};

static AREA_NAMED(registers, "registers", .size = 0x84, .address_bytes = 1, .read = 0xb2);
static AREA_NAMED(scratchpads, "scratchpads", .size = PAGES_OF_CHIP * PAGE, .address_bytes = 1,
                  .read = 0x11);

struct visit {
	uint8_t step, looks, mark;
	bool marked, recalled;
	uint8_t bytes[PAGE];
};

static int family_1b_command(struct txn *txn, uint8_t code, int64_t ns)
{
	txn_void(txn);
	return txn_command_wait(txn, &code, 1, ns);
}

/* Each look recalls the page: its scratchpad may hold something else. */
static int load_page(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                     unsigned n)
{
	struct visit *visit = txn_own(txn, struct visit);
	uint8_t code = pages[at / PAGE].recall, again[PAGE];
	int err;

	(void)area;
	if (!visit->recalled) {
		visit->recalled = true;
		return txn_command_wait(txn, &code, 1, COPY_NS);
	}
	err = area_fetch(txn, &scratchpads, at, again, n);
	if (err)
		return err;
	if (visit->looks && memcmp(again, visit->bytes, n) != 0)
		return -EBADMSG;
	memcpy(visit->bytes, again, n);
	visit->recalled = false;
	if (++visit->looks < AREA_LOOKS)
		return TXN_MORE;
	visit->looks = 0;
	memcpy(bytes, again, n);
	return 0;
}

static AREA_NAMED(memory, "pages", .size = PAGES_OF_CHIP * PAGE, .block = PAGE, .load = load_page);

/* And read back. */
static int family_1b_write_scratchpad(struct txn *txn, unsigned at, const uint8_t *bytes,
                                      unsigned n)
{
	uint8_t out[2 + PAGE] = {WRITE_SCRATCHPAD, (uint8_t)at}, in[PAGE];
	int err;

	memcpy(out + 2, bytes, n);
	txn_void(txn);
	err = txn_command(txn, out, 2 + n);
	if (!err)
		err = area_fetch(txn, &scratchpads, at, in, n);
	if (err)
		return err;
	return memcmp(in, bytes, n) == 0 ? 0 : -EBADMSG;
}

/* Leave in a scratchpad what a restart does not leave there. */
static int leave_mark(struct txn *txn)
{
	struct visit *visit = txn_own(txn, struct visit);
	int err = area_read(txn, &scratchpads, MARK_AT, &visit->mark, 1);

	if (err)
		return err;
	visit->mark = (uint8_t)~visit->mark;
	visit->marked = true;
	visit->step = 0;
	err = family_1b_write_scratchpad(txn, MARK_AT, &visit->mark, 1);
	return err ? err : TXN_MORE;
}

static int find_mark(struct txn *txn)
{
	const struct visit *visit = txn_own(txn, struct visit);
	uint8_t byte;
	int err = area_read(txn, &scratchpads, MARK_AT, &byte, 1);

	return err ? err : byte == visit->mark ? 0 : -EBADMSG;
}

enum step { FIRST, SECOND, TAKE, SET_MARK, LOOK };

/* A restart empties the registers: a zero is measured again between a mark and a look at it. */
static int family_1b_measure(struct txn *txn, uint8_t code, unsigned at, int *value)
{
	struct visit *visit = txn_own(txn, struct visit);
	uint8_t bytes[2];
	int err;

	switch ((enum step)visit->step) {
	case FIRST:
		if (!visit->marked && txn_shared(txn, &registers, at, bytes, 2)) {
			*value = (int16_t)(bytes[0] | bytes[1] << 8);
			return 0;
		}
		visit->step = SECOND;
		return family_1b_command(txn, code, CONVERT_NS);
	case SECOND:
		visit->step = TAKE;
		return family_1b_command(txn, code, CONVERT_NS);
	case TAKE:
		break;
	case SET_MARK:
		return leave_mark(txn);
	case LOOK:
		*value = 0;
		return find_mark(txn);
	}
	err = area_read(txn, &registers, at, bytes, 2);
	if (err)
		return err;
	*value = (int16_t)(bytes[0] | bytes[1] << 8);
	if (*value)
		return 0;
	txn_void(txn);
	visit->step = visit->marked ? LOOK : SET_MARK;
	return TXN_MORE;
}

static int read_temperature(struct txn *txn)
{
	int value = 0, err = family_1b_measure(txn, 0xd2, CELSIUS, &value);

	txn->number[0] = value / 256.0;
	return err;
}

/* The chip runs on it: it is never 0. */
static int read_volts(struct txn *txn)
{
	int value = 0, err = family_1b_measure(txn, 0xb4, VOLTS, &value);

	txn->number[0] = value * 0.01;
	return err || value ? err : -EIO;
}

static int read_count(struct txn *txn, uint8_t bytes[2])
{
	return area_read(txn, &registers, COUNT, bytes, 2);
}

/* One that failed may have counted: it counts from what stood there before it. */
static int write_increment(struct txn *txn)
{
	struct visit *visit = txn_own(txn, struct visit);
	uint8_t now[2], *want = visit->bytes;
	int err;

	if (txn->number[0] == 0)
		return 0;
	if (txn->phase == 0)
		txn_void(txn);
	txn->phase = 1;
	err = read_count(txn, now);
	if (err)
		return err;
	if (visit->step == 0) {
		memcpy(want, now, 2);
		unfinished_base(txn->device, &registers, COUNT, want, 2);
		unfinished_begin(txn->device, &registers, COUNT, want, want, 2);
		want[1] = (uint8_t)(want[1] + (++want[0] == 0));
		visit->step = 1;
		if (memcmp(now, want, 2) != 0)
			return family_1b_command(txn, 0xb5, COPY_NS);
	}
	if (memcmp(now, want, 2) != 0)
		return -EIO;
	unfinished_end(txn->device, &registers, COUNT);
	return 0;
}

static int write_reset(struct txn *txn)
{
	uint8_t now[2];
	int err;

	if (txn->number[0] == 0)
		return 0;
	if (txn->phase++ == 0) {
		unfinished_end(txn->device, &registers, COUNT);
		return family_1b_command(txn, 0xb8, COPY_NS);
	}
	err = read_count(txn, now);
	return err ? err : now[0] || now[1] ? -EIO : 0;
}

/* The page as it is to be; the bytes behind it cannot be written. */
static int prepare_page(struct txn *txn, uint8_t want[PAGE])
{
	unsigned page = (unsigned)txn->element;
	int err;

	if (txn->at + txn->len > pages[page].size)
		return -EINVAL;
	err = area_read(txn, &memory, page * PAGE, want, PAGE);
	if (err)
		return err;
	memcpy(want + txn->at, txn->data, txn->len);
	return family_1b_write_scratchpad(txn, page * PAGE, want, pages[page].size);
}

static int check_lock(struct txn *txn)
{
	uint8_t byte;
	int err = area_read(txn, &registers, STATUS, &byte, 1);

	return err ? err : byte & LOCKED ? 0 : -EIO;
}

/* Page 0 is locked but while it is written. */
static int write_page(struct txn *txn)
{
	unsigned page = (unsigned)txn->element;
	uint8_t want[PAGE];
	int err = 0;

	switch (txn->phase) {
	case 0:
		err = prepare_page(txn, want);
		break;
	case 1:
		err = page == 0 ? family_1b_command(txn, UNLOCK, COPY_NS) : 0;
		break;
	case 2:
		err = family_1b_command(txn, pages[page].copy, COPY_NS);
		break;
	case 3:
		err = page == 0 ? family_1b_command(txn, LOCK, COPY_NS) : 0;
		break;
	case 4:
		err = page == 0 ? check_lock(txn) : 0;
		break;
	default:
		err = area_read(txn, &memory, page * PAGE, want, PAGE);
		return err ? err : memcmp(want + txn->at, txn->data, txn->len) == 0 ? 0 : -EIO;
	}
	if (err < 0)
		return err;
	if (err == 0 || (txn->phase >= 1 && txn->phase <= 3))
		txn->phase++;
	return TXN_MORE;
}

enum { MEMORY = 1, REGISTERS };
static const struct area *const areas[] = {[MEMORY] = &memory, [REGISTERS] = &registers};

enum { WAY_TEMPERATURE = 1, WAY_VOLTS, WAY_INCREMENT, WAY_RESET, WAY_PAGE };
static const struct property_how how[] = {
	[WAY_TEMPERATURE] = {.read = read_temperature},
	[WAY_VOLTS] = {.read = read_volts},
	[WAY_INCREMENT] = {.write = write_increment},
	[WAY_RESET] = {.write = write_reset},
	[WAY_PAGE] = {.write = write_page},
};

static const struct property properties[] = {
	PROPERTY_DIR("counter"),
	PROPERTY("counter/cycles", UNSIGNED, STABLE, READ,
                 FIELD(REGISTERS, .at = COUNT, .bytes = 2), COUNTS_TO(UINT16_MAX)),
	PROPERTY("counter/increment", YESNO, VOLATILE, WRITE, .how = WAY_INCREMENT),
	PROPERTY("counter/reset", YESNO, VOLATILE, WRITE, .how = WAY_RESET),
	PROPERTY_DIR("pages"),
	PROPERTY("pages/page", BINARY, STABLE, BOTH, ELEMENTS(3, NUMBERS), .size = PAGE,
                 FIELD(MEMORY), .how = WAY_PAGE),
	/* -40 to +85 within 4; stored down to -55 and up to 125 */
	PROPERTY("temperature", TEMPERATURE, VOLATILE, READ, MEASURES(-58, 128, 3, DEGREES_C),
                 .how = WAY_TEMPERATURE),
	/* 10 bits of 10 mV, of its own supply */
	PROPERTY("volts", FLOAT, VOLATILE, READ, MEASURES(2, 10.23, 2, "V"), .how = WAY_VOLTS),
};

CHIP_FAMILY(1b, "DS2436", PRESENCE,
            SCAN({"temperature", "temperature"}, {"volts", "volt"}, {"counter/cycles", "cycles"}),
            AREAS(areas), HOW(how), PROPERTIES(properties));
