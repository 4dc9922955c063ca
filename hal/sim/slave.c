/* SPDX-License-Identifier: MIT */
/*
 * A simulated slave: the ROM layer bit by bit, and the calls of its family.
 *
 * In each slot the wire asks every slave for its output, and then gives all of them the level that
 * results. So slaves that send different bits at once act as on a wire with open-drain outputs. A
 * slave that takes no further part is deaf (SIM_ROM_IDLE) until the next reset.
 */
#include <assert.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "hal/sim/crc.h"
#include "hal/sim/slave.h"

/* ROM commands: DS2408 data sheet, "1-Wire ROM function commands"; the same in all families. */
enum {
	ROM_READ = 0x33,
	ROM_READ_OLD = 0x0F, /* DS2401, DS2405: the DS2400's code */
	ROM_MATCH = 0x55,
	ROM_SKIP = 0xCC,
	ROM_SEARCH = 0xF0,
	ROM_CONDITIONAL = 0xEC,
	ROM_RESUME = 0xA5,
	ROM_OVERDRIVE_SKIP = 0x3C,
	ROM_OVERDRIVE_MATCH = 0x69,
};

/* tSPON: the strong pull-up has to come within 10 us of the command's last slot. */
#define STRONG_WITHIN_NS 100000

struct sim_slave *sim_slave_create(const struct sim_family *family, const uint8_t id[6])
{
	struct sim_slave *slave = calloc(1, sizeof(*slave));

	if (!slave)
		return NULL;
	slave->state = calloc(1, family->state_size ? family->state_size : 1);
	if (!slave->state) {
		free(slave);
		return NULL;
	}
	slave->family = family;
	slave->plugged = true;
	slave->corrupt_bit = -1;
	slave->rom[0] = family->code;
	memcpy(slave->rom + 1, id, 6);
	slave->rom[7] = sim_crc8(0, slave->rom, 7);
	for (unsigned i = 0; family->inputs && family->inputs[i].name; i++) {
		assert(i < SIM_MAX_INPUTS);
		slave->input[i] = sim_constant(family->inputs[i].start);
	}
	if (family->create)
		family->create(slave);
	return slave;
}

void sim_slave_destroy(struct sim_slave *slave)
{
	if (!slave)
		return;
	free(slave->state);
	free(slave);
}

const struct sim_family *sim_family_find(const char *name, uint8_t code)
{
	for (const struct sim_family *const *f = sim_families; *f; f++) {
		if (name ? strcasecmp((*f)->name, name) == 0 : (*f)->code == code)
			return *f;
	}
	return NULL;
}

int sim_slave_input(const struct sim_slave *slave, const char *name)
{
	const struct sim_input *inputs = slave->family->inputs;

	for (int i = 0; inputs && inputs[i].name; i++) {
		if (strcmp(inputs[i].name, name) == 0)
			return i;
	}
	return -1;
}

double sim_input_now(const struct sim_slave *slave, unsigned input)
{
	return sim_input_at(slave, input, slave->now);
}

double sim_input_at(const struct sim_slave *slave, unsigned input, int64_t t)
{
	return sim_curve_at(&slave->input[input], t);
}

int sim_slave_option(struct sim_slave *slave, const char *name, double value)
{
	const struct sim_option *option = slave->family->options;

	while (option && option->name && strcmp(option->name, name) != 0)
		option++;
	if (!option || !option->name)
		return -ENOENT;
	if (value < option->least || value > option->most || value != (double)(int64_t)value)
		return -ERANGE;
	if (option->set)
		option->set(slave, (int64_t)value);
	else
		*((uint8_t *)slave->state + option->at) = (uint8_t)(int64_t)value;
	return 0;
}

uint8_t *sim_slave_memory(const struct sim_slave *slave, size_t *size)
{
	*size = slave->family->memory_size;
	return *size ? (uint8_t *)slave->state + slave->family->memory_at : NULL;
}

void sim_receive(struct sim_slave *slave)
{
	slave->mode = SIM_RECEIVE;
	slave->bits = 0;
}

