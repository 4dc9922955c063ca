/* SPDX-License-Identifier: MIT */
/*
 * Soft devices of Inferno Embedded: RGBW controller, switch master, firmware updater. No data sheet
 * can be had; the facts are those of OWFS's driver and manual page. A command is followed by its
 * bytes and a CRC8 of the ROM id, the command and them; the device answers 0 if that is right, then
 * data without a checksum. Numbers have their low byte first.
 */
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/crc.h"
#include "hal/sim/families.h"

enum kind { RGBW = 1, UPDATER, SWITCHES };
enum { LEDS = 4, PORTS = 2, CHANNELS = 4, RELAYS = CHANNELS, FIRMWARE = 2048 };
enum { START = 0x2000, BLOCK = 1024, WRITTEN = 8 }; /* WRITTEN: bytes ahead of those of a block */
enum { BOOT_UPDATER = 0xFC, STATUS, VERSION, DEVICE };
enum { POWER_ON = 0x01, ACTIVATED = 0x02, FAIL = 0x02, SUCCESS = 0x04 }; /* status */

struct light {
	uint8_t from[4], to[4], next[4];
	uint32_t fade_ms, next_ms;
	int64_t since;
};

struct inferno {
	struct light light[LEDS];
	uint8_t led[PORTS], type[PORTS][CHANNELS];
	uint8_t relay[3][RELAYS]; /* states, modes, timeouts */
	uint8_t active[PORTS], level[PORTS];
	enum kind kind; /* now */
	uint8_t status;
	uint8_t taken[WRITTEN + 1 + BLOCK + 4];
	uint16_t got;
	uint8_t firmware[FIRMWARE];
};

struct command {
	uint8_t code, args;
	/* Returns how many bytes the answer has after its 0; REFUSED; SILENT: there is none. */
	int (*answer)(struct sim_slave *slave, const uint8_t *args, uint8_t *out);
};
enum { REFUSED = -1, SILENT = -2 };

/* What it is but while its firmware is written. */
static enum kind application(const struct sim_slave *slave)
{
	return *(const enum kind *)slave->family->kind;
}

/* What a light shows; returns the ms that its fade still takes. */
static uint32_t light_shown(const struct light *light, uint8_t colour[4], int64_t t)
{
	int64_t gone = (t - light->since) / NS_PER_MS;
	uint32_t left = gone < light->fade_ms ? light->fade_ms - (uint32_t)gone : 0;

	for (unsigned i = 0; i < 4; i++) {
		int step = light->from[i] - light->to[i];

		colour[i] = light->to[i];
		if (left)
			colour[i] = (uint8_t)(light->to[i] + (int64_t)step * left / light->fade_ms);
	}
	return left;
}

static int lights_off(struct sim_slave *slave, const uint8_t *args, uint8_t *out)
{
	struct inferno *s = slave->state;

	(void)args, (void)out;
	memset(s->light, 0, sizeof(s->light));
	return 0;
}

static int count_lights(struct sim_slave *slave, const uint8_t *args, uint8_t *out)
{
	(void)slave, (void)args;
	out[0] = LEDS;
	return 1;
}

static int set_light(struct sim_slave *slave, const uint8_t *args, uint8_t *out)
{
	struct light *light = sim_state(slave, inferno)->light + args[0] % LEDS;

	(void)out;
	if (args[0] >= LEDS)
		return REFUSED;
	memcpy(light->next, args + 1, 4);
	light->next_ms = (uint32_t)sim_get(args + 5, 3);
	return 0;
}

static int get_light(struct sim_slave *slave, const uint8_t *args, uint8_t *out)
{
	if (args[0] >= LEDS)
		return REFUSED;
	sim_put(out + 4, 3,
	        light_shown(sim_state(slave, inferno)->light + args[0], out, slave->now));
	return 7;
}

