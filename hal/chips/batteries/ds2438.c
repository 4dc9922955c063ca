/* SPDX-License-Identifier: MIT */
/*
 * The memory of a DS2438 (data sheet 19-5099), which is read and written by way of scratchpads, one
 * for each page.
 *
 * Its checksum covers neither the command nor the page's number, and Recall says nothing: if it is
 * lost, the scratchpad's old contents come with a right checksum. So the scratchpad's first byte is
 * changed before and read back (the mark): the memory's byte in its place proves the Recall.
 * What is read is read twice, as the number of another page may have reached the chip; it may be
 * the same one twice. The measurements are in page 0: there the configuration must be the known
 * one.
 *
 * A page is written, read back, copied, recalled and compared. Before that the three scratchpads
 * are recalled that one wrong bit in the number of the page could copy. A program that plays a
 * DS2438 has neither recall nor busy slots: a search for it and two looks that are the same have to
 * do.
 */
#include <errno.h>
#include <string.h>

#include "hal/chips/batteries/ds2438.h"

#define RECALL 0xb8
#define READ_SCRATCHPAD 0xbe
#define WRITE_SCRATCHPAD 0x4e
#define COPY_SCRATCHPAD 0x48
#define COPY_NS (10 * TXN_MS)

#define CONFIGURATION 0x0f
#define BUSY 0x70      /* a conversion or a copy is under way */
#define THRESHOLD 0xc0 /* of byte 7 */

#define KNOWN 0x80 /* of a configuration */

/* Both marks of so many pairs, each the other's complement, outlived a recall: it has none. */
#define COPY_KEPT 3

/* The pages as the kernel's driver reads them; it recalls them itself. */
static AREA_NAMED(pages, "pages", .size = 64);

/* A page of the EEPROM: its first byte stays as it is. */
#define MARKED_PAGE 3

enum step { BEGIN, SET_MARK, FIND_MARK, TAKE };

static int ds2438_read_scratchpad(struct txn *txn, unsigned page, uint8_t in[9])
{
	uint8_t command[] = {READ_SCRATCHPAD, (uint8_t)page};
	bool blank = txn->blank;
	int err = txn_command(txn, command, sizeof(command));

	if (!err)
		err = txn_read_crc8(txn, in, 9);
	txn->blank = blank; /* ones fail the checksum; that zeros were recalled the mark shows */
	return err;
}

static int ds2438_recall(struct txn *txn, unsigned page, uint8_t in[9])
{
	uint8_t command[] = {RECALL, (uint8_t)page};
	int err = txn_command(txn, command, sizeof(command));

	return err ? err : ds2438_read_scratchpad(txn, page, in);
}

/* And read back. Of page 0 only the configuration is taken. */
static int ds2438_write_scratchpad(struct txn *txn, unsigned page, const uint8_t *bytes, unsigned n)
{
	uint8_t command[10] = {WRITE_SCRATCHPAD, (uint8_t)page}, in[9];
	int err;

	memcpy(command + 2, bytes, n);
	err = txn_command(txn, command, 2 + n);
	if (!err)
		err = ds2438_read_scratchpad(txn, page, in);
	if (err)
		return err;
	if (page == 0 ? ((in[0] ^ bytes[0]) & CONFIGURATION) || (in[0] & BUSY)
	              : memcmp(in, bytes, n) != 0)
		return -EBADMSG;
	return 0;
}

static bool is_mark(struct txn *txn, unsigned page, uint8_t byte)
{
	return ((byte ^ ds2438_visit(txn)->mark) & (page ? 0xff : DS2438_AD)) == 0;
}

bool ds2438_is_copy(const struct txn *txn)
{
	return ds2438_of(txn)->kept == COPY_KEPT;
}

void ds2438_is_genuine(struct txn *txn)
{
	ds2438_of(txn)->genuine = true;
	ds2438_of(txn)->kept = 0;
	txn->device->identity = NULL;
}

/* The recall of a chip may be lost, but not all of them where everything else comes over whole. */
static int kept_marks(struct txn *txn)
{
	struct ds2438 *chip = ds2438_of(txn);

	if (chip->genuine || ++chip->kept < COPY_KEPT)
		return -EBADMSG;
	txn->device->identity = "emulated: shows no conversion";
	ds2438_visit(txn)->step = BEGIN;
	ds2438_visit(txn)->again = false;
	return TXN_MORE;
}

