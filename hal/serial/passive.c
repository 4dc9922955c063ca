/* SPDX-License-Identifier: MIT */
/*
 * A passive adapter (DS9097) as a link: its diode and resistor join the two lines of the port to
 * the wire, so each byte that is sent is a pulse on the wire, and comes back as the wire had it
 * (Maxim application note 214). At 9600 baud F0 is a reset; at 115200 FF is a slot that writes 1 or
 * reads, and 00 one that writes 0. What comes back shows the pulse itself, or the port has another
 * speed, or there is no adapter. A search is a round trip for each bit.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/serial/passive.h"

#define RESET_BAUD 9600
#define SLOT_BAUD 115200
#define RESET_NS 1041667
#define SLOT_NS 86806
enum { RESET = 0xF0, ONE = 0xFF, ZERO = 0x00 };

#define PIECE 16 /* bytes of data at once: a byte of the line for each of their bits */

static int set_speed(struct serial_master *master, unsigned baud)
{
	int err;

	if (!master->port)
		return -ENODEV;
	if (master->baud == baud)
		return 0;
	err = master->port->ops->speed(master->port, baud);
	master->baud = err ? 0 : baud;
	return err;
}

/* What still comes from before belongs to nothing. */
static int pass(struct serial_master *master, unsigned baud, const uint8_t *out, uint8_t *in,
                size_t n)
{
	size_t got;
	int err = master->lost ? serial_settle(master) : 0;

	if (!err)
		err = set_speed(master, baud);
	if (!err)
		err = serial_exchange(master, baud, out, n, in, n, &got);
	master->lost = err != 0;
	return err == -ENOTTY ? -EIO : err;
}

/*
 * The first four bits are the pulse itself, which is low whatever answers: with others the speed is
 * wrong, or the byte is not an echo. A slave holds the line low somewhere in the rest.
 */
static int reset(struct serial_master *master)
{
	static const uint8_t out = RESET;
	uint8_t in = 0;
	int err = pass(master, RESET_BAUD, &out, &in, 1);

	if (err)
		return err;
	master->cost.resets++;
	master->cost.wire_ns += RESET_NS;
	if (in == 0)
		return -ECOMM;
	if (in & 0x0F) {
		master->lost = true;
		return -EIO;
	}
	return in == RESET ? -EHOSTDOWN : 0;
}

/* Write and read slots: -EIO where a 0 did not come back as one, or a written 1 did not. */
static int run_piece(struct serial_master *master, const uint8_t *out, uint8_t *in, size_t n)
{
	uint8_t line[8 * PIECE], back[8 * PIECE];

	for (size_t i = 0; i < 8 * n; i++)
		line[i] = !out || (out[i / 8] >> i % 8 & 1) ? ONE : ZERO;
	int err = pass(master, SLOT_BAUD, line, back, 8 * n);

	if (err)
		return err;
	master->cost.wire_ns += 8 * n * SLOT_NS;
	if (in)
		memset(in, 0, n);
	for (size_t i = 0; i < 8 * n; i++) {
		if (out && (back[i] & 1) != (line[i] & 1)) {
			master->lost = true;
			return -EIO;
		}
		if (in)
			in[i / 8] |= (uint8_t)((back[i] & 1) << i % 8);
	}
	return 0;
}

static int passive_run(struct link *base, const struct link_part *part)
{
	struct serial_master *master = serial_of(base);
	int err = 0;

	if (part->after == LINK_STRONG)
		return -EOPNOTSUPP;
	if (master->lost && !part->reset)
		return -EIO; /* what went before is not known */
	if (part->reset)
		err = reset(master);
	for (size_t at = 0, n; !err && at < part->out_n; at += n) {
		n = part->out_n - at < PIECE ? part->out_n - at : PIECE;
		err = run_piece(master, part->out + at, NULL, n);
	}
	for (size_t at = 0, n; !err && at < part->in_n; at += n) {
		n = part->in_n - at < PIECE ? part->in_n - at : PIECE;
		err = run_piece(master, NULL, part->in + at, n);
	}
	return err;
}

