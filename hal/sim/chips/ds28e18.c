/* SPDX-License-Identifier: MIT */
/*
 * DS28E18, 1-Wire to I2C/SPI bridge with command sequencer. From the maker's application note 7356
 * and published drivers; no whole data sheet was at hand. After power-on the ROM id is 56h with
 * zeros, until Write GPIO Configuration has loaded the real one. SPI is not simulated, nor the
 * supply of the sensors by SENS_VDD.
 */
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/chips/sensors.h"
#include "hal/sim/crc.h"
#include "hal/sim/families.h"

/* Device functions. */
enum {
	WRITE_SEQUENCER = 0x11,
	READ_SEQUENCER = 0x22,
	RUN_SEQUENCER = 0x33,
	WRITE_CONFIGURATION = 0x55,
	READ_CONFIGURATION = 0x6A,
	WRITE_GPIO = 0x83,
	READ_GPIO = 0x7C,
	DEVICE_STATUS = 0x7A,
};
/* Results. */
enum { POWER_ON = 0x44, MALFORMED = 0x55, INVALID = 0x77, REFUSED = 0x88, DONE = 0xAA };
enum { SEQUENCE = 512, PACKET = 130, RELEASE = 0xAA, IGNORE_NACK = 0x04 };

#define OPERATION_NS NS_PER_MS /* tOP */

struct ds28e18 {
	struct sim_sensors sensors; /* first */
	uint8_t rom[8];             /* the real one */
	uint8_t sequence[SEQUENCE];
	bool empty;             /* of the sequencer: nothing was written since power-on */
	bool restarted;         /* the status has not been read since power-on */
	uint8_t packet[PACKET]; /* device function and its parameters */
	unsigned got;
	bool checked;           /* the packet's checksum was sent, the release byte is due */
	bool released;          /* it has come */
	uint8_t result[PACKET]; /* length, result, data */
	uint8_t answer[PACKET + 3];
	unsigned answers, sent;
	uint8_t configuration, gpio[2][2];
};

static void ds28e18_create(struct sim_slave *slave)
{
	memcpy(sim_state(slave, ds28e18)->rom, slave->rom, 8);
}

static void ds28e18_power_on(struct sim_slave *slave)
{
	struct ds28e18 *s = slave->state;

	sim_sensors_power_on(slave);
	memset(slave->rom + 1, 0, 6);
	slave->rom[7] = sim_crc8(0, slave->rom, 7);
	memset(s->sequence, 0, SEQUENCE);
	s->empty = s->restarted = true;
	s->configuration = 0;
	memset(s->gpio, 0, sizeof(s->gpio));
}

/* --- The sequencer ---------------------------------------------------------------------------- */

struct run {
	struct sim_slave *slave;
	unsigned at, end;
	bool addressing; /* the next byte that is written follows a START */
};

/* One byte of I2C at 100, 400, 1000 kHz. */
static void spend_byte(struct run *run)
{
	static const int64_t byte_ns[] = {136000, 45000, 25000, 25000};

	run->slave->now += byte_ns[sim_state(run->slave, ds28e18)->configuration & 3];
}

/* False: the byte was not acknowledged. */
static bool run_write(struct run *run, unsigned n)
{
	struct ds28e18 *s = sim_state(run->slave, ds28e18);
	bool taken = true;

	while (n-- && taken) {
		uint8_t byte = s->sequence[run->at++];

		spend_byte(run);
		taken = run->addressing ? sim_sensors_start(run->slave, byte)
		                        : sim_sensors_write(run->slave, byte);
		run->addressing = false;
		taken |= (s->configuration & IGNORE_NACK) != 0;
	}
	return taken;
}

static void run_read(struct run *run, unsigned n)
{
	struct ds28e18 *s = sim_state(run->slave, ds28e18);

	while (n--) {
		spend_byte(run);
		s->sequence[run->at++] = sim_sensors_read(run->slave);
	}
}

/* The commands of a sequence. */
static const struct command {
	uint8_t code;
	bool alone;     /* no parameter follows */
	uint16_t bytes; /* after the parameter; 256: as many as it says, and 256 for 0 */
} commands[] = {
	{0x02, true, 0},    {0x03, true, 0},    /* START, STOP */
	{0xCC, true, 0},    {0xBB, true, 0},    /* SENS_VDD on, off */
	{0xE3, false, 256}, {0xD4, false, 256}, /* write, read */
	{0xD3, false, 256}, {0xDD, false, 0},   /* read with NACK at the end, delay */
	{0xD1, false, 0},   {0x1D, false, 0},   /* GPIO buffer write, read */
	{0xE2, false, 1},   {0x2E, false, 1},   /* GPIO control write, read */
};
#define COMMANDS (sizeof(commands) / sizeof(commands[0]))

