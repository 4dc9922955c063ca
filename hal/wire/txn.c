/* SPDX-License-Identifier: MIT */
/* The steps of a transaction with one device: what a family's functions are made of. */
#include <assert.h>
#include <errno.h>
#include <string.h>

#include "hal/owfs/path.h"
#include "hal/wire/crc.h"
#include "hal/wire/driver.h"
#include "hal/wire/search.h"
#include "hal/wire/txn.h"

#define MATCH_ROM 0x55
#define BYTES_MAX 64
/* Some chips begin up to 1 ms late (clones of the DS18B20, family A3): so many bytes more. */
#define LATE 10

int64_t txn_now(const struct txn *txn)
{
	return bus_now(txn->link->env);
}

static int of_link(struct txn *txn, int result)
{
	txn->on_wire = true;
	if (result == -EHOSTDOWN) {
		txn->silent = true;
		return -ENODEV;
	}
	if (result < 0 && result != -EOPNOTSUPP && result != -EBADMSG && !txn->link->driver)
		txn->link_error = result;
	return result;
}

/* Is it what was made already? Then what it has read is taken. */
static bool take_done(struct txn *txn, const struct link_part *part)
{
	const struct link_run *done = txn->done;

	txn->done = NULL;
	txn->done_ns = 0;
	if (!done || !part->reset || !part->in || part->after != LINK_IDLE ||
	    part->in_n != done->part.in_n || part->out_n != done->part.out_n ||
	    memcmp(part->out, done->part.out, part->out_n) != 0)
		return false;
	memcpy(part->in, done->part.in, part->in_n);
	txn->done_ns = done->ended_ns;
	txn->on_wire = true;
	return true;
}

/* What is kept, and what is read and follows. */
static int run_part(struct txn *txn, uint8_t *in, size_t in_n, enum link_after after)
{
	const struct link_part part = {.reset = txn->resets,
	                               .out = txn->out,
	                               .out_n = txn->out_n,
	                               .in = in,
	                               .in_n = in_n,
	                               .after = after};

	txn->resets = false;
	txn->out_n = 0;
	txn->has_read |= in_n > 0;
	return take_done(txn, &part) ? 0 : of_link(txn, txn->link->ops->run(txn->link, &part));
}

/* As txn_end(), where something else of the transaction follows. */
static int send_kept(struct txn *txn)
{
	return txn->resets || txn->out_n ? run_part(txn, NULL, 0, LINK_IDLE) : 0;
}

int txn_end(struct txn *txn, int err)
{
	int sent = send_kept(txn);

	return sent < 0 && err >= 0 ? sent : err;
}

int txn_wait(struct txn *txn, int64_t ns)
{
	int err = send_kept(txn);

	if (err)
		return err;
	/* what the chip does now is read when owsd runs again: that may be long after */
	txn->measured_ns = txn_now(txn);
	txn->wake_ns = txn->measured_ns + ns;
	return TXN_MORE;
}

void txn_done(struct txn *txn, const struct link_run *done)
{
	txn->done = done;
	txn->done_ns = 0;
}

int64_t txn_ended(const struct txn *txn)
{
	return txn->done_ns ? txn->done_ns : txn_now(txn);
}

static int keep(struct txn *txn, const uint8_t *bytes, size_t n)
{
	if (n > sizeof(txn->out))
		return -EINVAL;
	int err = n > sizeof(txn->out) - txn->out_n ? send_kept(txn) : 0;

	if (err)
		return err;
	if (n)
		memcpy(txn->out + txn->out_n, bytes, n);
	txn->out_n = (uint8_t)(txn->out_n + n);
	return 0;
}

static int begin_transaction(struct txn *txn, const uint8_t *bytes, size_t n)
{
	int err = send_kept(txn);

	if (err)
		return err;
	txn->resets = true;
	txn->has_read = false;
	return keep(txn, bytes, n);
}

int txn_raw_then(struct txn *txn, const uint8_t *bytes, size_t n, enum link_after after)
{
	int err = begin_transaction(txn, bytes, n);

	return err || after == LINK_IDLE ? err : run_part(txn, NULL, 0, after);
}

int txn_raw(struct txn *txn, const uint8_t *bytes, size_t n)
{
	return txn_raw_then(txn, bytes, n, LINK_IDLE);
}

size_t txn_select(const struct device *device, const uint8_t *bytes, size_t n, uint8_t *out)
{
	out[0] = MATCH_ROM;
	memcpy(out + 1, device->rom, 8);
	if (n)
		memcpy(out + TXN_SELECT, bytes, n);
	return TXN_SELECT + n;
}

static int send_command(struct txn *txn, const uint8_t *bytes, size_t n, enum link_after after)
{
	uint8_t out[TXN_SELECT + BYTES_MAX];

	assert(txn->device);
	if (n > BYTES_MAX)
		return -EINVAL;
	return txn_raw_then(txn, out, txn_select(txn->device, bytes, n, out), after);
}