/* Add data to the next checksum. */
static void slave_check(struct sim_slave *slave, const uint8_t *data, size_t n)
{
	slave->crc = slave->family->crc8 ? sim_crc8((uint8_t)slave->crc, data, n)
	                                 : sim_crc16(slave->crc, data, n);
}

void sim_send(struct sim_slave *slave, const uint8_t *data, size_t n)
{
	assert(n > 0 && n <= SIM_MAX_SEND);
	memcpy(slave->send, data, n);
	slave_check(slave, data, n);
	slave->mode = SIM_SEND;
	slave->send_at = 0;
	slave->send_count = (uint16_t)n;
	slave->bits = 0;
}

void sim_send_byte(struct sim_slave *slave, uint8_t byte)
{
	sim_send(slave, &byte, 1);
}

void sim_send_bits(struct sim_slave *slave)
{
	slave->mode = SIM_BITS;
	slave->bits = 0;
}

void sim_end(struct sim_slave *slave)
{
	slave->layer = SIM_ROM_IDLE;
}

void sim_send_checked(struct sim_slave *slave, const uint8_t *data, size_t n)
{
	uint8_t out[SIM_MAX_SEND];

	assert(n + 2 <= sizeof(out));
	if (n)
		memcpy(out, data, n);
	slave_check(slave, data, n);
	if (slave->family->crc8) {
		out[n++] = (uint8_t)slave->crc;
	} else {
		out[n++] = (uint8_t)~slave->crc;
		out[n++] = (uint8_t)(~slave->crc >> 8);
	}
	sim_send(slave, out, n);
	slave->crc = 0;
}

void sim_send_crc8(struct sim_slave *slave, const uint8_t *data, size_t n)
{
	uint8_t out[SIM_MAX_SEND];

	assert(n < sizeof(out));
	memcpy(out, data, n);
	out[n] = sim_crc8(0, data, n);
	sim_send(slave, out, n + 1);
}

void sim_send_next(struct sim_slave *slave, uint8_t byte, unsigned page)
{
	slave->address++;
	if (page && slave->address % page == 0)
		sim_send_checked(slave, &byte, 1);
	else
		sim_send_byte(slave, byte);
}

void sim_send_memory(struct sim_slave *slave, const uint8_t *memory, unsigned size, unsigned page)
{
	if (slave->address >= size) {
		sim_end(slave);
		return;
	}
	sim_send_next(slave, memory[slave->address], page);
}

void sim_send_checksum(struct sim_slave *slave)
{
	sim_send_checked(slave, NULL, 0);
}

void sim_send_stored(struct sim_slave *slave, uint8_t stored)
{
	sim_send_checksum(slave);
	slave->send[slave->send_count++] = stored;
	slave->address++;
	slave->crc = slave->family->crc8 ? slave->address & 0xFF : slave->address;
}

void sim_work(struct sim_slave *slave, int64_t takes)
{
	slave->busy = true;
	slave->since = slave->now;
	slave->until = slave->now + takes;
	sim_send_bits(slave);
}

bool sim_ones(struct sim_slave *slave)
{
	(void)slave;
	return true;
}

/*
 * A slave that the wire feeds restarts if the strong pull-up does not come in time. Work ends at
 * its own time, not at the time of this call, so that it measures what the inputs were then.
 */
void sim_slave_advance(struct sim_slave *slave, int64_t t)
{
	bool fed = !slave->parasite || slave->strong || !slave->family->starves;

	slave->now = t;
	if (slave->busy && !fed && t > slave->since + STRONG_WITHIN_NS)
		sim_slave_power_on(slave, t);
	if (slave->busy && t >= slave->until) {
		slave->busy = false;
		slave->now = slave->until;
		slave->family->worked(slave);
		slave->now = t;
	}
	if (slave->family->advance)
		slave->family->advance(slave);
}

void sim_slave_power_on(struct sim_slave *slave, int64_t t)
{
	slave->now = t;
	slave->power_ons++;
	slave->layer = SIM_ROM_IDLE;
	slave->overdrive = slave->resumable = slave->busy = false;
	if (slave->family->power_on)
		slave->family->power_on(slave);
}

void sim_slave_brownout(struct sim_slave *slave, int64_t t)
{
	sim_slave_advance(slave, t);
	sim_slave_power_on(slave, t);
}

