/* SPDX-License-Identifier: MIT */
/*
 * MCP23017 (Microchip DS20001952, "16-bit I/O expander"): its pins, each an input or an output. The
 * registers stay in pairs (IOCON.BANK is 0); interrupts are not simulated.
 */
#include <string.h>

#include "hal/sim/chips/sensor.h"

enum { IODIR = 0x00, IPOL = 0x02, IOCON = 0x0A, GPIO = 0x12, OLAT = 0x14, REGISTERS = 0x16 };
enum { SEQOP = 0x20 };

static void mcp23017_power_on(struct sim_sensor *sensor)
{
	memset(sensor->reg, 0, sizeof(sensor->reg));
	sensor->reg[IODIR] = sensor->reg[IODIR + 1] = 0xFF;
}

static void move_on(struct sim_sensor *sensor)
{
	if (!(sensor->reg[IOCON] & SEQOP))
		sensor->pointer = (uint8_t)((sensor->pointer + 1) % REGISTERS);
	else
		sensor->pointer ^= 1; /* the pair's other one */
}

static bool mcp23017_take(struct sim_slave *slave, struct sim_sensor *sensor, uint8_t byte,
                          unsigned at)
{
	uint8_t to = sensor->pointer;

	(void)slave;
	if (at == 0) {
		sensor->pointer = byte;
		return true;
	}
	if (to == IOCON || to == IOCON + 1)
		sensor->reg[IOCON] = sensor->reg[IOCON + 1] = byte & 0x3E;
	else if (to == GPIO || to == GPIO + 1)
		sensor->reg[to + OLAT - GPIO] = byte;
	else if (to < 0x0E || to == OLAT || to == OLAT + 1)
		sensor->reg[to] = byte;
	move_on(sensor);
	return true;
}

/* An output has its latch, an input what drives it, turned over where IPOL says so. */
static uint8_t port_level(struct sim_slave *slave, const struct sim_sensor *sensor, unsigned port)
{
	uint8_t in = (uint8_t)((unsigned)sim_input_now(slave, SENSOR_PINS) >> 8 * port);
	uint8_t direction = sensor->reg[IODIR + port];

	in ^= sensor->reg[IPOL + port];
	return (uint8_t)((in & direction) | (sensor->reg[OLAT + port] & ~direction));
}

static uint8_t mcp23017_give(struct sim_slave *slave, struct sim_sensor *sensor, unsigned at)
{
	uint8_t from = sensor->pointer;

	(void)at;
	move_on(sensor);
	if (from == GPIO || from == GPIO + 1)
		return port_level(slave, sensor, from - GPIO);
	return from < REGISTERS ? sensor->reg[from] : 0;
}

const struct sim_sensor_kind sim_sensor_mcp23017 = {
	.power_on = mcp23017_power_on, .write = mcp23017_take, .read = mcp23017_give};
