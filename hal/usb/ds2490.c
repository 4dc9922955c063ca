/* SPDX-License-Identifier: MIT */
/*
 * The DS2490 (DS9490R) as a link; data sheet Maxim 19-4993.
 *
 * A command is a control transfer; its bytes go by one bulk endpoint, and come back as the wire
 * had them by another; the interrupt endpoint has the state of the chip and the results of
 * commands. A result has no place of its own, so each command is waited for before the next one
 * goes out, and what is counted there has to be what was asked for. Nobody clears what an error
 * leaves in the buffers but this file: without that the answer of one transaction is taken for
 * that of the next. So after any error the chip is halted, its three buffers are flushed, and it
 * has to be idle; where that does not help, and where the chip says that it lost a command (EP0F),
 * it is reset. 64 bytes go out at once, and are compared with what comes back. The search is the
 * chip's macro, one id at a time, so that branches of a DS2409 are searched too.
 */
#include <errno.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/usb/ds2490.h"
#include "hal/wire/search.h"

#define US INT64_C(1000)
#define RESET_NS (1096 * US)
#define SLOT_NS (69 * US) /* flexible speed as at power-on: long lines need it */
#define LATE_NS (100 * NS_PER_MS)
#define LOOK_NS (500 * US) /* the state can be read each ms */
#define LOOKS 2            /* idle so often: the command has ended, and has nothing to say */

#define PIECE 64 /* bytes of one packet; the buffers take two */
#define STATE_MAX 32

/* Requests, and their values (appendices 1 to 3). */
enum { CONTROL, COMMUNICATION, MODE };
enum {
	RESET_DEVICE = 0x00,
	RESUME = 0x02,
	HALT_IDLE = 0x03,
	FLUSH_COMMANDS = 0x07,
	FLUSH_IN = 0x08,
	FLUSH_OUT = 0x09,
};
enum { PULSE_ENABLE = 0x00, SPEED = 0x02, PULL_UP = 0x03 };
enum { PULSE_STRONG = 0x02, FLEXIBLE = 0x01, ENDLESS = 0x00 };
enum {
	BIT_IO = 0x20,
	RESET_WIRE = 0x42,
	BYTE_IO = 0x52,
	BLOCK_IO = 0x74,
	SEARCH_ACCESS = 0xF4,
};
/* At once; the bit to be written; list ids; the result in any case; the wire's conflicts. */
enum { NOW = 0x0001, ONE = 0x0008, LIST = 0x0008, TELL = 0x0400, CONFLICTS = 0x4000 };
/* Clear the buffers if the command before has failed; the strong pull-up after it. */
enum { FLUSH = 0x0800, THEN_STRONG = 0x1000 };

#define ARRIVED 0xA5 /* in place of a result: a device has come to the wire */

static struct ds2490 *chip_of(struct link *link)
{
	return (struct ds2490 *)link;
}

int ds2490_parse(const uint8_t *bytes, int n, struct ds2490_state *state)
{
	if (n < 16)
		return -EIO;
	*state = (struct ds2490_state){
		.speed = bytes[1],
		.pull_up = bytes[2],
		.flags = bytes[8],
		.commands = bytes[11],
		.out = bytes[12],
		.in = bytes[13],
	};
	for (int i = 16; i < n; i++) {
		if (bytes[i] == ARRIVED)
			continue;
		state->told = true;
		state->results |= bytes[i];
	}
	return 0;
}

/* What the chip does now is not known: the next transaction clears its buffers. */
static int lose(struct ds2490 *chip, int err)
{
	chip->lost = true;
	return err;
}

static int control(struct ds2490 *chip, unsigned request, unsigned value, unsigned index)
{
	chip->shared.transfers++;
	return chip->port->ops->control(chip->port, (uint8_t)request, (uint16_t)value,
	                                (uint16_t)index);
}

/* All of them, of a bulk endpoint. */
static int transfer(struct ds2490 *chip, uint8_t endpoint, uint8_t *bytes, size_t n)
{
	chip->shared.transfers++;
	chip->shared.bytes += n;
	int done = chip->port->ops->transfer(chip->port, endpoint, bytes, n);

	return done < 0 ? done : (size_t)done == n ? 0 : -EIO;
}

static int wait_for(struct ds2490 *chip, int64_t ns)
{
	const struct bus_env *env = chip->link.env;

	return env->wait(env->ctx, -1, 0, bus_now(env) + ns) < 0 ? -ECANCELED : 0;
}

