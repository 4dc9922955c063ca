/* SPDX-License-Identifier: MIT */
/*
 * The DS2480B (DS9097U, LINK and LinkUSB in emulation) as a link; data sheet Maxim 19-5047.
 *
 * It has one byte of buffer. At 9600 baud a byte takes the line longer (1.04 ms) than the wire
 * (0.56 ms), so a whole transaction goes out in one write and is never too fast; the only command
 * that takes longer, the reset (1.1 ms), is followed by one that takes nothing. A quicker line
 * would need an answer before each byte, which costs more than it gains: a USB adapter holds
 * answers back for a millisecond and more. Each byte of data comes back as the wire had it, so
 * whatever is lost or added on the way shows. A search is one round trip for each device, by the
 * accelerator. Before a strong pull-up the chip is asked whether it still has its settings.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/serial/ds2480b.h"

#define BAUD 9600
#define BREAK_BAUD 4800 /* a NUL at this speed is low for longer than a byte at 9600 */
#define RESET_NS (1096 * INT64_C(1000))
#define SLOT_NS 69400

/* The mode, and the end of a pulse without end. */
enum { DATA_MODE = 0xE1, COMMAND_MODE = 0xE3, END_PULSE = 0xF1 };
/* Commands in flexible speed, which long lines need: the slew rate and times set below count. */
enum { RESET = 0xC5, BIT_0 = 0x85, BIT_1 = 0x95, SEARCH_ON = 0xB5, SEARCH_OFF = 0xA5 };
enum { THEN_STRONG = 0x02 }; /* after a bit: the strong pull-up */
/* The first reset after a break, from which the chip takes its time base. */
enum { CALIBRATE = 0xC1 };
/* The answer to a reset. */
enum { RESULT = 0x03, SHORT = 0, NOBODY = 3, RESET_MASK = 0xC0, CHIP_MASK = 0x1C };

/* Parameters (data sheet, tables 4 and 5); the answer to each is it without bit 0. */
static const uint8_t parameters[] = {
	0x17, /* slew rate 1.37 V/us */
	0x3F, /* strong pull-up until END_PULSE */
	0x45, /* write-1 low time 10 us */
	0x5B, /* sample offset and write-0 recovery 8 us */
};

/* Reads how long the strong pull-up lasts, and the answer that it has no end. */
enum { READ_STRONG = 0x07, ENDLESS = 0x0E };

#define PIECE 64 /* bytes of data of one write */
/* Bytes of data are doubled at most; before and between them are a few commands. */
struct stream {
	uint8_t out[2 * PIECE + 16], in[PIECE + 16];
	size_t out_n, in_n; /* in_n: how many answers there will be */
};

static void put_command(struct serial_master *master, struct stream *stream, uint8_t command,
                        bool answered)
{
	if (master->data_mode)
		stream->out[stream->out_n++] = COMMAND_MODE;
	master->data_mode = false;
	if (master->strong)
		stream->out[stream->out_n++] = END_PULSE;
	stream->in_n += master->strong;
	master->strong = false;
	stream->out[stream->out_n++] = command;
	stream->in_n += answered;
}

static void put_data(struct serial_master *master, struct stream *stream, uint8_t byte)
{
	if (!master->data_mode) {
		if (master->strong)
			stream->out[stream->out_n++] = END_PULSE;
		stream->in_n += master->strong;
		master->strong = false;
		stream->out[stream->out_n++] = DATA_MODE;
	}
	master->data_mode = true;
	stream->out[stream->out_n++] = byte;
	if (byte == COMMAND_MODE)
		stream->out[stream->out_n++] = byte;
	stream->in_n++;
}

/* After an error the mode is not known; nor is what is still to come. */
static int lose(struct serial_master *master, int err)
{
	master->lost = true;
	return err;
}

static int send(struct serial_master *master, struct stream *stream)
{
	size_t got;
	int err = serial_exchange(master, BAUD, stream->out, stream->out_n, stream->in,
	                          stream->in_n, &got);

	return err ? lose(master, err) : 0;
}

/* -ENXIO: the chip was without supply, and has forgotten its parameters. */
static int ask_parameters(struct serial_master *master)
{
	static const uint8_t ask = READ_STRONG;
	uint8_t answer = 0;
	size_t got;
	int err = serial_exchange(master, BAUD, &ask, 1, &answer, 1, &got);

	return err ? err : answer == ENDLESS ? 0 : -ENXIO;
}

/*
 * Back to command mode, whatever the adapter does: out of data mode, the accelerator off, the end
 * of a pulse. Twice, since the first byte may be the second of a doubled one.
 */
static int resync(struct serial_master *master)
{
	static const uint8_t out[] = {COMMAND_MODE, SEARCH_OFF, END_PULSE};
	int err = master->port ? 0 : -ENODEV;

	for (unsigned i = 0; !err && i < 2; i++) {
		err = serial_settle(master);
		if (!err)
			err = master->port->ops->write(master->port, out, sizeof(out));
	}
	if (!err)
		err = serial_settle(master);
	master->data_mode = master->strong = false;
	if (!err)
		err = ask_parameters(master);
	master->lost = err != 0;
	return err;
}