static int passive_slot(struct link *base, bool out, enum link_after after)
{
	struct serial_master *master = serial_of(base);
	uint8_t line = out ? ONE : ZERO, back = 0;

	if (after == LINK_STRONG)
		return -EOPNOTSUPP;
	if (master->lost)
		return -EIO;
	int err = pass(master, SLOT_BAUD, &line, &back, 1);

	if (err)
		return err;
	master->cost.wire_ns += SLOT_NS;
	return back & 1;
}

static void set_bit(uint8_t bits[8], unsigned i, bool on)
{
	uint8_t mask = (uint8_t)(1 << i % 8);

	bits[i / 8] = (uint8_t)(on ? bits[i / 8] | mask : bits[i / 8] & ~mask);
}

/* The direction goes out with the two slots of the next bit: one exchange for each bit of an id. */
static int passive_path(struct link *base, uint8_t command, uint8_t rom[8], uint8_t conflict[8])
{
	struct serial_master *master = serial_of(base);
	uint8_t line[3] = {ONE, ONE, ONE}, back[3] = {ONE};
	const struct link_part part = {.out = &command, .out_n = 1};
	int err = passive_run(base, &part);

	for (unsigned i = 0; !err && i <= 64; i++) {
		unsigned first = i == 0, n = i == 0 ? 2 : i == 64 ? 1 : 3;
		bool id, complement, taken;

		err = pass(master, SLOT_BAUD, line + first, back + first, n);
		if (!err && !line[0] && (back[0] & 1)) {
			master->lost = true;
			err = -EIO;
		}
		if (err || i == 64)
			break;
		id = back[1] & 1;
		complement = back[2] & 1;
		if (id && complement)
			err = i == 0 ? -EHOSTDOWN : -EBADMSG;
		taken = id == complement ? rom[i / 8] >> i % 8 & 1 : id;
		set_bit(conflict, i, id == complement);
		set_bit(rom, i, taken);
		line[0] = taken ? ONE : ZERO;
	}
	master->cost.wire_ns += UINT64_C(192) * SLOT_NS;
	return err;
}

static int passive_begin(struct serial_master *master, char *why, size_t why_size)
{
	int err;

	master->lost = true;
	err = reset(master);
	if (!err || err == -EHOSTDOWN || err == -ECOMM)
		err = set_speed(master, SLOT_BAUD);
	if (err == -ETIMEDOUT) {
		snprintf(why, why_size,
		         "nothing comes back from %s: no passive adapter; one with a DS2480B "
		         "(DS9097U, LinkUSB) is serial:%s",
		         master->name, master->name);
		return -ENXIO;
	}
	if (err == -ENOTTY)
		snprintf(why, why_size,
		         "%s cannot have the speeds of a passive adapter, 9600 and 115200",
		         master->name);
	else if (err == -EIO)
		snprintf(why, why_size,
		         "%s does not give back what is sent: no passive adapter, or its speed is "
		         "not what was set",
		         master->name);
	else if (err)
		snprintf(why, why_size, "%s: %s", master->name, strerror(-err));
	return err;
}

/* The adapter has no state: what can be out of step is what has come and was not read. */
static int passive_recover(struct link *base, enum link_rung rung)
{
	struct serial_master *master = serial_of(base);

	if (rung != LINK_BUS_RESET)
		return -EOPNOTSUPP;
	master->lost = true;
	int err = reset(master);

	return err == -EHOSTDOWN ? 0 : err;
}

static const struct link_ops passive_link = {
	.name = "passive adapter",
	.recover = passive_recover,
	.run = passive_run,
	.slot = passive_slot,
	.path = passive_path,
	.cost = serial_cost,
};

const struct serial_kind serial_passive = {
	.link = &passive_link,
	.facts = {.splits = true},
	.lag_ns = SLOT_NS / 10, /* it comes as it goes: a bit for what the port's own time is off */
	.begin = passive_begin,
};