/* The strong pull-up, or what takes its place. */
static int choose_pullup(const struct txn *txn, enum link_after *after)
{
	bool strong = txn->link->facts->strong;

	*after = strong ? LINK_STRONG : LINK_IDLE;
	return !strong && txn->device && device_is_fed(txn->device->power) ? -EOPNOTSUPP : 0;
}

static int hold_pullup(struct txn *txn, int err, int64_t ns)
{
	if (err < 0)
		return err;
	txn->strong = txn->link->facts->strong;
	return txn_wait(txn, ns);
}

int txn_command(struct txn *txn, const uint8_t *bytes, size_t n)
{
	return send_command(txn, bytes, n, LINK_IDLE);
}

int txn_command_wait(struct txn *txn, const uint8_t *bytes, size_t n, int64_t ns)
{
	int err = txn_command(txn, bytes, n);

	return err ? err : txn_wait(txn, ns);
}

int txn_command_strong(struct txn *txn, const uint8_t *bytes, size_t n, int64_t ns)
{
	enum link_after after;
	int err = choose_pullup(txn, &after);

	return err ? err : hold_pullup(txn, send_command(txn, bytes, n, after), ns);
}

int txn_write(struct txn *txn, const uint8_t *bytes, size_t n)
{
	return txn->has_read && !txn->link->facts->splits ? -EOPNOTSUPP : keep(txn, bytes, n);
}

int txn_write_paused(struct txn *txn, const uint8_t *bytes, size_t n, int64_t ns)
{
	const struct bus_env *env = txn->link->env;
	const struct link_facts *facts = txn->link->facts;
	bool external = txn->device && txn->device->power == POWER_EXTERNAL;

	if (!facts->splits || (!facts->strong && !external))
		return -EOPNOTSUPP;
	int err = keep(txn, bytes, n);

	if (!err)
		err = run_part(txn, NULL, 0, facts->strong ? LINK_STRONG : LINK_IDLE);
	if (!err && env->wait(env->ctx, -1, 0, bus_now(env) + ns) < 0)
		err = -ECANCELED;
	return err;
}

static void note_heard(struct txn *txn, const uint8_t *bytes, size_t n)
{
	bool zeros = n;

	txn->silent = true;
	for (size_t i = 0; i < n && (txn->silent || zeros); i++) {
		txn->silent &= bytes[i] == 0xff;
		zeros &= bytes[i] == 0;
	}
	txn->blank |= txn->silent || zeros;
	txn->heard |= !txn->silent;
}

int txn_read(struct txn *txn, uint8_t *bytes, size_t n)
{
	int err = run_part(txn, bytes, n, LINK_IDLE);

	if (err < 0)
		return err;
	note_heard(txn, bytes, n);
	return 0;
}

int txn_read_slots(struct txn *txn, uint8_t *bytes, size_t n)
{
	bool blank = txn->blank;
	int err = txn_read(txn, bytes, n);

	txn->blank = blank;
	return err;
}

static int slot(struct txn *txn, enum link_after after)
{
	int err = send_kept(txn);

	txn->has_read = true;
	return err ? err : of_link(txn, link_slot(txn->link, true, after));
}

int txn_bit(struct txn *txn)
{
	return slot(txn, LINK_IDLE);
}

int txn_bit_strong(struct txn *txn, int64_t ns)
{
	return hold_pullup(txn, slot(txn, LINK_STRONG), ns);
}

/*
 * The first of eight slots were ones, the rest is low. All but two bytes after that have to be low:
 * no id has so many zeros (after a disturbed Skip ROM a chip sends its id).
 */
static bool began_late(const uint8_t late[LATE])
{
	for (unsigned i = 2; i < LATE; i++)
		if (late[i])
			return false;
	return true;
}

int txn_started(struct txn *txn)
{
	uint8_t busy, late[LATE];

	/* A driver has waited for the end, or tells the error. */
	if (txn->link->driver)
		return 0;
	int err = txn_read_slots(txn, &busy, 1);
	if (err || !busy)
		return err;
	if (busy & (busy + 1))
		return -EBADMSG;
	memset(late, 0xff, sizeof(late));
	err = txn_read_slots(txn, late, sizeof(late));
	return err ? err : began_late(late) ? 0 : -EBADMSG;
}

int txn_checked(struct txn *txn, bool fits)
{
	txn->misread |= !fits;
	return fits ? 0 : -EBADMSG;
}

int txn_read_crc8(struct txn *txn, uint8_t *bytes, size_t n)
{
	int err = txn_read(txn, bytes, n);

	return err < 0 ? err : txn_checked(txn, rom_crc8(bytes, n) == 0);
}

int txn_read_crc16(struct txn *txn, const uint8_t *head, size_t head_n, uint8_t *bytes, size_t n)
{
	return txn_read_pages(txn, head, head_n, bytes, n, 1);
}

