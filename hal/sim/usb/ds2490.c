/* SPDX-License-Identifier: MIT */
/* The USB side of a DS2490: its endpoints, FIFOs, control and mode commands, and its state. */
#include <errno.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/branch.h"
#include "hal/sim/usb/ds2490.h"
#include "hal/sim/usb/standard.h"
#include "hal/sim/usb/work.h"

enum { COMMAND_ROOM = 16, RECIPIENT_ENDPOINT = 0x02 };

/* clang-format off */
static const uint8_t device_descriptor[] = {
	18, USB_DEVICE, 0x10, 0x01, 0xff, 0xff, 0xff, 8, 0xfa, 0x04, 0x90, 0x24, 0x02, 0x00, 0, 0, 0, 1,
};
#define ALTERNATE(n, interval, packet) \
	9, USB_INTERFACE, 0, n, 3, 0xff, 0xff, 0xff, 0, \
	7, USB_ENDPOINT, 0x81, 3, 32, 0, interval, \
	7, USB_ENDPOINT, 0x02, 2, packet, 0, 0, \
	7, USB_ENDPOINT, 0x83, 2, packet, 0, 0
static const uint8_t configuration_descriptor[] = {
	9, USB_CONFIGURATION, 129, 0, 1, 1, 0, 0xa0, 50,
	ALTERNATE(0, 10, 16), ALTERNATE(1, 10, 64), ALTERNATE(2, 1, 16), ALTERNATE(3, 1, 64),
};
/* clang-format on */
static const struct usb_identity identity = {device_descriptor, configuration_descriptor, NULL};

/* Data sheet, "Power-on default values": 512 ms, 512 us, 0.83 V/us, 12 us, 7 us. */
static const uint8_t mode_defaults[8] = {0, 0, 0x20, 0x40, 5, 4, 4, 0};
/* The last value of each mode register that is not reserved. */
static const uint8_t mode_most[8] = {3, 1, 2, 0xFE, 7, 0xFE, 7, 7};
/* From DS2490_SPEED on: where its register is. */
static const uint8_t mode_at[8] = {
	[DS2490_SPEED] = DS2490_AT_SPEED,       [DS2490_PULLUP_DURATION] = DS2490_AT_PULLUP,
	[DS2490_SLEW_RATE] = DS2490_AT_SLEW,    [DS2490_PULSE_DURATION] = DS2490_AT_PULSE,
	[DS2490_WRITE1_LOW] = DS2490_AT_WRITE1, [DS2490_SAMPLE_OFFSET] = DS2490_AT_SAMPLE,
};

static size_t devices(const struct sim_ds2490 *chip)
{
	const struct sim_wire *wire = sim_ds2490_wire(chip);
	size_t count = 0;

	for (size_t i = 0; i < wire->count; i++)
		count += wire->slaves[i]->plugged && sim_branch_connects(wire->slaves[i]);
	return count;
}

/* Into the state after power-on, and after RESET DEVICE. */
static void restart(struct sim_ds2490 *chip)
{
	if (chip->work.pulling)
		sim_ds2490_end_pulse(chip, chip->t);
	chip->work = (struct sim_ds2490_work){0};
	chip->command.count = chip->out.count = chip->in.count = chip->result.count = 0;
	chip->held_count = 0;
	chip->ep0_full = chip->running = chip->halted = false;
	chip->halt = 0;
	memcpy(chip->state, mode_defaults, sizeof(chip->state));
}

void sim_ds2490_init(struct sim_ds2490 *chip, struct sim_net *net)
{
	*chip = (struct sim_ds2490){.net = net};
	restart(chip);
	chip->present = devices(chip);
}

/* A command that waited in the FIFO of EP0 for room goes on. */
static void take_held(struct sim_ds2490 *chip)
{
	if (!chip->held_count || chip->command.count + chip->held_count > COMMAND_ROOM)
		return;
	for (unsigned i = 0; i < chip->held_count; i++)
		sim_fifo_put(&chip->command, chip->held[i]);
	chip->running |= chip->held[0] & DS2490_IM;
	chip->held_count = 0;
}