static int look(struct ds2490 *chip, struct ds2490_state *state)
{
	uint8_t bytes[STATE_MAX];

	chip->shared.transfers++;
	int n = chip->port->ops->transfer(chip->port, USB_STATE, bytes, sizeof(bytes));

	return n < 0 ? n : ds2490_parse(bytes, n, state);
}

/* Empty, and as it was set up. */
static bool is_clean(const struct ds2490_state *state)
{
	return (state->flags & (IDLE | HALTED | OVERRUN | PULLED_UP)) == IDLE && !state->commands &&
	       !state->out && !state->in && state->speed == FLEXIBLE && state->pull_up == ENDLESS;
}

static bool is_halted(const struct ds2490_state *state)
{
	return state->flags & HALTED;
}

static bool is_pulled_up(const struct ds2490_state *state)
{
	return state->flags & PULLED_UP;
}

/* Look until it is so: 0, -EIO: it does not become so, or an error. */
static int expect(struct ds2490 *chip, bool (*is)(const struct ds2490_state *state), bool wanted)
{
	int64_t until_ns = bus_now(chip->link.env) + LATE_NS;
	struct ds2490_state state;
	int err;

	while (!(err = look(chip, &state)) && is(&state) != wanted) {
		err = bus_now(chip->link.env) < until_ns ? wait_for(chip, LOOK_NS) : -EIO;
		if (err)
			break;
	}
	return err;
}

/* Requests one after the other, until one fails. */
static int send_all(struct ds2490 *chip, const uint8_t (*requests)[3], size_t n)
{
	int err = 0;

	for (size_t i = 0; !err && i < n; i++)
		err = control(chip, requests[i][0], requests[i][1], requests[i][2]);
	return err;
}

/* Into the state after power-on, and set up. The slew rate stays what it is then. */
static int reset_chip(struct ds2490 *chip)
{
	static const uint8_t requests[][3] = {
		{CONTROL, RESET_DEVICE, 0},
		{MODE, PULSE_ENABLE, PULSE_STRONG},
		{MODE, SPEED, FLEXIBLE},
		{MODE, PULL_UP, ENDLESS},
	};
	int err = chip->port->ops->clear(chip->port);

	if (!err)
		err = send_all(chip, requests, 4);
	if (!err)
		err = expect(chip, is_clean, true);
	chip->strong &= err != 0;
	chip->lost = err != 0;
	return err;
}

/* It heeds the flushes only while it is halted. */
static const uint8_t halt[][3] = {{CONTROL, HALT_IDLE, 0}};
static const uint8_t resume[][3] = {{CONTROL, RESUME, 0}};

/*
 * Whatever an error has left: out of a halted state, and all buffers empty. Where that does not
 * help, as with a chip that has lost a command (OVERRUN), a reset does.
 */
static int settle(struct ds2490 *chip)
{
	static const uint8_t flushes[][3] = {
		{CONTROL, FLUSH_COMMANDS, 0}, {CONTROL, FLUSH_IN, 0}, {CONTROL, FLUSH_OUT, 0}};
	int err = chip->port->ops->clear(chip->port);

	if (!err)
		err = send_all(chip, halt, 1);
	if (!err)
		err = expect(chip, is_halted, true);
	if (!err)
		err = send_all(chip, flushes, 3);
	if (!err)
		err = send_all(chip, resume, 1);
	if (!err)
		err = expect(chip, is_clean, true);
	chip->strong &= err != 0;
	chip->lost = err != 0;
	return err == -EIO || err == -ETIMEDOUT ? reset_chip(chip) : err;
}

/* A pulse without end ends where the chip is halted. */
static int end_strong(struct ds2490 *chip)
{
	int err = 0;

	if (!chip->strong)
		return 0;
	err = send_all(chip, halt, 1);
	if (!err)
		err = expect(chip, is_pulled_up, false);
	chip->strong = err != 0;
	if (!err)
		err = send_all(chip, resume, 1);
	return err ? lose(chip, err) : 0;
}

/* What a command is to have done when it has ended. */
struct goal {
	int64_t wire_ns;
	size_t in;          /* bytes that came back */
	bool strong, tells; /* the pull-up is on; there is a result */
};

/*
 * Has the command ended? That it is idle alone says little, unless it stays so: the packet may be
 * from before the command.
 */