/* In one read: a link may lend its wire for no longer. */
int txn_read_pages(struct txn *txn, const uint8_t *head, size_t head_n, uint8_t *bytes, size_t n,
                   unsigned pages)
{
	uint8_t in[BYTES_MAX + 2];
	uint16_t start = onewire_crc16(0, head, head_n);

	assert(pages * (n + 2) <= sizeof(in));
	int err = txn_read(txn, in, pages * (n + 2));
	if (err < 0)
		return err;
	for (unsigned i = 0; i < pages; i++, start = 0) {
		const uint8_t *page = in + i * (n + 2);

		if (!onewire_crc16_matches(onewire_crc16(start, page, n), page + n))
			return txn_checked(txn, false);
		memcpy(bytes + i * n, page, n);
	}
	return 0;
}

int txn_ask(struct txn *txn, const uint8_t *command, size_t command_n, uint8_t *bytes, size_t n)
{
	int err = txn_command(txn, command, command_n);

	return err ? err : txn_read(txn, bytes, n);
}

int txn_ask_crc16(struct txn *txn, const uint8_t *command, size_t command_n, uint8_t *bytes,
                  size_t n)
{
	int err = txn_command(txn, command, command_n);

	return err ? err : txn_read_crc16(txn, command, command_n, bytes, n);
}

bool txn_driven(const struct txn *txn)
{
	return txn->link->driver && txn->link->driver->has(txn->link, txn->device->rom);
}

int txn_driver_read(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes, size_t n)
{
	const struct driver_ops *driver = txn->link->driver;
	int err = driver->area_read(txn->link, txn->device->rom, area, at, bytes, (unsigned)n);
	bool blank = txn->blank;

	txn->on_wire = true;
	txn->misread |= err == -EBADMSG;
	if (!err)
		note_heard(txn, bytes, n);
	txn->blank = blank; /* of most chips the driver has looked at a checksum: area.c knows */
	return err == -EBADE ? -EBADMSG : err;
}

int txn_driver_write(struct txn *txn, const struct area *area, unsigned at, const uint8_t *bytes,
                     size_t n)
{
	const struct driver_ops *driver = txn->link->driver;

	txn->on_wire = true;
	return driver->area_write(txn->link, txn->device->rom, area, at, bytes, (unsigned)n);
}

int txn_driver_convert(struct txn *txn, const char *what)
{
	txn->on_wire = true;
	return txn->link->driver->convert(txn->link, txn->device->rom, what);
}

int txn_verify(struct txn *txn, bool alarm)
{
	int err = send_kept(txn);

	if (err)
		return err;
	int there = of_link(txn, search_verify(txn->link, txn->device->rom, alarm));

	txn->heard |= there > 0;
	return there;
}

/*
 * A driver may stay in the kernel for long, between two of its files as well: nobody knows when in
 * its call the chip answered.
 */
static int64_t made_ns(const struct txn *txn, int64_t begun_ns)
{
	if (txn->measured_ns)
		return txn->measured_ns;
	return txn_driven(txn) ? begun_ns : txn_now(txn);
}

void txn_share(struct txn *txn, const void *what, unsigned at, const void *bytes, size_t n,
               int64_t begun_ns)
{
	struct device *device = txn->device;
	struct device_reading *place = device->readings;

	if (device->readings_of != device->changes)
		txn_void(txn);
	for (unsigned i = 0; i < DEVICE_READINGS; i++) {
		struct device_reading *reading = &device->readings[i];

		if (reading->what == what && reading->at == at) {
			place = reading;
			break;
		}
		if (reading->made_ns < place->made_ns)
			place = reading;
	}
	assert(n <= sizeof(place->bytes));
	*place = (struct device_reading){.what = what,
	                                 .at = (uint16_t)at,
	                                 .n = (uint16_t)n,
	                                 .begun_ns = begun_ns,
	                                 .made_ns = made_ns(txn, begun_ns)};
	memcpy(place->bytes, bytes, n);
	if (!txn->part_ns || place->made_ns < txn->part_ns)
		txn->part_ns = place->made_ns;
}

bool txn_shared(struct txn *txn, const void *what, unsigned at, void *bytes, size_t n)
{
	struct device *device = txn->device;

	if (device->readings_of != device->changes)
		return false;
	for (unsigned i = 0; i < DEVICE_READINGS; i++) {
		struct device_reading *reading = &device->readings[i];

		if (reading->what != what || reading->at > at ||
		    at + n > (size_t)reading->at + reading->n ||
		    (reading->begun_ns < txn->since_ns && reading->made_ns < txn->oldest_ns))
			continue;
		memcpy(bytes, reading->bytes + (at - reading->at), n);
		if (!txn->shared_ns || reading->made_ns < txn->shared_ns)
			txn->shared_ns = reading->made_ns;
		if (txn->once)
			reading->what = NULL;
		return true;
	}
	return false;
}

void txn_void(struct txn *txn)
{
	memset(txn->device->readings, 0, sizeof(txn->device->readings));
	txn->device->readings_of = txn->device->changes;
}

int64_t txn_measured(const struct txn *txn)
{
	int64_t measured = txn->measured_ns ? txn->measured_ns : txn_now(txn);

	if (txn->part_ns && txn->part_ns < measured)
		measured = txn->part_ns;
	return txn->shared_ns && txn->shared_ns < measured ? txn->shared_ns : measured;
}
