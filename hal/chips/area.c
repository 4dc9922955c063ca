/* SPDX-License-Identifier: MIT */
/* Areas of a chip: the one machine that reads, looks, writes, verifies, copies and checks. */
#include <assert.h>
#include <errno.h>
#include <string.h>

#include "hal/chips/area.h"
#include "hal/owfs/path.h"
#include "hal/wire/crc.h"
#include "hal/wire/unfinished.h"

#define BLANK_LOOKS 3 /* more, where nothing but ones was read */

static unsigned smaller(unsigned a, unsigned b)
{
	return a < b ? a : b;
}

/* The command and where in the area; its length. */
static unsigned put_address(uint8_t *command, uint8_t code, const struct area *area, unsigned at)
{
	unsigned where = area->at + at;

	command[0] = code;
	command[1 + area->high_first] = (uint8_t)where;
	command[2 - area->high_first] = (uint8_t)(where >> 8);
	return 1u + area->address_bytes;
}

static bool is_all_alike(const uint8_t *bytes, unsigned n)
{
	return n && (bytes[0] == 0 || bytes[0] == 0xff) && memcmp(bytes, bytes + 1, n - 1) == 0;
}

/* The command's own CRC8, then pages with theirs. */
static int read_pages(struct txn *txn, const struct area *area, const uint8_t *command, size_t len,
                      uint8_t *bytes, unsigned n)
{
	uint8_t in[1 + 2 * AREA_UNIT];
	int err = txn_read(txn, in, 1 + n + n / area->block);

	if (err)
		return err;
	if (rom_crc8(command, len) != in[0])
		return txn_checked(txn, false);
	for (const uint8_t *page = in + 1; n; n -= area->block, page += area->block + 1) {
		if (rom_crc8(page, area->block + 1u))
			return txn_checked(txn, false);
		txn->blank |= is_all_alike(page, area->block + 1u);
		memcpy(bytes, page, area->block);
		bytes += area->block;
	}
	return 0;
}

int area_fetch(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes, unsigned n)
{
	uint8_t command[3];
	unsigned len = put_address(command, area->recall, area, at);
	int err = 0;

	if (txn_driven(txn)) {
		err = txn_driver_read(txn, area, at, bytes, n);
		if (!err && area->check == AREA_UNCHECKED && !area->load)
			txn->blank |= is_all_alike(bytes, n);
		return err;
	}
	if (area->recall)
		err = txn_command(txn, command, len);
	command[0] = area->read;
	if (!err)
		err = txn_command(txn, command, len);
	if (err)
		return err;
	switch ((enum area_check)area->check) {
	case AREA_UNCHECKED:
		return txn_read(txn, bytes, n);
	case AREA_CRC8:
		return txn_read_crc8(txn, bytes, n);
	case AREA_CRC16:
		return txn_read_pages(txn, command, len, bytes, area->block, n / area->block);
	case AREA_CRC8_PAGES:
		return read_pages(txn, area, command, len, bytes, n);
	}
	return -EIO;
}

int area_ask_driver(struct txn *txn, const struct area *const *areas, unsigned count)
{
	uint8_t bytes[AREA_UNIT];

	for (unsigned i = 1; i < count; i++) {
		const struct area *area = areas[i];
		unsigned n = smaller(area->size, AREA_UNIT);
		int err = txn_driver_read(txn, area, 0, bytes, n);

		if (!err && !is_all_alike(bytes, n))
			return 1;
		if (err && err != -ENOENT && err != -EOPNOTSUPP)
			return err;
	}
	return 0;
}

/* A driver gives an area as it is. */
static int area_load(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                     unsigned n)
{
	return area->load && !txn_driven(txn) ? area->load(txn, area, at, bytes, n)
	                                      : area_fetch(txn, area, at, bytes, n);
}

/* What was read of the chip: does it count, and what does it say of the device? */
static int area_saw(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                    unsigned n)
{
	if (area->ones_lie && bytes[0] == 0xff && is_all_alike(bytes, n))
		return -EIO;
	for (unsigned i = 0; area->counts && i < n; i++)
		bytes[i] &= area->counts;
	return area->saw ? area->saw(txn, at, bytes, n) : 0;
}

