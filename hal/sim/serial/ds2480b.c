/* SPDX-License-Identifier: MIT */
/* The DS2480B: its two modes, its commands, its search accelerator, its pulses. */
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/serial/answer.h"
#include "hal/sim/serial/ds2480b.h"

/* Data sheet, "Mode commands" and "Communication commands"; their bits 6 and 5 are the function. */
enum { DATA_MODE = 0xE1, COMMAND_MODE = 0xE3, END_PULSE = 0xF1 };
enum { SINGLE_BIT, SEARCH, RESET, PULSE };
enum { BIT_IS_ONE = 0x10, STRONG = 0x02, SEARCH_ON = 0x10, ARM = 0x02, PROGRAM = 0x10 };
/* Parameters, "Configuration commands". */
enum { STRONG_TIME = 3, SPEED = 7 };
enum { CHIP_ID = 0x0C, RESET_IS_SHORT = 0, PRESENCE = 1, NO_PRESENCE = 3 };

#define US INT64_C(1000)
#define SLOT_NS 69400 /* 0.52 to 0.57 ms for a byte */
#define OVERDRIVE_SLOT_NS 10000
#define RESET_NS (1096 * US)
#define OVERDRIVE_RESET_NS (140 * US)

static const uint32_t speeds[4] = {9600, 19200, 57600, 115200};
/* us; the forbidden code and the endless one are 0 */
static const uint32_t strong_us[8] = {16400, 65500, 131000, 262000, 524000, 1048000, 0, 0};

void sim_ds2480b_reset(struct sim_serial *serial, int64_t t)
{
	/* slew rate, 12 V pulse, strong pull-up, write-1 low, sample offset, load, speed */
	static const uint8_t defaults[8] = {0, 0, 4, 4, 0, 0, 0, 0};

	if (serial->pulse)
		sim_serial_strong(serial, false, t);
	/* what it had still to say */
	while (serial->answers &&
	       serial->answer[(serial->first + serial->answers - 1) % SIM_SERIAL_ANSWERS].at > t)
		serial->answers--;
	serial->answered_at = t;
	memcpy(serial->parameter, defaults, sizeof(defaults));
	serial->baud = speeds[0];
	serial->data_mode = serial->escaped = serial->search = serial->lost = false;
	serial->armed = serial->pulse = false;
	serial->speed = 0;
	serial->start = serial->end = t;
	serial->master_resets++;
}

static bool is_overdrive(const struct sim_serial *serial)
{
	return serial->speed == 2;
}

static int64_t slot_ns(const struct sim_serial *serial)
{
	return is_overdrive(serial) ? OVERDRIVE_SLOT_NS : SLOT_NS;
}

/* The strong pull-up from t on: for its time, or until F1. */
static int64_t begin_pulse(struct sim_serial *serial, uint8_t answer, int64_t t)
{
	int64_t takes = strong_us[serial->parameter[STRONG_TIME]] * US;

	sim_serial_strong(serial, true, t);
	if (!takes) {
		serial->pulse = true;
		serial->pulse_answer = answer;
		return t;
	}
	sim_serial_strong(serial, false, t + takes);
	sim_serial_answer(serial, answer, t + takes);
	return t + takes;
}

static int64_t single_bit(struct sim_serial *serial, uint8_t byte, int64_t t)
{
	bool line = sim_serial_slot(serial, byte & BIT_IS_ONE, is_overdrive(serial), t);

	t += slot_ns(serial);
	sim_serial_answer(serial, (uint8_t)((byte & 0xFC) | (line ? 3 : 0)), t);
	return byte & STRONG ? begin_pulse(serial, 0xEC, t) : t;
}

static int64_t reset(struct sim_serial *serial, int64_t t)
{
	bool present = sim_serial_reset(serial, is_overdrive(serial), t);
	uint8_t answer = 0xC0 | CHIP_ID | (present ? PRESENCE : NO_PRESENCE);

	if (sim_serial_is_short(serial))
		answer = 0xC0 | CHIP_ID | RESET_IS_SHORT;
	t += is_overdrive(serial) ? OVERDRIVE_RESET_NS : RESET_NS;
	sim_serial_answer(serial, answer, t);
	return t;
}

