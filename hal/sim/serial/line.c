/* SPDX-License-Identifier: MIT */
/* The line of a simulated serial adapter: its bytes in time, and what is lost. */
#include "hal/sim/serial/line.h"
#include "hal/base/time.h"
#include "hal/sim/serial/ds2480b.h"
#include "hal/sim/serial/passive.h"

static int64_t byte_ns(uint32_t baud)
{
	return 10 * NS_PER_S / baud;
}

void sim_serial_init(struct sim_serial *serial, enum sim_serial_kind kind, struct sim_net *net)
{
	*serial = (struct sim_serial){.kind = kind, .net = net};
	sim_ds2480b_reset(serial, 0);
	serial->master_resets = 0;
}

/*
 * A byte waits in the buffer while the one before is carried out; a third one takes its place, and
 * so it is lost.
 */
static void take_ds2480b(struct sim_serial *serial, uint8_t byte, uint32_t baud, int64_t t)
{
	if (baud != serial->baud) {
		/* data sheet, "Master reset": longer low than a byte of the chip's own speed */
		if (byte == 0 && baud < serial->baud)
			sim_ds2480b_reset(serial, t);
		return;
	}
	if (serial->start > t) {
		serial->overruns++;
		return;
	}
	serial->start = t > serial->end ? t : serial->end;
	serial->end = sim_ds2480b_byte(serial, byte, serial->start);
}

void sim_serial_send(struct sim_serial *serial, uint8_t byte, uint32_t baud, int64_t now)
{
	int64_t t = (now > serial->sent_at ? now : serial->sent_at) + byte_ns(baud);

	serial->sent_at = t;
	serial->bytes++;
	if (serial->silent)
		return;
	sim_net_run(serial->net, t);
	if (serial->kind == SIM_DS2480B)
		take_ds2480b(serial, byte, baud, t);
	else
		sim_passive_byte(serial, byte, baud, t);
}

void sim_serial_break(struct sim_serial *serial, int64_t now)
{
	sim_net_run(serial->net, now);
	if (serial->kind == SIM_DS2480B && !serial->silent)
		sim_ds2480b_reset(serial, now);
}

int64_t sim_serial_due(const struct sim_serial *serial)
{
	return serial->answers ? serial->answer[serial->first].at : INT64_MAX;
}

uint8_t sim_serial_take(struct sim_serial *serial, uint32_t baud)
{
	const struct sim_serial_answer *answer = &serial->answer[serial->first];

	serial->first = (serial->first + 1) % SIM_SERIAL_ANSWERS;
	serial->answers--;
	return answer->baud == baud ? answer->byte : (uint8_t)(answer->byte << 3 | 0x05);
}