/* Is there a step to do, or to begin? */
static bool is_busy(const struct sim_ds2490 *chip)
{
	return !chip->halted && (chip->work.code || (chip->running && chip->command.count));
}

/* A halt waits for the end of the command, or of what is under way on the wire; it ends a pulse. */
static void halt_if_asked(struct sim_ds2490 *chip, bool between_steps, int64_t t)
{
	int64_t ns = sim_ds2490_step_ns(chip);

	if (!chip->halt)
		return;
	if (chip->work.pulling && (chip->halt == DS2490_HALT_EXE_IDLE || ns == INT64_MAX)) {
		sim_ds2490_end_pulse(chip, t);
		chip->t = t;
		between_steps = true;
	}
	if (chip->work.code && (chip->halt == DS2490_HALT_EXE_DONE || (!between_steps && ns > 0)))
		return;
	chip->halted = true;
	chip->halt = 0;
}

void sim_ds2490_run(struct sim_ds2490 *chip, int64_t now)
{
	while (chip->net->plugged && is_busy(chip)) {
		bool pulse = chip->work.pulling;
		int64_t ns;

		if (!chip->work.code) {
			sim_ds2490_begin(chip);
			take_held(chip);
		}
		ns = sim_ds2490_step_ns(chip);
		if (ns < 0 || ns > now - chip->t)
			break;
		sim_ds2490_step(chip);
		chip->t += ns;
		chip->wire_ns += pulse ? 0 : ns;
		halt_if_asked(chip, true, chip->t);
	}
	chip->running &= chip->command.count > 0;
	if (!is_busy(chip) || sim_ds2490_step_ns(chip) < 0)
		chip->t = now;
	sim_net_run(chip->net, now);
	if (!chip->net->plugged) {
		restart(chip);
		chip->alternate = 0;
	}
}

int64_t sim_ds2490_due(const struct sim_ds2490 *chip)
{
	int64_t ns = is_busy(chip) ? sim_ds2490_step_ns(chip) : -1;

	return ns < 0 || ns == INT64_MAX ? INT64_MAX : chip->t + ns;
}

int64_t sim_ds2490_poll_ns(const struct sim_ds2490 *chip)
{
	return chip->alternate >= 2 ? NS_PER_MS : 10 * NS_PER_MS;
}

uint64_t sim_ds2490_forbidden(const struct sim_ds2490 *chip)
{
	const struct sim_ds2490_faults *faults = &chip->faults;

	return faults->setups_lost + faults->data_lost + faults->results_lost + faults->unhalted +
	       faults->reserved + faults->unknown + faults->babble;
}

static int unknown(struct sim_ds2490 *chip)
{
	chip->faults.unknown++;
	return -EPIPE;
}

static int flush(struct sim_ds2490 *chip, struct sim_fifo *fifo)
{
	if (chip->halted)
		fifo->count = 0;
	else
		chip->faults.unhalted++;
	return 0;
}

static int get_commands(struct sim_ds2490 *chip, uint8_t *data, size_t room)
{
	int n = 0;

	if (!chip->halted) {
		chip->faults.unhalted++;
		return 0;
	}
	while ((size_t)n < room && chip->command.count)
		data[n++] = sim_fifo_take(&chip->command);
	return n;
}

static int control_command(struct sim_ds2490 *chip, unsigned code, uint8_t *data, size_t room,
                           int64_t now)
{
	switch (code) {
	case DS2490_RESET_DEVICE:
		restart(chip);
		return 0;
	case DS2490_START_EXE:
		chip->running = true;
		return 0;
	case DS2490_RESUME_EXE:
		chip->halted = false;
		chip->halt = 0;
		return 0;
	case DS2490_HALT_EXE_IDLE:
	case DS2490_HALT_EXE_DONE:
		chip->halt = (uint8_t)code;
		halt_if_asked(chip, false, now);
		return 0;
	case DS2490_FLUSH_COMM:
		return flush(chip, &chip->command);
	case DS2490_FLUSH_RCV:
		return flush(chip, &chip->in);
	case DS2490_FLUSH_XMT:
		return flush(chip, &chip->out);
	case DS2490_GET_COMM:
		return get_commands(chip, data, room);
	}
	return unknown(chip);
}