static bool has_ended(struct ds2490 *chip, const struct goal *goal,
                      const struct ds2490_state *state, unsigned *idle)
{
	if (state->commands || !(state->flags & (goal->strong ? PULLED_UP : IDLE | HALTED)))
		return false;
	if (goal->in)
		return state->in >= goal->in;
	return state->told || (++*idle >= LOOKS && !(goal->tells && chip->tells));
}

static int finish(struct ds2490 *chip, const struct goal *goal, struct ds2490_state *state)
{
	const struct bus_env *env = chip->link.env;
	int64_t until_ns = bus_now(env) + goal->wire_ns + LATE_NS;
	uint8_t results = 0;
	unsigned idle = 0;
	int err = wait_for(chip, goal->wire_ns);

	chip->cost.wire_ns += (uint64_t)goal->wire_ns;
	while (!err) {
		err = look(chip, state);
		if (err)
			break;
		if (state->flags & OVERRUN)
			err = -EIO;
		else if (state->speed != FLEXIBLE || state->pull_up != ENDLESS)
			err = -ENXIO;
		results |= state->results;
		if (err || has_ended(chip, goal, state, &idle))
			break;
		err = bus_now(env) >= until_ns ? -ETIMEDOUT : wait_for(chip, LOOK_NS);
	}
	state->results = results;
	if (!err && goal->in && state->in != goal->in)
		err = -EIO;
	return err || (state->flags & HALTED) ? lose(chip, err) : 0;
}

static int reset_wire(struct ds2490 *chip)
{
	const struct goal goal = {.wire_ns = RESET_NS, .tells = true};
	struct ds2490_state state;
	int err = control(chip, COMMUNICATION, RESET_WIRE | NOW | FLUSH | TELL, 0);

	if (err)
		return lose(chip, err);
	err = finish(chip, &goal, &state);
	if (err)
		return err;
	chip->cost.resets++;
	chip->tells |= state.told && !state.results;
	if (state.in || state.out)
		return lose(chip, -EIO); /* of another transaction */
	return state.results & SHORT ? -ECOMM : state.results & NOBODY ? -EHOSTDOWN : 0;
}

/* Bytes that were sent to the wire, as it had them. */
static int take_back(struct ds2490 *chip, const struct goal *goal, uint8_t *bytes)
{
	struct ds2490_state state;
	int err = finish(chip, goal, &state);

	if (err)
		return err;
	err = transfer(chip, USB_IN, bytes, goal->in);
	return err ? lose(chip, err) : 0;
}

static int run_piece(struct ds2490 *chip, const uint8_t *out, size_t out_n, uint8_t *in,
                     size_t in_n)
{
	const struct goal goal = {.wire_ns = (int64_t)(out_n + in_n) * 8 * SLOT_NS,
	                          .in = out_n + in_n};
	uint8_t bytes[PIECE];

	memset(bytes, 0xFF, sizeof(bytes));
	if (out_n)
		memcpy(bytes, out, out_n);
	int err = transfer(chip, USB_OUT, bytes, goal.in);

	if (!err)
		err = control(chip, COMMUNICATION, BLOCK_IO | NOW | FLUSH, (unsigned)goal.in);
	if (err)
		return lose(chip, err);
	err = take_back(chip, &goal, bytes);
	if (!err && out_n && memcmp(bytes, out, out_n) != 0)
		err = lose(chip, -EIO);
	if (!err && in_n)
		memcpy(in, bytes + out_n, in_n);
	return err;
}

/* One byte, or one bit as command has it: what came back, or an error. */
static int run_command(struct ds2490 *chip, unsigned command, unsigned index, unsigned slots,
                       enum link_after after)
{
	const struct goal goal = {
		.wire_ns = slots * SLOT_NS, .in = 1, .strong = after == LINK_STRONG};
	uint8_t back = 0;

	if (goal.strong)
		command |= THEN_STRONG;
	int err = control(chip, COMMUNICATION, command | NOW | FLUSH, index);

	chip->strong = goal.strong;
	err = err ? lose(chip, err) : take_back(chip, &goal, &back);
	return err ? err : back;
}

/* Before each call on the wire. */
static int prepare(struct ds2490 *chip, bool anew)
{
	if (!chip->port)
		return -ENODEV;
	if (chip->lost)
		return anew ? settle(chip) : -EIO; /* what went before is not known */
	return end_strong(chip);
}