/* Of a chip that answers a reset. A passive adapter gives back CALIBRATE, which is none. */
static bool is_chip(uint8_t answer)
{
	return (answer & RESET_MASK) == RESET_MASK && (answer & CHIP_MASK);
}

static int judge_reset(struct serial_master *master, uint8_t answer)
{
	master->cost.resets++;
	master->cost.wire_ns += RESET_NS;
	if (!is_chip(answer))
		return lose(master, -EIO);
	switch (answer & RESULT) {
	case SHORT:
		return -ECOMM;
	case NOBODY:
		return -EHOSTDOWN;
	default:
		return 0;
	}
}

/*
 * Slots by single bits, after the last one the strong pull-up: that after a byte of data would have
 * to end by itself. A chip that was without supply has forgotten how long it lasts. Returns what
 * the wire had, or an error.
 */
static int run_bits(struct serial_master *master, uint8_t bits, unsigned n, bool strong)
{
	struct stream stream = {.out_n = 0};
	uint8_t command[8];
	int back = 0;

	if (strong)
		put_command(master, &stream, READ_STRONG, true);
	for (unsigned i = 0; i < n; i++) {
		command[i] = (uint8_t)((bits >> i & 1 ? BIT_1 : BIT_0) |
		                       (strong && i + 1 == n ? THEN_STRONG : 0));
		put_command(master, &stream, command[i], true);
	}
	int err = send(master, &stream);

	if (err)
		return err;
	const uint8_t *answer = stream.in + stream.in_n - n;

	master->cost.wire_ns += (uint64_t)n * SLOT_NS;
	master->strong = strong;
	if (strong && answer[-1] != ENDLESS)
		return lose(master, -ENXIO);
	for (unsigned i = 0; i < n; i++) {
		unsigned line = answer[i] & RESULT;

		if (((answer[i] ^ command[i]) & ~(unsigned)RESULT) || (line != 0 && line != RESULT))
			return lose(master, -EIO);
		back |= (line != 0) << i;
	}
	return back;
}

/* A reset, if it is asked for, and up to PIECE bytes of what is written and then read. */
static int run_piece(struct serial_master *master, bool reset, const uint8_t *out, size_t out_n,
                     uint8_t *in, size_t in_n)
{
	struct stream stream = {.out_n = 0};

	if (reset)
		put_command(master, &stream, RESET, true);
	for (size_t i = 0; i < out_n + in_n; i++)
		put_data(master, &stream, i < out_n ? out[i] : 0xFF);
	int err = send(master, &stream);
	const uint8_t *back = stream.in + stream.in_n - out_n - in_n;

	if (!err && reset)
		err = judge_reset(master, back[-1]);
	if (err)
		return err;
	master->cost.wire_ns += (out_n + in_n) * 8 * SLOT_NS;
	if (out_n && memcmp(back, out, out_n) != 0)
		return lose(master, -EIO);
	if (in_n)
		memcpy(in, back + out_n, in_n);
	return 0;
}

/* After an error what went before is not known. */
static int prepare(struct serial_master *master, bool reset)
{
	return !master->lost ? 0 : reset ? resync(master) : -EIO;
}

static int ds2480b_run(struct link *base, const struct link_part *part)
{
	struct serial_master *master = serial_of(base);
	size_t strong = part->after == LINK_STRONG && part->out_n;
	size_t out_n = part->out_n - strong, out_at = 0, in_at = 0;
	bool reset = part->reset;
	int err = prepare(master, reset);

	if (!err && !reset && !out_n && !part->in_n && !strong)
		return 0;
	while (!err && (reset || out_at < out_n || (!strong && in_at < part->in_n))) {
		size_t out = out_n - out_at < PIECE ? out_n - out_at : PIECE;
		size_t in = part->in_n - in_at; /* none while out fills the piece */

		if (in > PIECE - out)
			in = PIECE - out;
		err = run_piece(master, reset, part->out + out_at, out, part->in + in_at, in);
		reset = false;
		out_at += out;
		in_at += in;
	}
	if (err || !strong)
		return err;
	int back = run_bits(master, part->out[out_n], 8, true);

	return back < 0 ? back : back == part->out[out_n] ? 0 : lose(master, -EIO);
}

static int ds2480b_slot(struct link *base, bool out, enum link_after after)
{
	struct serial_master *master = serial_of(base);

	return master->lost ? -EIO : run_bits(master, out, 1, after == LINK_STRONG);
}