/*
 * It is there, and two looks are the same; nothing but zeros is also what a short wire gives. Its
 * busy flags mean nothing: they are what was written.
 */
static int read_copy(struct txn *txn, unsigned page, uint8_t bytes[8])
{
	static const uint8_t zeros[8];
	uint8_t in[9], again[9];
	int there = 1, err;

	if (ds2438_visit(txn)->step == BEGIN) {
		there = txn_verify(txn, false);
		ds2438_visit(txn)->step = TAKE;
		return there > 0 ? TXN_MORE : there ? there : -ENODEV;
	}
	ds2438_visit(txn)->step = BEGIN;
	err = ds2438_read_scratchpad(txn, page, in);
	if (!err)
		err = ds2438_read_scratchpad(txn, page, again);
	if (!err && memcmp(in, again, sizeof(in)) != 0)
		err = -EBADMSG;
	if (!err && memcmp(in, zeros, sizeof(zeros)) == 0)
		there = txn_verify(txn, false);
	if (err || there <= 0)
		return err ? err : there ? there : -ENODEV;
	ds2438_of(txn)->first[page] = page ? in[0] : KNOWN | (in[0] & CONFIGURATION);
	memcpy(bytes, in, 8);
	return 0;
}

/* Behind the mark. */
static int ds2438_take(struct txn *txn, unsigned page, uint8_t bytes[8])
{
	uint8_t in[9], again[9], *note = &ds2438_of(txn)->first[page];
	int err = ds2438_recall(txn, page, in);

	if (!err)
		err = ds2438_read_scratchpad(txn, page, again);
	if (!err && memcmp(in, again, sizeof(in)) != 0)
		err = -EBADMSG;
	/* The mark of page 0 in its place: the recall was lost, or there is none. */
	uint8_t fixed = ds2438_of(txn)->genuine ? CONFIGURATION : CONFIGURATION & ~DS2438_AD;
	if (!err && page == 0 && ((in[0] & BUSY) || ((in[0] ^ *note) & fixed)))
		err = -EBADMSG;
	if (err)
		return err;
	ds2438_visit(txn)->step = SET_MARK;
	*note = page ? in[0] : KNOWN | (in[0] & CONFIGURATION);
	if (!is_mark(txn, page, in[0])) {
		ds2438_visit(txn)->step = BEGIN;
		ds2438_visit(txn)->again = false;
		memcpy(bytes, in, 8);
		ds2438_is_genuine(txn);
		return 0;
	}
	/* The memory may well hold the mark: with another one, once more. */
	if (ds2438_visit(txn)->again)
		return kept_marks(txn);
	ds2438_visit(txn)->again = true;
	return TXN_MORE;
}

int ds2438_read(struct txn *txn, unsigned page, uint8_t bytes[8])
{
	uint8_t in[9] = {0}, *note = &ds2438_of(txn)->first[page];
	int err;

	if (txn_driven(txn))
		return txn_driver_read(txn, &pages, page * 8, bytes, 8);
	if (ds2438_is_copy(txn))
		return read_copy(txn, page, bytes);
	switch ((enum step)ds2438_visit(txn)->step) {
	case BEGIN:
		if (page == 0 && !*note) {
			err = ds2438_recall(txn, page, in);
			if (err)
				return err;
			*note = KNOWN | (in[0] & CONFIGURATION);
			ds2438_visit(txn)->step = SET_MARK;
			return TXN_MORE;
		}
		/* A mark stays in a copy: the second one is what was there. */
		if (page && !*note && !ds2438_of(txn)->genuine) {
			err = ds2438_read_scratchpad(txn, page, in);
			if (err)
				return err;
			*note = in[0];
			ds2438_visit(txn)->step = SET_MARK;
			return TXN_MORE;
		}
		/* fallthrough */
	case SET_MARK:
		ds2438_visit(txn)->mark = page ? (uint8_t) ~*note
		                               : (uint8_t)((*note & CONFIGURATION) ^ DS2438_AD);
		err = ds2438_write_scratchpad(txn, page, &ds2438_visit(txn)->mark, 1);
		ds2438_visit(txn)->step = TAKE;
		return err ? err : TXN_MORE;
	case FIND_MARK:
		err = ds2438_read_scratchpad(txn, page, in);
		if (!err && (!is_mark(txn, page, in[0]) || (in[0] & BUSY)))
			err = -EBADMSG;
		ds2438_visit(txn)->step = TAKE;
		return err ? err : TXN_MORE;
	case TAKE:
		break;
	}
	err = ds2438_take(txn, page, bytes);
	if (err < 0)
		*note = 0;
	return err;
}