static int mode_command(struct sim_ds2490 *chip, unsigned code, unsigned value)
{
	uint8_t *enable = &chip->state[DS2490_AT_ENABLE];

	if (code >= sizeof(chip->state))
		return unknown(chip);
	chip->faults.reserved += value > mode_most[code];
	if (code == DS2490_PULSE_EN) /* the two bits stand the other way round in the register */
		*enable = (uint8_t)((*enable & 4) | (value & 1) << 1 | (value >> 1 & 1));
	else if (code == DS2490_SPEED_CHANGE_EN)
		*enable = (uint8_t)((*enable & 3) | (value ? 4 : 0));
	else
		chip->state[mode_at[code]] = (uint8_t)value;
	return 0;
}

static int comm_command(struct sim_ds2490 *chip, unsigned code, unsigned parameter)
{
	unsigned length = sim_ds2490_length((uint16_t)code);

	if (!length)
		return unknown(chip);
	chip->held[0] = (uint8_t)code;
	chip->held[1] = (uint8_t)(code >> 8);
	chip->held[2] = (uint8_t)parameter;
	chip->held[3] = (uint8_t)(parameter >> 8);
	chip->held_count = length;
	take_held(chip);
	return 0;
}

static int vendor(struct sim_ds2490 *chip, const uint8_t setup[8], uint8_t *data, size_t room,
                  int64_t now)
{
	unsigned value = setup[2] | (unsigned)setup[3] << 8;
	unsigned index = setup[4] | (unsigned)setup[5] << 8;
	bool is_reset = setup[1] == DS2490_CONTROL && value == DS2490_RESET_DEVICE;
	bool is_get = setup[1] == DS2490_CONTROL && value == DS2490_GET_COMM;

	chip->requests++;
	if (is_get != !!(setup[0] & USB_IN) || (!is_get && (setup[6] || setup[7])))
		return unknown(chip);
	if ((chip->held_count || chip->ep0_full) && !is_reset) {
		chip->ep0_full = true;
		chip->faults.setups_lost++;
		return 0;
	}
	if (setup[1] == DS2490_CONTROL)
		return control_command(chip, value, data, room, now);
	if (setup[1] == DS2490_COMM)
		return comm_command(chip, value, index);
	if (setup[1] == DS2490_MODE)
		return mode_command(chip, value, index);
	return unknown(chip);
}

static int standard(struct sim_ds2490 *chip, const uint8_t setup[8], uint8_t *data, size_t room)
{
	if (setup[1] == USB_SET_CONFIGURATION)
		chip->alternate = 0;
	if (setup[1] == USB_GET_INTERFACE)
		return usb_give(data, room, &chip->alternate, 1);
	if (setup[1] == USB_SET_INTERFACE) {
		if (setup[2] > 3)
			return unknown(chip);
		chip->alternate = setup[2];
	}
	if (setup[1] == USB_CLEAR_FEATURE && (setup[0] & 3) == RECIPIENT_ENDPOINT)
		chip->stalled &= (uint8_t) ~(1u << (setup[4] & 7));
	return usb_standard(&identity, setup, data, room);
}

/* What a transfer of an endpoint meets first. */
static int meet(struct sim_ds2490 *chip, unsigned endpoint, int64_t now)
{
	sim_ds2490_run(chip, now);
	if (!chip->net->plugged)
		return -ENODEV;
	if (chip->stalled >> endpoint & 1)
		return -EPIPE;
	return chip->silent >> endpoint & 1 ? -EAGAIN : 0;
}

