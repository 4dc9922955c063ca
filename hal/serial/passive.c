/* SPDX-License-Identifier: MIT */
/*
 * A passive adapter (DS9097) as a link: its diode and resistor join the two lines of the port to
 * the wire, so each byte that is sent is a pulse on the wire, and comes back as the wire had it
 * (Maxim application note 214). At 9600 baud F0 is a reset; at 115200 FF is a slot that writes 1 or
 * reads, and 00 one that writes 0. What comes back shows the pulse itself, or the port has another
 * speed, or there is no adapter. A search is a round trip for each bit, whose direction depends on
 * what was read; where it will lead to a known id all goes out at once, and the echo shows it.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/serial/passive.h"
#include "hal/wire/search.h"

#define RESET_BAUD 9600
#define SLOT_BAUD 115200
#define RESET_NS 1041667
#define SLOT_NS 86806
enum { RESET = 0xF0, ONE = 0xFF, ZERO = 0x00 };

#define PIECE 32 /* bytes of data at once: a byte of the line for each of their bits */

/* What still comes from before belongs to nothing. */
static int passive_settle(struct adapter *adapter)
{
	return serial_settle(serial_of(adapter));
}

static int exchange(struct serial_master *master, unsigned baud, const uint8_t *out, uint8_t *in,
                    size_t n)
{
	size_t got;
	int err = serial_exchange(master, baud, out, n, in, n, &got);

	return err == -ENOTTY ? -EIO : err;
}

/*
 * The first four bits are the pulse itself, which is low whatever answers: with others the speed is
 * wrong, or the byte is not an echo. A slave holds the line low somewhere in the rest. At a speed
 * that another program has set, nobody takes it for a reset, and the echo is right: it is set again
 * where nobody answers.
 */
static int reset(struct serial_master *master)
{
	static const uint8_t out = RESET;
	uint8_t in = 0;
	int err = exchange(master, RESET_BAUD, &out, &in, 1);

	if (err)
		return err;
	master->adapter.cost.resets++;
	master->adapter.cost.wire_ns += RESET_NS;
	if (in == 0)
		return -ECOMM;
	if (in & 0x0F)
		return -EIO;
	if (in != RESET)
		return 0;
	master->baud = 0;
	return -EHOSTDOWN;
}

static int slots(struct serial_master *master, const uint8_t *line, uint8_t *back, size_t n)
{
	int err = exchange(master, SLOT_BAUD, line, back, n);

	if (!err)
		master->adapter.cost.wire_ns += n * SLOT_NS;
	return err;
}

static int passive_pass(struct adapter *adapter, bool anew, const uint8_t *out, size_t out_n,
                        uint8_t *in, size_t in_n)
{
	struct serial_master *master = serial_of(adapter);
	uint8_t line[8 * PIECE], back[8 * PIECE];
	size_t n = 8 * (out_n + in_n);
	int err = anew ? reset(master) : 0;

	for (size_t i = 0; i < n; i++)
		line[i] = i / 8 >= out_n || (out[i / 8] >> i % 8 & 1) ? ONE : ZERO;
	if (!err && n)
		err = slots(master, line, back, n);
	if (err)
		return err;
	if (in_n)
		memset(in, 0, in_n);
	for (size_t i = 0; i < n; i++) {
		if (i / 8 >= out_n)
			in[i / 8 - out_n] |= (uint8_t)((back[i] & 1) << i % 8);
		else if ((back[i] ^ line[i]) & 1)
			return -EIO;
	}
	return 0;
}

/* A slot alone: there is no strong pull-up, and so no byte before one. */
static int passive_bits(struct adapter *adapter, uint8_t bit, unsigned n, bool strong)
{
	uint8_t line = bit ? ONE : ZERO, back = 0;
	int err = slots(serial_of(adapter), &line, &back, 1);

	(void)n, (void)strong;
	return err ? err : back & 1;
}

/* The slots of a search: its command; for each bit of an id it, its complement, the direction. */
#define COMMAND 8
#define SLOTS (COMMAND + 3 * 64)
enum { BIT, COMPLEMENT, DIRECTION };

static unsigned bit_of(const uint8_t bits[8], unsigned i)
{
	return bits[i / 8] >> i % 8 & 1;
}

static unsigned what_is(unsigned slot)
{
	return slot < COMMAND ? DIRECTION : (slot - COMMAND) % 3;
}