/*
 * To visit->have; TXN_MORE until enough looks agree. So long as nothing but ones is read, the
 * chip may not have heard: if it was found by its id, the last look is made again.
 */
static int area_look(struct txn *txn, const struct area *area, unsigned at, unsigned n)
{
	struct area_visit *visit = &txn->area;
	uint8_t again[AREA_UNIT];
	int err = area_load(txn, area, at, again, n);

	if (err)
		return err;
	if (visit->looks && memcmp(visit->have, again, n) != 0)
		return -EBADMSG;
	memcpy(visit->have, again, n);
	if (area->check == AREA_UNCHECKED && !area->load && !txn_driven(txn)) {
		if (++visit->looks < AREA_LOOKS)
			return TXN_MORE;
		if (txn->silent && txn->asked && ++visit->blanks <= BLANK_LOOKS) {
			visit->looks--;
			return TXN_MORE;
		}
	}
	visit->looks = visit->blanks = 0;
	/* It is read again, or no request gets it: it shows nothing of the chip. */
	if (txn->blank && !txn->asked)
		return 0;
	return area_saw(txn, area, at, visit->have, n);
}

/* The blocks that n bytes from `at` on touch. */
static void whole_blocks(const struct area *area, unsigned *at, unsigned *n)
{
	unsigned block = area->block ? area->block : 1, before = *at % block;

	*at -= before;
	*n = smaller((*n + before + block - 1) / block * block, area->size - *at);
	assert(*n <= AREA_UNIT);
}

int area_read(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes, unsigned n)
{
	struct area_visit *visit = &txn->area;
	unsigned from = at, len = n;
	int err;

	if (at > area->size || n > area->size - at)
		return -EINVAL;
	if (!visit->begun_ns) {
		err = area->begin ? area->begin(txn) : 0;
		if (err)
			return err;
		if (txn_shared(txn, area, at, bytes, n))
			return 0;
		visit->begun_ns = txn_now(txn);
	}
	if (!area->parts || !txn_driven(txn))
		whole_blocks(area, &from, &len);
	err = area_look(txn, area, from, len);
	if (err)
		return err;
	if (!txn->blank || txn->asked)
		txn_share(txn, area, from, visit->have, len, visit->begun_ns);
	visit->begun_ns = 0;
	memcpy(bytes, visit->have + (at - from), n);
	return 0;
}

int area_read_data(struct txn *txn, const struct area *area, unsigned at, unsigned n)
{
	bool single = area->block && area->check == AREA_UNCHECKED;
	unsigned part = smaller(n - (unsigned)txn->len, single ? area->block : AREA_UNIT);
	int err = area_read(txn, area, at + (unsigned)txn->len, txn->data + txn->len, part);

	if (err)
		return err;
	txn->len += part;
	return txn->len < n ? TXN_MORE : 0;
}

/* --- Writing --- */

enum step { LOOK, WRITE, VERIFY, COPY, CHECK };

struct unit {
	unsigned at, n; /* what is looked at and changed together */
};

/*
 * Where byte `at` is written: a row of the scratchpad; registers all at once, for a write that is
 * disturbed may reach any of them, or block by block.
 */
static struct unit unit_of(const struct area *area, unsigned at)
{
	if (area->verify)
		return (struct unit){at - at % area->row, area->row};
	if (at < area->fixed)
		return (struct unit){0, area->fixed};
	if (area->size - area->fixed <= AREA_UNIT)
		return (struct unit){area->fixed, area->size - area->fixed};
	return (struct unit){at - at % area->block, area->block};
}

/* Registers take effect with the byte behind the checksum. */
static int check_answer(struct txn *txn, const struct area *area, const uint8_t *command,
                        unsigned len)
{
	uint8_t in[3];
	int err = txn_read(txn, in, area->verify ? 2 : 3);

	if (err)
		return err;
	if (!onewire_crc16_matches(onewire_crc16(0, command, len), in))
		return txn_checked(txn, false);
	return area->echo && in[2] != command[len - 1] ? -EIO : 0;
}