/* One command of the sequence; DONE, or the result that ends it. */
static uint8_t ds28e18_step(struct run *run)
{
	struct ds28e18 *s = sim_state(run->slave, ds28e18);
	const struct command *command = commands;
	uint8_t code = s->sequence[run->at++], parameter = 0;
	unsigned n;

	while (command < commands + COMMANDS && command->code != code)
		command++;
	if (command == commands + COMMANDS)
		return MALFORMED;
	if (!command->alone && run->at < run->end)
		parameter = s->sequence[run->at];
	run->at += !command->alone;
	n = command->bytes == 256 && parameter ? parameter : command->bytes;
	if (run->at + n > run->end)
		return MALFORMED;
	switch (code) {
	case 0x02:
		run->addressing = true;
		break;
	case 0x03:
		sim_sensors_stop(run->slave);
		break;
	case 0xE3:
		return run_write(run, n) ? DONE : REFUSED;
	case 0xD3:
	case 0xD4:
		run_read(run, n);
		break;
	case 0xDD:
		run->slave->now += NS_PER_MS << (parameter & 15);
		break;
	default:
		run->at += n;
		break;
	}
	return DONE;
}

static void ds28e18_answer(struct ds28e18 *s, uint8_t result)
{
	s->result[0] = 1;
	s->result[1] = result;
}

static void ds28e18_add(struct ds28e18 *s, uint8_t byte)
{
	s->result[++s->result[0]] = byte;
}

/* The sequence runs at once, ahead of the time. Returns how long it took. */
static int64_t run_sequencer(struct sim_slave *slave)
{
	struct ds28e18 *s = slave->state;
	unsigned length = s->packet[2] >> 1 | (s->packet[3] & 3u) << 7;
	struct run run = {.slave = slave, .at = s->packet[1] | (s->packet[2] & 1u) << 8};
	int64_t began = slave->now, took;
	uint8_t result = s->empty ? POWER_ON : DONE;

	run.end = run.at + (length ? length : SEQUENCE);
	if (run.end > SEQUENCE)
		result = INVALID;
	while (result == DONE && run.at < run.end)
		result = ds28e18_step(&run);
	ds28e18_answer(s, result);
	if (result == REFUSED) { /* the place of the byte, from 1 on; 512 is 0 */
		ds28e18_add(s, (uint8_t)run.at);
		ds28e18_add(s, (uint8_t)(run.at >> 8 & 1));
		sim_sensors_stop(slave);
	}
	took = slave->now - began;
	slave->now = began;
	return took;
}

/* --- Device functions ------------------------------------------------------------------------- */

static void write_sequencer(struct ds28e18 *s)
{
	unsigned at = s->packet[1] | (s->packet[2] & 1u) << 8, n = s->got - 3;

	if (at + n > SEQUENCE) {
		ds28e18_answer(s, INVALID);
		return;
	}
	memcpy(s->sequence + at, s->packet + 3, n);
	s->empty = false;
}

static void read_sequencer(struct ds28e18 *s)
{
	unsigned at = s->packet[1] | (s->packet[2] & 1u) << 8, n = s->packet[2] >> 1;

	n = n ? n : 128;
	if (at + n > SEQUENCE)
		ds28e18_answer(s, INVALID);
	for (unsigned i = 0; at + n <= SEQUENCE && i < n; i++)
		ds28e18_add(s, s->sequence[at + i]);
}

static void access_gpio(struct ds28e18 *s, bool write)
{
	uint8_t which = s->packet[1] - 0x0B;

	if (which > 1) {
		ds28e18_answer(s, INVALID);
		return;
	}
	for (unsigned i = 0; i < 2; i++) {
		if (write)
			s->gpio[which][i] = s->packet[3 + i];
		else
			ds28e18_add(s, s->gpio[which][i]);
	}
}

static void device_status(struct ds28e18 *s)
{
	ds28e18_add(s, s->restarted ? 0x02 : 0x00);
	for (unsigned i = 0; i < 3; i++)
		ds28e18_add(s, 0);
	s->restarted = false;
}