void sim_slave_reset(struct sim_slave *slave, bool overdrive, int64_t t)
{
	sim_slave_advance(slave, t);
	if (overdrive && !slave->overdrive) {
		slave->layer = SIM_ROM_IDLE;
		return;
	}
	slave->overdrive = overdrive;
	slave->layer = SIM_ROM_COMMAND;
	slave->function = NULL;
	sim_receive(slave);
}

void sim_slave_strong(struct sim_slave *slave, bool on, int64_t t)
{
	sim_slave_advance(slave, t);
	if (slave->strong == on)
		return;
	slave->strong = on;
	/* the operation under way needs the current until its end */
	if (!on && slave->parasite && slave->busy)
		sim_slave_power_on(slave, t);
}

/* xorshift64*: a seed gives the same numbers everywhere. */
static double random_part(uint64_t *state)
{
	uint64_t x = *state ? *state : 88172645463325252u;

	x ^= x >> 12;
	x ^= x << 25;
	x ^= x >> 27;
	*state = x;
	return (double)((x * 2685821657736338717u) >> 11) / 9007199254740992.0;
}

/* The slave was addressed. Whether a bit of this call is to be spoiled is decided here, once. */
static void function_layer(struct sim_slave *slave)
{
	slave->layer = SIM_FUNCTION;
	sim_receive(slave);
	slave->calls++;
	slave->corrupt_bit = -1;
	if ((slave->corrupt_every && slave->calls % slave->corrupt_every == 0) ||
	    (slave->corrupt_probability > 0 &&
	     random_part(&slave->corrupt_random) < slave->corrupt_probability))
		slave->corrupt_bit = (int)(random_part(&slave->corrupt_random) * 64);
}

static void begin_rom(struct sim_slave *slave, enum sim_layer layer)
{
	slave->layer = layer;
	slave->rom_bit = slave->search_phase = 0;
}

static void rom_command(struct sim_slave *slave, uint8_t byte)
{
	const struct sim_family *family = slave->family;
	bool resumable = slave->resumable;

	sim_end(slave);
	slave->resumable = resumable && byte == ROM_RESUME;
	switch (byte) {
	case ROM_READ:
		begin_rom(slave, SIM_ROM_READ);
		break;
	case ROM_READ_OLD:
		if (family->code == 0x01 || family->code == 0x05)
			begin_rom(slave, SIM_ROM_READ);
		break;
	case ROM_MATCH:
		begin_rom(slave, SIM_ROM_MATCH);
		break;
	case ROM_SEARCH:
		begin_rom(slave, SIM_ROM_SEARCH);
		break;
	case ROM_CONDITIONAL:
		if (family->alarm && family->alarm(slave))
			begin_rom(slave, SIM_ROM_SEARCH);
		break;
	case ROM_SKIP:
		function_layer(slave);
		break;
	case ROM_RESUME:
		if (family->resume && resumable)
			function_layer(slave);
		break;
	case ROM_OVERDRIVE_SKIP:
		if (family->overdrive) {
			slave->overdrive = true;
			function_layer(slave);
		}
		break;
	case ROM_OVERDRIVE_MATCH:
		if (family->overdrive) {
			slave->overdrive = true;
			begin_rom(slave, SIM_ROM_MATCH);
		}
		break;
	}
}

static bool rom_bit(const struct sim_slave *slave)
{
	return slave->rom[slave->rom_bit / 8] >> (slave->rom_bit % 8) & 1;
}

/* Agree upon one more bit of the ROM id; true: that was the last bit. */
static bool rom_step(struct sim_slave *slave, bool agreed)
{
	if (!agreed) {
		sim_end(slave);
		return false;
	}
	return ++slave->rom_bit == 64;
}

static void selected(struct sim_slave *slave, bool match)
{
	slave->resumable = slave->family->resume;
	function_layer(slave);
	if (slave->family->selected)
		slave->family->selected(slave, match);
}

static bool next_sent_bit(struct sim_slave *slave)
{
	bool out = slave->send[slave->send_at] >> slave->bits & 1;

	return slave->corrupt_bit == 0 ? !out : out;
}