int sim_ds2490_control(struct sim_ds2490 *chip, const uint8_t setup[8], uint8_t *data, size_t room,
                       int64_t now)
{
	size_t stated = setup[6] | (size_t)setup[7] << 8;
	bool is_vendor = (setup[0] & USB_KIND) == USB_KIND_VENDOR;
	int err = meet(chip, 0, now);
	int moved;

	if (err && (is_vendor || err == -ENODEV))
		return err;
	if (room > stated)
		room = stated;
	if (!is_vendor)
		return standard(chip, setup, data, room);
	moved = vendor(chip, setup, data, room, now);
	sim_ds2490_run(chip, now);
	return moved;
}

static void write_state(const struct sim_ds2490 *chip, uint8_t state[DS2490_STATE])
{
	bool busy = is_busy(chip);
	uint8_t flags = 0;

	memcpy(state, chip->state, sizeof(chip->state));
	memset(state + DS2490_AT_FLAGS, 0, DS2490_STATE - DS2490_AT_FLAGS);
	if (chip->work.pulling)
		flags |= DS2490_SPUA;
	if (chip->halted)
		flags |= DS2490_HALTED;
	if (!busy)
		flags |= DS2490_IDLE;
	if (chip->ep0_full)
		flags |= DS2490_EP0F;
	state[DS2490_AT_FLAGS] = flags;
	if (busy) {
		state[DS2490_AT_COMMAND] = (uint8_t)chip->work.code;
		state[DS2490_AT_COMMAND + 1] = (uint8_t)(chip->work.code >> 8);
	}
	state[DS2490_AT_COMMANDS] = (uint8_t)chip->command.count;
	state[DS2490_AT_OUT] = (uint8_t)chip->out.count;
	state[DS2490_AT_IN] = (uint8_t)chip->in.count;
}

static int babble(struct sim_ds2490 *chip, struct sim_fifo *fifo)
{
	chip->faults.babble++;
	fifo->count = 0;
	return -EOVERFLOW;
}

int sim_ds2490_interrupt(struct sim_ds2490 *chip, uint8_t *data, size_t room, int64_t now)
{
	int err = meet(chip, 1, now);
	size_t here, n = DS2490_STATE;

	if (err)
		return err;
	chip->transfers++;
	here = devices(chip);
	if (here > chip->present && !chip->work.code)
		sim_ds2490_result(chip, DS2490_DETECT);
	chip->present = here;
	if (room < DS2490_STATE + chip->result.count)
		return babble(chip, &chip->result);
	write_state(chip, data);
	while (chip->result.count)
		data[n++] = sim_fifo_take(&chip->result);
	return (int)n;
}

static size_t packet(const struct sim_ds2490 *chip)
{
	return chip->alternate & 1 ? 64 : 16;
}

int sim_ds2490_bulk_out(struct sim_ds2490 *chip, const uint8_t *data, size_t len, int64_t now)
{
	int err = meet(chip, 2, now);
	size_t taken = 0;

	if (err)
		return err;
	while (taken < len) {
		size_t n = len - taken < packet(chip) ? len - taken : packet(chip);

		if (chip->out.count + n > sizeof(chip->out.byte))
			break;
		while (n--)
			sim_fifo_put(&chip->out, data[taken++]);
	}
	if (!taken && len)
		return -EAGAIN;
	chip->transfers++;
	sim_ds2490_run(chip, now);
	return (int)taken;
}

int sim_ds2490_bulk_in(struct sim_ds2490 *chip, uint8_t *data, size_t room, int64_t now)
{
	int err = meet(chip, 3, now);
	size_t moved = 0;

	if (err)
		return err;
	if (!chip->in.count)
		return -EAGAIN;
	chip->transfers++;
	while (chip->in.count && moved < room) {
		size_t n = chip->in.count < packet(chip) ? chip->in.count : packet(chip);

		if (n > room - moved)
			return babble(chip, &chip->in);
		while (n--)
			data[moved++] = sim_fifo_take(&chip->in);
	}
	return (int)moved;
}