static int commit_lights(struct sim_slave *slave, const uint8_t *args, uint8_t *out)
{
	(void)args, (void)out;
	for (unsigned i = 0; i < LEDS; i++) {
		struct light *light = sim_state(slave, inferno)->light + i;

		if (memcmp(light->next, light->to, 4) == 0)
			continue;
		light_shown(light, light->from, slave->now);
		memcpy(light->to, light->next, 4);
		light->fade_ms = light->next_ms;
		light->since = slave->now;
	}
	return 0;
}

static const struct command of_rgbw[] = {
	{0x01, 0, lights_off}, {0x02, 0, count_lights},  {0x03, 8, set_light},
	{0x04, 1, get_light},  {0x05, 0, commit_lights}, {0},
};

static int bootloader_size(struct sim_slave *slave, const uint8_t *args, uint8_t *out)
{
	(void)slave, (void)args;
	sim_put(out, 4, START);
	return 4;
}

static int firmware_range(struct sim_slave *slave, const uint8_t *args, uint8_t *out)
{
	(void)slave, (void)args;
	sim_put(out, 4, START);
	sim_put(out + 4, 4, START + FIRMWARE);
	return 8;
}

static int erase_firmware(struct sim_slave *slave, const uint8_t *args, uint8_t *out)
{
	struct inferno *s = slave->state;

	(void)args, (void)out;
	memset(s->firmware, 0xFF, FIRMWARE);
	s->status = SUCCESS;
	return 0;
}

static int boot_application(struct sim_slave *slave, const uint8_t *args, uint8_t *out)
{
	(void)args, (void)out;
	sim_state(slave, inferno)->kind = application(slave);
	return 0;
}

/* A part of the firmware: an address and a number of bytes. */
static uint8_t *firmware_part(struct sim_slave *slave, const uint8_t *args, unsigned *n)
{
	uint32_t at = (uint32_t)sim_get(args, 4);

	*n = (unsigned)sim_get(args + 4, 4);
	if (at < START || at >= START + FIRMWARE || *n > START + FIRMWARE - at)
		return NULL;
	return sim_state(slave, inferno)->firmware + (at - START);
}

/* The block may come then: take_block. */
static int inferno_write_block(struct sim_slave *slave, const uint8_t *args, uint8_t *out)
{
	unsigned n;

	(void)out;
	return firmware_part(slave, args, &n) && n && n <= BLOCK ? 0 : REFUSED;
}

static int firmware_crc(struct sim_slave *slave, const uint8_t *args, uint8_t *out)
{
	unsigned n;
	const uint8_t *from = firmware_part(slave, args, &n);

	if (!from)
		return REFUSED;
	sim_put(out, 2, sim_crc16(0, from, n));
	return 2;
}

static const struct command of_updater[] = {
	{0x00, 0, bootloader_size},
	{0x01, 0, erase_firmware},
	{0x04, 0, firmware_range},
	{0x05, 0, boot_application},
	{0x06, 8, inferno_write_block},
	{0x07, 8, firmware_crc},
	{0},
};

/* Switches, LEDs (one bit a channel), relays: ports and channels. */
static int count_ports(struct sim_slave *slave, const uint8_t *args, uint8_t *out)
{
	(void)args;
	out[0] = slave->code == 0x03 ? 1 : PORTS;
	out[1] = CHANNELS;
	return 2;
}

static int set_switch_type(struct sim_slave *slave, const uint8_t *args, uint8_t *out)
{
	struct inferno *s = slave->state;

	(void)out;
	if (args[0] >= PORTS || args[1] >= CHANNELS || args[2] > 3)
		return REFUSED;
	s->type[args[0]][args[1]] = args[2];
	s->active[args[0]] &= (uint8_t) ~(1u << args[1]);
	return 0;
}

static int read_activated(struct sim_slave *slave, const uint8_t *args, uint8_t *out)
{
	struct inferno *s = slave->state;

	(void)args;
	memcpy(out, s->active, PORTS);
	for (unsigned port = 0; port < PORTS; port++)
		for (unsigned i = 0; i < CHANNELS; i++)
			if (s->type[port][i] >= 2) /* momentary */
				s->active[port] &= (uint8_t) ~(1u << i);
	s->status &= (uint8_t)~ACTIVATED;
	return PORTS;
}

