/* SPDX-License-Identifier: MIT */
/* What a simulated serial adapter does: answers to the host, and its wire. */
#include "hal/sim/serial/answer.h"
#include "hal/base/time.h"

static struct sim_wire *wire_of(struct sim_serial *serial)
{
	return &serial->net->chip[0].wire[0];
}

bool sim_serial_reset(struct sim_serial *serial, bool overdrive, int64_t now)
{
	sim_net_run(serial->net, now);
	return sim_wire_reset(wire_of(serial), overdrive, serial->net->time);
}

bool sim_serial_slot(struct sim_serial *serial, bool out, bool overdrive, int64_t now)
{
	sim_net_run(serial->net, now);
	return sim_wire_slot(wire_of(serial), out, overdrive, serial->net->time);
}

bool sim_serial_is_short(struct sim_serial *serial)
{
	return !sim_wire_level(wire_of(serial), serial->net->time);
}

void sim_serial_strong(struct sim_serial *serial, bool on, int64_t now)
{
	sim_net_run(serial->net, now);
	sim_wire_strong(wire_of(serial), on, serial->net->time);
}

void sim_serial_answer(struct sim_serial *serial, uint8_t byte, int64_t t)
{
	struct sim_serial_answer *answer;

	if (serial->answers == SIM_SERIAL_ANSWERS)
		return;
	serial->answered++;
	if (serial->noise_each && serial->answered % serial->noise_each == 0)
		byte ^= (uint8_t)(1u << (serial->answered / serial->noise_each % 8));
	if (t < serial->answered_at)
		t = serial->answered_at;
	serial->answered_at = t + 10 * NS_PER_S / serial->baud;
	answer = &serial->answer[(serial->first + serial->answers++) % SIM_SERIAL_ANSWERS];
	*answer = (struct sim_serial_answer){serial->answered_at, serial->baud, byte};
}