/*
 * The slots whose directions are known go out at once, the others bit by bit. The first `sure` bits
 * of id are; all become those of the device that is found. Returns 0, an error, or how many bits
 * are right now: the direction that was written after them was not.
 */
static int follow(struct serial_master *master, uint8_t command, const uint8_t wanted[8],
                  unsigned sure, uint8_t id[8], uint8_t conflict[8])
{
	unsigned known = COMMAND + 3 * sure + DIRECTION, to;
	uint8_t line[SLOTS], back[SLOTS];

	memset(conflict, 0, 8);
	for (unsigned from = 0; from < SLOTS; from = to) {
		to = from < known ? known : from + 3;
		if (to > SLOTS)
			to = SLOTS;
		for (unsigned i = from, one; i < to; i++) {
			one = i < COMMAND ? command >> i & 1 : bit_of(id, (i - COMMAND) / 3);
			line[i] = what_is(i) == DIRECTION && !one ? ZERO : ONE;
		}
		int err = slots(master, line + from, back + from, to - from);

		for (unsigned i = from; !err && i < to; i++) {
			unsigned bit = (i - COMMAND) / 3;

			if (what_is(i) == DIRECTION && ((back[i] ^ line[i]) & 1))
				err = -EIO;
			if (what_is(i) != COMPLEMENT)
				continue;
			unsigned is = back[i - 1] & 1, both = is == (back[i] & 1);
			unsigned taken = both ? bit_of(wanted, bit) : is;
			unsigned wrong = taken ^ bit_of(id, bit);

			if (both && is)
				return bit ? -EBADMSG : -EHOSTDOWN;
			conflict[bit / 8] |= (uint8_t)(both << bit % 8);
			id[bit / 8] ^= (uint8_t)(wrong << bit % 8);
			if (wrong && i + 1 < to)
				return (int)bit + 1;
		}
		if (err)
			return err;
	}
	return 0;
}

/* In a search for alarms any of the known ones may be missing. */
static int passive_path(struct adapter *adapter, bool anew, uint8_t command, uint8_t rom[8],
                        uint8_t conflict[8])
{
	struct serial_master *master = serial_of(adapter);
	bool all = command == ONEWIRE_SEARCH;
	int expected = anew && all ? known_expect(&master->known, rom) : -1;
	uint8_t id[8] = {0};
	int err = anew ? reset(master) : 0;

	if (expected >= 0)
		memcpy(id, master->known.id[expected], sizeof(id));
	if (!err)
		err = follow(master, command, rom, expected >= 0 ? 64 : 0, id, conflict);
	if (err > 0) {
		unsigned sure = (unsigned)err;

		err = reset(master);
		if (!err)
			err = follow(master, command, rom, sure, id, conflict);
	}
	if (err)
		return err < 0 ? err : -EBADMSG;
	if (all)
		known_found(&master->known, expected, id);
	memcpy(rom, id, sizeof(id));
	return 0;
}

static int passive_begin(struct serial_master *master, char *why, size_t why_size)
{
	int err = passive_settle(&master->adapter);

	if (!err)
		err = reset(master);
	if (!err || err == -EHOSTDOWN || err == -ECOMM)
		err = serial_speed(master, SLOT_BAUD);
	if (err == -ETIMEDOUT) {
		snprintf(why, why_size,
		         "nothing comes back from %s: no passive adapter; one with a DS2480B "
		         "(DS9097U, LinkUSB) is serial:%s",
		         master->adapter.name, master->adapter.name);
		return -ENXIO;
	}
	if (err == -ENOTTY)
		snprintf(why, why_size,
		         "%s cannot have the speeds of a passive adapter, 9600 and 115200",
		         master->adapter.name);
	else if (err == -EIO)
		snprintf(why, why_size,
		         "%s does not give back what is sent: no passive adapter, or its speed is "
		         "not what was set",
		         master->adapter.name);
	else if (err)
		snprintf(why, why_size, "%s: %s", master->adapter.name, strerror(-err));
	return err;
}

static const struct link_ops passive_link = {
	.name = "passive adapter",
	ADAPTER_LINK_SLOTS,
};

const struct serial_kind serial_passive = {
	.adapter = {.link = &passive_link,
                    .facts = {.splits = true},
                    .piece = PIECE,
                    .settle = passive_settle,
                    .pass = passive_pass,
                    .bits = passive_bits,
                    .path = passive_path},
	.lag_ns = SLOT_NS / 10, /* it comes as it goes: a bit for what the port's own time is off */
	.begin = passive_begin,
};
