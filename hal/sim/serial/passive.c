/* SPDX-License-Identifier: MIT */
/*
 * A passive adapter: the line of the host is the wire. Each byte comes back as what the wire made
 * of it. The start bit is low, so the zeros after it tell how long the host holds the wire low.
 */
#include "hal/sim/serial/passive.h"
#include "hal/base/time.h"
#include "hal/sim/serial/answer.h"

enum { RESET = 0xF0, PRESENT = 0xE0, SLOT_WAS_LOW = 0xFE };
#define US 1000
#define RESET_LOW_NS (400 * US) /* slaves take it for a reset pulse (480 by the data sheets) */

void sim_passive_byte(struct sim_serial *serial, uint8_t byte, uint32_t baud, int64_t t)
{
	int64_t bit_ns = NS_PER_S / baud, low_ns = bit_ns;
	uint8_t back = byte;

	for (unsigned i = 0; i < 8 && !(byte >> i & 1); i++)
		low_ns += bit_ns;
	serial->baud = baud;
	if (low_ns >= RESET_LOW_NS) {
		if (sim_serial_reset(serial, false, t) && byte == RESET)
			back = PRESENT;
	} else if (!sim_serial_slot(serial, low_ns < 15 * US, false, t)) {
		back = byte & SLOT_WAS_LOW;
	}
	if (sim_serial_is_short(serial))
		back = 0;
	/* its bits come back as they go */
	sim_serial_answer(serial, back, t - 10 * bit_ns);
}