static int ds2490_run(struct link *base, const struct link_part *part)
{
	struct ds2490 *chip = chip_of(base);
	size_t strong = part->after == LINK_STRONG && part->out_n;
	size_t out_n = part->out_n - strong, out_at = 0, in_at = 0;
	int err = prepare(chip, part->reset);

	if (!err && part->reset)
		err = reset_wire(chip);
	while (!err && (out_at < out_n || (!strong && in_at < part->in_n))) {
		size_t out = out_n - out_at < PIECE ? out_n - out_at : PIECE;
		size_t in = out_at + out < out_n || strong ? 0 : part->in_n - in_at;

		if (in > PIECE - out)
			in = PIECE - out;
		err = run_piece(chip, part->out + out_at, out, part->in + in_at, in);
		out_at += out;
		in_at += in;
	}
	if (err || !strong)
		return err;
	int back = run_command(chip, BYTE_IO, part->out[out_n], 8, LINK_STRONG);

	return back < 0 ? back : back == part->out[out_n] ? 0 : lose(chip, -EIO);
}

static int ds2490_slot(struct link *base, bool out, enum link_after after)
{
	struct ds2490 *chip = chip_of(base);
	int err = prepare(chip, false);
	int back = err ? err : run_command(chip, BIT_IO | (out ? ONE : 0), 0, 1, after);

	return back < 0 ? back : back & 1;
}

/*
 * The search macro with one id as its limit: it follows the directions where devices differ, and
 * says where it has left some behind, which has a 0 in the id. Where the id has the 1 that it was
 * asked for, they may differ or not.
 */
static int ds2490_path(struct link *base, bool reset, uint8_t command, uint8_t rom[8],
                       uint8_t conflict[8])
{
	const struct goal goal = {.wire_ns = 200 * SLOT_NS};
	struct ds2490 *chip = chip_of(base);
	struct ds2490_state state;
	uint8_t bytes[16] = {0};
	int err = prepare(chip, reset);

	if (!err && reset)
		err = reset_wire(chip);
	if (err)
		return err;
	err = transfer(chip, USB_OUT, rom, 8);
	if (!err)
		err = control(chip, COMMUNICATION, SEARCH_ACCESS | NOW | LIST | FLUSH | CONFLICTS,
		              1 << 8 | command);
	err = err ? lose(chip, err) : finish(chip, &goal, &state);
	if (err)
		return err;
	/* none of those whose presence pulse was seen answers: they were disturbed */
	if (state.in == 0)
		return command == ONEWIRE_SEARCH ? -EBADMSG : -EHOSTDOWN;
	if (state.in != 8 && state.in != 16)
		return lose(chip, -EIO);
	err = transfer(chip, USB_IN, bytes, state.in);
	if (err)
		return lose(chip, err);
	for (unsigned i = 0; i < 8; i++) {
		conflict[i] = bytes[8 + i] | (rom[i] & bytes[i]);
		rom[i] = bytes[i];
	}
	return 0;
}

int ds2490_begin(struct ds2490 *chip)
{
	chip->strong = chip->tells = false;
	int err = reset_chip(chip);

	if (err == -EIO || err == -ETIMEDOUT) {
		err = chip->port->ops->reset(chip->port);
		if (!err)
			err = reset_chip(chip);
	}
	return err;
}

void ds2490_end(struct ds2490 *chip)
{
	(void)end_strong(chip);
}

/* The adapter's supply is that of USB, which cannot be switched here. */
static int ds2490_recover(struct link *base, enum link_rung rung)
{
	struct ds2490 *chip = chip_of(base);
	const struct link_part reset = {.reset = true};

	if (!chip->port)
		return -ENODEV;
	if (rung == LINK_POWER_CYCLE)
		return -EOPNOTSUPP;
	if (rung == LINK_CHIP_RESET) {
		int err = reset_chip(chip);

		if (err)
			return err;
	}
	chip->lost |= rung == LINK_BUS_RESET;
	int err = ds2490_run(base, &reset);

	return err == -EHOSTDOWN ? 0 : err;
}

static void ds2490_cost(const struct link *link, struct link_cost *cost)
{
	*cost = ((const struct ds2490 *)link)->cost;
}

static const struct link_ops ops = {
	.name = "DS2490",
	.recover = ds2490_recover,
	.run = ds2490_run,
	.slot = ds2490_slot,
	.path = ds2490_path,
	.cost = ds2490_cost,
};

static const struct link_facts facts = {.strong = true, .splits = true};

void ds2490_init(struct ds2490 *chip, const struct bus_env *env)
{
	*chip = (struct ds2490){.link = {.ops = &ops, .facts = &facts, .env = env}};
}
