/* SPDX-License-Identifier: MIT */
/* The commands of a DS2490, step by step: resets, slots, bytes, triplets of a search, pulses. */
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/usb/work.h"

#define US INT64_C(1000)
#define WAITS INT64_C(-1)

enum { FLEXIBLE = 1, OVERDRIVE = 2, DURATION_RESERVED = 0xFF };
enum { ENABLED_PULLUP = 0x01, ENABLED_SPEED_CHANGE = 0x04 };
/* Low byte of a command: bits 7 to 4 are its kind, 2 and 1 the number of its parameters. */
enum { KIND = 0xF6, KIND_STRAIGHT = 0xF0 };

static bool is_overdrive(const struct sim_ds2490 *chip)
{
	return chip->state[DS2490_AT_SPEED] == OVERDRIVE;
}

/* Data sheet, "Nominal timing values"; at flexible speed the recovery time is 3 us and its code. */
static int64_t slot_ns(const struct sim_ds2490 *chip)
{
	if (is_overdrive(chip))
		return 10 * US;
	if (chip->state[DS2490_AT_SPEED] == FLEXIBLE)
		return (62 + 3 + chip->state[DS2490_AT_SAMPLE]) * US;
	return 68 * US;
}

static int64_t reset_ns(const struct sim_ds2490 *chip)
{
	return is_overdrive(chip) ? 140 * US : 1096 * US;
}

static int64_t pulse_ns(const struct sim_ds2490 *chip)
{
	uint8_t code = chip->state[DS2490_AT_PULLUP];

	if (code == 0)
		return INT64_MAX;
	return code == DURATION_RESERVED ? US : code * 16 * NS_PER_MS;
}

void sim_fifo_put(struct sim_fifo *fifo, uint8_t byte)
{
	fifo->byte[(fifo->first + fifo->count++) % sizeof(fifo->byte)] = byte;
}

uint8_t sim_fifo_take(struct sim_fifo *fifo)
{
	uint8_t byte = fifo->byte[fifo->first];

	fifo->first = (fifo->first + 1) % sizeof(fifo->byte);
	fifo->count--;
	return byte;
}

static unsigned kind_of(uint16_t code)
{
	return (code & KIND_STRAIGHT) == DS2490_STRAIGHT ? DS2490_STRAIGHT : code & KIND;
}

unsigned sim_ds2490_length(uint16_t code)
{
	switch (kind_of(code)) {
	case DS2490_BIT:
	case DS2490_PULSE:
		return 2;
	case DS2490_SET_DURATION:
	case DS2490_WIRE_RESET:
	case DS2490_BYTE:
		return 3;
	case DS2490_MATCH:
	case DS2490_BLOCK:
	case DS2490_STRAIGHT:
	case DS2490_SEARCH:
		return 4;
	default:
		return 0;
	}
}

struct sim_wire *sim_ds2490_wire(const struct sim_ds2490 *chip)
{
	return &chip->net->chip[0].wire[0];
}

void sim_ds2490_result(struct sim_ds2490 *chip, uint8_t result)
{
	if (chip->result.count == 16)
		chip->faults.results_lost++;
	else
		sim_fifo_put(&chip->result, result);
}

static void to_host(struct sim_ds2490 *chip, uint8_t byte)
{
	if (chip->in.count == sizeof(chip->in.byte))
		chip->faults.data_lost++;
	else
		sim_fifo_put(&chip->in, byte);
}

static void set_speed(struct sim_ds2490 *chip, uint8_t speed)
{
	if (!(chip->state[DS2490_AT_ENABLE] & ENABLED_SPEED_CHANGE))
		return;
	if (speed > OVERDRIVE)
		chip->faults.reserved++;
	chip->state[DS2490_AT_SPEED] = speed;
}

/* The bits of READ STRAIGHT stand elsewhere. */
static uint16_t bits_of(uint16_t code)
{
	uint16_t bits = 0;

	if (kind_of(code) != DS2490_STRAIGHT)
		return code & 0xFF00;
	if (code & DS2490_STRAIGHT_RST)
		bits |= DS2490_RST;
	if (code & DS2490_STRAIGHT_ICP)
		bits |= DS2490_ICP;
	if (code & DS2490_STRAIGHT_NTF)
		bits |= DS2490_NTF;
	return bits;
}

static void begin_reset(struct sim_ds2490 *chip, uint16_t code, uint8_t speed)
{
	chip->work.reset = true;
	/* data sheet, "1-Wire reset": after Overdrive Skip ROM; the reset has the new speed */
	if (code & DS2490_SE)
		set_speed(chip, speed);
}