/* Two bits for each of an id: the direction or what was taken, and below it the conflict. */
static int ds2480b_path(struct link *base, bool reset, uint8_t command, uint8_t rom[8],
                        uint8_t conflict[8])
{
	struct serial_master *master = serial_of(base);
	struct stream stream = {.out_n = 0};
	uint8_t answer[16];
	bool nobody = true;
	int err = prepare(master, reset);

	if (err)
		return err;
	if (reset)
		put_command(master, &stream, RESET, true);
	put_data(master, &stream, command);
	put_command(master, &stream, SEARCH_ON, false);
	for (unsigned i = 0; i < 16; i++) {
		uint8_t four = rom[i / 2] >> i % 2 * 4 & 0x0F, byte = 0;

		for (unsigned bit = 0; bit < 4; bit++)
			byte |= (uint8_t)((four >> bit & 1) << (2 * bit + 1));
		put_data(master, &stream, byte);
	}
	put_command(master, &stream, SEARCH_OFF, false);
	err = send(master, &stream);
	const uint8_t *back = stream.in + stream.in_n - sizeof(answer) - 1;

	if (!err && reset)
		err = judge_reset(master, back[-1]);
	if (err)
		return err;
	master->cost.wire_ns += UINT64_C(200) * SLOT_NS;
	if (back[0] != command)
		return lose(master, -EIO);
	memcpy(answer, back + 1, sizeof(answer));
	memset(rom, 0, 8);
	memset(conflict, 0, 8);
	for (unsigned i = 0; i < 64; i++) {
		unsigned two = answer[i / 4] >> i % 4 * 2 & 3;

		rom[i / 8] |= (uint8_t)((two >> 1) << i % 8);
		conflict[i / 8] |= (uint8_t)((two & 1) << i % 8);
		nobody &= two == 3;
	}
	return nobody ? -EHOSTDOWN : answer[15] >> 6 == 3 ? -EBADMSG : 0;
}

/* What answers in place of a DS2480B. */
static void explain(const struct serial_master *master, bool answered, uint8_t answer, char *why,
                    size_t size)
{
	if (!answered)
		snprintf(
			why, size,
			"nothing answers on %s: is a DS2480B there (DS9097U, LinkUSB), and does it "
			"have its supply?",
			master->name);
	else if ((answer | 1) == CALIBRATE)
		snprintf(why, size,
		         "%s gives back what is sent: a passive adapter, its target is uart:%s",
		         master->name, master->name);
	else
		snprintf(why, size, "what answers on %s is no DS2480B: it said 0x%02X to a reset",
		         master->name, answer);
}

/* Into the state after power-on, at the speed of power-on, with a time base. */
static int master_reset(struct serial_master *master)
{
	static const uint8_t low = 0, calibrate = CALIBRATE;
	struct serial_port *port = master->port;
	int err = port->ops->speed(port, BREAK_BAUD);

	port->ops->send_break(port);
	if (!err)
		err = port->ops->write(port, &low, 1);
	if (!err)
		err = serial_wait(master, 10 * NS_PER_MS);
	if (!err)
		err = port->ops->speed(port, BAUD);
	if (!err)
		err = serial_settle(master);
	if (!err)
		err = port->ops->write(port, &calibrate, 1);
	if (!err)
		err = serial_settle(master);
	master->data_mode = master->strong = false;
	return err;
}

static int ds2480b_begin(struct serial_master *master, char *why, size_t why_size)
{
	static const uint8_t reset = CALIBRATE;
	uint8_t answer[sizeof(parameters)] = {0};
	size_t got = 0;
	int err = master_reset(master);

	if (!err)
		err = serial_exchange(master, BAUD, &reset, 1, answer, 1, &got);
	if (!err || err == -ETIMEDOUT) {
		if (!got || !is_chip(answer[0])) {
			explain(master, got, answer[0], why, why_size);
			return lose(master, -ENXIO);
		}
		err = serial_exchange(master, BAUD, parameters, sizeof(parameters), answer,
		                      sizeof(parameters), &got);
	}
	for (size_t i = 0; !err && i < sizeof(parameters); i++)
		if (answer[i] != (parameters[i] & 0xFE))
			err = -EIO;
	if (err) {
		snprintf(why, why_size, "%s: %s", master->name, strerror(-err));
		return lose(master, err);
	}
	master->lost = false;
	return 0;
}

static int ds2480b_recover(struct link *base, enum link_rung rung)
{
	struct serial_master *master = serial_of(base);
	const struct link_part reset = {.reset = true};
	char why[BUS_EVENT_TEXT];
	int err;

	if (!master->port)
		return -ENODEV;
	if (rung == LINK_POWER_CYCLE)
		return -EOPNOTSUPP;
	if (rung == LINK_CHIP_RESET) {
		err = ds2480b_begin(master, why, sizeof(why));
		if (err)
			return err;
	}
	master->lost |= rung == LINK_BUS_RESET;
	err = ds2480b_run(base, &reset);
	return err == -EHOSTDOWN ? 0 : err;
}

static const struct link_ops ds2480b_link = {
	.name = "DS2480B",
	.recover = ds2480b_recover,
	.run = ds2480b_run,
	.slot = ds2480b_slot,
	.path = ds2480b_path,
	.cost = serial_cost,
};

const struct serial_kind serial_ds2480b = {
	.link = &ds2480b_link,
	.facts = {.strong = true, .splits = true},
	.lag_ns = 8 * SLOT_NS + 10 * NS_PER_S / BAUD,
	.begin = ds2480b_begin,
};