bool sim_slave_output(struct sim_slave *slave, int64_t t)
{
	sim_slave_advance(slave, t);
	switch (slave->layer) {
	case SIM_ROM_IDLE:
	case SIM_ROM_COMMAND:
	case SIM_ROM_MATCH:
		break;
	case SIM_ROM_READ:
		return rom_bit(slave);
	case SIM_ROM_SEARCH:
		if (slave->search_phase < 2)
			return rom_bit(slave) ^ (slave->search_phase == 1);
		break;
	case SIM_FUNCTION:
		switch (slave->mode) {
		case SIM_RECEIVE:
			break;
		case SIM_SEND:
			return next_sent_bit(slave);
		case SIM_BITS:
			return slave->family->bit ? slave->family->bit(slave) : !slave->busy;
		}
		break;
	}
	return true;
}

static void sent_bit(struct sim_slave *slave)
{
	if (slave->corrupt_bit >= 0)
		slave->corrupt_bit--;
	if (++slave->bits < 8)
		return;
	slave->bits = 0;
	if (++slave->send_at < slave->send_count)
		return;
	if (slave->function->next)
		slave->function->next(slave);
	if (slave->mode == SIM_SEND && slave->send_at >= slave->send_count)
		sim_end(slave);
}

static bool is_function(const struct sim_function *function)
{
	return function->code || function->start || function->byte;
}

/* A code that the family does not have makes the slave deaf, as the data sheets state. */
static void begin_function(struct sim_slave *slave, uint8_t code)
{
	const struct sim_function *function = slave->family->functions;

	while (function && is_function(function) && !function->any && function->code != code)
		function++;
	if (!function || !is_function(function)) {
		sim_end(slave);
		return;
	}
	slave->function = function;
	slave->code = code;
	slave->got = 0;
	slave->address = slave->crc = 0;
	slave_check(slave, &code, 1);
	if (slave->family->begun)
		slave->family->begun(slave);
	if (!function->takes && function->start)
		function->start(slave);
}

static void function_byte(struct sim_slave *slave, uint8_t byte)
{
	const struct sim_function *function = slave->function;

	if (!function) {
		begin_function(slave, byte);
		return;
	}
	if (slave->got >= function->takes || slave->got < function->takes - function->unchecked)
		slave_check(slave, &byte, 1);
	if (slave->got < function->takes) {
		slave->taken[slave->got++] = byte;
		if (slave->got < function->takes)
			return;
		slave->address = (uint16_t)(slave->taken[0] |
		                            (function->takes > 1 ? slave->taken[1] << 8 : 0));
		if (function->start)
			function->start(slave);
	} else if (function->byte) {
		function->byte(slave, byte);
	} else {
		sim_end(slave);
	}
}

static void received_bit(struct sim_slave *slave, bool line)
{
	uint8_t byte = (uint8_t)(slave->shift >> 1 | (line ? 0x80 : 0));

	slave->shift = byte;
	if (++slave->bits < 8)
		return;
	slave->bits = 0;
	if (slave->layer == SIM_ROM_COMMAND)
		rom_command(slave, byte);
	else
		function_byte(slave, byte);
}

void sim_slave_slot(struct sim_slave *slave, bool line, int64_t t)
{
	slave->now = t;
	switch (slave->layer) {
	case SIM_ROM_IDLE:
		break;
	case SIM_ROM_COMMAND:
		received_bit(slave, line);
		break;
	case SIM_ROM_READ:
		if (rom_step(slave, true))
			function_layer(slave);
		break;
	case SIM_ROM_MATCH:
		if (rom_step(slave, line == rom_bit(slave)))
			selected(slave, true);
		break;
	case SIM_ROM_SEARCH:
		if (++slave->search_phase < 3)
			break;
		slave->search_phase = 0;
		if (rom_step(slave, line == rom_bit(slave)))
			selected(slave, false);
		break;
	case SIM_FUNCTION:
		switch (slave->mode) {
		case SIM_RECEIVE:
			received_bit(slave, line);
			break;
		case SIM_SEND:
			sent_bit(slave);
			break;
		case SIM_BITS:
			break;
		}
		break;
	}
}