static int set_led(struct sim_slave *slave, const uint8_t *args, uint8_t *out)
{
	uint8_t *led = sim_state(slave, inferno)->led + args[0] % PORTS;

	(void)out;
	if (args[0] >= PORTS || args[1] >= CHANNELS)
		return REFUSED;
	*led = (uint8_t)((*led & ~(1u << args[1])) | (args[2] ? 1u << args[1] : 0));
	return 0;
}

static int get_led(struct sim_slave *slave, const uint8_t *args, uint8_t *out)
{
	out[0] = sim_state(slave, inferno)->led[args[0] % PORTS];
	return args[0] < PORTS ? 1 : REFUSED;
}

/* 09h mode, 0Ah timeout, 0Bh state; 0Ch states, 0Dh modes, 0Eh timeouts. */
static int set_relay(struct sim_slave *slave, const uint8_t *args, uint8_t *out)
{
	static const uint8_t which[] = {1, 2, 0};

	(void)out;
	if (args[0] || args[1] >= RELAYS)
		return REFUSED;
	sim_state(slave, inferno)->relay[which[slave->code - 0x09]][args[1]] = args[2];
	return 0;
}

static int get_relays(struct sim_slave *slave, const uint8_t *args, uint8_t *out)
{
	(void)args;
	memcpy(out, sim_state(slave, inferno)->relay[slave->code - 0x0C], RELAYS);
	return RELAYS;
}

static const struct command of_switches[] = {
	{0x01, 0, count_ports},    {0x02, 0, count_ports},
	{0x03, 0, count_ports},    {0x04, 3, set_switch_type},
	{0x06, 0, read_activated}, {0x07, 3, set_led},
	{0x08, 1, get_led},        {0x09, 3, set_relay},
	{0x0A, 3, set_relay},      {0x0B, 3, set_relay},
	{0x0C, 0, get_relays},     {0x0D, 0, get_relays},
	{0x0E, 0, get_relays},     {0},
};

static int boot_updater(struct sim_slave *slave, const uint8_t *args, uint8_t *out)
{
	struct inferno *s = slave->state;

	(void)args, (void)out;
	s->kind = UPDATER;
	s->status = POWER_ON;
	return SILENT;
}

static const struct command *inferno_find(struct sim_slave *slave)
{
	static const struct command *const tables[] = {
		[RGBW] = of_rgbw, [UPDATER] = of_updater, [SWITCHES] = of_switches};
	static const struct command boot = {BOOT_UPDATER, 0, boot_updater};
	const struct command *c = tables[sim_state(slave, inferno)->kind];

	if (slave->code == BOOT_UPDATER)
		return &boot;
	while (c->answer && c->code != slave->code)
		c++;
	return c->answer ? c : NULL;
}

static void inferno_begin(struct sim_slave *slave)
{
	sim_state(slave, inferno)->got = 0;
	if (!inferno_find(slave))
		sim_end(slave);
}

/* The bytes of a block and their CRC16, four bytes of which two count. */
static void take_block(struct sim_slave *slave)
{
	struct inferno *s = slave->state;
	const uint8_t *block = s->taken + WRITTEN + 1;
	unsigned n;
	uint8_t *to = firmware_part(slave, s->taken, &n);
	bool good;

	if (s->got < WRITTEN + 1 + n + 4)
		return;
	good = sim_crc16(0, block, n) == sim_get(block + n, 2);
	s->status = good ? SUCCESS : FAIL;
	if (good)
		memcpy(to, block, n);
	sim_send_byte(slave, !good);
}

