/* SPDX-License-Identifier: MIT */
/*
 * DS28E17, 1-Wire to I2C bridge. From published drivers (Linux w1_ds28e17, Maxim's library); no
 * data sheet was at hand. A packet ends with its CRC16; then read slots are 1 while the bridge is
 * busy, and a 0 stands before the status.
 */
#include <string.h>

#include "hal/sim/chips/sensors.h"
#include "hal/sim/families.h"

/* Commands with a packet. */
enum {
	WRITE_STOP = 0x4B,
	WRITE_NO_STOP = 0x5A,
	WRITE_ONLY = 0x69,
	WRITE_ONLY_STOP = 0x78,
	READ_STOP = 0x87,
	WRITE_READ_STOP = 0x2D,
};
/* Status. */
enum { BAD_CRC = 0x01, NO_ADDRESS = 0x02, NO_START = 0x08 };
enum { GOOD_CRC = 0xB001, PACKET = 255 };

struct ds28e17 {
	struct sim_sensors sensors; /* first */
	uint8_t data[PACKET + 3];   /* behind the length: what is written, a second length, CRC */
	unsigned length, got;
	uint8_t code, address;      /* of the packet that is whole; a reset does not end its work */
	bool good;                  /* its checksum is right */
	uint8_t answer[PACKET + 3]; /* a byte of which one bit is sent, status, bytes read */
	unsigned answers, sent;
	uint8_t speed; /* 100, 400, 900 kHz */
	bool started;  /* the I2C transaction has no STOP yet */
};

static void ds28e17_power_on(struct sim_slave *slave)
{
	struct ds28e17 *s = slave->state;

	sim_sensors_power_on(slave);
	s->speed = 1;
	s->started = false;
}

static bool has_write(uint8_t code)
{
	return code != READ_STOP;
}

static bool has_address(uint8_t code)
{
	return code != WRITE_ONLY && code != WRITE_ONLY_STOP;
}

static bool has_read(uint8_t code)
{
	return code == READ_STOP || code == WRITE_READ_STOP;
}

/* Returns the status of writing; *at: the byte that was not acknowledged, from 1 on. */
static uint8_t write_i2c(struct sim_slave *slave, uint8_t code, uint8_t *at)
{
	struct ds28e17 *s = slave->state;

	*at = 0;
	if (!has_address(code) && !s->started)
		return NO_START;
	if (has_address(code) && !sim_sensors_start(slave, s->address & 0xFE))
		return NO_ADDRESS;
	for (unsigned i = 0; i < s->length && !*at; i++) {
		if (!sim_sensors_write(slave, s->data[i]))
			*at = (uint8_t)(i + 1);
	}
	return 0;
}

static void ds28e17_put(struct ds28e17 *s, uint8_t byte)
{
	s->answer[s->answers++] = byte;
}

/* The packet is whole and its checksum right: the I2C transaction. */
static void exchange_i2c(struct sim_slave *slave)
{
	struct ds28e17 *s = slave->state;
	uint8_t code = s->code, at = 0;
	uint8_t status = has_write(code) ? write_i2c(slave, code, &at) : 0;
	unsigned n = code == READ_STOP ? s->length : s->data[s->length];

	if (has_read(code) && !status && !at && !sim_sensors_start(slave, s->address | 1))
		status = NO_ADDRESS;
	ds28e17_put(s, status);
	if (has_write(code))
		ds28e17_put(s, at);
	for (unsigned i = 0; has_read(code) && i < n; i++)
		ds28e17_put(s, status || at ? 0xFF : sim_sensors_read(slave));
	s->started = !status && !at && (code == WRITE_NO_STOP || code == WRITE_ONLY);
	if (!s->started)
		sim_sensors_stop(slave);
}

static void ds28e17_worked(struct sim_slave *slave)
{
	struct ds28e17 *s = slave->state;

	s->answers = s->sent = 0;
	ds28e17_put(s, 0);
	if (!s->good) {
		ds28e17_put(s, BAD_CRC);
		if (has_write(s->code))
			ds28e17_put(s, 0);
	} else {
		exchange_i2c(slave);
	}
}

/* Send more of the answer. */
static void send_more(struct sim_slave *slave)
{
	struct ds28e17 *s = slave->state;
	unsigned n = s->answers - s->sent;

	if (n > SIM_MAX_SEND)
		n = SIM_MAX_SEND;
	if (n == 0) {
		sim_end(slave);
		return;
	}
	sim_send(slave, s->answer + s->sent, n);
	s->sent += n;
}

/* Busy: 1. The first 0 is the last bit of a byte, and the status follows. */
static bool ds28e17_bit(struct sim_slave *slave)
{
	if (slave->busy)
		return true;
	send_more(slave);
	slave->bits = 7;
	return false;
}

static void ds28e17_begin(struct sim_slave *slave)
{
	struct ds28e17 *s = slave->state;

	s->length = slave->taken[slave->function->takes - 1];
	s->got = 0;
	if (slave->busy)
		sim_end(slave);
}

static void take_packet(struct sim_slave *slave, uint8_t byte)
{
	static const int64_t byte_ns[] = {90000, 23000, 10000};
	struct ds28e17 *s = slave->state;
	uint8_t code = slave->function->code;
	unsigned written = has_write(code) ? s->length : 0;
	unsigned whole = written + (code == WRITE_READ_STOP) + 2;
	unsigned bytes = written + 2;

	s->data[s->got++] = byte;
	if (s->got < whole)
		return;
	if (has_read(code))
		bytes += code == READ_STOP ? s->length : s->data[s->length];
	s->code = code;
	s->address = slave->taken[0];
	s->good = slave->crc == GOOD_CRC;
	sim_work(slave, byte_ns[s->speed] * bytes);
}

static void write_configuration(struct sim_slave *slave)
{
	if (slave->taken[0] <= 2)
		sim_state(slave, ds28e17)->speed = slave->taken[0];
	sim_end(slave);
}

static void read_configuration(struct sim_slave *slave)
{
	sim_send_byte(slave, sim_state(slave, ds28e17)->speed);
}

static void revision(struct sim_slave *slave)
{
	sim_send_byte(slave, 0x10);
}

#define PACKET_FUNCTION(number, bytes) \
	.code = (number), .takes = (bytes), .start = ds28e17_begin, .byte = take_packet, \
	.next = send_more

static const struct sim_function functions[] = {
	{PACKET_FUNCTION(WRITE_STOP, 2)},
	{PACKET_FUNCTION(WRITE_NO_STOP, 2)},
	{PACKET_FUNCTION(WRITE_ONLY, 1)},
	{PACKET_FUNCTION(WRITE_ONLY_STOP, 1)},
	{PACKET_FUNCTION(READ_STOP, 2)},
	{PACKET_FUNCTION(WRITE_READ_STOP, 2)},
	{.code = 0xD2, .takes = 1, .start = write_configuration},
	{.code = 0xE1, .start = read_configuration},
	{.code = 0xC4, .start = revision},
	{.code = 0x1E, .start = sim_end}, /* It sleeps until the next reset. */
	{0},
};

const struct sim_family sim_ds28e17 = {
	.name = "DS28E17",
	.code = 0x19,
	.overdrive = true,
	.resume = true,
	.state_size = sizeof(struct ds28e17),
	.functions = functions,
	.inputs = sim_sensor_inputs,
	.power_on = ds28e17_power_on,
	.bit = ds28e17_bit,
	.worked = ds28e17_worked,
	.options = sim_sensor_options,
};