static int write_row(struct txn *txn, const struct area *area, unsigned at, const uint8_t *row)
{
	uint8_t command[3 + AREA_UNIT];
	unsigned len = put_address(command, area->write, area, at);
	int err;

	if (area->store)
		return area->store(txn, area, at, row, area->row);
	memcpy(command + len, row, area->row);
	len += area->row;
	err = txn_command(txn, command, len);
	return err || !area->write_crc16 ? err : check_answer(txn, area, command, len);
}

/* Row by row where it differs; 0 when none does. */
static int write_registers(struct txn *txn, const struct area *area, struct unit unit)
{
	struct area_visit *visit = &txn->area;

	for (unsigned i = 0; i < unit.n; i += area->row) {
		if (memcmp(visit->have + i, visit->want + i, area->row) == 0)
			continue;
		memcpy(visit->have + i, visit->want + i, area->row);
		int err = write_row(txn, area, unit.at + i, visit->want + i);
		return err ? err : TXN_MORE;
	}
	return 0;
}

/* Does the scratchpad hold the row? */
static int verify_row(struct txn *txn, const struct area *area, struct unit unit)
{
	struct area_visit *visit = &txn->area;
	uint8_t command[3], in[3 + AREA_UNIT];
	unsigned len = put_address(command, area->verify, area, unit.at);
	unsigned head = area->key ? 0 : 3;
	int err = txn_command(txn, command, head ? 1 : len);

	if (!err)
		err = area->write_crc16 ? txn_read_crc16(txn, command, 1, in, head + unit.n)
		                        : txn_read(txn, in, head + unit.n);
	if (err)
		return err;
	if ((head && memcmp(in, command + 1, 2) != 0) ||
	    memcmp(in + head, visit->want, unit.n) != 0)
		return -EBADMSG;
	visit->ending = in[2];
	return 0;
}

static int copy_row(struct txn *txn, const struct area *area, struct unit unit)
{
	uint8_t command[4 + AREA_PASSWORD] = {0};
	unsigned len = put_address(command, area->copy, area, unit.at);

	if (area->key) {
		command[1] = area->key;
		len = 2;
	} else if (area->verify) {
		command[len++] = txn->area.ending;
	}
	len += area->password;
	if (area->strong)
		return txn_command_strong(txn, command, len, area->copy_ns);
	return txn_command_wait(txn, command, len, area->copy_ns);
}

static int check_unit(struct txn *txn, const struct area *area, struct unit unit)
{
	struct area_visit *visit = &txn->area;
	uint8_t in[AREA_UNIT];
	int err = area_load(txn, area, unit.at, in, unit.n);

	txn->silent = false;
	if (!err)
		err = area_saw(txn, area, unit.at, in, unit.n);
	if (err)
		return err;
	bool written = area->is_written ? area->is_written(txn, in, visit->want, unit.n)
	                                : memcmp(in, visit->want, unit.n) == 0;
	if (written && !area->verify)
		unfinished_end(txn->device, area, unit.at);
	return written ? 0 : -EIO;
}

/* One step of a unit; 0 when it is written. */
static int write_step(struct txn *txn, const struct area *area, struct unit unit)
{
	struct area_visit *visit = &txn->area;
	int err = 0;

	switch ((enum step)visit->step) {
	case LOOK:
	case WRITE:
		txn_void(txn);
		if (txn_driven(txn)) {
			visit->step = CHECK;
			err = txn_driver_write(txn, area, unit.at, visit->want, unit.n);
			return err ? err : TXN_MORE;
		}
		err = area->verify ? write_row(txn, area, unit.at, visit->want)
		                   : write_registers(txn, area, unit);
		if (err)
			return err;
		visit->step = area->verify ? VERIFY : area->copy ? COPY : CHECK;
		return area->verify ? TXN_MORE : write_step(txn, area, unit);
	case VERIFY:
		err = verify_row(txn, area, unit);
		visit->step = COPY;
		return err ? err : TXN_MORE;
	case COPY:
		err = copy_row(txn, area, unit);
		visit->step = CHECK;
		return err;
	case CHECK:
		err = check_unit(txn, area, unit);
		/* Where the copy and this recall were lost, what is read was never copied. */
		return !err && area->recall && ++visit->looks < AREA_LOOKS ? TXN_MORE : err;
	}
	return -EIO;
}