static void begin_pulse(struct sim_ds2490 *chip, uint16_t code)
{
	if (code & DS2490_TYPE)
		chip->work.result = DS2490_VPP;
	else
		chip->work.pull = true;
}

void sim_ds2490_begin(struct sim_ds2490 *chip)
{
	struct sim_ds2490_work *work = &chip->work;
	uint8_t byte[4] = {0};
	unsigned length;
	uint16_t code;

	byte[0] = sim_fifo_take(&chip->command);
	byte[1] = sim_fifo_take(&chip->command);
	code = (uint16_t)(byte[0] | byte[1] << 8);
	length = sim_ds2490_length(code);
	for (unsigned i = 2; i < length; i++)
		byte[i] = sim_fifo_take(&chip->command);
	*work = (struct sim_ds2490_work){.code = code, .bits = bits_of(code)};
	work->first_byte = byte[2];
	switch (kind_of(code)) {
	case DS2490_SET_DURATION:
		chip->state[code & DS2490_TYPE ? DS2490_AT_PULSE : DS2490_AT_PULLUP] = byte[2];
		chip->faults.reserved += byte[2] == DURATION_RESERVED;
		return;
	case DS2490_PULSE:
		begin_pulse(chip, code);
		return;
	case DS2490_WIRE_RESET:
		begin_reset(chip, code, byte[2]);
		return;
	case DS2490_BIT:
		work->slot = true;
		work->slot_out = code & DS2490_D;
		break;
	case DS2490_BYTE:
		work->first = true;
		work->first_back = !(work->bits & DS2490_ICP);
		break;
	case DS2490_BLOCK:
		work->out = byte[2] | byte[3] << 8;
		work->out_back = true;
		break;
	case DS2490_MATCH:
		work->first = true;
		work->speed = code & DS2490_SE;
		work->new_speed = byte[3];
		work->out = 8;
		break;
	case DS2490_STRAIGHT:
		work->out = code >> 8;
		work->in = byte[2] | byte[3] << 8;
		break;
	case DS2490_SEARCH:
		work->first = true;
		work->search = 64;
		work->wanted = byte[3];
		work->last = 64;
		break;
	}
	work->reset = work->bits & DS2490_RST;
	work->pull = work->bits & DS2490_SPU && kind_of(code) < DS2490_STRAIGHT;
}

int64_t sim_ds2490_step_ns(const struct sim_ds2490 *chip)
{
	const struct sim_ds2490_work *work = &chip->work;

	if (work->reset)
		return reset_ns(chip);
	if (work->first)
		return 8 * slot_ns(chip);
	if (work->slot)
		return slot_ns(chip);
	if (work->search && !work->search_begun)
		return chip->out.count < 8 ? WAITS : 0;
	if (work->search)
		return 3 * slot_ns(chip);
	if (work->out)
		return chip->out.count ? 8 * slot_ns(chip) : WAITS;
	if (work->in)
		return 8 * slot_ns(chip);
	return work->pulling ? pulse_ns(chip) : 0;
}

/* The i-th slot of a step. */
static bool slot(struct sim_ds2490 *chip, unsigned i, bool out)
{
	sim_net_run(chip->net, chip->t + i * slot_ns(chip));
	return sim_wire_slot(sim_ds2490_wire(chip), out, is_overdrive(chip), chip->net->time);
}

static uint8_t byte_slots(struct sim_ds2490 *chip, uint8_t out)
{
	uint8_t back = 0;

	for (unsigned i = 0; i < 8; i++)
		back |= (uint8_t)(slot(chip, i, out >> i & 1) << i);
	return back;
}

static void reset_step(struct sim_ds2490 *chip)
{
	struct sim_ds2490_work *work = &chip->work;
	bool present;

	sim_net_run(chip->net, chip->t);
	present = sim_wire_reset(sim_ds2490_wire(chip), is_overdrive(chip), chip->net->time);
	work->reset = false;
	if (!sim_wire_level(sim_ds2490_wire(chip), chip->net->time))
		work->result |= DS2490_SH;
	else if (!present)
		work->result |= DS2490_NRS;
	if (kind_of(work->code) == DS2490_WIRE_RESET) {
		work->reset = work->result & DS2490_NRS && work->bits & DS2490_PST;
		if (work->reset)
			work->result = 0;
	} else if (work->search) {
		if (work->result) {
			work->first = false;
			work->search = 0;
		}
	} else {
		work->result = 0; /* data sheet: the other commands have no error codes */
	}
}

static bool bit_of(const uint8_t id[8], int i)
{
	return id[i / 8] >> i % 8 & 1;
}

