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
	bool ends;          /* it has the end of a pulse */
};

/* Of a pulse, in command mode. */
static void put_end(struct serial_master *master, struct stream *stream)
{
	if (!master->adapter.strong || stream->ends)
		return;
	stream->out[stream->out_n++] = END_PULSE;
	stream->in_n++;
	stream->ends = true;
}

static void put_command(struct serial_master *master, struct stream *stream, uint8_t command,
                        bool answered)
{
	if (master->data_mode)
		stream->out[stream->out_n++] = COMMAND_MODE;
	master->data_mode = false;
	put_end(master, stream);
	stream->out[stream->out_n++] = command;
	stream->in_n += answered;
}

static void put_data(struct serial_master *master, struct stream *stream, uint8_t byte)
{
	if (!master->data_mode) {
		put_end(master, stream);
		stream->out[stream->out_n++] = DATA_MODE;
	}
	master->data_mode = true;
	stream->out[stream->out_n++] = byte;
	if (byte == COMMAND_MODE)
		stream->out[stream->out_n++] = byte;
	stream->in_n++;
}

/* strong: the pull-up is on after it. After an error it may be, as it may where it was before. */
static int send(struct serial_master *master, struct stream *stream, bool strong)
{
	size_t got;

	master->adapter.strong |= strong;
	int err = serial_exchange(master, BAUD, stream->out, stream->out_n, stream->in,
	                          stream->in_n, &got);

	if (!err)
		master->adapter.strong = strong;
	return err;
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
static int ds2480b_settle(struct adapter *adapter)
{
	static const uint8_t out[] = {COMMAND_MODE, SEARCH_OFF, END_PULSE};
	struct serial_master *master = serial_of(adapter);
	int err = 0;

	for (unsigned i = 0; !err && i < 2; i++) {
		err = serial_settle(master);
		if (!err)
			err = master->port->ops->write(master->port, out, sizeof(out));
	}
	if (!err)
		err = serial_settle(master);
	if (!err) {
		master->data_mode = adapter->strong = false;
		err = ask_parameters(master);
	}
	return err;
}

/* Of a chip that answers a reset. A passive adapter gives back CALIBRATE, which is none. */
static bool is_chip(uint8_t answer)
{
	return (answer & RESET_MASK) == RESET_MASK && (answer & CHIP_MASK);
}

static int judge_reset(struct serial_master *master, uint8_t answer)
{
	master->adapter.cost.resets++;
	master->adapter.cost.wire_ns += RESET_NS;
	if (!is_chip(answer))
		return -EIO;
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
static int ds2480b_bits(struct adapter *adapter, uint8_t bits, unsigned n, bool strong)
{
	struct serial_master *master = serial_of(adapter);
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
	int err = send(master, &stream, strong);

	if (err)
		return err;
	const uint8_t *answer = stream.in + stream.in_n - n;

	master->adapter.cost.wire_ns += (uint64_t)n * SLOT_NS;
	if (strong && answer[-1] != ENDLESS)
		return -ENXIO;
	for (unsigned i = 0; i < n; i++) {
		unsigned line = answer[i] & RESULT;

		if (((answer[i] ^ command[i]) & ~(unsigned)RESULT) || (line != 0 && line != RESULT))
			return -EIO;
		back |= (line != 0) << i;
	}
	return back;
}

static int ds2480b_pass(struct adapter *adapter, bool reset, const uint8_t *out, size_t out_n,
                        uint8_t *in, size_t in_n)
{
	struct serial_master *master = serial_of(adapter);
	struct stream stream = {.out_n = 0};

	if (reset)
		put_command(master, &stream, RESET, true);
	for (size_t i = 0; i < out_n + in_n; i++)
		put_data(master, &stream, i < out_n ? out[i] : 0xFF);
	int err = send(master, &stream, false);
	const uint8_t *back = stream.in + stream.in_n - out_n - in_n;

	if (!err && reset)
		err = judge_reset(master, back[-1]);
	if (err)
		return err;
	master->adapter.cost.wire_ns += (out_n + in_n) * 8 * SLOT_NS;
	if (out_n && memcmp(back, out, out_n) != 0)
		return -EIO;
	if (in_n)
		memcpy(in, back + out_n, in_n);
	return 0;
}

/* Two bits for each of an id: the direction or what was taken, and below it the conflict. */
static int ds2480b_path(struct adapter *adapter, bool reset, uint8_t command, uint8_t rom[8],
                        uint8_t conflict[8])
{
	struct serial_master *master = serial_of(adapter);
	struct stream stream = {.out_n = 0};
	uint8_t answer[16];
	bool nobody = true;
	int err;

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
	err = send(master, &stream, false);
	const uint8_t *back = stream.in + stream.in_n - sizeof(answer) - 1;

	if (!err && reset)
		err = judge_reset(master, back[-1]);
	if (err)
		return err;
	master->adapter.cost.wire_ns += UINT64_C(200) * SLOT_NS;
	if (back[0] != command)
		return -EIO;
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
			master->adapter.name);
	else if ((answer | 1) == CALIBRATE)
		snprintf(why, size,
		         "%s gives back what is sent: a passive adapter, its target is uart:%s",
		         master->adapter.name, master->adapter.name);
	else
		snprintf(why, size, "what answers on %s is no DS2480B: it said 0x%02X to a reset",
		         master->adapter.name, answer);
}

/* Into the state after power-on, at the speed of power-on, with a time base. */
static int master_reset(struct serial_master *master)
{
	static const uint8_t low = 0, calibrate = CALIBRATE;
	struct serial_port *port = master->port;
	int err = serial_speed(master, BREAK_BAUD);

	port->ops->send_break(port);
	if (!err)
		err = port->ops->write(port, &low, 1);
	if (!err)
		err = adapter_wait(&master->adapter, 10 * NS_PER_MS);
	if (!err)
		err = serial_speed(master, BAUD);
	if (!err)
		err = serial_settle(master);
	if (!err)
		err = port->ops->write(port, &calibrate, 1);
	if (!err)
		err = serial_settle(master);
	if (!err)
		master->data_mode = master->adapter.strong = false;
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
			return -ENXIO;
		}
		err = serial_exchange(master, BAUD, parameters, sizeof(parameters), answer,
		                      sizeof(parameters), &got);
	}
	for (size_t i = 0; !err && i < sizeof(parameters); i++)
		if (answer[i] != (parameters[i] & 0xFE))
			err = -EIO;
	if (err) {
		snprintf(why, why_size, "%s: %s", master->adapter.name, strerror(-err));
	}
	return err;
}

static int ds2480b_renew(struct adapter *adapter)
{
	char why[BUS_EVENT_TEXT];

	return ds2480b_begin(serial_of(adapter), why, sizeof(why));
}

static const struct link_ops ds2480b_link = {
	.name = "DS2480B",
	ADAPTER_LINK_SLOTS,
};

const struct serial_kind serial_ds2480b = {
	.adapter = {.link = &ds2480b_link,
                    .facts = {.strong = true, .splits = true},
                    .piece = PIECE,
                    .settle = ds2480b_settle,
                    .pass = ds2480b_pass,
                    .bits = ds2480b_bits,
                    .path = ds2480b_path,
                    .renew = ds2480b_renew},
	.lag_ns = 8 * SLOT_NS + 10 * NS_PER_S / BAUD,
	.begin = ds2480b_begin,
};