static void inferno_take(struct sim_slave *slave, uint8_t byte)
{
	struct inferno *s = slave->state;
	const struct command *c = inferno_find(slave);
	uint8_t crc, out[1 + 16] = {0};
	int n = REFUSED;

	s->taken[s->got++] = byte;
	if (!c || s->got <= c->args)
		return;
	if (s->got > c->args + 1) {
		take_block(slave);
		return;
	}
	crc = sim_crc8(0, slave->rom, 8);
	crc = sim_crc8(crc, &c->code, 1);
	if (sim_crc8(crc, s->taken, c->args) == byte)
		n = c->answer(slave, s->taken, out + 1);
	if (n == REFUSED)
		sim_send_byte(slave, 1);
	else if (n == SILENT)
		sim_end(slave);
	else
		sim_send(slave, out, 1u + (unsigned)n);
}

/* The block that a command has announced may come. */
static void inferno_answered(struct sim_slave *slave)
{
	const struct inferno *s = slave->state;

	if (s->kind == UPDATER && slave->code == 0x06 && s->got == WRITTEN + 1 &&
	    slave->send[0] == 0)
		sim_receive(slave);
}

static void inferno_identity(struct sim_slave *slave)
{
	struct inferno *s = slave->state;
	uint8_t out[8] = {0};

	if (slave->code == STATUS)
		out[0] = s->status;
	else
		sim_put(out, 4, slave->code == DEVICE ? (int)s->kind : 7);
	sim_send(slave, out, slave->code == STATUS ? 8 : 4);
}

static void inferno_power_on(struct sim_slave *slave)
{
	struct inferno *s = slave->state;

	s->kind = application(slave);
	s->status = POWER_ON;
	memset(s->light, 0, sizeof(s->light));
	memset(s->led, 0, sizeof(s->led));
	memset(s->active, 0, sizeof(s->active));
	memset(s->relay[0], 0, RELAYS);
}

/* Types 0 and 2 are switches to VCC, 1 and 3 to ground; 2 and 3 are momentary, and latched. */
static void inferno_advance(struct sim_slave *slave)
{
	struct inferno *s = slave->state;

	for (unsigned i = 0; slave->family->inputs && i < PORTS * CHANNELS; i++) {
		unsigned port = i / CHANNELS, channel = i % CHANNELS;
		uint8_t type = s->type[port][channel], bit = (uint8_t)(1u << channel);
		bool on = (sim_input_now(slave, i) >= 0.5) != (type & 1);

		if (on && !(s->active[port] & bit))
			s->status |= ACTIVATED;
		if (on)
			s->active[port] |= bit;
		else if (type < 2)
			s->active[port] &= (uint8_t)~bit;
	}
}

/* What the tables above have is the commands of the device as it is now. */
static const struct sim_function functions[] = {
	{.code = STATUS, .start = inferno_identity},
	{.code = VERSION, .start = inferno_identity},
	{.code = DEVICE, .start = inferno_identity},
	{.any = true, .start = inferno_begin, .byte = inferno_take, .next = inferno_answered},
	{0},
};

static const struct sim_input switches[] = {
	{SIM_CONDITION("switch.0.0")}, {SIM_CONDITION("switch.0.1")}, {SIM_CONDITION("switch.0.2")},
	{SIM_CONDITION("switch.0.3")}, {SIM_CONDITION("switch.1.0")}, {SIM_CONDITION("switch.1.1")},
	{SIM_CONDITION("switch.1.2")}, {SIM_CONDITION("switch.1.3")}, {0}};

#define INFERNO(part, which, inputs_) \
	.name = (part), .code = 0xED, .resume = true, .inputs = (inputs_), \
	.state_size = sizeof(struct inferno), .functions = functions, \
	.kind = &(const enum kind){which}, .power_on = inferno_power_on, \
	.advance = inferno_advance

const struct sim_family sim_inferno_switches = {INFERNO("IE_SWITCH_MASTER", SWITCHES, switches)};
const struct sim_family sim_inferno_rgbw = {INFERNO("IE_RGBW", RGBW, NULL)};
const struct sim_family sim_inferno_updater = {INFERNO("IE_UPDATER", UPDATER, NULL)};