static void put_bit(uint8_t id[8], int i, bool bit)
{
	id[i / 8] = (uint8_t)((id[i / 8] & ~(1u << i % 8)) | (unsigned)bit << i % 8);
}

static void ids_to_host(struct sim_ds2490 *chip, const uint8_t id[8])
{
	for (unsigned i = 0; i < 8; i++)
		to_host(chip, id[i]);
}

/* An id has been found: report it, and go on to the next or end. */
static void end_pass(struct sim_ds2490 *chip)
{
	struct sim_ds2490_work *work = &chip->work;
	int turn = 63;

	if (!(work->code & DS2490_SM))
		return;
	ids_to_host(chip, work->id);
	work->found++;
	while (turn >= 0 && !(bit_of(work->conflict, turn) && !bit_of(work->id, turn)))
		turn--;
	if (turn < 0) {
		if (work->found < work->wanted)
			work->result |= DS2490_EOS;
		return;
	}
	if (work->found == work->wanted) {
		if (work->bits & DS2490_RTS)
			ids_to_host(chip, work->conflict);
		return;
	}
	work->last = turn;
	memset(work->conflict, 0, sizeof(work->conflict));
	work->reset = work->first = true;
	work->search = 64;
}

/* One triplet of a search, or the id that it begins at. */
static void search_step(struct sim_ds2490 *chip)
{
	struct sim_ds2490_work *work = &chip->work;
	int i = 64 - (int)work->search;
	bool id, complement, taken;

	if (!work->search_begun) {
		work->search_begun = true;
		for (unsigned n = 0; n < 8; n++)
			work->id[n] = sim_fifo_take(&chip->out);
		return;
	}
	id = slot(chip, 0, true);
	complement = slot(chip, 1, true);
	if (id && complement) { /* nobody answers */
		work->result |= work->code & DS2490_SM ? DS2490_EOS : DS2490_CMP;
		work->search = 0;
		return;
	}
	taken = id;
	if (id == complement) {
		taken = i == work->last || (i < work->last && bit_of(work->id, i));
		put_bit(work->conflict, i, true);
	}
	if (!(work->code & DS2490_SM)) {
		if (taken != bit_of(work->id, i))
			work->result |= DS2490_CMP;
		taken = bit_of(work->id, i);
	}
	slot(chip, 2, taken);
	put_bit(work->id, i, taken);
	if (--work->search == 0)
		end_pass(chip);
}

static void strong(struct sim_ds2490 *chip, bool on, int64_t t)
{
	chip->work.pulling = on;
	sim_net_run(chip->net, t);
	sim_wire_strong(sim_ds2490_wire(chip), on, chip->net->time);
}

void sim_ds2490_end_pulse(struct sim_ds2490 *chip, int64_t t)
{
	strong(chip, false, t);
	chip->work.pull = false;
}

/* The command is done: what it has to say, and what is to be forgotten after an error. */
static void end_work(struct sim_ds2490 *chip)
{
	struct sim_ds2490_work work = chip->work;

	chip->commands++;
	chip->work = (struct sim_ds2490_work){0};
	if (!(work.bits & DS2490_ICP) && (work.result || work.bits & DS2490_NTF))
		sim_ds2490_result(chip, work.result);
	/* that a search has found all is no error: the kernel searches with F, and loses no id */
	if (work.result & ~DS2490_EOS && work.bits & DS2490_F)
		chip->command.count = chip->out.count = chip->in.count = 0;
}

void sim_ds2490_step(struct sim_ds2490 *chip)
{
	struct sim_ds2490_work *work = &chip->work;
	uint8_t back;

	if (work->reset) {
		reset_step(chip);
	} else if (work->first) {
		work->first = false;
		back = byte_slots(chip, work->first_byte);
		if (work->first_back)
			to_host(chip, back);
		if (work->speed)
			set_speed(chip, work->new_speed);
	} else if (work->slot) {
		work->slot = false;
		back = slot(chip, 0, work->slot_out);
		if (!(work->bits & DS2490_ICP))
			to_host(chip, back);
		if (back && work->bits & DS2490_CIB)
			work->pull = false;
	} else if (work->search) {
		search_step(chip);
	} else if (work->out) {
		work->out--;
		back = byte_slots(chip, sim_fifo_take(&chip->out));
		if (work->out_back)
			to_host(chip, back);
	} else if (work->in) {
		work->in--;
		to_host(chip, byte_slots(chip, 0xFF));
	} else if (work->pulling) {
		sim_ds2490_end_pulse(chip, chip->t + pulse_ns(chip));
	} else if (work->pull && chip->state[DS2490_AT_ENABLE] & ENABLED_PULLUP) {
		strong(chip, true, chip->t);
	} else {
		end_work(chip);
	}
}