/* Is the packet a device function with as many parameters as it takes? */
static bool is_valid(const struct ds28e18 *s)
{
	static const struct {
		uint8_t function, least, most;
	} functions[] = {
		{WRITE_SEQUENCER, 3, PACKET}, {READ_SEQUENCER, 2, 2}, {RUN_SEQUENCER, 3, 3},
		{WRITE_CONFIGURATION, 1, 1},  {WRITE_GPIO, 4, 4},     {READ_GPIO, 2, 2},
		{READ_CONFIGURATION, 0, 0},   {DEVICE_STATUS, 0, 0},
	};

	for (unsigned i = 0; i < sizeof(functions) / sizeof(functions[0]); i++)
		if (functions[i].function == s->packet[0])
			return s->got > functions[i].least && s->got <= functions[i].most + 1u;
	return false;
}

static int64_t carry_out(struct sim_slave *slave)
{
	struct ds28e18 *s = slave->state;
	int64_t takes = OPERATION_NS;

	ds28e18_answer(s, is_valid(s) ? DONE : INVALID);
	if (!is_valid(s))
		return takes;
	switch (s->packet[0]) {
	case WRITE_SEQUENCER:
		write_sequencer(s);
		break;
	case READ_SEQUENCER:
		read_sequencer(s);
		break;
	case RUN_SEQUENCER:
		takes += run_sequencer(slave);
		break;
	case WRITE_CONFIGURATION:
		s->configuration = s->packet[1] & 0x3F;
		break;
	case READ_CONFIGURATION:
		ds28e18_add(s, s->configuration);
		break;
	case WRITE_GPIO:
		memcpy(slave->rom, s->rom, 8);
		access_gpio(s, true);
		break;
	case READ_GPIO:
		access_gpio(s, false);
		break;
	default:
		device_status(s);
		break;
	}
	return takes;
}

/* Length and packet, whose checksum the bridge sends; the release byte starts the function. */
static void ds28e18_begin(struct sim_slave *slave)
{
	struct ds28e18 *s = slave->state;

	s->got = 0;
	s->checked = s->released = false;
	if (slave->taken[0] == 0 || slave->taken[0] > PACKET)
		sim_end(slave);
}

static void take_packet(struct sim_slave *slave, uint8_t byte)
{
	struct ds28e18 *s = slave->state;

	if (s->checked && byte == RELEASE) {
		s->released = true;
		sim_work(slave, carry_out(slave));
	} else if (s->checked) {
		sim_end(slave);
	} else {
		s->packet[s->got++] = byte;
		s->checked = s->got == slave->taken[0];
		if (s->checked)
			sim_send_checked(slave, NULL, 0);
	}
}

static void ds28e18_worked(struct sim_slave *slave)
{
	struct ds28e18 *s = slave->state;
	uint16_t crc = sim_crc16(0, s->result, s->result[0] + 1u);

	s->answer[0] = 0xFF; /* the dummy byte */
	memcpy(s->answer + 1, s->result, s->result[0] + 1u);
	s->answers = s->result[0] + 2u;
	s->answer[s->answers++] = (uint8_t)~crc;
	s->answer[s->answers++] = (uint8_t)(~crc >> 8);
	s->sent = 0;
}

/* Behind the packet's checksum the release byte is due; behind the answer, nothing. */
static void send_result(struct sim_slave *slave)
{
	struct ds28e18 *s = slave->state;
	unsigned n = s->answers - s->sent;

	if (!s->released) {
		sim_receive(slave);
	} else if (n == 0) {
		sim_end(slave);
	} else {
		n = n < SIM_MAX_SEND ? n : SIM_MAX_SEND;
		sim_send(slave, s->answer + s->sent, n);
		s->sent += n;
	}
}

/* Ones while it works; then a dummy byte of ones, and length and result with their checksum. */
static bool ds28e18_bit(struct sim_slave *slave)
{
	if (!slave->busy)
		send_result(slave);
	return true;
}

static const struct sim_function functions[] = {
	{.code = 0x66,
         .takes = 1,
         .start = ds28e18_begin,
         .byte = take_packet,
         .next = send_result},
	{0},
};

const struct sim_family sim_ds28e18 = {
	.name = "DS28E18",
	.code = 0x56,
	.overdrive = true,
	.resume = true,
	.starves = true,
	.state_size = sizeof(struct ds28e18),
	.functions = functions,
	.inputs = sim_sensor_inputs,
	.create = ds28e18_create,
	.power_on = ds28e18_power_on,
	.bit = ds28e18_bit,
	.worked = ds28e18_worked,
	.options = sim_sensor_options,
};
