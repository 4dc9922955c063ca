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

static struct ds2490 *chip_of(struct adapter *adapter)
{
	return (struct ds2490 *)adapter;
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

static int control(struct ds2490 *chip, unsigned request, unsigned value, unsigned index)
{
	chip->adapter.shared.transfers++;
	return chip->port->ops->control(chip->port, (uint8_t)request, (uint16_t)value,
	                                (uint16_t)index);
}

/* All of them, of a bulk endpoint. */
static int transfer(struct ds2490 *chip, uint8_t endpoint, uint8_t *bytes, size_t n)
{
	chip->adapter.shared.transfers++;
	chip->adapter.shared.bytes += n;
	int done = chip->port->ops->transfer(chip->port, endpoint, bytes, n);

	return done < 0 ? done : (size_t)done == n ? 0 : -EIO;
}

static int look(struct ds2490 *chip, struct ds2490_state *state)
{
	uint8_t bytes[STATE_MAX];

	chip->adapter.shared.transfers++;
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
	int64_t until_ns = bus_now(chip->adapter.link.env) + LATE_NS;
	struct ds2490_state state;
	int err;

	while (!(err = look(chip, &state)) && is(&state) != wanted) {
		err = bus_now(chip->adapter.link.env) < until_ns
		              ? adapter_wait(&chip->adapter, LOOK_NS)
		              : -EIO;
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

static int halt(struct ds2490 *chip, bool (*is)(const struct ds2490_state *state), bool wanted)
{
	int err = control(chip, CONTROL, HALT_IDLE, 0);

	return err ? err : expect(chip, is, wanted);
}

/* After these requests all buffers are empty, and nothing is on. */
static int clean(struct ds2490 *chip, const uint8_t (*requests)[3], size_t n)
{
	int err = send_all(chip, requests, n);

	if (!err)
		err = expect(chip, is_clean, true);
	chip->adapter.strong &= err != 0;
	return err;
}

/* Into the state after power-on, and set up. The slew rate stays what it is then. */
static int ds2490_renew(struct adapter *adapter)
{
	static const uint8_t requests[][3] = {
		{CONTROL, RESET_DEVICE, 0},
		{MODE, PULSE_ENABLE, PULSE_STRONG},
		{MODE, SPEED, FLEXIBLE},
		{MODE, PULL_UP, ENDLESS},
	};
	struct ds2490 *chip = chip_of(adapter);
	int err = chip->port->ops->clear(chip->port);

	return err ? err : clean(chip, requests, 4);
}

/*
 * Whatever an error has left: out of a halted state, and all buffers empty. The chip heeds the
 * flushes only while it is halted. Where that does not help, as with one that has lost a command
 * (OVERRUN), a reset does.
 */
static int ds2490_settle(struct adapter *adapter)
{
	static const uint8_t flushes[][3] = {
		{CONTROL, FLUSH_COMMANDS, 0},
		{CONTROL, FLUSH_IN, 0},
		{CONTROL, FLUSH_OUT, 0},
		{CONTROL, RESUME, 0},
	};
	struct ds2490 *chip = chip_of(adapter);
	int err = chip->port->ops->clear(chip->port);

	if (!err)
		err = halt(chip, is_halted, true);
	if (!err)
		err = clean(chip, flushes, 4);
	return err == -EIO || err == -ETIMEDOUT ? ds2490_renew(adapter) : err;
}

/* A pulse without end ends where the chip is halted. */
int ds2490_end_strong(struct ds2490 *chip)
{
	if (!chip->adapter.strong)
		return 0;
	int err = halt(chip, is_pulled_up, false);

	chip->adapter.strong = err != 0;
	return err ? err : control(chip, CONTROL, RESUME, 0);
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
	const struct bus_env *env = chip->adapter.link.env;
	int64_t until_ns = bus_now(env) + goal->wire_ns + LATE_NS;
	uint8_t results = 0;
	unsigned idle = 0;
	int err = adapter_wait(&chip->adapter, goal->wire_ns);

	chip->adapter.cost.wire_ns += (uint64_t)goal->wire_ns;
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
		err = bus_now(env) >= until_ns ? -ETIMEDOUT : adapter_wait(&chip->adapter, LOOK_NS);
	}
	state->results = results;
	if (!err && goal->in && state->in != goal->in)
		err = -EIO;
	if (!err)
		chip->adapter.lost |= (state->flags & HALTED) != 0;
	return err;
}

static int reset_wire(struct ds2490 *chip)
{
	const struct goal goal = {.wire_ns = RESET_NS, .tells = true};
	struct ds2490_state state = {0};
	int err = control(chip, COMMUNICATION, RESET_WIRE | NOW | FLUSH | TELL, 0);

	if (!err)
		err = finish(chip, &goal, &state);
	if (err)
		return err;
	chip->adapter.cost.resets++;
	chip->tells |= state.told && !state.results;
	if (state.in || state.out)
		return -EIO; /* of another transaction */
	return state.results & SHORT ? -ECOMM : state.results & NOBODY ? -EHOSTDOWN : 0;
}

/* Before a command on the wire. */
static int ready(struct ds2490 *chip, bool reset)
{
	int err = ds2490_end_strong(chip);

	return !err && reset ? reset_wire(chip) : err;
}

/* Bytes that were sent to the wire, as it had them. */
static int take_back(struct ds2490 *chip, const struct goal *goal, uint8_t *bytes)
{
	struct ds2490_state state = {0};
	int err = finish(chip, goal, &state);

	return err ? err : transfer(chip, USB_IN, bytes, goal->in);
}

static int ds2490_pass(struct adapter *adapter, bool reset, const uint8_t *out, size_t out_n,
                       uint8_t *in, size_t in_n)
{
	const struct goal goal = {.wire_ns = (int64_t)(out_n + in_n) * 8 * SLOT_NS,
	                          .in = out_n + in_n};
	struct ds2490 *chip = chip_of(adapter);
	uint8_t bytes[PIECE];
	int err = ready(chip, reset);

	if (err || !goal.in)
		return err;
	memset(bytes, 0xFF, sizeof(bytes));
	if (out_n)
		memcpy(bytes, out, out_n);
	err = transfer(chip, USB_OUT, bytes, goal.in);
	if (!err)
		err = control(chip, COMMUNICATION, BLOCK_IO | NOW | FLUSH, (unsigned)goal.in);
	if (!err)
		err = take_back(chip, &goal, bytes);
	if (!err && out_n && memcmp(bytes, out, out_n) != 0)
		err = -EIO;
	if (!err && in_n)
		memcpy(in, bytes + out_n, in_n);
	return err;
}

static int ds2490_bits(struct adapter *adapter, uint8_t bits, unsigned n, bool strong)
{
	const struct goal goal = {.wire_ns = n * SLOT_NS, .in = 1, .strong = strong};
	unsigned command = n == 1 ? BIT_IO | (bits ? ONE : 0) : BYTE_IO;
	struct ds2490 *chip = chip_of(adapter);
	uint8_t back = 0;
	int err = ready(chip, false);

	if (err)
		return err;
	if (strong)
		command |= THEN_STRONG;
	err = control(chip, COMMUNICATION, command | NOW | FLUSH, n == 1 ? 0 : bits);
	adapter->strong = strong;
	if (!err)
		err = take_back(chip, &goal, &back);
	return err ? err : n == 1 ? back & 1 : back;
}

/*
 * The search macro with one id as its limit: it follows the directions where devices differ, and
 * says where it has left some behind, which has a 0 in the id. Where the id has the 1 that it was
 * asked for, they may differ or not.
 */
static int ds2490_path(struct adapter *adapter, bool reset, uint8_t command, uint8_t rom[8],
                       uint8_t conflict[8])
{
	const struct goal goal = {.wire_ns = 200 * SLOT_NS};
	struct ds2490 *chip = chip_of(adapter);
	struct ds2490_state state = {0};
	uint8_t bytes[16] = {0};
	int err = ready(chip, reset);

	if (!err)
		err = transfer(chip, USB_OUT, rom, 8);
	if (!err)
		err = control(chip, COMMUNICATION, SEARCH_ACCESS | NOW | LIST | FLUSH | CONFLICTS,
		              1 << 8 | command);
	if (!err)
		err = finish(chip, &goal, &state);
	if (err)
		return err;
	/* none of those whose presence pulse was seen answers: they were disturbed */
	if (state.in == 0)
		return command == ONEWIRE_SEARCH ? -EBADMSG : -EHOSTDOWN;
	if (state.in != 8 && state.in != 16)
		return -EIO;
	err = transfer(chip, USB_IN, bytes, state.in);
	if (err)
		return err;
	for (unsigned i = 0; i < 8; i++) {
		conflict[i] = bytes[8 + i] | (rom[i] & bytes[i]);
		rom[i] = bytes[i];
	}
	return 0;
}

int ds2490_begin(struct ds2490 *chip)
{
	chip->adapter.strong = chip->tells = false;
	int err = ds2490_renew(&chip->adapter);

	if (err == -EIO || err == -ETIMEDOUT) {
		err = chip->port->ops->reset(chip->port);
		if (!err)
			err = ds2490_renew(&chip->adapter);
	}
	return err;
}

static const struct link_ops ds2490_link = {
	.name = "DS2490",
	ADAPTER_LINK_SLOTS,
};

static const struct adapter_kind ds2490 = {
	.link = &ds2490_link,
	.facts = {.strong = true, .splits = true},
	.piece = PIECE,
	.settle = ds2490_settle,
	.pass = ds2490_pass,
	.bits = ds2490_bits,
	.path = ds2490_path,
	.renew = ds2490_renew,
};

void ds2490_init(struct ds2490 *chip, const struct link_master_ops *ops, const struct bus_env *env)
{
	adapter_init(&chip->adapter, &ds2490, ops, env);
}