static int64_t configure(struct sim_serial *serial, uint8_t byte, int64_t t)
{
	unsigned parameter = byte >> 4, value = byte >> 1 & 7;

	if (parameter == 0) { /* read */
		sim_serial_answer(serial, (uint8_t)(serial->parameter[value] << 1), t);
		return t;
	}
	serial->parameter[parameter] = (uint8_t)value;
	if (parameter == SPEED)
		serial->baud = speeds[value & 3];
	sim_serial_answer(serial, byte & 0xFE, t);
	return t;
}

static int64_t command(struct sim_serial *serial, uint8_t byte, int64_t t)
{
	if (serial->pulse) {
		if (byte != END_PULSE)
			return t;
		serial->pulse = false;
		sim_serial_strong(serial, false, t);
		sim_serial_answer(serial, serial->pulse_answer, t);
		return t;
	}
	if (byte == DATA_MODE || byte == COMMAND_MODE) {
		serial->data_mode = byte == DATA_MODE;
		return t;
	}
	if (!(byte & 1) || byte == END_PULSE)
		return t;
	if (!(byte & 0x80))
		return configure(serial, byte, t);
	if ((byte >> 5 & 3) != PULSE)
		serial->speed = byte >> 2 & 3;
	switch (byte >> 5 & 3) {
	case PULSE:
		serial->armed = byte & ARM && !(byte & PROGRAM);
		return begin_pulse(serial, byte & 0xFC, t);
	case SINGLE_BIT:
		return single_bit(serial, byte, t);
	case RESET:
		return reset(serial, t);
	default:
		serial->search = byte & SEARCH_ON;
		serial->lost = false;
		return t;
	}
}

/*
 * One step of the accelerator: of a conflict the host's bit r is taken; without an answer all bits
 * are ones from there on. Returns the bit taken, and in bit 0 whether there was a conflict.
 */
static uint8_t step(struct sim_serial *serial, bool r, int64_t t)
{
	bool id, complement, taken;

	if (serial->lost)
		return 3;
	id = sim_serial_slot(serial, true, is_overdrive(serial), t);
	complement = sim_serial_slot(serial, true, is_overdrive(serial), t + slot_ns(serial));
	serial->lost = id && complement;
	taken = id == complement ? (serial->lost || r) : id;
	sim_serial_slot(serial, taken, is_overdrive(serial), t + 2 * slot_ns(serial));
	return (uint8_t)(taken << 1 | (id == complement));
}

static int64_t data(struct sim_serial *serial, uint8_t byte, int64_t t)
{
	uint8_t back = 0;

	if (serial->search) {
		for (unsigned i = 0; i < 8; i += 2) {
			back |= (uint8_t)(step(serial, byte >> (i + 1) & 1, t) << i);
			t += 3 * slot_ns(serial);
		}
	} else {
		for (unsigned i = 0; i < 8; i++) {
			bool line = sim_serial_slot(serial, byte >> i & 1, is_overdrive(serial), t);

			back |= (uint8_t)(line << i);
			t += slot_ns(serial);
		}
	}
	sim_serial_answer(serial, back, t);
	return serial->armed && !serial->search ? begin_pulse(serial, 0x76, t) : t;
}

int64_t sim_ds2480b_byte(struct sim_serial *serial, uint8_t byte, int64_t t)
{
	if (!serial->data_mode || serial->pulse)
		return command(serial, byte, t);
	if (!serial->escaped && byte == COMMAND_MODE) {
		serial->escaped = true;
		return t;
	}
	if (serial->escaped && byte != COMMAND_MODE) {
		serial->escaped = serial->data_mode = false;
		return command(serial, byte, t);
	}
	serial->escaped = false;
	return data(serial, byte, t);
}