/* All of a row of registers: nothing of what is there matters. */
static bool is_given(const struct area *area, struct unit unit, unsigned at, const uint8_t *mask,
                     unsigned n)
{
	bool whole = !area->verify && at == unit.at && n == unit.n && n == area->row;

	for (unsigned i = 0; whole && mask && i < n; i++)
		whole = mask[i] == 0xff;
	return whole;
}

/* What is there, and what is to be there. 0: it is already; TXN_MORE: go on. */
static int prepare_unit(struct txn *txn, const struct area *area, struct unit unit, unsigned at,
                        const uint8_t *bytes, const uint8_t *mask, unsigned n)
{
	struct area_visit *visit = &txn->area;
	unsigned from = at > unit.at ? at : unit.at, to = smaller(at + n, unit.at + unit.n);
	uint8_t begun[AREA_UNIT];
	int err;

	if (is_given(area, unit, at, mask, n)) {
		unfinished_end(txn->device, area, unit.at);
		memcpy(visit->want, bytes, unit.n);
		visit->have[0] = (uint8_t)~bytes[0];
		visit->step = WRITE;
		return write_step(txn, area, unit);
	}
	err = area_look(txn, area, unit.at, unit.n);
	txn->silent = false;
	if (err)
		return err;
	memcpy(begun, visit->have, unit.n);
	bool again = !area->verify && !txn->restarted &&
	             unfinished_base(txn->device, area, unit.at, begun, unit.n);
	memcpy(visit->want, begun, unit.n);
	for (unsigned i = from; i < to; i++) {
		uint8_t bits = mask ? mask[i - at] : 0xff, *byte = &visit->want[i - unit.at];

		*byte = (uint8_t)((*byte & ~bits) | (bytes[i - at] & bits));
	}
	if (area->adjust && unit.at >= area->fixed)
		area->adjust(txn, visit->want);
	/* Bits that do not count may be wrong as well. */
	bool anew = (again && unit.n == area->row) || (area->hidden && txn_driven(txn));
	bool equal = !anew && memcmp(visit->have, visit->want, unit.n) == 0;
	if (unit.at < area->fixed)
		return equal ? 0 : -EIO;
	if (equal && again)
		unfinished_end(txn->device, area, unit.at);
	if (!equal && !area->verify)
		unfinished_begin(txn->device, area, unit.at, begun, visit->want, unit.n);
	if (anew)
		visit->have[0] = (uint8_t)~visit->want[0];
	visit->step = WRITE;
	return equal ? 0 : TXN_MORE;
}

int area_write(struct txn *txn, const struct area *area, unsigned at, const uint8_t *bytes,
               const uint8_t *mask, unsigned n)
{
	struct area_visit *visit = &txn->area;
	int err = area->begin ? area->begin(txn) : 0;

	if (err || n == 0)
		return err;
	if (!area->row)
		return -EOPNOTSUPP;
	if (at > area->size || n > area->size - at)
		return -EINVAL;
	struct unit unit = unit_of(area, at + visit->done);
	err = visit->step == LOOK ? prepare_unit(txn, area, unit, at, bytes, mask, n)
	                          : write_step(txn, area, unit);
	if (err)
		return err;
	unsigned done = unit.at + unit.n - at;
	memset(visit, 0, sizeof(*visit));
	visit->done = done < n ? (uint16_t)done : 0;
	return done < n ? TXN_MORE : 0;
}

int conversion_start(struct txn *txn, const struct conversion *conversion, bool strong)
{
	uint8_t none;
	int err;

	if (txn_driven(txn)) {
		err = txn_driver_convert(txn, conversion->name);
		return err ? err : txn_wait(txn, 0);
	}
	err = txn_command(txn, conversion->command, conversion->n);

	if (!err && conversion->crc16)
		err = txn_read_crc16(txn, conversion->command, conversion->n, &none, 0);
	else if (!err)
		err = txn_started(txn);
	if (err)
		return err;
	/* The last slot of what was read is over: the pull-up is armed with one more. */
	return strong ? txn_bit_strong(txn, conversion->ns) : txn_wait(txn, conversion->ns);
}