int ds2438_select(struct txn *txn, uint8_t select)
{
	uint8_t configuration = ds2438_of(txn)->first[0], bytes[8];

	/* A driver's conversions select what they measure. */
	if (txn_driven(txn))
		return 0;
	if (!(configuration & KNOWN) || ds2438_visit(txn)->step != BEGIN) {
		int err = ds2438_read(txn, 0, bytes);

		return err ? err : TXN_MORE;
	}
	configuration = (uint8_t)((configuration & CONFIGURATION & ~DS2438_AD) | select);
	return ds2438_write_scratchpad(txn, 0, &configuration, 1);
}

/* What is selected is a mark, too, where the memory selects the other. */
int ds2438_read_selected(struct txn *txn, uint8_t select, uint8_t bytes[8])
{
	if (txn_driven(txn)) {
		int err = ds2438_read(txn, 0, bytes);

		return err || (bytes[0] & DS2438_AD) == select ? err : -EIO;
	}
	if (ds2438_is_copy(txn)) {
		int err = ds2438_read(txn, 0, bytes);

		return err || (bytes[0] & DS2438_AD) == select ? err : -EBADMSG;
	}
	if (ds2438_visit(txn)->step == BEGIN && (ds2438_of(txn)->first[0] & DS2438_AD) != select) {
		ds2438_visit(txn)->mark = select;
		ds2438_visit(txn)->step = FIND_MARK;
	}
	return ds2438_read(txn, 0, bytes);
}

/* A driver's scratchpad cannot be marked. */
int ds2438_mark(struct txn *txn)
{
	struct ds2438_visit *visit = ds2438_visit(txn);
	uint8_t bytes[8];

	if (txn_driven(txn))
		return 0;
	if (!visit->marking) {
		int err = ds2438_read(txn, MARKED_PAGE, bytes);

		if (err)
			return err;
		visit->proof_mark = (uint8_t)~bytes[0];
		visit->marking = true;
		return TXN_MORE;
	}
	visit->marking = false;
	return ds2438_write_scratchpad(txn, MARKED_PAGE, &visit->proof_mark, 1);
}

int ds2438_is_marked(struct txn *txn)
{
	uint8_t in[9];

	if (txn_driven(txn))
		return 0;
	int err = ds2438_read_scratchpad(txn, MARKED_PAGE, in);

	return err ? err : in[0] == ds2438_visit(txn)->proof_mark ? 0 : -EBADMSG;
}

static bool near(unsigned now, unsigned before, unsigned most)
{
	return now - before <= most;
}

/* What was written, and has gone on since where the chip counts by itself. */
static bool is_written(unsigned page, const uint8_t *in, const uint8_t *bytes, unsigned n)
{
	uint32_t now = area_le32(in);
	uint32_t then = area_le32(bytes);

	switch (page) {
	case 0: /* the configuration and the threshold; the rest is measured */
		return ((in[0] ^ bytes[0]) & CONFIGURATION) == 0 &&
		       (n < 8 || ((in[7] ^ bytes[7]) & THRESHOLD) == 0);
	case 1: /* the clock, the accumulator, the offset */
		return near(now, then, 5) && near((uint8_t)(in[4] - bytes[4] + 1), 0, 2) &&
		       memcmp(in + 5, bytes + 5, 2) == 0;
	case 7: /* two words, and what was charged and discharged */
		return now == then &&
		       near((in[4] | in[5] << 8) - (bytes[4] | bytes[5] << 8), 0, 1) &&
		       near((in[6] | in[7] << 8) - (bytes[6] | bytes[7] << 8), 0, 1);
	default:
		return memcmp(in, bytes, n) == 0;
	}
}

/*
 * The steps of *step: the scratchpad, three recalls, the copy, and what the page holds then. 0 when
 * it is written. A copy whose page's number is disturbed by one bit takes one of three other
 * scratchpads: they are made to hold what their pages hold.
 */
static int write_page(struct txn *txn, unsigned page, const uint8_t *bytes, unsigned n,
                      uint8_t *step)
{
	uint8_t command[] = {COPY_SCRATCHPAD, (uint8_t)page}, in[8] = {0};
	int err;

	if (txn_driven(txn))
		return txn_driver_write(txn, &pages, page * 8, bytes, n);
	switch (*step) {
	case 0:
		err = ds2438_write_scratchpad(txn, page, bytes, n);
		/* A copy has nothing else to keep it in. */
		*step = ds2438_is_copy(txn) ? 5 : 1;
		return err ? err : TXN_MORE;
	case 1:
	case 2:
	case 3:
		command[0] = RECALL;
		command[1] ^= (uint8_t)(1 << (*step - 1));
		err = txn_command(txn, command, sizeof(command));
		++*step;
		return err ? err : TXN_MORE;
	case 4:
		err = txn_command(txn, command, sizeof(command));
		if (page == 0)
			ds2438_of(txn)->first[0] = KNOWN | (bytes[0] & CONFIGURATION);
		++*step;
		return err ? err : txn_wait(txn, COPY_NS);
	default:
		err = ds2438_read(txn, page, in);
		if (err)
			return err;
		*step = 0;
		return is_written(page, in, bytes, n) ? 0 : -EIO;
	}
}

int ds2438_configure(struct txn *txn, uint8_t mask, uint8_t bits, uint8_t *before)
{
	struct ds2438_visit *visit = ds2438_visit(txn);
	uint8_t bytes[8] = {0};
	int err;

	if (!visit->configuring) {
		err = ds2438_read(txn, 0, bytes);
		if (err)
			return err;
		if (before)
			*before = bytes[0];
		if ((bytes[0] & mask) == bits)
			return 0;
		visit->configuration = (uint8_t)((bytes[0] & CONFIGURATION & ~mask) | bits);
		visit->configuring = true;
		visit->writing = 0;
		return TXN_MORE;
	}
	bytes[0] = visit->configuration;
	err = write_page(txn, 0, bytes, 1, &visit->writing);
	visit->configuring = err > 0;
	return err;
}

int ds2438_patch(struct txn *txn, unsigned page, unsigned at, const uint8_t *bytes, unsigned n)
{
	struct ds2438_visit *visit = ds2438_visit(txn);
	uint8_t before[8];

	if (!visit->patching) {
		int err = ds2438_read(txn, page, visit->page);

		if (err)
			return err;
		memcpy(before, visit->page, 8);
		memcpy(visit->page + at, bytes, n);
		visit->patching = memcmp(before, visit->page, 8) != 0;
		visit->writing = 0;
		return visit->patching ? TXN_MORE : 0;
	}
	int err = write_page(txn, page, visit->page, 8, &visit->writing);
	visit->patching = err > 0;
	return err;
}

static int load_page(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                     unsigned n)
{
	(void)area, (void)n;
	return ds2438_read(txn, at / 8, bytes);
}

AREA_NAMED(ds2438_pages, "pages", .size = 64, .block = 8, .load = load_page);

int ds2438_write_field(struct txn *txn)
{
	const struct field *field = &txn->property->field;
	uint32_t value = (uint32_t)txn->number[0];
	uint8_t bytes[] = {(uint8_t)value, (uint8_t)(value >> 8), (uint8_t)(value >> 16),
	                   (uint8_t)(value >> 24)};

	return ds2438_patch(txn, field->at / 8, field->at % 8, bytes, sizeof(bytes));
}

int ds2438_write_flag(struct txn *txn)
{
	uint8_t bit = (uint8_t)(1 << txn->property->field.shift);

	return ds2438_configure(txn, bit, txn->number[0] != 0 ? bit : 0, NULL);
}

int ds2438_write_page(struct txn *txn)
{
	return ds2438_patch(txn, (unsigned)txn->element, (unsigned)txn->at, txn->data,
	                    (unsigned)txn->len);
}
